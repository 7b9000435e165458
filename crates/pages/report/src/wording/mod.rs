//! Plain words for everything a study can say: findings, needs, parts, roles, numbers with their uncertainty.
//!
//! All texts are plain Unicode without markup, fit for a terminal. Symbols are written as in the thesis (`T_d*`,
//! `K_p`); the HTML report typesets them.

mod assumption;
mod choice;
mod experiment;
mod finding;
pub mod number;
mod reason;
mod scale;
mod verdict;

pub use assumption::{assumption, engine_pulses, limited, model_parameter, peak, quantity, safety};
pub use choice::{choice, sought};
pub use experiment::experiment;
pub use finding::{advice, diagnostic, finding, remark, twice_estimated};
pub use reason::{listed, missing, need, needs, reason_of, reasons};
pub use scale::torque_scale;
pub use verdict::{MODEL_WORDS, asks, found, headline, outcome};

use rig::facts::BenchVariant;
use rig::results::Part;
use rig::{ControlMode, Place, Role, Severity};

/// The severity as one word: `error`, `warning`, `note`.
pub fn severity(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

/// Meaning of a severity for the reader of a result.
pub fn severity_meaning(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "something was left out, or a result must not be used",
        Severity::Warning => "a result is weaker than it could be",
        Severity::Note => "worth knowing; nothing to do",
    }
}

/// A part of the study in plain words.
pub fn part(part: Part) -> &'static str {
    match part {
        Part::Timing => "timing of the signals",
        Part::SpeedController => "speed control",
        Part::FeedForward => "feed-forward",
        Part::TorqueControl => "torque control",
        Part::Shaft => "shaft",
        Part::Whole => "whole model",
    }
}

/// A role in plain words without its symbol, e.g. `dynamometer speed`.
pub fn role_name(role: Role) -> &'static str {
    match role {
        Role::DynoSpeed => "dynamometer speed",
        Role::EngineSpeed => "engine speed",
        Role::DynoSpeedDemand => "dynamometer speed demand",
        Role::DynoTorqueDemand => "dynamometer torque demand",
        Role::AirGapTorque => "computed air-gap torque",
        Role::LoadCellTorque => "air-gap torque from the load cell",
        Role::SystemShaftTorque => "shaft torque as the bench system computes it",
        Role::FlangeTorque => "shaft torque from the torque flange",
        Role::Throttle => "engine throttle",
    }
}

/// A role in plain words with its symbol, e.g. `dynamometer speed N_d`.
pub fn role(role: Role) -> String {
    format!("{} {}", role_name(role), role.symbol())
}

/// Control of the two sides of the bench.
pub fn mode(mode: ControlMode) -> &'static str {
    match mode {
        ControlMode::Nt => "speed control (NT): the dynamometer holds speed, the engine torque",
        ControlMode::Tn => "torque control (TN): the dynamometer holds torque, the engine speed",
    }
}

/// The mode in two words.
pub fn mode_short(mode: ControlMode) -> &'static str {
    match mode {
        ControlMode::Nt => "speed control",
        ControlMode::Tn => "torque control",
    }
}

/// How the bench measures torque.
pub fn variant(variant: BenchVariant) -> &'static str {
    match variant {
        BenchVariant::LoadCell => "load cell on the dynamometer: shaft torque is computed, two masses",
        BenchVariant::TorqueFlange => "torque flange in the shaft: air-gap torque is computed, dual-mass flywheel",
    }
}

/// Where a finding was made, e.g. `bs.mf4, channel "Torque", at 12.35 s`; `None` when it concerns the study as a whole.
pub fn place(place: &Place) -> Option<String> {
    let parts: Vec<String> = [
        place.file.clone(),
        place.channel.as_ref().map(|channel| format!("channel “{channel}”")),
        place.time_s.map(|time| format!("at {}", number::time(time))),
    ]
    .into_iter()
    .flatten()
    .collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// The text with a capital first letter. A symbol or a name of a file stays as it is: k is another number than K.
pub fn capitalised(text: &str) -> String {
    let first = text.split_whitespace().next().unwrap_or_default().trim_end_matches([',', '.', ':', ';']);
    let is_letter = first.chars().count() == 1 && first != "a";
    if is_letter || first.contains(['_', '*', '.', '/']) {
        return text.to_owned();
    }
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Joins words as a sentence does: `a`, `a or b`, `a, b or c`.
pub fn join(words: &[impl AsRef<str>], last: &str) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words.as_slice() {
        [] => String::new(),
        [only] => (*only).to_owned(),
        [rest @ .., end] => format!("{} {last} {end}", rest.join(", ")),
    }
}
