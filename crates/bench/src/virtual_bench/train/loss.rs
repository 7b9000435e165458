//! Loss-factor damping as a sum of relaxing springs.

use std::f64::consts::TAU;

use crate::virtual_bench::parameters::LossFactor;

/// Relaxing springs in a decade of frequency; with two, the loss factor ripples by less than 3 %.
const A_DECADE: f64 = 2.0;
/// Decades by which the springs reach beyond the band, so that the loss factor holds up to its ends.
const BEYOND_DECADES: f64 = 0.5;

/// K(ω) = K_0 (1 + g Σ iωτ_i/(1 + iωτ_i)). In time: T = K_0 φ + K_0 g Σ z_i, dz_i/dt = dφ/dt − z_i/τ_i.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RelaxingSprings {
    /// K_0 ÷ K.
    pub(super) static_ratio: f64,
    /// K_0 g ÷ K, of each spring.
    pub(super) ratio: f64,
    /// 1/τ_i, 1/s.
    pub(super) rates: Vec<f64>,
}

impl RelaxingSprings {
    /// The springs that give a loss factor; none without one.
    ///
    /// With S' + iS'' the sum at the reference, (1 + g S') K_0 = K and g S''/(1 + g S') = η.
    pub(super) fn new(loss: Option<LossFactor>) -> Self {
        let Some(loss) = loss.filter(|loss| loss.loss_factor > 0.0) else {
            return Self { static_ratio: 1.0, ratio: 0.0, rates: Vec::new() };
        };
        let decades = (loss.highest_hz / loss.lowest_hz).log10() + 2.0 * BEYOND_DECADES;
        let springs = (decades * A_DECADE).ceil() as i32;
        let lowest = TAU * loss.lowest_hz * 10f64.powf(-BEYOND_DECADES);
        let rates: Vec<f64> =
            (0..=springs).map(|i| lowest * 10f64.powf(decades * f64::from(i) / f64::from(springs))).collect();
        let w = TAU * loss.reference_hz;
        let real: f64 = rates.iter().map(|a| w * w / (a * a + w * w)).sum();
        let imaginary: f64 = rates.iter().map(|a| w * a / (a * a + w * w)).sum();
        let weight = loss.loss_factor / (imaginary - loss.loss_factor * real);
        let static_ratio = 1.0 / (1.0 + weight * real);
        Self { static_ratio, ratio: static_ratio * weight, rates }
    }
}
