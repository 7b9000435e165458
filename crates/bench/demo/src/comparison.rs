//! The estimates of a study beside the truth.

use rig::bench_parameters::BenchParameters;
use rig::results::{Notation, Parameter, Quantity, WrittenParameter};
use serde::Serialize;
use study::Study;

/// Relative difference of numbers that are the same but for rounding.
const ROUNDING: f64 = 1e-9;

/// One quantity, estimated or not, beside its true value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The quantity in words.
    pub quantity: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// The unit of all that follows.
    pub unit: &'static str,
    /// The true value.
    pub truth: f64,
    /// The estimate; none where there is none.
    pub estimate: Option<WrittenParameter>,
    /// True where the 95 % interval contains the true value.
    pub contains_truth: Option<bool>,
}

/// The quantities whose truth is known, in the order of the report.
pub fn rows(study: &Study, parameters: &BenchParameters) -> Vec<Row> {
    let truth = virtual_bench::Truth::of(parameters);
    let controller = |quantity| study.speed_controller.estimated().and_then(|part| part.estimate.parameter(quantity));
    let feed_forward = |quantity| study.feed_forward.estimated().and_then(|part| part.estimate.parameter(quantity));
    let shaft = |quantity| study.shaft.estimated().and_then(|part| part.estimate.parameter(quantity));
    let torque = |quantity| study.torque_control.estimated().and_then(|part| part.delay_and_lag.parameter(quantity));
    let resonance = study.whole.estimated().map(|part| &part.resonance_hz);
    let row = |quantity, of: Quantity, truth: f64, estimate: Option<&Parameter>| {
        let Notation { symbol, unit, per_si, .. } = of.notation();
        let contains_truth = estimate.map(|estimate| contains(estimate.interval, truth));
        let estimate = estimate.map(Parameter::written);
        Row { quantity, symbol, unit, truth: per_si * truth, estimate, contains_truth }
    };
    vec![
        row("shaft stiffness", Quantity::Stiffness, truth.stiffness_nm_per_rad, shaft(Quantity::Stiffness)),
        row("shaft damping", Quantity::Damping, truth.damping_nm_s_per_rad, shaft(Quantity::Damping)),
        row(
            "proportional gain",
            Quantity::ProportionalGain,
            truth.proportional_nm_s_per_rad,
            controller(Quantity::ProportionalGain),
        ),
        row("integral gain", Quantity::IntegralGain, truth.integral_nm_per_rad, controller(Quantity::IntegralGain)),
        row(
            "controller delay",
            Quantity::ControllerDelay,
            truth.controller_delay_s,
            controller(Quantity::ControllerDelay),
        ),
        row(
            "feed-forward of speed",
            Quantity::SpeedFeedForward,
            truth.speed_feed_forward_nm_s_per_rad,
            feed_forward(Quantity::SpeedFeedForward),
        ),
        row(
            "feed-forward of acceleration",
            Quantity::AccelerationFeedForward,
            truth.acceleration_feed_forward_nm_s2_per_rad,
            feed_forward(Quantity::AccelerationFeedForward),
        ),
        row(
            "torque control, total delay",
            Quantity::TorqueControlTotalDelay,
            truth.torque_control_delay_s,
            torque(Quantity::TorqueControlTotalDelay),
        ),
        row("resonance of T_d → T_shaft", Quantity::ResonanceFrequency, truth.resonance_hz, resonance),
    ]
}

/// Tells whether the interval contains the value, but for the rounding of computed numbers.
fn contains((low, high): (f64, f64), value: f64) -> bool {
    let rounding = ROUNDING * value.abs();
    low - rounding <= value && value <= high + rounding
}
