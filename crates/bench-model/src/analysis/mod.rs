//! What the assembled model says: resonance, Bode curves, margins, and sine tests held against it.

mod bode;
mod influence;
mod margins;
mod result;

use rig::estimation::Label;
use rig::facts::Engine;
use rig::results::Parameter;

use crate::model::{BenchModel, ModelUncertainty};
pub use margins::margins;
pub use result::{BodeCurve, Influence, Margins, ParameterInfluence, SinePoint, WholeModel};

/// What the analysis works on.
#[derive(Debug, Clone, Copy)]
pub struct WholeInputs<'a> {
    /// The model.
    pub model: &'a BenchModel,
    /// Its uncertainty.
    pub uncertainty: &'a ModelUncertainty,
    /// The engine's firing.
    pub engine: Engine,
    /// Gains measured by sine tests in torque control.
    pub sine_points: &'a [SinePoint],
}

/// Analyses the assembled model. Standard errors are by the delta method from the parameters' covariance, with
/// 95 % Student-t intervals.
///
/// Curves that need a part the model lacks are left out; so are the margins.
pub fn whole_model(inputs: &WholeInputs<'_>) -> WholeModel {
    let number = |label, function: &dyn Fn(&BenchModel) -> f64| -> Parameter {
        inputs.uncertainty.propagate(inputs.model, function).parameter(label)
    };
    let engine = inputs.engine;
    let influences = results(inputs.model)
        .map(|(label, function)| influence::influence((label, inputs.model, inputs.uncertainty), function));
    WholeModel {
        resonance_hz: number(RESONANCE, &resonance_hz),
        resonance_gain: number(GAIN, &resonance_gain),
        static_gain: inputs.model.mechanics.static_gain(),
        firing_meets_resonance_rpm: number(FIRING, &|m| engine.firing_speed_rpm(m.mechanics.resonance().frequency_hz)),
        damping_ratio: number(DAMPING, &damping_ratio),
        bode: bode::curves(inputs.model, inputs.uncertainty),
        sine_points: inputs.sine_points.to_vec(),
        speed_loop_margins: margins(inputs.model),
        influences: influences.collect(),
    }
}

/// What is computed from a model, each with its interval: resonance, gain and damping there, and of the speed loop, if there
/// is one, crossover and phase margin.
pub fn results_of(model: &BenchModel, uncertainty: &ModelUncertainty) -> Vec<Parameter> {
    results(model).map(|(label, function)| uncertainty.propagate(model, function).parameter(label)).collect()
}

/// A number that a model gives.
type ModelResult = (Label, fn(&BenchModel) -> f64);

fn results(model: &BenchModel) -> impl Iterator<Item = ModelResult> + use<> {
    let shaft: [ModelResult; 3] = [(RESONANCE, resonance_hz), (GAIN, resonance_gain), (DAMPING, damping_ratio)];
    let speed_loop: [ModelResult; 2] = [(CROSSOVER, crossover_hz), (PHASE_MARGIN, phase_margin_deg)];
    let has_loop = margins(model).is_some();
    shaft.into_iter().chain(speed_loop.into_iter().filter(move |_| has_loop))
}

fn resonance_hz(model: &BenchModel) -> f64 {
    model.mechanics.resonance().frequency_hz
}

fn resonance_gain(model: &BenchModel) -> f64 {
    model.mechanics.resonance().gain
}

fn damping_ratio(model: &BenchModel) -> f64 {
    model.mechanics.resonance().damping_ratio
}

fn crossover_hz(model: &BenchModel) -> f64 {
    margins(model).map_or(f64::NAN, |m| m.crossover_hz)
}

fn phase_margin_deg(model: &BenchModel) -> f64 {
    margins(model).map_or(f64::NAN, |m| m.phase_margin_deg)
}

const RESONANCE: Label = Label { symbol: "f_r", name: "resonance of T_d → T_shaft", unit: "Hz" };
const GAIN: Label = Label { symbol: "g_r", name: "gain at the resonance", unit: "Nm/Nm" };
const FIRING: Label = Label { symbol: "N_r", name: "speed at which firing meets the resonance", unit: "rpm" };
const DAMPING: Label = Label { symbol: "ζ", name: "damping ratio of the resonance", unit: "1" };
const CROSSOVER: Label = Label { symbol: "f_c", name: "crossover of the speed loop", unit: "Hz" };
const PHASE_MARGIN: Label = Label { symbol: "φ_m", name: "phase margin of the speed loop", unit: "°" };
