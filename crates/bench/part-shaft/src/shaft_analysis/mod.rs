//! The shaft of every recording: by band of frequencies, with both inertias, against what may be in a shaft beyond K
//! and B, and of all recordings together (thesis §6.3.5, §7.2).

mod recording;
mod together;

use numerics::parallel;
use rig::estimation::{EstimateError, need};
use rig::experiment::{Sought, Test};
use rig::facts::BenchVariant;
use rig::results::{Estimate, Outcome, Part, Quantity, Reason, Shaft};
use rig::{BenchFile, Experiment, Role};
use serde::{Deserialize, Serialize};
use signal::Signal;
use work::Context;

use crate::Parts;
use crate::shaft::{self, Beyond, Fitted, ShaftInputs, Term, TermTest, Wanted};
use crate::shaft_routes::Timing;
use crate::shaft_routes::black_box;
use crate::shaft_routes::multisine::{self, DynoInertia};
use crate::shaft_routes::state_space::{self, Skews};
pub use recording::ShaftRecording;
pub use recording::{Band, DualMass, Routes};
pub use together::{CommonValue, Together};

/// Bands that the shaft is estimated from beside the whole one, Hz.
const BANDS_HZ: [(f64, f64); 4] = [(1.0, 20.0), (5.0, 40.0), (15.0, 60.0), (30.0, 110.0)];

/// Samples of T_d further apart than this, s, miss what moves the shaft.
const COARSE_S: f64 = 2e-3;
/// A simple shaft whose errors are this many times what noise explains is not the whole truth.
const MISFIT: f64 = 2.0;

/// Findings of recordings on the shaft.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShaftAnalysis {
    /// One entry a recording with a shaft.
    pub recordings: Vec<ShaftRecording>,
    /// K and B of all recordings together, from two on.
    pub together: Option<Together>,
}

/// Looks at the shaft in every recording that has one, on all processors. Each is a part of a step of the work.
///
/// Needs N_d, N_e and T_d,calc, on a bench with torque flange T_shaft in its place. The torque control is that of the
/// recording that is chosen for it, gate and noise of the encoder those of the chosen speed controller, where there is
/// one.
#[must_use]
pub fn shaft_analysis(parts: &Parts<'_>, context: &Context) -> ShaftAnalysis {
    // Chosen before the recordings are shared out.
    let _ = (parts.controllers.chosen(), parts.torque_controls.chosen());
    let with_shaft: Vec<&Experiment> =
        parts.experiments.iter().copied().filter(|e| !e.label.is_without_shaft()).collect();
    let step = context.step("looking at the shaft", with_shaft.len() as u64);
    let look = |experiment: &&Experiment| {
        let _part = step.step(format!("looking at the shaft in {}", experiment.file), 0);
        of_recording(experiment, parts)
    };
    let recordings = parallel::map(&with_shaft, look);
    let together = together::of(&recordings);
    ShaftAnalysis { recordings, together }
}

fn of_recording(experiment: &Experiment, parts: &Parts<'_>) -> ShaftRecording {
    let bench = parts.bench;
    let inputs = parts.shaft_inputs(experiment);
    let folded = inputs.as_ref().ok().and_then(|inputs| folded_torque(&experiment.file, inputs, bench));
    let shaft = match &folded {
        Some(why) if !Sought::Shaft.is_given_by(experiment) => Outcome::because(why.clone()),
        _ => Outcome::from(parts.shaft(experiment).map(|shaft| shaft.as_ref().clone())),
    };
    let no_shaft = Outcome::because(Reason::Part { part: Part::Shaft });
    let (mut bands, mut beyond, mut inertias) = (Vec::new(), no_shaft, None);
    let (mut dual_mass, mut routes) = (None, Routes::default());
    if let (Ok(inputs), Outcome::Estimated(shaft)) = (&inputs, &shaft) {
        routes = by_other_routes(experiment, inputs, shaft, bench);
        bands = shaft::checks::by_band(inputs, &BANDS_HZ).map(by_band).unwrap_or_default();
        beyond = folded.map_or_else(|| shaft::checks::beyond(inputs).into(), Outcome::because);
        dual_mass = needs_dual_mass(bench, &beyond).then(|| with_dual_mass(inputs).into());
        let both = || Outcome::from(parts.inertias(experiment).map(|both| both.as_ref().clone()));
        inertias = parts.gives_inertias(experiment).then(both);
    }
    let (file, label) = (experiment.file.clone(), experiment.label.clone());
    let inertia = shaft.estimated().and_then(|shaft| shaft.estimate.parameter(Quantity::DynoInertia));
    let inertia_contradiction =
        inertia.and_then(|found| bench.dynamometer_inertia().contradicted_by(found.value, found.standard_error));
    ShaftRecording { file, label, shaft, inertia_contradiction, bands, beyond, dual_mass, routes, inertias }
}

/// Why T_d is not known between its samples, where it is not and they are far apart. What folds in them is taken for
/// the shaft: beside a demand that moves T_d it is little, beside a motored engine alone it is most of T_d.
fn folded_torque(file: &str, inputs: &ShaftInputs<'_>, bench: &BenchFile) -> Option<Reason> {
    let apart_s = inputs.torque.iter().map(|torque| torque.signal.sample_time_s).fold(f64::INFINITY, f64::min);
    let is_coarse = bench.variant == BenchVariant::LoadCell && apart_s > COARSE_S;
    is_coarse.then(|| Reason::FoldedTorque { file: file.to_owned(), apart_s })
}

fn by_other_routes(experiment: &Experiment, inputs: &ShaftInputs<'_>, shaft: &Shaft, bench: &BenchFile) -> Routes {
    let Some(timing) = Timing::of(&shaft.estimate).filter(|_| inputs.inertia_kg_m2.is_some()) else {
        return Routes::default();
    };
    let engine = bench.engine();
    let multisine = |demand: &Signal| multisine::estimate(inputs, demand, &timing, DynoInertia::Stated, engine);
    let demand = need(experiment, Role::DynoTorqueDemand);
    Routes {
        state_space: Some(state_space::estimate(inputs, &timing, Skews::Estimated).into()),
        black_box: experiment
            .is_test(&Test::Unfired)
            .then(|| black_box::estimate(inputs, &timing, engine, experiment.label.mode).into()),
        multisine: experiment.is_test(&Test::Multisine).then(|| demand.and_then(multisine).into()),
        torque_sample_time_s: inputs.torque.iter().map(|torque| torque.signal.sample_time_s).min_by(f64::total_cmp),
    }
}

fn needs_dual_mass(bench: &BenchFile, beyond: &Outcome<Beyond>) -> bool {
    let shows_more = |beyond: &Beyond| {
        let second_mass = |test: &TermTest| test.found && test.term == Term::SecondMass;
        beyond.simple_misfit > MISFIT || beyond.tests.iter().any(second_mass)
    };
    bench.variant == BenchVariant::TorqueFlange || beyond.estimated().is_some_and(shows_more)
}

fn with_dual_mass(inputs: &ShaftInputs<'_>) -> Result<DualMass, EstimateError> {
    let Fitted { estimate, misfit } = shaft::fit(inputs, Wanted::DualMass)?;
    Ok(DualMass { estimate, misfit })
}

fn by_band(found: Vec<Option<(Estimate, Estimate)>>) -> Vec<Band> {
    let band = |(band_hz, found): (&(f64, f64), Option<(Estimate, Estimate)>)| {
        let (estimate, ignoring_timing) = found?;
        Some(Band { band_hz: *band_hz, estimate, ignoring_timing })
    };
    BANDS_HZ.iter().zip(found).filter_map(band).collect()
}
