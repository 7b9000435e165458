//! `dynoid fit …`: a model from recordings, with its uncertainty and its judgement.

mod estimate;
mod method;
mod orders;

use dataset::CommonClock;
use dynoid::{Files, replace_file};
use ident::{
    AnyModel, Dataset, EstimateRecord, Fit, FormulaStructure, IdentError, ModelDocument, Source, StructureError,
};

use toolbox_report::data::Purpose;
use toolbox_report::fit::{Estimated, Verdict};
use toolbox_report::operating_point::{TakenOff, hint};

use super::data::{Gaps, Loaded, Note, RecordedFiles, check_variation, load_on, named, say, take_about};
use super::sources::which_data;
use super::{greybox, operating_point};
use crate::cli::identify::{FitArguments, FitCommand, Window};
use crate::commands::result::{check_plot, show_with};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(command: &FitCommand, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let common = command.common();
    check_fit(common, &terminal.files())?;
    orders::check(command)?;
    let structure = greybox::structure_of(command, &terminal.files())?;
    let sees_through = sees_through_missing_outputs(command, structure.as_ref());
    let (estimation, unseen) = data(command, sees_through, terminal)?;
    check_variation(&estimation)?;
    orders::check_delays(command, &estimation.data)?;
    let wanted = method::wanted(command);
    let step = terminal.work().step("identifying", 2);
    let estimating = step.step(format!("estimating {wanted}"), 0);
    let fit = estimate::estimate(command, structure, &estimation.data, &estimating);
    drop(estimating);
    let mut fit = fit.map_err(|error| refused(error, command, &estimation))?;
    let (estimation, unseen) = operating_point::with_levels(&fit, estimation, unseen)?;
    let judging = step.step("judging the model", 0);
    let others = unseen.as_ref().map(|u| (&u.data, which_data(&u.sources, &estimation.sources)));
    let verdict = Verdict::new(&fit, &estimation.data, others);
    drop((judging, step));
    if let FitCommand::Greybox(arguments) = command {
        greybox::warnings(arguments, &fit.model).iter().for_each(|text| terminal.warning(text));
    }
    fit.doubts.extend(verdict.doubts());
    let document = document(&fit, method::fitted(wanted, &fit.model), &estimation);
    let estimated = Estimated { document, fit, verdict, experiments: estimation.data.experiments().len() };
    if let Some(path) = &common.out {
        let text = serde_json::to_string_pretty(&estimated.document).map_err(CliError::internal)?;
        replace_file(path, text.as_bytes(), &terminal.files())?;
    }
    let shown = &unseen.as_ref().unwrap_or(&estimation).data;
    let (page, json) = (|| estimated.page(shown), || estimated.json(&estimation.notes));
    show_with(&common.result, &[&common.out], page, json, terminal)?;
    estimated.verdict.failures().iter().for_each(|text| terminal.warning(text));
    let hint = unseen.as_ref().and_then(|unseen| hint_of(&estimated, &unseen.data));
    hint.iter().for_each(|text| terminal.warning(text));
    Ok(if estimated.verdict.explains_little() { Outcome::ExplainsLittle } else { Outcome::Done })
}

/// Hint where unseen data rest elsewhere than those of the estimate.
fn hint_of(estimated: &Estimated, unseen: &Dataset) -> Option<String> {
    hint(&estimated.document, unseen, estimated.verdict.simulated()?, TakenOff::OfModel)
}

/// Checks where results go before any work is done.
fn check_fit(arguments: &FitArguments, files: &Files) -> Result<(), CliError> {
    arguments.out.as_deref().map_or(Ok(()), |out| dynoid::check_model_file(out, files))?;
    check_plot(&arguments.result, files)
}

/// Tells whether the method looks at the simulated output alone, so that outputs may be slower than the inputs.
fn sees_through_missing_outputs(command: &FitCommand, structure: Option<&FormulaStructure>) -> bool {
    match command {
        FitCommand::Oe(_) | FitCommand::Tf(_) | FitCommand::Process(_) => true,
        FitCommand::Poly(a) => [a.na, a.nc, a.nd].iter().all(|order| order.unwrap_or(0) == 0),
        FitCommand::Greybox(_) => structure.is_some_and(greybox::is_output_error),
        _ => false,
    }
}

/// Where the data have to be without gaps. Nothing can be simulated over a gap in the inputs; most methods leave out
/// rows that touch a missing output, or predict over it.
fn gaps(command: &FitCommand) -> Gaps {
    match command {
        FitCommand::Ss(a) if a.subspace => Gaps::OfAll,
        _ => Gaps::OfInputs,
    }
}

/// Data that the estimate rests on, and those that judge it besides; both cut where the method cannot go on.
fn data(
    command: &FitCommand,
    sees_through: bool,
    terminal: &mut Terminal,
) -> Result<(Loaded, Option<Loaded>), CliError> {
    let arguments = command.common();
    let clock = if sees_through { CommonClock::Fastest } else { CommonClock::Slowest };
    let whole = load_on(clock, &arguments.data, terminal)?;
    let mut said = whole.notes.clone();
    let (estimation, unseen) = parts(whole, arguments, terminal)?;
    let mut estimation = estimation.cut_at(gaps(command))?;
    say(&estimation.notes, &mut said, terminal);
    // A prediction gets over a gap in the outputs.
    let unseen = unseen.map(|u| u.cut_at(Gaps::OfInputs)).transpose()?;
    if let Some(unseen) = &unseen {
        say(&unseen.notes, &mut said, terminal);
    }
    estimation.notes = said;
    Ok((estimation, unseen))
}

/// The estimation data, and those to judge on where there are any.
fn parts(
    whole: Loaded,
    arguments: &FitArguments,
    terminal: &mut Terminal,
) -> Result<(Loaded, Option<Loaded>), CliError> {
    if let Some(share) = arguments.split {
        let (first, rest) = whole.split(share)?;
        return Ok((first, Some(rest)));
    }
    if arguments.validate.is_empty() {
        return Ok((whole, None));
    }
    let mut data = arguments.data.clone();
    // The window belongs to the recordings of the estimate, the clock to both.
    let row_time_s = data.sample_time_s.unwrap_or(whole.data.sample_time_s());
    (data.window, data.sample_time_s) = (Window::default(), Some(whole.data.sample_time_s()));
    let names: Vec<&str> = data.inputs.iter().chain(&data.outputs).map(String::as_str).collect();
    let files = RecordedFiles::read(&arguments.validate, &names, Some(row_time_s), terminal)?;
    let about = |_: &_, sources: &_| operating_point::of_data(whole.trend.as_ref(), &whole.sources, sources);
    let mut unseen = take_about(&files, CommonClock::Slowest, &data, Purpose::Judgement, about)?;
    let same = |a: &Source| whole.sources.iter().any(|b| a.sha256 == b.sha256);
    for source in unseen.sources.iter().filter(|source| same(source)) {
        let text = format!("{}: the estimate rests on this recording too, so it is no unseen one", source.file);
        unseen.notes.push(Note::Warning(text));
    }
    Ok((whole, Some(unseen)))
}

/// Why there is no estimate, with the data and with what can be changed.
fn refused(error: CliError, command: &FitCommand, estimation: &Loaded) -> CliError {
    let CliError::Identify { source, .. } = error else { return error };
    let remedy = match &source {
        IdentError::TooFewSamples { .. } | IdentError::RankDeficient { .. } => {
            format!("; lower {}, or give more data", orders::options(command))
        }
        IdentError::Structure(StructureError::UnknownParameter { .. }) => {
            "; --hold and --bound take K, Tw, zeta, Tp1, Tp2, Tp3, Tz and Td as far as --structure has them, with several inputs K[1], K[2] …".into()
        }
        _ => String::new(),
    };
    CliError::Estimate { data: named(&estimation.data, &estimation.sources), source, remedy }
}

fn document(fit: &Fit<AnyModel>, method: String, data: &Loaded) -> ModelDocument {
    let (inputs, outputs) = (data.data.input_labels().to_vec(), data.data.output_labels().to_vec());
    let mut document = ModelDocument::new(fit.model.clone(), inputs, outputs, data.data.sample_time_s());
    document.intersample = data.between;
    document.trend = data.trend.clone();
    document.estimate = Some(EstimateRecord::new(fit, method, data.sources.clone()));
    document
}

impl Loaded {
    /// The first part of each recording, and the rest.
    fn split(self, share: f64) -> Result<(Loaded, Loaded), CliError> {
        let split = self.data.split(share).map_err(|source| CliError::identify("splitting the data", source))?;
        let part = |data: Dataset| {
            // A recording too short to give a part has no experiment there.
            let is_there = |index: &usize| {
                let name = &self.data.experiments()[*index].name;
                data.experiments().iter().any(|e| e.name == *name)
            };
            let recording: Vec<usize> = self.recording.iter().copied().filter(is_there).collect();
            let mut sources = self.sources.clone();
            for (experiment, of) in data.experiments().iter().zip(&recording) {
                sources[*of].from_s = experiment.start_s;
                sources[*of].to_s =
                    experiment.start_s + experiment.len().saturating_sub(1) as f64 * data.sample_time_s();
            }
            let (trend, adjustments, notes) = (self.trend.clone(), self.adjustments.clone(), self.notes.clone());
            Loaded { data, between: self.between, trend, sources, recording, adjustments, notes }.without_unused()
        };
        Ok((part(split.estimation)?, part(split.validation)?))
    }
}
