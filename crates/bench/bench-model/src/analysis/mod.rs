//! Results of the assembled model: resonance, Bode curves, margins, and sine tests held against it.

mod bode;
mod influence;
mod margins;
mod result;

use rig::facts::Engine;
use rig::results::{Parameter, Quantity};
use units::RPM_RAD_S;

use crate::model::{BenchModel, ModelUncertainty};
pub use margins::margins;
pub use result::{BodeCurve, Influence, Margins, ParameterInfluence, SinePoint, WholeModel};

/// Inputs of the analysis.
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
    let number = |quantity, function: &dyn Fn(&BenchModel) -> f64| -> Parameter {
        inputs.uncertainty.propagate(inputs.model, function).parameter(quantity)
    };
    let engine = inputs.engine;
    let influences = results(inputs.model)
        .map(|(quantity, function)| influence::influence(quantity, inputs.model, inputs.uncertainty, function));
    WholeModel {
        resonance_hz: number(Quantity::ResonanceFrequency, &resonance_hz),
        resonance_gain: number(Quantity::ResonanceGain, &resonance_gain),
        static_gain: inputs.model.mechanics.static_gain(),
        firing_meets_resonance: number(Quantity::FiringResonanceSpeed, &|m| {
            engine.firing_speed_rpm(m.mechanics.resonance().frequency_hz) * RPM_RAD_S
        }),
        damping_ratio: number(Quantity::ResonanceDampingRatio, &damping_ratio),
        bode: bode::curves(inputs.model, inputs.uncertainty),
        sine_points: inputs.sine_points.to_vec(),
        speed_loop_margins: margins(inputs.model),
        influences: influences.collect(),
    }
}

/// Results computed from a model, each with its interval: resonance, with gain and damping there. A speed loop adds
/// crossover and phase margin.
pub fn results_of(model: &BenchModel, uncertainty: &ModelUncertainty) -> Vec<Parameter> {
    results(model).map(|(quantity, function)| uncertainty.propagate(model, function).parameter(quantity)).collect()
}

/// A number that a model gives.
type ModelResult = (Quantity, fn(&BenchModel) -> f64);

fn results(model: &BenchModel) -> impl Iterator<Item = ModelResult> + use<> {
    let shaft: [ModelResult; 3] = [
        (Quantity::ResonanceFrequency, resonance_hz),
        (Quantity::ResonanceGain, resonance_gain),
        (Quantity::ResonanceDampingRatio, damping_ratio),
    ];
    let speed_loop: [ModelResult; 2] = [(Quantity::Crossover, crossover_hz), (Quantity::PhaseMargin, phase_margin_rad)];
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

fn phase_margin_rad(model: &BenchModel) -> f64 {
    margins(model).map_or(f64::NAN, |m| m.phase_margin_deg.to_radians())
}
