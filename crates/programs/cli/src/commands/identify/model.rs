//! `dynoid model bode`, `step`, `poles`: what models are like.

use dynoid::Files;
use dynoid::linear::models_in;
use ident::IdentError;
use toolbox_report::models::{self, Curves, Detail, Model};

use crate::cli::identify::{CurveArguments, ModelArguments};
use crate::commands::result::{Sorted, check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid model bode`
pub(crate) fn bode(arguments: &CurveArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    curves(arguments, models::bode, terminal)
}

/// `dynoid model step`
pub(crate) fn step(arguments: &CurveArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    curves(arguments, models::step, terminal)
}

fn curves(
    arguments: &CurveArguments,
    of: fn(Vec<Model>, f64) -> Result<Curves, IdentError>,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    let CurveArguments { models, table } = arguments;
    let found = of(read(models, &terminal.files())?, models.level).map_err(failed)?;
    let detail = if *table { Detail::Points } else { Detail::Summary };
    show(&models.result, || found.page(detail), || Sorted(found.facts()), terminal)?;
    Ok(Outcome::Done)
}

/// `dynoid model poles`
pub(crate) fn poles(arguments: &ModelArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let found = models::poles(read(arguments, &terminal.files())?, arguments.level).map_err(failed)?;
    show(&arguments.result, || found.page(), || Sorted(found.facts()), terminal)?;
    Ok(Outcome::Done)
}

/// The models, once it is clear that the result can be written.
fn read(arguments: &ModelArguments, files: &Files) -> Result<Vec<Model>, CliError> {
    check_plot(&arguments.result, files)?;
    Ok(models_in(&arguments.models, arguments.noise, files)?)
}

fn failed(source: IdentError) -> CliError {
    CliError::identify("the response", source)
}
