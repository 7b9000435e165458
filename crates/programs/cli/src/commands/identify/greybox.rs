//! `dynoid fit greybox`: structures of formulas.

use std::path::Path;

use dynoid::{Files, paths::with_slashes};
use ident::uncertainty::Dynamics;
use ident::{AnyModel, FormulaStructure, GreyBox, GreyNoise, InitialState, Structure};

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
        Some((what, has, option, named)) => Err(CliError::StructureFile {
            path: arguments.structure.clone(),
            reason: format!("it is of {has} {what}, but the number named with {option} is {named}"),
        }),
        None => Ok(()),
    }
}

/// Tells whether a structure has white noise on its outputs alone, so that outputs may be missing.
pub(super) fn is_output_error(structure: &FormulaStructure) -> bool {
    let values: Vec<f64> = structure.parameters().iter().map(|p| p.value).collect();
    matches!(structure.noise(&values), GreyNoise::OutputError)
}

fn structure(path: &Path, files: &Files) -> Result<FormulaStructure, CliError> {
    let wrong = |error: toml::de::Error| CliError::StructureFile {
        path: path.to_owned(),
        reason: error.to_string().trim_end().to_owned(),
    };
    toml::from_str(&files.read_text(path, "a structure in TOML as `dynoid fit greybox --help` shows it")?)
        .map_err(wrong)
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
pub(super) fn warnings(arguments: &GreyBoxArguments, model: &AnyModel) -> Vec<&'static str> {
    if arguments.fit.data.detrend == Detrend::None {
        return Vec::new();
    }
    let mut all = Vec::new();
    if integrates(model) {
        all.push("the structure integrates, but a trend was taken off, and its integral with it; give --detrend none");
    }
    if arguments.from_rest {
        all.push(
            "--from-rest: a trend was taken off, so zero is no longer where the system rested; give --detrend none",
        );
    }
    all
}

/// Tells whether a pole is where an integrator has it.
fn integrates(model: &AnyModel) -> bool {
    let Ok(system) = model.system() else { return false };
    let Ok(poles) = system.poles() else { return false };
    let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    let place = if system.sample_time_s().is_some() { 1.0 } else { 0.0 };
    poles.iter().any(|p| (p - place).norm() <= 1e-9 * largest)
}
