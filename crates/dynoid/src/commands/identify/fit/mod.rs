//! `dynoid fit …`: a model from recordings, with its uncertainty and its judgement.

mod estimate;
mod method;
mod orders;
mod show;
mod verdict;

use bench::dataset::CommonClock;
use ident::validate::TestData;
use ident::{AnyModel, Dataset, EstimateRecord, Fit, FormulaStructure, IdentError, ModelDocument, Source};

use super::data::{Files, Gaps, Loaded, check_plot, check_targets, draw, load_on, named, say, take};
use super::{greybox, model_file};
use crate::cli::identify::{FitArguments, FitCommand};
use crate::error::{CliError, Outcome};
use crate::output::replace_file;
use crate::terminal::Terminal;
use verdict::Verdict;

/// Confidence of the intervals shown.
const INTERVAL: f64 = 0.95;
/// Confidence of the regions of the residual tests.
const REGION: f64 = 0.99;

/// What an estimate was made of and came to.
struct Finished {
    document: ModelDocument,
    fit: Fit<AnyModel>,
    verdict: Verdict,
    /// Experiments that the estimate rests on.
    experiments: usize,
    /// What was said of the data on the way.
    notes: Vec<String>,
}

pub(crate) fn run(command: &FitCommand, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let common = command.common();
    check_fit(common)?;
    orders::check(command)?;
    let structure = greybox::structure_of(command)?;
    let sees_through = sees_through_missing_outputs(command, structure.as_ref());
    let (estimation, unseen) = data(command, sees_through, terminal)?;
    let wanted = method::wanted(command);
    let progress = terminal.progress(1);
    progress.say(&format!("estimating {wanted}"));
    let fit = estimate::estimate(command, structure, &estimation.data);
    let mut fit = fit.map_err(|error| refused(error, command, &estimation))?;
    drop(progress);
    if let FitCommand::Greybox(arguments) = command {
        greybox::warnings(arguments, &fit.model).iter().for_each(|text| terminal.warning(text));
    }
    let others = unseen.as_ref().map(|u| (&u.data, which_data(&u.sources, &estimation.sources)));
    let verdict = Verdict::new(&fit, &estimation.data, others);
    fit.doubts.extend(verdict.doubts(&estimation.data));
    let document = document(&fit, method::fitted(wanted, &fit.model), &estimation);
    let (experiments, notes) = (estimation.data.experiments().len(), estimation.notes.clone());
    let finished = Finished { document, fit, verdict, experiments, notes };
    if let Some(path) = &common.out {
        let text = serde_json::to_string_pretty(&finished.document).map_err(CliError::internal)?;
        replace_file(path, text.as_bytes())?;
    }
    if let Some(path) = &common.result.plot {
        let shown = unseen.as_ref().unwrap_or(&estimation);
        let title = format!("{} → {}", show::channels(&finished.document), show::method(&finished.document));
        replace_file(path, &draw(path, &title, &finished.verdict.figures(&shown.data))?)?;
    }
    if common.result.json {
        terminal.json(&finished.json())?;
    } else if !terminal.is_quiet() {
        finished.print(common, terminal);
    }
    finished.verdict.failures().iter().for_each(|text| terminal.warning(text));
    Ok(Outcome::Done)
}

/// Checks where results go before any work is done.
fn check_fit(arguments: &FitArguments) -> Result<(), CliError> {
    let targets = [&arguments.out, &arguments.result.plot];
    arguments.out.as_deref().map_or(Ok(()), model_file::check_ending)?;
    check_targets(&targets, &[&arguments.data.recordings, &arguments.validate])?;
    check_plot(&arguments.result)
}

/// Whether the method looks at the simulated output alone, so that outputs may be slower than the inputs.
fn sees_through_missing_outputs(command: &FitCommand, structure: Option<&FormulaStructure>) -> bool {
    match command {
        FitCommand::Oe(_) | FitCommand::Tf(_) | FitCommand::Process(_) => true,
        FitCommand::Poly(a) => [a.na, a.nc, a.nd].iter().all(|order| order.unwrap_or(0) == 0),
        FitCommand::Greybox(_) => structure.is_some_and(greybox::is_output_error),
        _ => false,
    }
}

/// Where the data have to be without gaps. Nothing can be simulated over a gap in the inputs; rows that touch a missing
/// output are left out by most methods themselves.
fn gaps(command: &FitCommand, sees_through: bool) -> Gaps {
    match command {
        FitCommand::Ss(_) => Gaps::OfAll,
        FitCommand::Greybox(_) if !sees_through => Gaps::OfAll,
        _ => Gaps::OfInputs,
    }
}

/// What the estimate rests on, and what it is judged by besides; both cut where the method cannot go on.
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
    let mut estimation = estimation.cut_at(gaps(command, sees_through))?;
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
        let (first, rest) = whole.split(model_file::checked_share("--split", share)?)?;
        return Ok((first, Some(rest)));
    }
    if arguments.validate.is_empty() {
        return Ok((whole, None));
    }
    let mut data = arguments.data.clone();
    // The window belongs to the recordings of the estimate, the clock to both.
    let row_time_s = data.sample_time_s.unwrap_or(whole.data.sample_time_s());
    (data.from_s, data.to_s, data.sample_time_s) = (None, None, Some(whole.data.sample_time_s()));
    let files = Files::read(&arguments.validate, Some(row_time_s), terminal)?;
    let mut unseen = take(&files, CommonClock::Slowest, &data)?;
    let same = |a: &Source| whole.sources.iter().any(|b| a.sha256 == b.sha256);
    for source in unseen.sources.iter().filter(|source| same(source)) {
        unseen.notes.push(format!("{}: the estimate rests on this recording too, so it is no unseen one", source.file));
    }
    Ok((whole, Some(unseen)))
}

/// What data are to an estimate: its own where a part of them is.
pub(super) fn which_data(sources: &[Source], of_the_estimate: &[Source]) -> TestData {
    let shared = |source: &Source| of_the_estimate.iter().any(|own| own.overlaps(source));
    if sources.iter().any(shared) { TestData::Own } else { TestData::Unseen }
}

/// Why there is no estimate, with the data and with what can be changed.
fn refused(error: CliError, command: &FitCommand, estimation: &Loaded) -> CliError {
    let CliError::Identify { source, .. } = error else { return error };
    let remedy = match &source {
        IdentError::TooFewSamples { .. } | IdentError::RankDeficient { .. } => {
            format!("; lower {}, or give more data", orders::options(command))
        }
        _ => String::new(),
    };
    CliError::Estimate { data: named(&estimation.data, &estimation.sources), source, remedy }
}

fn document(fit: &Fit<AnyModel>, method: String, data: &Loaded) -> ModelDocument {
    let (inputs, outputs) = (data.data.input_labels().to_vec(), data.data.output_labels().to_vec());
    let mut document = ModelDocument::new(fit.model.clone(), inputs, outputs, data.data.sample_time_s());
    document.intersample = data.data.intersample();
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
            Loaded { data, trend: self.trend.clone(), sources, recording, notes: self.notes.clone() }
        };
        Ok((part(split.estimation), part(split.validation)))
    }
}
