//! What a part of the study needs before it can be estimated.

use rig::results::Need;

use super::{experiment, join, part, role};

/// One need as a phrase that completes "needs …".
pub fn need(need: &Need) -> String {
    match need {
        Need::Recording { any_of } => recording(any_of),
        Need::Channel { file, role: missing } => format!("the {} in {file}", role(*missing)),
        Need::Part { name } => format!("the {} to be estimated first", part(name)),
        Need::UsableData { file, reason } => {
            format!("better data than {file}, where the estimate failed: {}", reason.trim_end_matches('.'))
        }
    }
}

/// All needs of a part as one phrase that completes "needs …".
pub fn needs(needs: &[Need]) -> String {
    match needs {
        [] => "data that were not stated".to_owned(),
        _ => needs.iter().map(need).collect::<Vec<_>>().join("; and "),
    }
}

fn recording(any_of: &[String]) -> String {
    let described: Vec<String> = any_of
        .iter()
        .map(|label| match experiment(label) {
            Some(words) => format!("{label} ({words})"),
            None => label.clone(),
        })
        .collect();
    match described.len() {
        0 => "a further recording".to_owned(),
        _ => format!("a recording of {}", join(&described, "or")),
    }
}
