//! `dynoid fit greybox`: structures of formulas.

use dynoid::linear::{LinearFit, structure};
use dynoid::{Error, Files, paths::with_slashes};
use ident::{FormulaStructure, GreyBox, InitialState};

use crate::cli::identify::{Detrend, FitCommand, GreyBoxArguments};
use crate::error::CliError;

/// The structure that a command names; none where it is no grey box.
pub(super) fn structure_of(command: &FitCommand, files: &Files) -> Result<Option<FormulaStructure>, CliError> {
    match command {
        FitCommand::Greybox(arguments) => {
            let structure = structure(&arguments.structure, files)?;
            check_channels(&structure, arguments)?;
            Ok(Some(structure))
        }
        _ => Ok(None),
    }
}

/// Refuses a structure of other channels than those named, before anything is read.
fn check_channels(structure: &FormulaStructure, arguments: &GreyBoxArguments) -> Result<(), CliError> {
    let parts = structure.parts();
    let data = &arguments.fit.data;
    let counts = [
        ("inputs (columns of B)", parts.b.first().map_or(0, Vec::len), "--input", data.inputs.len()),
        ("outputs (rows of C)", parts.c.len(), "--output", data.outputs.len()),
    ];
    match counts.into_iter().find(|(_, has, _, named)| has != named && *named > 0) {
        Some((what, has, option, named)) => Err(Error::StructureFile {
            path: arguments.structure.clone(),
            reason: format!("it is of {has} {what}, but the number named with {option} is {named}"),
        }
        .into()),
        None => Ok(()),
    }
}

/// The estimator of a structure.
pub(super) fn estimator(arguments: &GreyBoxArguments, structure: FormulaStructure) -> GreyBox<FormulaStructure> {
    let initial = if arguments.from_rest { InitialState::Zero } else { InitialState::Estimated };
    GreyBox::new(structure).with_initial_state(initial).with_further_starts(arguments.starts)
}

/// The method and its options, as a person would write them.
pub(super) fn method(arguments: &GreyBoxArguments) -> String {
    let mut text = format!("grey box {}", with_slashes(&arguments.structure));
    if arguments.starts > 0 {
        text.push_str(&format!(", {} further starts", arguments.starts));
    }
    if arguments.from_rest {
        text.push_str(", from rest");
    }
    text
}

/// Where the trend that was taken off contradicts what is asked for.
pub(super) fn warnings(arguments: &GreyBoxArguments, found: &LinearFit) -> Vec<&'static str> {
    if arguments.fit.data.detrend == Detrend::None {
        return Vec::new();
    }
    let mut all = Vec::new();
    if found.integrates() {
        all.push("the structure integrates, but a trend was taken off, and its integral with it; give --detrend none");
    }
    if arguments.from_rest {
        all.push(
            "--from-rest: a trend was taken off, so zero is no longer where the system rested; give --detrend none",
        );
    }
    all
}
