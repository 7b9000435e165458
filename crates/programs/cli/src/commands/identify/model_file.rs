//! Model files, and the recordings that models meet.

use std::path::Path;

use bench_model::analysis;
use dataset::{CommonClock, DatasetError};
use dynoid::linear::{DataOptions, Gaps, Loaded, RecordedFiles, operating_point};
use dynoid::{Error, Files, Model, model_name};
use faer::Mat;
use ident::uncertainty::Dynamics;
use ident::{Experiment, ModelDocument};
use toolbox_report::data::Purpose;
use toolbox_report::models::LoopMargins;
use units::may_be_same;

use crate::cli::identify::{MeetArguments, MeetDetrend};
use crate::error::CliError;

/// A linear model with its name.
pub(super) struct NamedModel {
    pub(super) name: String,
    pub(super) document: ModelDocument,
    /// Which loop its margins are of.
    pub(super) margins: LoopMargins,
}

/// Reads a model file, or a bench model as linear models. A bench model has the margins of its speed loop, which is
/// closed in it.
pub(super) fn read_all(path: &Path, files: &Files) -> Result<Vec<NamedModel>, CliError> {
    let name = model_name(path);
    let bench = match files.model(path)? {
        Model::Linear(document) => {
            return Ok(vec![NamedModel { name, document: *document, margins: LoopMargins::OfModel }]);
        }
        Model::Bench(bench) => bench,
    };
    let speed_loop = analysis::margins(&bench.model).map_or(LoopMargins::None, |found| LoopMargins::Within {
        gain_db: found.gain_margin_db,
        phase_deg: found.phase_margin_deg,
        crossover_hz: found.crossover_hz,
    });
    let models = export::toolbox_models(&bench).map_err(|source| Error::Export { path: path.to_owned(), source })?;
    let named = |(mode, document): (&str, ModelDocument)| NamedModel {
        name: format!("{name} {mode}"),
        margins: if document.inputs.iter().any(|input| input.name == "N_d*") { speed_loop } else { LoopMargins::None },
        document,
    };
    Ok(models.into_iter().map(named).collect())
}

/// The names of all channels of models, each once.
pub(super) fn channels(documents: &[ModelDocument]) -> Vec<&str> {
    let labels = documents.iter().flat_map(|document| document.inputs.iter().chain(&document.outputs));
    let mut names: Vec<&str> = labels.map(|label| label.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// The time from row to row of text without a time column: that of the model unless another is given.
pub(super) fn row_time_s(document: &ModelDocument, arguments: &MeetArguments) -> f64 {
    arguments.sample_time_s.unwrap_or(document.sample_time_s)
}

/// The model's channels out of recordings, on the model's clock or, for a continuous model, on the one given; cut where
/// inputs are missing.
pub(super) fn meet(
    document: &ModelDocument,
    files: &RecordedFiles,
    arguments: &MeetArguments,
) -> Result<Loaded, CliError> {
    let names = |labels: &[ident::Label]| labels.iter().map(|label| label.name.clone()).collect();
    let options = DataOptions {
        recordings: arguments.on.clone(),
        inputs: names(&document.inputs),
        outputs: names(&document.outputs),
        from_s: arguments.window.from_s,
        to_s: arguments.window.to_s,
        sample_time_s: Some(clock_s(document, files, arguments)?),
        detrend: None,
        between: Some(document.intersample),
    };
    let about = |data: &_, sources: &_| operating_point::trend(document, arguments.detrend.off(), data, sources);
    let loaded = Loaded::take_about(files, CommonClock::Slowest, &options, Purpose::Judgement, about)?;
    check_units(document, &loaded)?;
    Ok(loaded.cut_at(Gaps::OfInputs)?)
}

/// Refuses channels in another unit than the model's.
fn check_units(document: &ModelDocument, loaded: &Loaded) -> Result<(), CliError> {
    let found = loaded.data.input_labels().iter().chain(loaded.data.output_labels());
    let mut pairs = document.inputs.iter().chain(&document.outputs).zip(found);
    match pairs.find(|(expected, found)| !may_be_same(&expected.unit, &found.unit)) {
        None => Ok(()),
        Some((expected, found)) => Err(CliError::UnitOfModel {
            data: loaded.sources.iter().map(|s| s.file.as_str()).collect::<Vec<_>>().join(", "),
            channel: found.name.clone(),
            found: found.unit.clone(),
            expected: expected.unit.clone(),
        }),
    }
}

/// The clock of the data that a model meets.
fn clock_s(document: &ModelDocument, files: &RecordedFiles, arguments: &MeetArguments) -> Result<f64, CliError> {
    let own_s = document.sample_time_s;
    let is_discrete = document.model.system().is_ok_and(|system| system.sample_time_s().is_some());
    match arguments.sample_time_s {
        Some(given_s) if !is_discrete => Ok(given_s),
        // With text of another time from row to row, the data are brought onto the model's clock.
        Some(given_s) if given_s != own_s && !files.are_untimed() => Err(CliError::Usage {
            what: format!(
                "--sample-time {given_s}: the model is discrete, with a sample every {own_s} s, and keeps to that; leave the option out, or convert the model"
            ),
        }),
        _ => Ok(own_s),
    }
}

/// As [`meet`], but recordings without the outputs will do: a simulation needs the inputs alone. Unmeasured outputs are
/// missing throughout.
pub(super) fn meet_inputs(
    document: &ModelDocument,
    files: &RecordedFiles,
    arguments: &MeetArguments,
) -> Result<Loaded, CliError> {
    let is_output = |name: &str| document.outputs.iter().any(|label| label.name == name);
    let missing = match meet(document, files, arguments) {
        Err(CliError::Door { source: Error::Dataset { source: DatasetError::NoChannel { channel, .. } } })
            if is_output(&channel) =>
        {
            channel
        }
        other => return other,
    };
    let failed = |source| CliError::identify("the simulation", source);
    let Some(first) = document.inputs.first() else {
        return Err(CliError::Usage { what: "a model without inputs has nothing to be simulated on".into() });
    };
    if matches!(arguments.detrend, MeetDetrend::Mean | MeetDetrend::Line) {
        let what = format!(
            "--detrend takes off what the outputs show, and \"{missing}\" is not in the recording; leave the option out, and the operating point of the model is taken"
        );
        return Err(CliError::Usage { what });
    }
    let mut inputs_only = document.clone();
    // A stand-in for every output, so that the data have the model's shape; its values are taken out again.
    inputs_only.outputs = vec![first.clone(); document.outputs.len()];
    let loaded = meet(&inputs_only, files, arguments)?;
    let unmeasured = |e: &Experiment| {
        let outputs = Mat::full(e.len(), document.outputs.len(), f64::NAN);
        Ok(Experiment { outputs, ..e.clone() })
    };
    let data = loaded.data.map_experiments(unmeasured).map_err(failed)?;
    let data = data.with_labels(document.inputs.clone(), document.outputs.clone()).map_err(failed)?;
    Ok(Loaded { data, ..loaded })
}
