//! `dynoid fit …`: a model from recordings, with its uncertainty and its judgement.

mod estimate;
mod method;
mod orders;

use dynoid::linear::{FitData, FitNeeds, Gaps, Judging, LinearFit, Loaded};
use dynoid::{Error, Files, check_model_file};
use ident::{FormulaStructure, IdentError, StructureError};

use super::data::say;
use super::greybox;
use crate::cli::identify::{FitArguments, FitCommand};
use crate::commands::result::{Sorted, check_plot, show_with};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(command: &FitCommand, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let common = command.common();
    check_fit(common, &terminal.files())?;
    orders::check(command)?;
    let structure = greybox::structure_of(command, &terminal.files())?;
    let needs = needs(command, structure.as_ref());
    let (options, judging) = (common.data.options(), judging(common));
    let whole = Loaded::take(&options.read(&terminal.files(), terminal.work())?, needs.clock(), &options)?;
    let mut said = Vec::new();
    say(&whole.notes, &mut said, terminal);
    let data = FitData::of(whole, &options, &judging, needs, &terminal.files(), terminal.work())?;
    say(data.notes(), &mut said, terminal);
    orders::check_delays(command, data.estimation())?;
    let method = estimate::method(command, structure, data.estimation())?;
    let found = LinearFit::of(data, &method, &method::wanted(command), terminal.work());
    let found = found.map_err(|error| refused(error, command))?;
    if let FitCommand::Greybox(arguments) = command {
        greybox::warnings(arguments, &found).iter().for_each(|text| terminal.warning(text));
    }
    if let Some(path) = &common.out {
        found.write(path, &terminal.files())?;
    }
    show_with(&common.result, &[&common.out], || found.page(), || Sorted(found.facts()), terminal)?;
    found.verdict().failures().iter().for_each(|text| terminal.warning(text));
    found.hint().iter().for_each(|text| terminal.warning(text));
    Ok(if found.verdict().explains_little() { Outcome::ExplainsLittle } else { Outcome::Done })
}

/// The data that judge the estimate.
fn judging(arguments: &FitArguments) -> Judging {
    match arguments.split {
        Some(share) => Judging::Split(share),
        None if arguments.validate.is_empty() => Judging::Own,
        None => Judging::On(arguments.validate.clone()),
    }
}

/// Checks where results go before any work is done.
fn check_fit(arguments: &FitArguments, files: &Files) -> Result<(), CliError> {
    arguments.out.as_deref().map_or(Ok(()), |out| check_model_file(out, files))?;
    check_plot(&arguments.result, files)
}

/// Needs of the method. Nothing can be simulated over a gap in the inputs; most methods leave out rows that touch a
/// missing output, or predict over it.
fn needs(command: &FitCommand, structure: Option<&FormulaStructure>) -> FitNeeds {
    let gaps = match command {
        FitCommand::Ss(arguments) if arguments.subspace => Gaps::OfAll,
        _ => Gaps::OfInputs,
    };
    FitNeeds { sees_through: sees_through_missing_outputs(command, structure), gaps }
}

/// Tells whether the method looks at the simulated output alone, so that outputs may be slower than the inputs.
fn sees_through_missing_outputs(command: &FitCommand, structure: Option<&FormulaStructure>) -> bool {
    match command {
        FitCommand::Oe(_) | FitCommand::Tf(_) | FitCommand::Process(_) => true,
        FitCommand::Poly(a) => [a.na, a.nc, a.nd].iter().all(|order| order.unwrap_or(0) == 0),
        FitCommand::Greybox(_) => structure.is_some_and(|structure| FitNeeds::of_structure(structure).sees_through),
        _ => false,
    }
}

/// Why there is no estimate, with what can be changed.
fn refused(error: Error, command: &FitCommand) -> CliError {
    let Error::NotEstimated { data, source } = error else { return error.into() };
    let remedy = match &source {
        IdentError::TooFewSamples { .. } | IdentError::RankDeficient { .. } => {
            format!("; lower {}, or give more data", orders::options(command))
        }
        IdentError::Structure(StructureError::UnknownParameter { .. }) => {
            "; --hold and --bound take K, Tw, zeta, Tp1, Tp2, Tp3, Tz and Td as far as --structure has them, with several inputs K[1], K[2] …".into()
        }
        _ => String::new(),
    };
    CliError::Estimate { data, source, remedy }
}
