//! Loss-factor damping as a sum of relaxing springs.

use std::f64::consts::{FRAC_PI_2, TAU};

use serde::{Deserialize, Serialize};

use super::error::{ParameterError, require};

/// Relaxing springs in a decade of frequency; with two, the loss factor ripples by less than 3 %.
const A_DECADE: f64 = 2.0;
/// Decades by which the springs reach beyond the band, so that the loss factor holds up to its ends.
const BEYOND_DECADES: f64 = 1.0;

/// K(ω) = K_0 (1 + Σ g_i iωτ_i/(1 + iωτ_i)). In time: T = K_0 (φ + Σ g_i z_i), dz_i/dt = dφ/dt − z_i/τ_i.
#[derive(Debug, Clone, PartialEq)]
pub struct RelaxingSprings {
    /// K_0 ÷ K.
    pub static_ratio: f64,
    /// The springs that relax.
    pub springs: Vec<RelaxingSpring>,
}

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxingSpring {
    /// 1/τ_i, 1/s.
    pub rate: f64,
    /// K_0 g_i ÷ K.
    pub ratio: f64,
}

impl RelaxingSprings {
    /// The springs that give a loss factor; none without one.
    ///
    /// A constant loss factor belongs to K(ω) ∝ (iω)^β with η = tan(πβ/2), hence to g_i ∝ τ_i^{−β}. With S' + iS'' the
    /// sum at the reference for g_i = g (τ ω_ref)^{−β}, the two numbers follow from (1 + g S') K_0 = K and g S''/(1 + g
    /// S') = η.
    pub fn new(loss: Option<LossFactor>) -> Self {
        let Some(loss) = loss.filter(|loss| loss.loss_factor > 0.0) else {
            return Self { static_ratio: 1.0, springs: Vec::new() };
        };
        let decades = (loss.highest_hz / loss.lowest_hz).log10() + 2.0 * BEYOND_DECADES;
        let count = (decades * A_DECADE).ceil() as i32;
        let lowest = TAU * loss.lowest_hz * 10f64.powf(-BEYOND_DECADES);
        let power = loss.loss_factor.atan() / FRAC_PI_2;
        let reference = TAU * loss.reference_hz;
        let relative = |i: i32| lowest * 10f64.powf(decades * f64::from(i) / f64::from(count)) / reference;
        let rates: Vec<f64> = (0..=count).map(relative).collect();
        let real: f64 = rates.iter().map(|a| a.powf(power) / (a * a + 1.0)).sum();
        let imaginary: f64 = rates.iter().map(|a| a.powf(power) * a / (a * a + 1.0)).sum();
        let weight = loss.loss_factor / (imaginary - loss.loss_factor * real);
        let static_ratio = 1.0 / (1.0 + weight * real);
        let spring = |a: &f64| RelaxingSpring { rate: a * reference, ratio: static_ratio * weight * a.powf(power) };
        Self { static_ratio, springs: rates.iter().map(spring).collect() }
    }
}

/// Damping of rubber and the like: the complex stiffness is K(1 + iη) near the reference, and its loss factor stays
/// near η over the band, where a viscous damper's grows with frequency. Below and above the band it falls off.
///
/// A sum of relaxing springs: K(ω) = K_0 (1 + Σ g_i iωτ_i/(1 + iωτ_i)), two τ_i a decade, such that real part and loss
/// factor at the reference are K and η. The real part grows slowly with frequency, as causality asks for.
///
/// # Source
///
/// Wiechert's model; see Tschoegl, *The Phenomenological Theory of Linear Viscoelastic Behavior*, 1989, §3.5.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct LossFactor {
    /// η, 1.
    pub loss_factor: f64,
    /// Frequency at which stiffness and loss factor are those stated, Hz.
    pub reference_hz: f64,
    /// Lower end of the band, Hz.
    pub lowest_hz: f64,
    /// Upper end of the band, Hz.
    pub highest_hz: f64,
}

impl LossFactor {
    pub(super) fn check(&self, backlash_rad: f64) -> Result<(), ParameterError> {
        let (low, reference, high) = (self.lowest_hz, self.reference_hz, self.highest_hz);
        require("mechanics.shaft_loss", backlash_rad, backlash_rad == 0.0, "without backlash")?;
        let eta = self.loss_factor;
        require("mechanics.shaft_loss.loss_factor", eta, (0.0..=0.5).contains(&eta), "between 0 and 0.5")?;
        require("mechanics.shaft_loss.lowest_hz", low, low >= 1e-3, "at least 1 mHz")?;
        let requirement = "within the band";
        require("mechanics.shaft_loss.reference_hz", reference, (low..=high).contains(&reference), requirement)?;
        require("mechanics.shaft_loss.highest_hz", high, high <= 1e4 * low, "at most 10 000 times the lowest")?;
        let ratio = RelaxingSprings::new(Some(*self)).static_ratio;
        require("mechanics.shaft_loss.static_ratio", ratio, ratio > 0.0 && ratio <= 1.0, "reached by a narrower band")
    }
}
