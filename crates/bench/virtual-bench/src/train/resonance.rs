//! Where T_d → T_shaft has its largest gain.

use std::ops::RangeInclusive;

use numerics::search::global_maximum;
use rig::bench_parameters::MechanicsParameters;

use super::assembly::Assembly;

/// Frequencies between which it is looked for, Hz.
const RANGE_HZ: RangeInclusive<f64> = 1.0..=200.0;
/// Frequencies tried first.
const TRIED: usize = 2000;

/// Frequency of the largest gain of T_d → T_shaft in torque control, Hz, with play and stiffening left out.
pub(crate) fn resonance_hz(parameters: &MechanicsParameters) -> f64 {
    let assembly = Assembly::new(parameters, true);
    let gain = |log_hz: f64| assembly.shaft_gain(log_hz.exp());
    global_maximum((RANGE_HZ.start().ln(), RANGE_HZ.end().ln()), TRIED, gain).exp()
}
