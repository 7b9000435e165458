//! Why a template gives no plan.

use signal::SignalError;

use crate::experiment::PlanError;

/// Why a template gives no plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CatalogueError {
    /// No experiment has this name.
    #[error("there is no experiment `{name}`; {}", suggestion(.closest.as_deref(), .known))]
    UnknownExperiment {
        /// The name.
        name: String,
        /// The one that was probably meant.
        closest: Option<String>,
        /// All.
        known: Vec<String>,
    },
    /// The experiment has no parameter of this name.
    #[error("the experiment has no parameter `{name}`; {}", suggestion(.closest.as_deref(), .known))]
    UnknownParameter {
        /// The name.
        name: String,
        /// The one that was probably meant.
        closest: Option<String>,
        /// All.
        known: Vec<String>,
    },
    /// A parameter is given twice.
    #[error("{name} is given twice")]
    GivenTwice {
        /// Which.
        name: String,
    },
    /// A value is no number in the parameter's unit.
    #[error("{name} = {text} is no number{}; write e.g. {name}={example}", in_unit(.unit))]
    NotANumber {
        /// Which.
        name: &'static str,
        /// The text.
        text: String,
        /// The unit.
        unit: &'static str,
        /// The default.
        example: f64,
    },
    /// A value lies outside the parameter's range.
    #[error("{name} = {value}{} is outside {lowest} … {highest} ({meaning})", spaced(.unit))]
    OutOfRange {
        /// Which.
        name: &'static str,
        /// The value.
        value: f64,
        /// The unit.
        unit: &'static str,
        /// Smallest possible.
        lowest: f64,
        /// Largest possible.
        highest: f64,
        /// Effect of the parameter.
        meaning: &'static str,
    },
    /// Two values exclude each other.
    #[error("{what}")]
    Contradiction {
        /// How.
        what: String,
    },
    /// An excitation that cannot be made.
    #[error("the excitation cannot be made: {0}")]
    Excitation(#[from] SignalError),
    /// A plan that cannot be.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

fn suggestion(closest: Option<&str>, known: &[String]) -> String {
    match closest {
        Some(closest) => format!("did you mean `{closest}`?"),
        None => format!("there are {}", known.join(", ")),
    }
}

fn in_unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" in {unit}") }
}

fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}
