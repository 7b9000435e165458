//! The types a study is made of. They hold numbers and structure only; wording and drawing belong to the report.

use bench_model::analysis::WholeModel;
use bench_model::document::Validity;
use bench_model::drive_ripple::RecordedTorque;
use bench_model::model::AssembledModel;
use bench_model::replay::Replay;
use bench_model::skews::SignalSkews;
use rig::bench_file::ReportIdentity;
use rig::experiment::Choice;
use rig::facts::BenchFacts;
use rig::results::{
    FeedForward, Outcome, Part, Shaft, SpeedController, Timing, TorqueControl, read_status, write_status,
};
use rig::{Diagnostic, ExperimentLabel, Role};
use serde::{Deserialize, Serialize};

/// Everything learnt from one campaign. [`crate::document`] has its form in JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Study {
    /// Where it came from.
    pub provenance: Provenance,
    /// Facts that the bench file states about the bench.
    pub bench: BenchFacts,
    /// The recordings that were looked at, used or not.
    pub recordings: Vec<RecordingSummary>,
    /// Which recording each part is from, and why.
    pub choices: Vec<Choice>,
    /// Delay of each torque signal.
    #[cfg_attr(feature = "schema", schemars(with = "rig::results::ReadStatus<Timing>"))]
    #[serde(serialize_with = "write_status", deserialize_with = "read_status")]
    pub timing: Outcome<Timing>,
    /// PI with delay.
    #[cfg_attr(feature = "schema", schemars(with = "rig::results::ReadStatus<SpeedController>"))]
    #[serde(serialize_with = "write_status", deserialize_with = "read_status")]
    pub speed_controller: Outcome<SpeedController>,
    /// Feed-forward of the speed controller.
    #[cfg_attr(feature = "schema", schemars(with = "rig::results::ReadStatus<FeedForward>"))]
    #[serde(serialize_with = "write_status", deserialize_with = "read_status")]
    pub feed_forward: Outcome<FeedForward>,
    /// Torque control, closed loop from T_d* to T_d.
    #[cfg_attr(feature = "schema", schemars(with = "rig::results::ReadStatus<TorqueControl>"))]
    #[serde(serialize_with = "write_status", deserialize_with = "read_status")]
    pub torque_control: Outcome<TorqueControl>,
    /// Stiffness and damping, with gate and skew.
    #[cfg_attr(feature = "schema", schemars(with = "rig::results::ReadStatus<Shaft>"))]
    #[serde(serialize_with = "write_status", deserialize_with = "read_status")]
    pub shaft: Outcome<Shaft>,
    /// The assembled model's analysis.
    #[cfg_attr(feature = "schema", schemars(with = "rig::results::ReadStatus<WholeModel>"))]
    #[serde(serialize_with = "write_status", deserialize_with = "read_status")]
    pub whole: Outcome<WholeModel>,
    /// The assembled model itself, in SI, for those who compute with it.
    pub model: Option<AssembledModel>,
    /// The range of the recordings that the model is from.
    pub validity: Validity,
    /// How the signals of the shaft's recording lie in time against each other.
    pub skews: Option<SignalSkews>,
    /// How the recordings show T_d.
    pub recorded_torque: Option<RecordedTorque>,
    /// Replays of recordings on the assembled model.
    pub replays: Vec<Replay>,
    /// Doubts.
    pub diagnostics: Vec<Diagnostic>,
}

/// Where a study came from: enough to repeat it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Provenance {
    /// Version of dynoid.
    pub version: String,
    /// The bench file, word for word.
    pub bench_file: String,
    /// Name of the bench file.
    pub bench_file_name: String,
    /// The day of the study, UTC, as in 2026-05-03; none where nobody states it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub studied_on: Option<String>,
    /// Seed, when the recordings were simulated.
    pub seed: Option<u64>,
    /// Statements of the bench file on the report.
    pub report: ReportIdentity,
}

/// One recording as the study saw it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingSummary {
    /// File, as the user knows it.
    pub file: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// Label, if it has one.
    pub label: Option<ExperimentLabel>,
    /// The day of the recording, as in 2026-05-03, if its file states it.
    pub recorded_on: Option<String>,
    /// Length, s.
    pub duration_s: f64,
    /// Mean dynamometer speed, rad/s.
    pub mean_speed_rad_s: Option<f64>,
    /// Sample times by role.
    pub sample_times_s: Vec<(Role, f64)>,
    /// The parts that were estimated from it.
    pub used_for: Vec<Part>,
}
