//! Stability margins of the speed loop.

use std::f64::consts::TAU;

use numerics::search;
use signal::Complex64;

use crate::analysis::Margins;
use crate::model::BenchModel;

const LOWEST_HZ: f64 = 0.01;
const POINTS: usize = 6000;

/// Gain and phase margin of the speed loop L ([`BenchModel::open_loop`]) from 0.01 Hz to half the controller's rate.
///
/// Where |L| crosses one several times, as it may about the resonance, the crossing with the smallest phase margin is
/// reported; where L crosses the negative real axis several times, the one whose gain is nearest to one. A positive
/// gain margin shows by how much the gain may grow, a negative one by how much it must fall (or, for a loop that is
/// stable only within bounds, may fall). `None` without controller or torque control, or where there is no crossing.
///
/// # Source
/// Åström & Murray, *Feedback Systems*, 2nd ed. 2021, §10.3.
pub fn margins(model: &BenchModel) -> Option<Margins> {
    let highest_hz = 0.5 / model.speed_controller?.sample_time_s;
    let ratio = (highest_hz / LOWEST_HZ).ln() / (POINTS - 1) as f64;
    let grid: Vec<f64> = (0..POINTS).map(|i| LOWEST_HZ * (ratio * i as f64).exp()).collect();
    model.open_loop(1.0)?;
    let open_loop = |f: f64| model.open_loop(TAU * f).unwrap_or_default();
    let phase_margin = |f: f64| (-open_loop(f)).arg().to_degrees();
    let gain_margin = |f: f64| -20.0 * open_loop(f).norm().log10();
    let crossover_hz = crossings(&grid, &open_loop, |l| l.norm() - 1.0, |_| true)
        .min_by(|a, b| phase_margin(*a).abs().total_cmp(&phase_margin(*b).abs()))?;
    let gain_margin_db = crossings(&grid, &open_loop, |l| l.im, |l| l.re < 0.0)
        .map(gain_margin)
        .min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    Some(Margins { gain_margin_db, phase_margin_deg: phase_margin(crossover_hz), crossover_hz })
}

/// Frequencies at which `measure` of the loop changes sign, where `counts`.
fn crossings(
    grid: &[f64],
    open_loop: &impl Fn(f64) -> Complex64,
    measure: impl Fn(Complex64) -> f64,
    counts: impl Fn(Complex64) -> bool,
) -> impl Iterator<Item = f64> {
    grid.windows(2).filter_map(move |pair| {
        let rises = measure(open_loop(pair[0])) < 0.0;
        let is_before = |frequency_hz: f64| rises == (measure(open_loop(frequency_hz)) < 0.0);
        if is_before(pair[1]) {
            return None;
        }
        let (low, _) = search::bisect((pair[0], pair[1]), is_before);
        counts(open_loop(low)).then_some(low)
    })
}
