//! Model files, and the recordings that models meet.

use std::path::Path;

use bench::dataset::DatasetError;
use faer::Mat;
use ident::{Experiment, Intersample, ModelDocument, Trend};

use super::data::{Loaded, load_files};
use crate::cli::identify::{Between, DataArguments, Detrend, MeetArguments};
use crate::error::CliError;
use crate::input::read_text;
use crate::terminal::Terminal;

/// Reads a model file.
pub(super) fn read(path: &Path) -> Result<ModelDocument, CliError> {
    let wrong = |reason: String| CliError::ModelFile { path: path.to_owned(), reason };
    let document: ModelDocument = serde_json::from_str(&read_text(path)?).map_err(|error| wrong(error.to_string()))?;
    document.checked().map_err(|error| wrong(error.to_string()))
}

/// What a model is called: the name of its file.
pub(super) fn name(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// The model's channels out of recordings, on the model's clock.
pub(super) fn meet(
    document: &ModelDocument,
    arguments: &MeetArguments,
    terminal: &mut Terminal,
) -> Result<Loaded, CliError> {
    let names = |labels: &[ident::Label]| labels.iter().map(|label| label.name.clone()).collect();
    let data = DataArguments {
        recordings: arguments.on.clone(),
        inputs: names(&document.inputs),
        outputs: names(&document.outputs),
        from_s: arguments.from_s,
        to_s: arguments.to_s,
        sample_time_s: Some(document.sample_time_s),
        detrend: arguments.detrend,
        between: match document.intersample {
            Intersample::ZeroOrderHold => Between::Held,
            Intersample::FirstOrderHold => Between::Straight,
            Intersample::BandLimited => Between::BandLimited,
        },
    };
    load_files(&arguments.on, &data, terminal)
}

/// As [`meet`], but recordings without the outputs will do: a simulation needs the inputs alone. Unmeasured outputs are
/// missing throughout, and the inputs are taken about the operating point of the model.
pub(super) fn meet_inputs(
    document: &ModelDocument,
    arguments: &MeetArguments,
    terminal: &mut Terminal,
) -> Result<Loaded, CliError> {
    let is_output = |name: &str| document.outputs.iter().any(|label| label.name == name);
    match meet(document, arguments, terminal) {
        Err(CliError::Dataset(DatasetError::NoChannel { channel, .. })) if is_output(&channel) => {}
        other => return other,
    }
    let failed = |source| CliError::identify("the simulation", source);
    let Some(first) = document.inputs.first() else {
        return Err(CliError::Usage { what: "a model without inputs has nothing to be simulated on".into() });
    };
    let mut inputs_only = document.clone();
    // A stand-in for every output, so that the data have the model's shape; its values are taken out again.
    inputs_only.outputs = vec![first.clone(); document.outputs.len()];
    let unchanged = MeetArguments { detrend: Detrend::None, ..arguments.clone() };
    let Loaded { data, sources, .. } = meet(&inputs_only, &unchanged, terminal)?;
    let unmeasured = |e: &Experiment| {
        let outputs = Mat::full(e.len(), document.outputs.len(), f64::NAN);
        Ok(Experiment { outputs, ..e.clone() })
    };
    let data = data.map_experiments(unmeasured).map_err(failed)?;
    let data = data.with_labels(document.inputs.clone(), document.outputs.clone()).map_err(failed)?;
    let levels = |lines: &[ident::Line]| lines.iter().map(|line| line.level).collect::<Vec<f64>>();
    let Some(trend) = document.trend.as_ref().filter(|_| arguments.detrend != Detrend::None) else {
        return Ok(Loaded { data, trend: None, sources });
    };
    let trend = Trend::offsets(&levels(trend.inputs(0)), &levels(trend.outputs(0))).map_err(failed)?;
    let data = trend.remove(&data).map_err(failed)?;
    Ok(Loaded { data, trend: Some(trend), sources })
}

/// A number of one to the right of the point, such as a confidence.
pub(super) fn checked_share(option: &str, share: f64) -> Result<f64, CliError> {
    if share > 0.0 && share < 1.0 {
        return Ok(share);
    }
    Err(CliError::Usage { what: format!("{option} {share}: give a share between 0 and 1") })
}
