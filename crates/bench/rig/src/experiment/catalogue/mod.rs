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
mod parameter;
mod settings;
mod template;
mod templates;

use recording::names::likely_meant;

use super::{ExperimentLabel, Test};
pub use error::CatalogueError;
pub use parameter::{Parameter, parameter};
pub use settings::Settings;
pub use template::Template;

/// Parameters of a designed experiment, see `design::excitation_design`.
pub const OPTIMAL: &[Parameter] = templates::OPTIMAL;

/// Every template, in the order of the method's table.
pub fn all() -> &'static [Template] {
    templates::ALL
}

/// The template of a label, if it is one of the method.
pub fn of(label: &ExperimentLabel) -> Option<&'static Template> {
    all().iter().find(|template| template.label() == *label)
}

/// The template of a label such as `BS_T_NT`; letter case does not matter, and the test's name will do where one alone
/// has it.
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
