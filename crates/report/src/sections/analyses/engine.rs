//! The engine's torque.

use page::Blocks;
use part_engine::{EngineRecording, EngineTorque};
use rig::results::Told;

use super::{figures, of_recording, plain_table, sentence, untold};
use crate::engine as words;
use crate::torque;

/// The section on the engine's torque.
pub(crate) fn engine(found: &EngineTorque) -> Blocks {
    let mut all = sentence(
        "No bench records the torque of the engine. It is computed from both speeds and T_d, with the shaft and the \
         inertias estimated from the recordings",
    );
    match &found.masses {
        Told::Found(masses) => all.push(sentence(&words::masses(masses))),
        Told::Untold(why) => all.push(untold("No recording shows the shaft", &torque::untold(why))),
    }
    found.recordings.iter().for_each(|recording| all.push(one(recording)));
    all
}

fn one(recording: &EngineRecording) -> Blocks {
    let mut all = of_recording(&recording.file, &recording.label);
    match &recording.engine {
        Told::Found(engine) => all.push(sentence(&format!("T_e is {}", words::rebuilt(engine)))),
        Told::Untold(why) => {
            all.push(untold("T_e", &torque::untold(why)));
            return all;
        }
    }
    match &recording.cycles {
        Told::Found(found) => {
            all.push(sentence(&words::cycles(found)));
            all.push(sentence(&words::cylinders(&found.cylinders)));
            all.push(sentence(words::CUT));
            let heads = ["Fires as", "T_e less the cycle’s mean", "Varies from cycle to cycle by"];
            all.push(plain_table(&heads, words::cylinder_rows(&found.cylinders).into_iter().map(Vec::from)));
        }
        Told::Untold(why) => all.push(untold("Cycles and cylinders", &torque::untold(why))),
    }
    all.push(figures(words::figures_of(recording)));
    all
}
