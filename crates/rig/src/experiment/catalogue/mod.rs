//! The experiments of the method as templates: each with its parameters, their units, ranges and meanings.
//!
//! ```
//! use rig::experiment::catalogue::{Settings, find};
//! let template = find("BS_T_NT")?;
//! let settings = Settings::parse(&template.parameters(), &[("speed", "1500"), ("low", "35 Nm")])?;
//! let plan = template.plan(&settings)?;
//! assert_eq!((plan.label.to_string().as_str(), plan.duration_s), ("BS_T_NT", 60.0));
//! # Ok::<(), rig::experiment::catalogue::CatalogueError>(())
//! ```

mod error;
mod settings;
mod templates;

use recording::names::likely_meant;
use serde::Serialize;

use super::{ControlMode, Excitation, ExperimentLabel, ExperimentPlan, Test};
pub use error::CatalogueError;
pub use settings::Settings;

/// A number that an experiment can be given.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Parameter {
    /// What it is called on the command line.
    pub name: &'static str,
    /// Its unit; empty for counts.
    pub unit: &'static str,
    /// What it is unless given.
    pub default: f64,
    /// Smallest value.
    pub lowest: f64,
    /// Largest value.
    pub highest: f64,
    /// What it does.
    pub meaning: &'static str,
}

/// An experiment of the method, of which a plan is made by giving it numbers.
#[derive(Debug, Clone)]
pub struct Template {
    /// What is done, first part of the label.
    pub test: Test,
    /// What is excited.
    pub excitation: Excitation,
    /// Who controls what.
    pub mode: ControlMode,
    /// What is demanded.
    pub demands: &'static str,
    /// What a recording of it gives.
    pub gives: &'static str,
    duration_s: f64,
    own: &'static [Parameter],
    build: fn(&Settings) -> Result<ExperimentPlan, CatalogueError>,
}

impl Template {
    /// The label of its recordings.
    pub fn label(&self) -> ExperimentLabel {
        ExperimentLabel { test: self.test.clone(), excitation: self.excitation, mode: self.mode }
    }

    /// Its parameters: those of every experiment first.
    pub fn parameters(&self) -> Vec<Parameter> {
        let duration = Parameter { default: self.duration_s, ..templates::DURATION };
        [templates::SPEED, duration, templates::SETTLING].into_iter().chain(self.own.iter().copied()).collect()
    }

    /// The plan with these numbers.
    ///
    /// # Errors
    /// Numbers that contradict each other, or a plan that cannot be.
    pub fn plan(&self, settings: &Settings) -> Result<ExperimentPlan, CatalogueError> {
        let mut plan = (self.build)(settings)?;
        plan.settling_s = settings.get("settling");
        plan.check()?;
        Ok(plan)
    }
}

/// What can be set in a designed experiment, see [`design::excitation_design`].
pub const OPTIMAL: &[Parameter] = templates::OPTIMAL;

/// Every template, in the order of the method's table.
pub fn all() -> &'static [Template] {
    templates::ALL
}

/// The template of a label such as `BS_T_NT`; letter case does not matter, and the test's name will do where one alone has
/// it.
///
/// # Errors
/// [`CatalogueError::UnknownExperiment`] with the name that was probably meant.
pub fn find(name: &str) -> Result<&'static Template, CatalogueError> {
    let by_label = || all().iter().find(|t| t.label().to_string().eq_ignore_ascii_case(name));
    let by_test = || {
        let test = Test::from(name);
        let mut same = all().iter().filter(|t| t.test == test);
        same.next().filter(|_| same.next().is_none())
    };
    by_label().or_else(by_test).ok_or_else(|| {
        let known: Vec<String> = all().iter().map(|t| t.label().to_string()).collect();
        let closest = likely_meant(name, known.iter().map(String::as_str));
        CatalogueError::UnknownExperiment { name: name.to_owned(), closest, known }
    })
}
