//! `dynoid model compare`, `residuals`, `simulate`, `predict`: models on recordings.

use dynoid::FileFormat;
use dynoid::linear::operating_point::taken_off;
use dynoid::linear::{Loaded, Note, RecordedFiles, which_data};
use ident::InitialState;
use ident::uncertainty::Dynamics;
use ident::validate::{ResidualTest, judge};
use ident::{Dataset, ModelDocument};
use toolbox_report::compare::{self, Met};
use toolbox_report::operating_point::hint;
use toolbox_report::residuals::{self, REGION};
use toolbox_report::response::Responded;
use toolbox_report::words::growing_pole;

use super::data::say;
use super::{bench_replay, model_file, recorded};
use crate::cli::identify::{
    BenchArguments, CompareArguments, MeetArguments, PredictArguments, ResidualsArguments, RunArguments,
    SimulateModelArguments,
};
use crate::commands::result::{check_plot, show, show_with};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid model compare`
pub(crate) fn compare(arguments: &CompareArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &terminal.files())?;
    if arguments.horizon == Some(0) {
        return Err(CliError::Usage { what: "--horizon 0 predicts nothing; give one sample or more".into() });
    }
    if let Some(models) = bench_replay::Named::all(&arguments.models, &terminal.files())? {
        return bench_replay::compare(&models, arguments, terminal);
    }
    no_bench_options(&arguments.bench)?;
    let all = meetings(arguments, terminal)?;
    show(&arguments.result, || compare::page(&all), || compare::json(&all), terminal)?;
    for met in &all {
        if let Err(reason) = &met.judged {
            terminal.warning(&format!("{}: no comparison: {reason}", met.model));
        }
    }
    // One model that cannot be compared leaves the others their comparison.
    match all.iter().find_map(|met| met.judged.as_ref().err()) {
        Some(reason) if all.iter().all(|met| met.judged.is_err()) => {
            Err(CliError::identify("the comparison", reason.clone()))
        }
        Some(_) => Ok(Outcome::SomeUnreadable),
        None => Ok(Outcome::Done),
    }
}

/// Every model on the recordings, which are read once.
fn meetings(arguments: &CompareArguments, terminal: &mut Terminal) -> Result<Vec<Met>, CliError> {
    let documents: Vec<ModelDocument> =
        arguments.models.iter().map(|path| terminal.files().linear_model(path)).collect::<Result<_, _>>()?;
    let (mut files, mut said, mut all): (Option<RecordedFiles>, _, _) = (None, Vec::new(), Vec::new());
    for (path, document) in arguments.models.iter().zip(&documents) {
        let row_time_s = model_file::row_time_s(document, &arguments.meet);
        let read = match files.take() {
            Some(read) if read.serves(row_time_s) => read,
            _ => {
                let (files, channels) = (terminal.files(), model_file::channels(&documents));
                RecordedFiles::read(&arguments.meet.on, &channels, Some(row_time_s), &files, terminal.work())?
            }
        };
        let Loaded { data, notes, .. } = model_file::meet(document, &read, &arguments.meet)?;
        files = Some(read);
        say(&notes, &mut said, terminal);
        say(&beyond(arguments.horizon, &data), &mut said, terminal);
        let judged = judge(&document.model, &data, arguments.horizon, &InitialState::Estimated);
        let name = dynoid::model_name(path);
        if arguments.horizon.is_none()
            && let Some(mode) = document.model.system().and_then(|system| system.growing_mode()).ok().flatten()
        {
            let pole = growing_pole(&mode);
            let text =
                format!("{name} is not stable ({pole}): its simulation runs away; --horizon compares predictions");
            say(&[Note::Warning(text)], &mut said, terminal);
        } else if let Ok(judged) = &judged
            && let Some(hint) = hint(document, &data, &judged.response, taken_off(arguments.meet.detrend.off()))
        {
            say(&[Note::Warning(format!("{name}: {hint}"))], &mut said, terminal);
        }
        all.push(Met { model: name, data, judged });
    }
    Ok(all)
}

/// That a horizon reaches beyond every recording.
fn beyond(horizon: Option<usize>, data: &Dataset) -> Vec<Note> {
    let longest = data.experiments().iter().map(|e| e.len()).max().unwrap_or(0);
    let said = |horizon: usize| {
        Note::Warning(format!("no recording has more than {longest} samples: {horizon} samples ahead is a simulation"))
    };
    horizon.filter(|horizon| *horizon >= longest).map(said).into_iter().collect()
}

/// The recordings that one model meets.
fn recordings(
    document: &ModelDocument,
    arguments: &MeetArguments,
    terminal: &Terminal,
) -> Result<RecordedFiles, CliError> {
    let names = model_file::channels(std::slice::from_ref(document));
    let row_time_s = model_file::row_time_s(document, arguments);
    Ok(RecordedFiles::read(&arguments.on, &names, Some(row_time_s), &terminal.files(), terminal.work())?)
}

/// `dynoid model residuals`
pub(crate) fn residuals(arguments: &ResidualsArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &terminal.files())?;
    let document = terminal.files().linear_model(&arguments.model)?;
    let files = recordings(&document, &arguments.meet, terminal)?;
    let Loaded { data, notes, sources, .. } = model_file::meet(&document, &files, &arguments.meet)?;
    say(&notes, &mut Vec::new(), terminal);
    if arguments.lags == 0 || arguments.lags > data.samples() / 4 {
        let what = format!(
            "--lags {}: give at least 1, and at most a quarter of the {} samples",
            arguments.lags,
            data.samples()
        );
        return Err(CliError::Usage { what });
    }
    let failed = |source| CliError::identify("the residual test", source);
    let predicted = judge(&document.model, &data, Some(1), &InitialState::Estimated).map_err(failed)?;
    let hint = hint(&document, &data, &predicted.response, taken_off(arguments.meet.detrend.off()));
    hint.iter().for_each(|hint| terminal.warning(hint));
    let test = ResidualTest { lags: arguments.lags, level: REGION, ..ResidualTest::default() };
    let report = match &document.estimate {
        Some(estimate) => document.fit().and_then(|fit| test.run(&fit, &data, which_data(&sources, &estimate.sources))),
        None => test.run_known(&document.model, &data),
    };
    let report = report.map_err(failed)?;
    show(&arguments.result, || residuals::page(&report, &data), || residuals::json(&report, &data), terminal)?;
    Ok(Outcome::Done)
}

/// `dynoid model simulate`
pub(crate) fn simulate(arguments: &SimulateModelArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let SimulateModelArguments { run: of_run, bench } = arguments;
    if let Some(model) =
        bench_replay::Named::all(std::slice::from_ref(&of_run.model), &terminal.files())?.and_then(|mut all| all.pop())
    {
        return bench_replay::simulate(model, of_run, bench, terminal);
    }
    no_bench_options(bench)?;
    run(of_run, "simulated", None, terminal)
}

/// Refuses options of bench models where the models are linear.
fn no_bench_options(given: &BenchArguments) -> Result<(), CliError> {
    match given.bench.is_some() || given.mode.is_some() {
        true => Err(CliError::Usage { what: "--bench and --mode belong to bench models; leave them out".to_owned() }),
        false => Ok(()),
    }
}

/// `dynoid model predict`
pub(crate) fn predict(arguments: &PredictArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    if arguments.horizon == 0 {
        return Err(CliError::Usage { what: "--horizon 0 predicts nothing; give one sample or more".into() });
    }
    run(&arguments.run, "predicted", Some(arguments.horizon), terminal)
}

/// Responses to recordings: so many samples ahead, or simulated where there is no horizon.
fn run(
    arguments: &RunArguments,
    what: &str,
    horizon: Option<usize>,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &terminal.files())?;
    if let Some(path) = &arguments.out {
        recorded::check_output(path, arguments.meet.on.len(), &terminal.files())?;
    }
    let document = terminal.files().linear_model(&arguments.model)?;
    let files = recordings(&document, &arguments.meet, terminal)?;
    let loaded = match horizon {
        Some(_) => model_file::meet(&document, &files, &arguments.meet)?,
        None => model_file::meet_inputs(&document, &files, &arguments.meet)?,
    };
    let mut said = Vec::new();
    say(&loaded.notes, &mut said, terminal);
    say(&beyond(horizon, &loaded.data), &mut said, terminal);
    let initial = if arguments.from_rest { InitialState::Zero } else { InitialState::Estimated };
    let failed = |source| CliError::identify("the response", source);
    let judged = judge(&document.model, &loaded.data, horizon, &initial).map_err(failed)?;
    let response = &judged.response;
    let hint = hint(&document, &loaded.data, response, taken_off(arguments.meet.detrend.off()));
    hint.iter().for_each(|hint| terminal.warning(hint));
    if let Some(path) = &arguments.out {
        let recording = recorded::recording_of(&document, &loaded, response, what).map_err(failed)?;
        FileFormat::of_output(path)?.write(&recording, path, &terminal.files())?;
    }
    let model = dynoid::model_name(&arguments.model);
    let found = Responded { model: &model, what, outputs: &document.outputs, data: &loaded.data, judged: &judged };
    show_with(&arguments.result, &[&arguments.out], || found.page(), || found.json(), terminal)?;
    Ok(Outcome::Done)
}
