//! `dynoid can`: whether a bench can run a test, and whether a run of one is valid.

mod compared;
mod cycle_table;
mod engine_map;
mod map;
mod predicted;
mod recorded;
mod test;
mod wanted;

use crate::cli::can::CanArguments;
use crate::commands::result::check_plot;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;
use test::Test;
use wanted::Wanted;

/// The name that asks for the map in place of a test.
const MAP: &str = "map";

pub(crate) fn run(arguments: &CanArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.on.result, &terminal.files())?;
    if arguments.test.eq_ignore_ascii_case(MAP) {
        return map::run(arguments, terminal);
    }
    if !arguments.want.is_empty() {
        let what = "--want compares sines and gradients with the map; give `map` as the test".to_owned();
        return Err(CliError::Usage { what });
    }
    let test = Test::of(arguments, terminal)?;
    let wanted = Wanted::of(arguments, &test)?;
    match &arguments.recorded {
        Some(file) => recorded::run(arguments, &test, &wanted, file, terminal),
        None => predicted::run(arguments, &test, &wanted, terminal),
    }
}
