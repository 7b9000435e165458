//! The engine's torque.

use page::Blocks;
use part_engine::{EngineRecording, EngineTorque};
use rig::results::Outcome;

use super::words;
use crate::blocks::{figures, no_result, of_recording, plain_table, sentence};
use crate::wording;

/// The section on the engine's torque.
pub(crate) fn analysis(found: &EngineTorque) -> Blocks {
    let mut all = sentence(
        "No bench records the torque of the engine. It is computed from both speeds and T_d, with the shaft and the \
         inertias estimated from the recordings",
    );
    match &found.masses {
        Outcome::Estimated(masses) => all.push(sentence(&words::masses(masses))),
        Outcome::NotEstimated { needs: why } => {
            all.push(no_result("No recording shows the shaft", &wording::reasons(why)))
        }
    }
    found.recordings.iter().for_each(|recording| all.push(one(recording)));
    all
}

fn one(recording: &EngineRecording) -> Blocks {
    let mut all = of_recording(&recording.file, &recording.label);
    match &recording.engine {
        Outcome::Estimated(engine) => all.push(sentence(&format!("T_e is {}", words::rebuilt(&engine.certainty())))),
        Outcome::NotEstimated { needs: why } => {
            all.push(no_result("T_e", &wording::reasons(why)));
            return all;
        }
    }
    match &recording.cycles {
        Outcome::Estimated(found) => {
            all.push(sentence(&words::cycles(found)));
            all.push(sentence(&words::cylinders(&found.cylinders)));
            all.push(sentence(words::CUT));
            let heads = ["Fires as", "T_e less the cycle’s mean", "Varies from cycle to cycle by"];
            all.push(plain_table(&heads, words::cylinder_rows(&found.cylinders).into_iter().map(Vec::from)));
        }
        Outcome::NotEstimated { needs: why } => all.push(no_result("Cycles and cylinders", &wording::reasons(why))),
    }
    all.push(figures(words::figures_of(recording)));
    all
}
