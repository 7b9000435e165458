//! Where T_d → T_shaft has its largest gain.

use super::assembly::Assembly;
use crate::virtual_bench::parameters::MechanicsParameters;

/// Frequencies between which it is looked for, Hz.
const RANGE_HZ: (f64, f64) = (1.0, 200.0);
/// Frequencies tried first, and steps of the golden section after them.
const TRIED: usize = 2000;
const GOLDEN_STEPS: usize = 40;

/// Frequency of the largest gain of T_d → T_shaft in torque control, Hz, with play and stiffening left out.
pub(crate) fn resonance_hz(parameters: &MechanicsParameters) -> f64 {
    let assembly = Assembly::new(parameters, true);
    let gain = |log_hz: f64| assembly.shaft_gain(log_hz.exp());
    let (low, high) = (RANGE_HZ.0.ln(), RANGE_HZ.1.ln());
    let spacing = (high - low) / TRIED as f64;
    let tried = (0..=TRIED).map(|k| low + k as f64 * spacing);
    let best = tried.max_by(|a, b| gain(*a).total_cmp(&gain(*b))).unwrap_or(low);
    let (mut left, mut right) = (best - spacing, best + spacing);
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..GOLDEN_STEPS {
        let (a, b) = (right - golden * (right - left), left + golden * (right - left));
        if gain(a) > gain(b) {
            right = b;
        } else {
            left = a;
        }
    }
    (0.5 * (left + right)).exp()
}
