//! `dynoid bode`, `step`, `poles`: what a model is like.

mod bode;
mod curves;
mod plane;
mod poles;
mod step;

pub(crate) use bode::bode;
pub(crate) use poles::poles;
pub(super) use poles::print_roots;
pub(crate) use step::step;

use ident::uncertainty::{Dynamics, Features};
use ident::{AnyModel, Fit, IdentError, LinearModel, ModelDocument};

use super::model_file;
use crate::cli::identify::ModelArguments;
use crate::error::CliError;

/// A model file with its name and, where it carries one, its estimate.
struct Model {
    name: String,
    document: ModelDocument,
    fit: Option<Fit<AnyModel>>,
}

fn models(arguments: &ModelArguments) -> Result<Vec<Model>, CliError> {
    model_file::checked_share("--level", arguments.level)?;
    let read = |path: &std::path::PathBuf| {
        let document = model_file::read(path)?;
        let fit = document.estimate.as_ref().map(|_| document.fit()).transpose();
        let fit = fit.map_err(|error| CliError::ModelFile { path: path.clone(), reason: error.to_string() })?;
        Ok(Model { name: model_file::name(path), document, fit })
    };
    arguments.models.iter().map(read).collect()
}

/// The models, each of which has to answer to an input.
fn driven_models(arguments: &ModelArguments) -> Result<Vec<Model>, CliError> {
    let models = models(arguments)?;
    match models.iter().find(|model| model.document.inputs.is_empty()) {
        None => Ok(models),
        Some(model) => Err(CliError::Usage {
            what: format!(
                "{}: the model has no inputs, and so no response to one; see its poles, or predict with it",
                model.name
            ),
        }),
    }
}

/// Every way from an input to an output of a model.
fn channels(model: &Model) -> impl Iterator<Item = (usize, usize)> + use<> {
    let (inputs, outputs) = (model.document.model.inputs(), model.document.model.outputs());
    (0..outputs).flat_map(move |output| (0..inputs).map(move |input| (output, input)))
}

fn channel_name(model: &Model, (output, input): (usize, usize)) -> String {
    format!("{} → {}", model.document.inputs[input].name, model.document.outputs[output].name)
}

fn failed(source: IdentError) -> CliError {
    CliError::identify("the response", source)
}

impl Model {
    /// What its way from an input to an output is summed up by.
    fn features(&self, output: usize, input: usize) -> Features<'_, AnyModel> {
        match &self.fit {
            Some(fit) => Features::of_fit(fit, output, input),
            None => Features::of_model(&self.document.model, output, input),
        }
    }

    /// `None` for a continuous model.
    fn sample_time_s(&self) -> Option<f64> {
        self.document.model.system().ok().and_then(|s| s.sample_time_s())
    }
}

/// The longest delay of a continuous model; a discrete one holds its delays as states.
fn longest_delay_s(model: &Model) -> Result<f64, IdentError> {
    let delays = channels(model).map(|(output, input)| model.document.model.delay_s(output, input));
    Ok(delays.collect::<Result<Vec<f64>, _>>()?.into_iter().fold(0.0, f64::max))
}
