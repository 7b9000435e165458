//! Where a model comes from, and what it lacks.

use rig::results::Part;
use serde::{Deserialize, Serialize};

/// Where a model comes from: enough to make it again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Provenance {
    /// Version of dynoid that made it.
    pub dynoid_version: String,
    /// Day on which it was made, UTC, as in 2026-05-03.
    pub date: String,
    /// The bench file.
    pub bench_file: BenchFileOrigin,
    /// The recordings that parts of the model were estimated from.
    pub recordings: Vec<UsedRecording>,
    /// Seed of the recordings, where they were simulated.
    #[serde(default)]
    pub seed: Option<u64>,
    /// Verdict of the study on the model.
    #[serde(default)]
    pub verdict: Option<StudyVerdict>,
}

/// A bench file by name and content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BenchFileOrigin {
    /// Its name.
    pub name: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// A recording that something was estimated from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UsedRecording {
    /// File, as the user knows it.
    pub file: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// Label of the experiment.
    #[serde(default)]
    pub label: Option<String>,
    /// The parts that were estimated from it.
    pub used_for: Vec<Part>,
}

/// Verdict of a study on its model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StudyVerdict {
    /// `good`, `reservations` or `insufficient`.
    pub level: String,
    /// The same in a sentence.
    pub headline: String,
    /// The study's reservations about the rules that the model does not meet.
    pub reservations: Vec<String>,
}

/// A part that was not estimated.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NotEstimated {
    /// Which part.
    pub part: Part,
    /// Its needs, in words.
    pub needs: String,
}
