//! T_e, the engine's torque, which no bench records: rebuilt from N_d, N_e and T_d on the two masses and the shaft
//! between them (6.1), (6.4), by a fixed-interval smoother with its uncertainty, cycle by cycle and, where firings are
//! separated, cylinder by cylinder.
//!
//! Engine torque rebuilt from recordings: gas torque and the inertia torque of pistons and rods, less the engine's
//! friction. It also holds the bearing friction of the dynamometer at the mean speed, which nothing with the shaft on
//! separates from it.

mod certainty;
mod cycles;
pub mod firing;
pub mod folded_pulses;
pub mod orders;
pub mod pulse_path;
mod pulses;
mod rebuild;
mod source;

use numerics::parallel;
use part_shaft::Parts;
use part_shaft::shaft_inputs::stated_gate;
use rig::prepare::believable;
use rig::results::{Outcome, Reason, read_found, write_found};
use rig::{Experiment, ExperimentLabel};
use serde::{Deserialize, Serialize};
use work::Context;

pub use self::certainty::Certainty;
pub use self::cycles::{Cycle, Cycles, Cylinder, Cylinders, CylindersOnceATurn, Order, Profile};
pub use self::pulses::engine_pulses;
pub use self::rebuild::RebuiltEngine;
pub use self::source::{InertiaSource, TwoMasses};

/// Findings of recordings on the engine's torque.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EngineTorque {
    /// The masses and the shaft that all recordings are rebuilt with, or why there are none.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub masses: Outcome<TwoMasses>,
    /// One entry a recording with a shaft; none without masses.
    pub recordings: Vec<EngineRecording>,
}

/// Findings of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EngineRecording {
    /// The file.
    pub file: String,
    /// The experiment's label.
    pub label: ExperimentLabel,
    /// The engine's torque.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub engine: Outcome<RebuiltEngine>,
    /// The same by cycle and cylinder; not estimated where firings are too fast for the rate of N_d.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub cycles: Outcome<Cycles>,
}

/// Rebuilds the engine's torque of every recording with a shaft. Each is a part of a step of the work.
///
/// Shaft and J_e are those of the recordings that are chosen for them, J_e otherwise the bench file's. Recordings whose
/// T_d,calc has the wrong sign are not used.
#[must_use]
pub fn engine_torque(parts: &Parts<'_>, context: &Context) -> EngineTorque {
    let all: Vec<&Experiment> = parts.experiments.iter().copied().filter(|e| !e.label.is_without_shaft()).collect();
    let unbelievable = || all.iter().map(|experiment| believable(experiment)).collect::<Result<Vec<()>, _>>().err();
    let masses = TwoMasses::of(parts).map_err(|needs| unbelievable().map_or(needs, |error| vec![error.into()]));
    let masses = match masses {
        Ok(masses) => masses,
        Err(needs) => return EngineTorque { masses: Outcome::NotEstimated { needs }, recordings: Vec::new() },
    };
    let known = rebuild::Known {
        engine: parts.bench.engine(),
        stated_gate_s: stated_gate(parts.bench),
        controller: parts.controllers.best(),
        torque_control: parts.torque_controls.best(),
    };
    let step = context.step("rebuilding the engine torque", all.len() as u64);
    let look = |experiment: &&Experiment| {
        let _part = step.step(format!("rebuilding the engine torque of {}", experiment.file), 0);
        of_recording(experiment, &masses, &known)
    };
    let recordings = parallel::map(&all, look);
    EngineTorque { masses: Outcome::Estimated(masses), recordings }
}

fn of_recording(experiment: &Experiment, masses: &TwoMasses, known: &rebuild::Known<'_>) -> EngineRecording {
    let rebuilt =
        believable(experiment).and_then(|()| rebuild::rebuild(experiment, masses, known)).map_err(Reason::from);
    let (engine, cycles) = match rebuilt {
        Ok((engine, motion)) => {
            let cycles = cycles::of(&engine, &motion, known.engine).into();
            (Outcome::Estimated(engine), cycles)
        }
        Err(why) => (Outcome::because(why.clone()), Outcome::because(why)),
    };
    EngineRecording { file: experiment.file.clone(), label: experiment.label.clone(), engine, cycles }
}
