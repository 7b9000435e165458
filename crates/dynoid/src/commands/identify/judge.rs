//! `dynoid compare`, `resid`, `simulate`, `predict`: models against recordings.

use std::path::{Path, PathBuf};

use ident::InitialState;
use ident::prediction::Response;
use ident::validate::{Judgement, ResidualTest, judge};
use ident::{Dataset, IdentError, ModelDocument};
use recording::{Channel, Format, Raster, Recording};

use super::data::{Loaded, check_targets, draw};
use super::{figures, model_file, words};
use crate::cli::identify::{CompareArguments, PredictArguments, ResidArguments, ResultArguments, RunArguments};
use crate::error::{CliError, Outcome};
use crate::output::replace_file;
use crate::table::{Align, Table};
use crate::terminal::Terminal;

/// Confidence of the regions of the residual tests.
const REGION: f64 = 0.99;

/// A model and the recordings it met.
struct Met {
    model: String,
    data: Dataset,
    judged: Result<Judgement, IdentError>,
}

/// `dynoid compare`
pub(crate) fn compare(arguments: &CompareArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_targets(&[&arguments.result.plot], &[&arguments.meet.on, &arguments.models])?;
    if arguments.horizon == Some(0) {
        return Err(CliError::Usage { what: "--horizon 0 predicts nothing; give one sample or more".into() });
    }
    let mut all = Vec::new();
    for path in &arguments.models {
        let document = model_file::read(path)?;
        let data = model_file::meet(&document, &arguments.meet, terminal)?.data;
        let judged = judge(&document.model, &data, arguments.horizon, &InitialState::Estimated);
        all.push(Met { model: model_file::name(path), data, judged });
    }
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

/// `dynoid resid`
pub(crate) fn resid(arguments: &ResidArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_targets(&[&arguments.result.plot], &[&arguments.meet.on])?;
    let document = model_file::read(&arguments.model)?;
    let data = model_file::meet(&document, &arguments.meet, terminal)?.data;
    if arguments.lags == 0 || arguments.lags > data.samples() / 4 {
        let what = format!(
            "--lags {}: give at least 1, and at most a quarter of the {} samples",
            arguments.lags,
            data.samples()
        );
        return Err(CliError::Usage { what });
    }
    let test = ResidualTest { lags: arguments.lags, level: REGION, ..ResidualTest::default() };
    let report = test.run(&document.model, &data).map_err(|source| CliError::identify("the residual test", source))?;
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

/// `dynoid simulate` on a model file
pub(crate) fn simulate_model(arguments: &RunArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    run(arguments, "simulated", None, terminal)
}

/// `dynoid predict`
pub(crate) fn predict_model(arguments: &PredictArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
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
    check_targets(&[&arguments.out, &arguments.result.plot], &[&arguments.meet.on])?;
    if let Some(path) = &arguments.out {
        check_output(path, arguments.meet.on.len())?;
    }
    let document = model_file::read(&arguments.model)?;
    let loaded = match horizon {
        Some(_) => model_file::meet(&document, &arguments.meet, terminal)?,
        None => model_file::meet_inputs(&document, &arguments.meet, terminal)?,
    };
    let initial = if arguments.from_rest { InitialState::Zero } else { InitialState::Estimated };
    let failed = |source| CliError::identify("the response", source);
    let judged = judge(&document.model, &loaded.data, horizon, &initial).map_err(failed)?;
    let response = &judged.response;
    picture(&arguments.result, &format!("{}, {what}", model_file::name(&arguments.model)), || {
        figures::comparison(&[figures::Shown { name: what, data: &loaded.data, response }])
    })?;
    if let Some(path) = &arguments.out {
        let recording = recording_of(&document, &loaded, response, what).map_err(failed)?;
        replace_file(path, &encoded(path, &recording)?)?;
    }
    let fit = |number: usize, output: usize| judged.fit_percent[number][output];
    let rows = (0..response.outputs.len()).flat_map(|n| (0..document.outputs.len()).map(move |o| (n, o)));
    if arguments.result.json {
        let row = |(n, o): (usize, usize)| {
            let (recording, output) = (&loaded.data.experiments()[n].name, &document.outputs[o].name);
            let values = response.outputs[n].col_as_slice(o);
            serde_json::json!({"recording": recording, "output": output, "unit": document.outputs[o].unit,
                "fit_percent": fit(n, o), "start_s": loaded.data.experiments()[n].start_s,
                "sample_time_s": document.sample_time_s, "values": values})
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

/// Responses with the trend put back, one raster a recording.
fn recording_of(
    document: &ModelDocument,
    loaded: &Loaded,
    response: &Response,
    what: &str,
) -> Result<Recording, IdentError> {
    let (mut rasters, mut channels) = (Vec::new(), Vec::new());
    for (number, experiment) in loaded.data.experiments().iter().enumerate() {
        let values = response.outputs[number].as_ref();
        let values = match &loaded.trend {
            Some(trend) => trend.restore_outputs(values, number, experiment.start_s, document.sample_time_s)?,
            None => values.to_owned(),
        };
        let time_s = (0..values.nrows()).map(|n| experiment.start_s + n as f64 * document.sample_time_s).collect();
        rasters.push(Raster { time_s, name: Some(experiment.name.clone()) });
        for (output, label) in document.outputs.iter().enumerate() {
            channels.push(Channel {
                name: format!("{}_{what}", label.name),
                unit: label.unit.clone(),
                comment: String::new(),
                raster: number,
                samples: values.col_as_slice(output).to_vec(),
            });
        }
    }
    let format = Format::Csv { delimiter: ',', decimal_comma: false };
    Ok(Recording { format, comment: None, start_time: None, rasters, channels, findings: Vec::new() })
}

/// Text has room for one recording.
fn check_output(path: &Path, recordings: usize) -> Result<(), CliError> {
    let ending = crate::input::ending(path).map(str::to_lowercase);
    if ending.as_deref() == Some("csv") && recordings > 1 {
        let what = format!(
            "{}: .csv holds one recording, and {recordings} are given; write .mf4, or one after the other",
            path.display()
        );
        return Err(CliError::Usage { what });
    }
    Ok(())
}

fn encoded(path: &Path, recording: &Recording) -> Result<Vec<u8>, CliError> {
    let encoded = match crate::input::ending(path).map(str::to_lowercase).as_deref() {
        Some("csv") => recording::encode_csv(recording),
        Some("mf4") => recording::encode_mdf4(recording),
        _ => {
            let what = format!("{}: the ending of the output says what it is: .csv or .mf4", path.display());
            return Err(CliError::Usage { what });
        }
    };
    encoded.map_err(|source| CliError::Recording { source, untimed: false })
}

/// Draws figures where a plot is asked for.
pub(super) fn picture(
    arguments: &ResultArguments,
    title: &str,
    figures: impl FnOnce() -> Vec<plot::Figure>,
) -> Result<(), CliError> {
    match &arguments.plot {
        Some(path) => replace_file(path, &draw(path, title, &figures())?),
        None => Ok(()),
    }
}

/// Says where something was written.
pub(super) fn written(path: &Option<PathBuf>, terminal: &mut Terminal) {
    if let Some(path) = path {
        terminal.line(&format!("written: {}", path.display()));
    }
}
