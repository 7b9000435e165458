//! `dynoid model compare`, `residuals`, `simulate`, `predict`: models on recordings.

use std::num::NonZeroUsize;

use dynoid::linear::{
    ComparedModels, ModelResponse, NamedModel, ResponseOptions, TestedResiduals, check_recordings_file,
};
use dynoid::replay::{BenchModelFile, BenchReplays, ReplayedStretch};
use dynoid::{Error, FileFormat, Models};

use super::data::say;
use crate::cli::identify::{
    BenchArguments, CompareArguments, MeetArguments, PredictArguments, ResidualsArguments, RunArguments,
    SimulateModelArguments,
};
use crate::commands::result::{Sorted, check_plot, show, show_with};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid model compare`
pub(crate) fn compare(arguments: &CompareArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &terminal.files())?;
    let horizon = arguments.horizon.map(horizon).transpose()?;
    let models = match terminal.files().models(&arguments.models)? {
        Models::Bench(models) => return compare_benches(&models, arguments, terminal),
        Models::Linear(models) => models,
    };
    no_bench_options(&arguments.bench)?;
    let (files, mut notes) = (terminal.files(), Vec::new());
    let options = arguments.meet.options();
    let found = ComparedModels::of(&models, &options, horizon, &files, terminal.work(), &mut notes);
    say(&notes, &mut Vec::new(), terminal);
    let found = found?;
    show(&arguments.result, || found.page(), || Sorted(found.facts()), terminal)?;
    for (model, reason) in found.failures() {
        terminal.warning(&format!("{model}: no comparison: {reason}"));
    }
    // One model that cannot be compared leaves the others their comparison.
    match found.failures().next() {
        Some((_, reason)) if found.failures().count() == found.all().len() => {
            Err(CliError::identify("the comparison", reason.clone()))
        }
        Some(_) => Ok(Outcome::SomeUnreadable),
        None => Ok(Outcome::Done),
    }
}

fn compare_benches(
    models: &[BenchModelFile],
    arguments: &CompareArguments,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    if arguments.horizon.is_some() {
        return Err(of_linear_models("--horizon"));
    }
    let all = replays(models, &arguments.meet, &arguments.bench, ReplayedStretch::AsStudy, terminal)?;
    show(&arguments.result, || all.page("Bench models compared"), || Sorted(all.facts()), terminal)?;
    Ok(Outcome::Done)
}

fn of_linear_models(option: &str) -> CliError {
    CliError::Usage { what: format!("{option} belongs to linear models; leave it out with a bench model") }
}

/// Refuses options of bench models where the models are linear.
fn no_bench_options(given: &BenchArguments) -> Result<(), CliError> {
    match given.bench.is_some() || given.mode.is_some() {
        true => Err(CliError::Usage { what: "--bench and --mode belong to bench models; leave them out".to_owned() }),
        false => Ok(()),
    }
}

fn horizon(samples: usize) -> Result<NonZeroUsize, CliError> {
    let nothing = || CliError::Usage { what: "--horizon 0 predicts nothing; give one sample or more".into() };
    NonZeroUsize::new(samples).ok_or_else(nothing)
}

/// Every recording on every bench model; of each the `unasked` stretch where none is asked for.
fn replays(
    models: &[BenchModelFile],
    meet: &MeetArguments,
    bench: &BenchArguments,
    unasked: ReplayedStretch,
    terminal: &mut Terminal,
) -> Result<BenchReplays, CliError> {
    if meet.sample_time_s.is_some() {
        return Err(of_linear_models("--sample-time"));
    }
    if !meet.is_at_operating_point() {
        return Err(of_linear_models("--detrend"));
    }
    let (options, files, mut notes) = (meet.replay_options(bench, unasked), terminal.files(), Vec::new());
    let found = BenchReplays::of(models, &options, &files, terminal.work(), &mut notes);
    notes.iter().for_each(|note| terminal.warning(note.text()));
    Ok(found?)
}

/// `dynoid model residuals`
pub(crate) fn residuals(arguments: &ResidualsArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let files = terminal.files();
    check_plot(&arguments.result, &files)?;
    let (document, options, mut notes) = (files.linear_model(&arguments.model)?, arguments.meet.options(), Vec::new());
    let found = TestedResiduals::of(&document, &options, arguments.lags, &files, terminal.work(), &mut notes);
    say(&notes, &mut Vec::new(), terminal);
    let found = found?;
    show(&arguments.result, || found.page(), || Sorted(found.facts()), terminal)?;
    Ok(Outcome::Done)
}

/// `dynoid model simulate`
pub(crate) fn simulate(arguments: &SimulateModelArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let SimulateModelArguments { run, bench } = arguments;
    if let Models::Bench(models) = terminal.files().models(std::slice::from_ref(&run.model))? {
        return simulate_bench(&models, run, bench, terminal);
    }
    no_bench_options(bench)?;
    respond(run, None, terminal)
}

fn simulate_bench(
    models: &[BenchModelFile],
    arguments: &RunArguments,
    bench: &BenchArguments,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    let RunArguments { meet, out, result, .. } = arguments;
    check_plot(result, &terminal.files())?;
    if arguments.from_rest {
        return Err(of_linear_models("--from-rest"));
    }
    check_out(arguments, terminal)?;
    let all = replays(models, meet, bench, ReplayedStretch::Whole, terminal)?;
    if let Some(path) = out {
        FileFormat::of_output(path)?.write(&all.recording(), path, &terminal.files())?;
    }
    show_with(result, &[out], || all.page("Bench model simulated"), || Sorted(all.facts()), terminal)?;
    Ok(Outcome::Done)
}

/// `dynoid model predict`
pub(crate) fn predict(arguments: &PredictArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    respond(&arguments.run, Some(horizon(arguments.horizon)?), terminal)
}

/// Responses to recordings: so many samples ahead, or simulated where there is no horizon.
fn respond(
    arguments: &RunArguments,
    horizon: Option<NonZeroUsize>,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    let files = terminal.files();
    check_plot(&arguments.result, &files)?;
    check_out(arguments, terminal)?;
    let model = NamedModel::read(&arguments.model, &files)?;
    let (options, mut notes) = (arguments.meet.options(), Vec::new());
    let response = ResponseOptions { horizon, from_rest: arguments.from_rest };
    let found = ModelResponse::of(model, &options, response, &files, terminal.work(), &mut notes);
    say(&notes, &mut Vec::new(), terminal);
    let found = found?;
    if let Some(path) = &arguments.out {
        FileFormat::of_output(path)?.write(&found.recording()?, path, &files)?;
    }
    show_with(&arguments.result, &[&arguments.out], || found.page(), || Sorted(found.facts()), terminal)?;
    Ok(Outcome::Done)
}

/// Checks before any work that the response can be written.
fn check_out(arguments: &RunArguments, terminal: &Terminal) -> Result<(), Error> {
    let check = |path: &_| check_recordings_file(path, arguments.meet.on.len(), &terminal.files());
    arguments.out.as_ref().map_or(Ok(()), |path| check(path.as_path()))
}
