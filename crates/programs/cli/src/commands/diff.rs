//! `dynoid diff`: whether a bench is still the same.

use std::path::Path;

use dynoid::paths;
use serde::Serialize;
use study::{ModelComparison, compare_models};

use crate::cli::diff::DiffArguments;
use crate::commands::result::{Sorted, check_plot, show};
use crate::commands::study::model_of;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid diff`
pub(crate) fn run(arguments: &DiffArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let DiffArguments { first, second, result } = arguments;
    check_plot(result, &terminal.files())?;
    let old = terminal.files().bench_model(first)?;
    let is_bench_file = paths::ending(second).is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let new = if is_bench_file { model_of(second, terminal)? } else { terminal.files().bench_model(second)? };
    let found = compare_models(&old, &new);
    let names = [paths::with_slashes(first), paths::with_slashes(second)];
    let page = || report::comparison::page(&found, [(&names[0], &old), (&names[1], &new)]);
    let json = || Sorted(Facts { first, second, changed: found.has_changed(), comparison: &found });
    show(result, page, json, terminal)?;
    Ok(if found.has_changed() { Outcome::Changed } else { Outcome::Done })
}

/// Changes of a bench, with the files.
#[derive(Serialize)]
struct Facts<'a> {
    first: &'a Path,
    second: &'a Path,
    changed: bool,
    comparison: &'a ModelComparison,
}
