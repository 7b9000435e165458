//! `dynoid model compare`, `residuals`, `simulate`, `predict`: models on recordings.

use std::path::PathBuf;

use ident::InitialState;
use ident::uncertainty::Dynamics;
use ident::validate::{Judgement, ResidualTest, judge};
use ident::{Dataset, IdentError, ModelDocument};

use super::data::{Files, Loaded, Note, check_plot, check_targets, draw, say};
use super::fit::which_data;
use super::{figures, model_file, operating_point, recorded, words};
use crate::cli::identify::{
    CompareArguments, MeetArguments, PredictArguments, ResidualsArguments, ResultArguments, RunArguments,
};
use crate::error::{CliError, Outcome};
use crate::formats::FileFormat;
use crate::output::replace_file;
use crate::terminal::Terminal;
use page::{Align, Page, Table};

/// Confidence of the regions of the residual tests.
pub(super) const REGION: f64 = 0.99;

/// A model and the recordings it met.
struct Met {
    model: String,
    data: Dataset,
    judged: Result<Judgement, IdentError>,
}

/// `dynoid model compare`
pub(crate) fn compare(arguments: &CompareArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &[&arguments.meet.on, &arguments.models])?;
    if arguments.horizon == Some(0) {
        return Err(CliError::Usage { what: "--horizon 0 predicts nothing; give one sample or more".into() });
    }
    let all = meetings(arguments, terminal)?;
    picture(&arguments.result, "Models compared", || {
        figures::comparison(&all.iter().filter_map(shown).collect::<Vec<_>>())
    })?;
    if arguments.result.json {
        let row = |met: &Met| match &met.judged {
            Ok(j) => serde_json::json!({"model": met.model, "outputs": met.data.output_labels(),
                "recordings": met.data.experiments().iter().map(|e| e.name.as_str()).collect::<Vec<_>>(),
                "fit_percent": j.fit_percent, "rms_error": j.rms_error, "loss": j.loss}),
            Err(reason) => serde_json::json!({"model": met.model, "error": reason.to_string()}),
        };
        terminal.json(&all.iter().map(row).collect::<Vec<_>>())?;
    } else if !terminal.is_quiet() {
        terminal.table(&comparison(&all));
        written(&arguments.result.plot, terminal);
    }
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
        arguments.models.iter().map(|path| model_file::read(path)).collect::<Result<_, _>>()?;
    let (mut files, mut said, mut all): (Option<Files>, _, _) = (None, Vec::new(), Vec::new());
    for (path, document) in arguments.models.iter().zip(&documents) {
        let row_time_s = model_file::row_time_s(document, &arguments.meet);
        let read = match files.take() {
            Some(read) if read.serves(row_time_s) => read,
            _ => Files::read(&arguments.meet.on, &model_file::channels(&documents), Some(row_time_s), terminal)?,
        };
        let Loaded { data, notes, .. } = model_file::meet(document, &read, &arguments.meet)?;
        files = Some(read);
        say(&notes, &mut said, terminal);
        say(&beyond(arguments.horizon, &data), &mut said, terminal);
        let judged = judge(&document.model, &data, arguments.horizon, &InitialState::Estimated);
        let name = model_file::name(path);
        if arguments.horizon.is_none()
            && let Some(mode) = document.model.system().and_then(|system| system.growing_mode()).ok().flatten()
        {
            let pole = words::growing_pole(&mode);
            let text =
                format!("{name} is not stable ({pole}): its simulation runs away; --horizon compares predictions");
            say(&[Note::Warning(text)], &mut said, terminal);
        } else if let Ok(judged) = &judged
            && let Some(hint) = operating_point::hint(document, &data, &judged.response, arguments.meet.detrend)
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
fn recordings(document: &ModelDocument, arguments: &MeetArguments, terminal: &Terminal) -> Result<Files, CliError> {
    let names = model_file::channels(std::slice::from_ref(document));
    Files::read(&arguments.on, &names, Some(model_file::row_time_s(document, arguments)), terminal)
}

fn shown(met: &Met) -> Option<figures::Shown<'_>> {
    let response = &met.judged.as_ref().ok()?.response;
    Some(figures::Shown { name: &met.model, data: &met.data, response })
}

fn comparison(all: &[Met]) -> Table {
    let columns = [
        ("model", Align::Left),
        ("recording", Align::Left),
        ("output", Align::Left),
        ("fit", Align::Right),
        ("rms error", Align::Right),
    ];
    let mut table = Table::new(&columns);
    for met in all {
        let Ok(judgement) = &met.judged else { continue };
        for (number, experiment) in met.data.experiments().iter().enumerate() {
            for (output, label) in met.data.output_labels().iter().enumerate() {
                table.row([
                    met.model.as_str().into(),
                    experiment.name.as_str().into(),
                    label.name.as_str().into(),
                    words::percent(judgement.fit_percent[number][output]).into(),
                    format!("{} {}", words::significant(judgement.rms_error[number][output]), label.unit).into(),
                ]);
            }
        }
    }
    table
}

/// `dynoid model residuals`
pub(crate) fn residuals(arguments: &ResidualsArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &[&arguments.meet.on, std::slice::from_ref(&arguments.model)])?;
    let document = model_file::read(&arguments.model)?;
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
    let hint = operating_point::hint(&document, &data, &predicted.response, arguments.meet.detrend);
    hint.iter().for_each(|hint| terminal.warning(hint));
    let test = ResidualTest { lags: arguments.lags, level: REGION, ..ResidualTest::default() };
    let report = match &document.estimate {
        Some(estimate) => document.fit().and_then(|fit| test.run(&fit, &data, which_data(&sources, &estimate.sources))),
        None => test.run_known(&document.model, &data),
    };
    let report = report.map_err(failed)?;
    picture(&arguments.result, "Residuals", || figures::residuals(&report, &data, REGION))?;
    if arguments.result.json {
        let mut tests = words::tests_json(&report, REGION);
        tests["inputs"] = serde_json::json!(data.input_labels());
        tests["outputs"] = serde_json::json!(data.output_labels());
        terminal.json(&tests)?;
    } else if !terminal.is_quiet() {
        words::print_tests(&report, (data.input_labels(), data.output_labels()), REGION, terminal);
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

/// `dynoid model simulate`
pub(crate) fn simulate(arguments: &RunArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    run(arguments, "simulated", None, terminal)
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
    let read = [arguments.meet.on.as_slice(), std::slice::from_ref(&arguments.model)];
    check_plot(&arguments.result, &read)?;
    if let Some(path) = &arguments.out {
        recorded::check_output(path, arguments.meet.on.len())?;
    }
    check_targets(&[&arguments.out], &read)?;
    let document = model_file::read(&arguments.model)?;
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
    let hint = operating_point::hint(&document, &loaded.data, response, arguments.meet.detrend);
    hint.iter().for_each(|hint| terminal.warning(hint));
    picture(&arguments.result, &format!("{}, {what}", model_file::name(&arguments.model)), || {
        figures::comparison(&[figures::Shown { name: what, data: &loaded.data, response }])
    })?;
    if let Some(path) = &arguments.out {
        let recording = recorded::recording_of(&document, &loaded, response, what).map_err(failed)?;
        FileFormat::of_output(path)?.write(&recording, path)?;
    }
    let fit = |number: usize, output: usize| judged.fit_percent[number][output];
    let rows = (0..response.outputs.len()).flat_map(|n| (0..document.outputs.len()).map(move |o| (n, o)));
    if arguments.result.json {
        let row = |(n, o): (usize, usize)| {
            let (experiment, output) = (&loaded.data.experiments()[n], &document.outputs[o].name);
            let values = response.outputs[n].col_as_slice(o);
            serde_json::json!({"recording": experiment.name, "output": output, "unit": document.outputs[o].unit,
                "start_s": experiment.start_s, "sample_time_s": loaded.data.sample_time_s(),
                "fit_percent": fit(n, o), "values": values})
        };
        terminal.json(&rows.map(row).collect::<Vec<_>>())?;
    } else if !terminal.is_quiet() {
        for (n, o) in rows {
            let (recording, output) = (&loaded.data.experiments()[n].name, &document.outputs[o].name);
            terminal.line(&format!("{recording}: {output} {what}, fit {}", words::percent(fit(n, o))));
        }
        [&arguments.out, &arguments.result.plot].into_iter().for_each(|path| written(path, terminal));
    }
    Ok(Outcome::Done)
}

/// Draws figures where a plot is asked for.
pub(in crate::commands) fn picture(
    arguments: &ResultArguments,
    title: &str,
    figures: impl FnOnce() -> Vec<page::Figure>,
) -> Result<(), CliError> {
    match &arguments.plot {
        Some(path) => write_page(Some(path), &Page::of_figures(title, figures())),
        None => Ok(()),
    }
}

/// Writes a page where a plot is asked for.
pub(in crate::commands) fn write_page(plot: Option<&PathBuf>, page: &Page) -> Result<(), CliError> {
    plot.map_or(Ok(()), |path| replace_file(path, &draw(path, page)?))
}

/// Says where something was written.
pub(in crate::commands) fn written(path: &Option<PathBuf>, terminal: &mut Terminal) {
    if let Some(path) = path {
        terminal.line(&format!("written: {}", path.display()));
    }
}
