//! What the assembled model says: resonance, Bode curves, margins, and sine tests held against it.

mod bode;
mod influence;
mod margins;
mod segments;
mod sine;

pub use margins::margins;
pub use segments::{Segment, steady_sines};
pub use sine::{SignalSkews, SineTest, sine_points};

use crate::estimate::{EstimateError, Label};
use crate::model::{BenchModel, Engine, ModelUncertainty};
use crate::study::{Influence, Margins, Parameter, WholeModel};

/// What the analysis works on.
#[derive(Debug, Clone, Copy)]
pub struct WholeInputs<'a> {
    /// The model.
    pub model: &'a BenchModel,
    /// Its uncertainty.
    pub uncertainty: &'a ModelUncertainty,
    /// The engine's firing.
    pub engine: Engine,
    /// Sine tests in torque control.
    pub sine_tests: &'a [SineTest<'a>],
}

/// Analyses the assembled model. Standard errors are by the delta method from the parameters' covariance, with
/// 95 % Student-t intervals.
///
/// Curves that need a part the model lacks are left out; so are the margins.
///
/// # Errors
/// A sine test lacks a signal or cannot be processed.
pub fn whole_model(inputs: &WholeInputs<'_>) -> Result<WholeModel, EstimateError> {
    let mut sine = Vec::new();
    for test in inputs.sine_tests {
        sine.extend(sine_points(inputs.model, inputs.engine, test)?);
    }
    let number = |label, function: &dyn Fn(&BenchModel) -> f64| -> Parameter {
        inputs.uncertainty.propagate(inputs.model, function).parameter(label)
    };
    let engine = inputs.engine;
    let moved = |label, function: &dyn Fn(&BenchModel) -> f64| -> Influence {
        influence::influence((label, inputs.model, inputs.uncertainty), function)
    };
    let mut influences = vec![
        moved(RESONANCE, &|m| m.mechanics.resonance().frequency_hz),
        moved(GAIN, &|m| m.mechanics.resonance().gain),
        moved(DAMPING, &|m| m.mechanics.resonance().damping_ratio),
    ];
    if margins(inputs.model).is_some() {
        let of_loop = |value: fn(&Margins) -> f64| move |m: &BenchModel| margins(m).as_ref().map_or(f64::NAN, value);
        influences.push(moved(CROSSOVER, &of_loop(|m| m.crossover_hz)));
        influences.push(moved(PHASE_MARGIN, &of_loop(|m| m.phase_margin_deg)));
    }
    Ok(WholeModel {
        resonance_hz: number(RESONANCE, &|m| m.mechanics.resonance().frequency_hz),
        resonance_gain: number(GAIN, &|m| m.mechanics.resonance().gain),
        static_gain: inputs.model.mechanics.static_gain(),
        firing_meets_resonance_rpm: number(FIRING, &|m| engine.firing_speed_rpm(m.mechanics.resonance().frequency_hz)),
        damping_ratio: number(DAMPING, &|m| m.mechanics.resonance().damping_ratio),
        bode: bode::curves(inputs.model, inputs.uncertainty),
        sine_points: sine,
        speed_loop_margins: margins(inputs.model),
        influences,
    })
}

const RESONANCE: Label = Label { symbol: "f_r", name: "resonance of T_d → T_shaft", unit: "Hz" };
const GAIN: Label = Label { symbol: "g_r", name: "gain at the resonance", unit: "Nm/Nm" };
const FIRING: Label = Label { symbol: "N_r", name: "speed at which firing meets the resonance", unit: "rpm" };
const DAMPING: Label = Label { symbol: "ζ", name: "damping ratio of the resonance", unit: "1" };
const CROSSOVER: Label = Label { symbol: "f_c", name: "crossover of the speed loop", unit: "Hz" };
const PHASE_MARGIN: Label = Label { symbol: "φ_m", name: "phase margin of the speed loop", unit: "°" };
