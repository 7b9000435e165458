//! Why a part is from the recording that it is from.

use rig::experiment::{Choice, Sought};

/// Result that is estimated.
pub fn sought(sought: Sought) -> &'static str {
    match sought {
        Sought::SpeedController => "speed controller",
        Sought::FeedForward => "feed-forward",
        Sought::TorqueControl => "torque control",
        Sought::Timing => "delays of the torque signals",
        Sought::Shaft => "shaft",
        Sought::Inertias => "both inertias",
    }
}

/// Why its recording was chosen.
pub fn choice(choice: &Choice) -> String {
    let among = match choice.of_the_test {
        0 | 1 => format!("the only usable recording of {}", choice.label),
        count => format!("the longest usable one of {count} recordings of {}", choice.label),
    };
    let preference = match choice.preference {
        1 => "the preferred experiment".to_owned(),
        place => format!("choice {place} among the experiments"),
    };
    let passed_over: Vec<String> =
        choice.passed_over.iter().map(|other| format!(" {} was tried first: {}.", other.file, other.error)).collect();
    format!("{among}, {preference} for this part.{}", passed_over.concat())
}
