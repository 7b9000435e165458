//! `dynoid compare`, `resid`, `simulate`, `predict`: models against recordings.

use std::path::{Path, PathBuf};

use ident::prediction::{InitialState, Response, predict, simulate};
use ident::validate::{Judgement, ResidualTest, judge};
use ident::{Dataset, IdentError, ModelDocument};
use recording::{Channel, Format, Raster, Recording};

use super::data::{Loaded, draw};
use super::{figures, model_file, words};
use crate::cli::identify::{CompareArguments, PredictArguments, ResidArguments, ResultArguments, RunArguments};
use crate::error::{CliError, Outcome};
use crate::output::replace_file;
use crate::table::{Align, Table};
use crate::terminal::Terminal;

/// Confidence of the regions of the residual tests.
const REGION: f64 = 0.99;

/// `dynoid compare`
pub(crate) fn compare(arguments: &CompareArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let mut judged: Vec<(String, Result<Judgement, IdentError>)> = Vec::new();
    let mut shown: Option<Dataset> = None;
    for path in &arguments.models {
        let document = model_file::read(path)?;
        let data = model_file::meet(&document, &arguments.meet, terminal)?.data;
        let result = judge(&document.model, &data, arguments.horizon, &InitialState::Estimated);
        judged.push((model_file::name(path), result));
        shown.get_or_insert(data);
    }
    let Some(data) = shown else { return Ok(Outcome::Done) };
    let good = judged.iter().filter_map(|(name, j)| Some((name.clone(), &j.as_ref().ok()?.response)));
    let same =
        |(_, r): &(String, &Response)| r.outputs.iter().zip(data.experiments()).all(|(m, e)| m.nrows() == e.len());
    let curves: Vec<(String, &Response)> = good.filter(same).collect();
    picture(&arguments.result, "Models compared", || figures::comparison(&data, &curves))?;
    if arguments.result.json {
        let row = |(name, j): &(String, Result<Judgement, IdentError>)| match j {
            Ok(j) => {
                serde_json::json!({"model": name, "fit_percent": j.fit_percent, "rms_error": j.rms_error, "loss": j.loss})
            }
            Err(reason) => serde_json::json!({"model": name, "error": reason.to_string()}),
        };
        terminal.json(&judged.iter().map(row).collect::<Vec<_>>())?;
    } else if !terminal.is_quiet() {
        terminal.table(&comparison(&judged, &data));
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

fn comparison(judged: &[(String, Result<Judgement, IdentError>)], data: &Dataset) -> Table {
    let columns = [
        ("model", Align::Left),
        ("recording", Align::Left),
        ("output", Align::Left),
        ("fit", Align::Right),
        ("rms error", Align::Right),
    ];
    let mut table = Table::new(&columns);
    for (name, judgement) in judged {
        let judgement = match judgement {
            Ok(judgement) => judgement,
            Err(reason) => {
                table.row([name.as_str().into(), "".into(), "".into(), "–".into(), reason.to_string().into()]);
                continue;
            }
        };
        for (number, experiment) in data.experiments().iter().enumerate() {
            for (output, label) in data.output_labels().iter().enumerate() {
                table.row([
                    name.as_str().into(),
                    experiment.name.as_str().into(),
                    label.name.as_str().into(),
                    format!("{:.2} %", judgement.fit_percent[number][output]).into(),
                    format!("{} {}", words::significant(judgement.rms_error[number][output]), label.unit).into(),
                ]);
            }
        }
    }
    table
}

/// `dynoid resid`
pub(crate) fn resid(arguments: &ResidArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let document = model_file::read(&arguments.model)?;
    let data = model_file::meet(&document, &arguments.meet, terminal)?.data;
    let test = ResidualTest { lags: arguments.lags, level: REGION, ..ResidualTest::default() };
    let report = test.run(&document.model, &data).map_err(|source| CliError::identify("the residual test", source))?;
    picture(&arguments.result, "Residuals", || figures::residuals(&report, &data, REGION))?;
    if arguments.result.json {
        terminal.json(&words::tests_json(&report, REGION))?;
    } else if !terminal.is_quiet() {
        words::print_tests(&report, (data.input_labels(), data.output_labels()), REGION, terminal);
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

/// `dynoid simulate` on a model file
pub(crate) fn simulate_model(arguments: &RunArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    run(arguments, "simulated", |document, data, initial| simulate(&document.model, data, initial), terminal)
}

/// `dynoid predict`
pub(crate) fn predict_model(arguments: &PredictArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let horizon = arguments.horizon;
    run(
        &arguments.run,
        "predicted",
        |document, data, initial| predict(&document.model, data, horizon, initial),
        terminal,
    )
}

fn run(
    arguments: &RunArguments,
    what: &str,
    respond: impl Fn(&ModelDocument, &Dataset, &InitialState) -> Result<Response, IdentError>,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    let document = model_file::read(&arguments.model)?;
    let loaded = model_file::meet(&document, &arguments.meet, terminal)?;
    let initial = if arguments.from_rest { InitialState::Zero } else { InitialState::Estimated };
    let failed = |source| CliError::identify("the response", source);
    let response = respond(&document, &loaded.data, &initial).map_err(failed)?;
    let shown = (what.to_owned(), &response);
    picture(&arguments.result, &format!("{}, {what}", model_file::name(&arguments.model)), || {
        figures::comparison(&loaded.data, &[shown])
    })?;
    if let Some(path) = &arguments.out {
        let recording = recording_of(&document, &loaded, &response, what).map_err(failed)?;
        replace_file(path, &encoded(path, &recording)?)?;
    }
    let fit = |number: usize, output: usize| {
        let measured = loaded.data.experiments()[number].output(output);
        ident::validate::fit_percent(measured, response.outputs[number].col_as_slice(output)).unwrap_or(f64::NAN)
    };
    let rows = (0..response.outputs.len()).flat_map(|n| (0..document.outputs.len()).map(move |o| (n, o)));
    if arguments.result.json {
        let row = |(n, o): (usize, usize)| {
            let (recording, output) = (&loaded.data.experiments()[n].name, &document.outputs[o].name);
            let values = response.outputs[n].col_as_slice(o);
            serde_json::json!({"recording": recording, "output": output, "fit_percent": fit(n, o), "values": values})
        };
        terminal.json(&rows.map(row).collect::<Vec<_>>())?;
    } else if !terminal.is_quiet() {
        for (n, o) in rows {
            let (recording, output) = (&loaded.data.experiments()[n].name, &document.outputs[o].name);
            terminal.line(&format!("{recording}: {output} {what}, fit {:.2} %", fit(n, o)));
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
