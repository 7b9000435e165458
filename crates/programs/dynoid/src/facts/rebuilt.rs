//! Rebuilt torques without their samples.

use part_engine::{Cycles, EngineRecording, EngineTorque, RebuiltEngine, TwoMasses};
use part_torque::timing::ShaftFilter;
use part_torque::torque_signals::{OnceATurn, RebuiltShaft, TorqueRecording, TorqueSignals, TrustCheck};
use part_torque::torque_smoother::{NoiseLevels, TorqueSource};
use rig::ExperimentLabel;
use rig::results::{Found, SignalDelay};
use serde::Serialize;

/// A torque that was rebuilt.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct RebuiltFacts<T, N> {
    start_s: f64,
    sample_time_s: f64,
    samples: usize,
    torque: T,
    noise: N,
}

/// The engine's torque.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EngineFacts<'a> {
    masses: Found<'a, &'a TwoMasses>,
    recordings: Vec<EngineRecordingFacts<'a>>,
}

impl<'a> EngineFacts<'a> {
    /// Of an analysis.
    pub fn of(found: &'a EngineTorque) -> Self {
        EngineFacts {
            masses: found.masses.written(),
            recordings: found.recordings.iter().map(EngineRecordingFacts::of).collect(),
        }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct EngineRecordingFacts<'a> {
    file: &'a str,
    label: &'a ExperimentLabel,
    engine: Found<'a, RebuiltEngineFacts<'a>>,
    cycles: Found<'a, &'a Cycles>,
}

impl<'a> EngineRecordingFacts<'a> {
    fn of(one: &'a EngineRecording) -> Self {
        let engine = one.engine.written_as(RebuiltEngineFacts::of);
        EngineRecordingFacts { file: &one.file, label: &one.label, engine, cycles: one.cycles.written() }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct RebuiltEngineFacts<'a> {
    #[serde(flatten)]
    rebuilt: RebuiltFacts<&'a TorqueSource, &'a NoiseLevels>,
    once_a_turn_nm: f64,
}

impl<'a> RebuiltEngineFacts<'a> {
    fn of(engine: &'a RebuiltEngine) -> Self {
        let rebuilt = RebuiltFacts {
            start_s: engine.start_s,
            sample_time_s: engine.sample_time_s,
            samples: engine.smoothed_nm.len(),
            torque: &engine.torque,
            noise: &engine.noise,
        };
        RebuiltEngineFacts { rebuilt, once_a_turn_nm: engine.once_a_turn_nm }
    }
}

/// The torque signals.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueSignalsFacts<'a> {
    recordings: Vec<TorqueRecordingFacts<'a>>,
    trust: &'a Option<TrustCheck>,
}

impl<'a> TorqueSignalsFacts<'a> {
    /// Of an analysis.
    pub fn of(found: &'a TorqueSignals) -> Self {
        let recordings = found.recordings.iter().map(TorqueRecordingFacts::of).collect();
        TorqueSignalsFacts { recordings, trust: &found.trust }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct TorqueRecordingFacts<'a> {
    file: &'a str,
    label: &'a ExperimentLabel,
    delays: Found<'a, &'a Vec<SignalDelay>>,
    filter: Option<Found<'a, &'a ShaftFilter>>,
    shaft: Option<Found<'a, RebuiltShaftFacts<'a>>>,
}

impl<'a> TorqueRecordingFacts<'a> {
    fn of(one: &'a TorqueRecording) -> Self {
        TorqueRecordingFacts {
            file: &one.file,
            label: &one.label,
            delays: one.delays.written(),
            filter: one.filter.as_ref().map(|outcome| outcome.written()),
            shaft: one.shaft.as_ref().map(|outcome| outcome.written_as(RebuiltShaftFacts::of)),
        }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct RebuiltShaftFacts<'a> {
    #[serde(flatten)]
    rebuilt: RebuiltFacts<&'a TorqueSource, &'a NoiseLevels>,
    once_a_turn: &'a OnceATurn,
}

impl<'a> RebuiltShaftFacts<'a> {
    fn of(shaft: &'a RebuiltShaft) -> Self {
        let rebuilt = RebuiltFacts {
            start_s: shaft.start_s,
            sample_time_s: shaft.sample_time_s,
            samples: shaft.smoothed_nm.len(),
            torque: &shaft.torque,
            noise: &shaft.noise,
        };
        RebuiltShaftFacts { rebuilt, once_a_turn: &shaft.once_a_turn }
    }
}
