//! Why there is no estimate, and what it needs.

use rig::Role;
use rig::estimation::EstimateError;
use rig::experiment::ExperimentLabel;
use rig::results::Reason;

use super::number::significant;
use super::{experiment, join, part, role};

/// Need, as a phrase that completes "needs …".
pub fn need(reason: &Reason) -> String {
    let better = |file: &str, failure: &str| {
        format!("better data than {file}, where the estimate failed: {}", failure.trim_end_matches('.'))
    };
    match reason {
        Reason::Recording { any_of } => recording(any_of),
        Reason::Channel { file, role: missing } => format!("the {} in {file}", role(*missing)),
        Reason::Part { part: other } => format!("the {} to be estimated first", part(*other)),
        Reason::Error { file: Some(file) } => format!("{file} without the error that a finding names"),
        Reason::Error { file: None } => "a bench file without the error that a finding names".to_owned(),
        Reason::NotExcited { file, role } => {
            better(file, &format!("{file}: {} hardly varies, so nothing can be learnt from it", role.symbol()))
        }
        Reason::WrongSign { file, role } => {
            better(file, &EstimateError::WrongSign { file: file.clone(), role: *role }.to_string())
        }
        Reason::Failed { file, error } => better(file, &error.to_string()),
        Reason::NotExplained { file } | Reason::FoldedTorque { file, .. } => better(file, &reason_of(reason)),
        Reason::FiringsTooFast { .. } | Reason::TooFewCycles { .. } | Reason::Analysis { .. } => reason_of(reason),
    }
}

/// All that a part needs, as one phrase that completes "needs …".
pub fn needs(needs: &[Reason]) -> String {
    match needs {
        [] => "data that were not stated".to_owned(),
        _ => joined(needs).join("; and "),
    }
}

/// The phrases of all reasons; a channel that several recordings lack is named once.
fn joined(needs: &[Reason]) -> Vec<String> {
    let mut phrases = Vec::new();
    let mut channels = Vec::new();
    for reason in needs {
        let Reason::Channel { role: missing, .. } = reason else {
            phrases.push(need(reason));
            continue;
        };
        if channels.contains(missing) {
            continue;
        }
        channels.push(*missing);
        let lacks = |other: &&Reason| matches!(other, Reason::Channel { role, .. } if role == missing);
        match needs.iter().filter(lacks).count() {
            1 => phrases.push(need(reason)),
            count => phrases.push(format!("the {} in {count} recordings", role(*missing))),
        }
    }
    phrases
}

/// Why a recording cannot show something, and what can.
pub fn reasons(reasons: &[Reason]) -> String {
    reasons.iter().map(reason_of).collect::<Vec<_>>().join("; ")
}

/// The same of one reason.
pub fn reason_of(reason: &Reason) -> String {
    match reason {
        Reason::Recording { any_of } => format!("no recording gives it; give one of {}", listed(any_of).join(", ")),
        Reason::Channel { role, .. } => missing(*role),
        Reason::Part { part: other } => format!("the {} is not estimated", part(*other)),
        Reason::Error { file } => {
            let of = file.as_deref().unwrap_or("the bench file");
            format!("a finding names an error in {of}, so that its numbers are struck")
        }
        Reason::WrongSign { role: torque, .. } => format!(
            "{} is negative when it brakes, as its effect on the speed shows, and is not used; write sign = -1 for \
             {} in the bench file",
            role(*torque),
            torque.key()
        ),
        Reason::NotExcited { role: Role::DynoSpeedDemand, .. } => {
            "N_d* hardly moves where T_d* is below its limit; run Levels_N_NT".to_owned()
        }
        Reason::NotExcited { .. } => {
            "T_d* does not move T_d by itself here; run WhiteNoise_T_TN or Step_T_TN".to_owned()
        }
        Reason::NotExplained { .. } => {
            "neither a moving average, a lag nor a delay of N_d explains it; check J_d and the channels".to_owned()
        }
        Reason::FoldedTorque { apart_s, .. } => format!(
            "T_d is known by its samples alone, {} ms apart, and its aliases cannot be separated from the shaft; record T_d*, and \
             add WhiteNoise_T_TN or Step_T_TN, which shows what T_d does between its samples",
            significant(1e3 * apart_s, 6)
        ),
        Reason::FiringsTooFast { firing_s, needed_hz, rate_hz } => format!(
            "firings come every {:.1} ms, which takes speeds at {needed_hz:.0} Hz or more; they are at {rate_hz:.0} Hz: run \
             slower or record faster",
            1e3 * firing_s
        ),
        Reason::TooFewCycles { found, needed, needed_s } => {
            format!("it holds {found} whole cycles, {needed} are needed: {needed_s:.1} s")
        }
        Reason::Failed { error, .. } => error.to_string(),
        Reason::Analysis { words } => words.clone(),
    }
}

/// A signal that is not there, or was and is of no use: which of the two, the warnings say.
pub fn missing(missing: Role) -> String {
    format!("no {} can be used; record it, or correct its channel if a warning names it", role(missing))
}

fn recording(any_of: &[ExperimentLabel]) -> String {
    let described: Vec<String> = any_of
        .iter()
        .map(|label| match experiment(label) {
            Some(words) => format!("{label} ({words})"),
            None => label.to_string(),
        })
        .collect();
    match described.len() {
        0 => "a further recording".to_owned(),
        _ => format!("a recording of {}", join(&described, "or")),
    }
}

/// Labels as texts.
pub fn listed(labels: &[ExperimentLabel]) -> Vec<String> {
    labels.iter().map(ToString::to_string).collect()
}
