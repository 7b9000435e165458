//! `dynoid model bode`, `step`, `poles`: what a model is like.

mod bode;
mod curves;
mod plane;
mod poles;
mod step;

pub(crate) use bode::bode;
pub(super) use bode::bode_figures;
pub(crate) use poles::poles;
pub(super) use poles::print_roots;
pub(crate) use step::step;

use ident::uncertainty::{Dynamics, Features};
use ident::{AnyModel, Fit, IdentError, LinearModel, ModelDocument};

use lti::Mode;

use super::model_file;
use crate::cli::identify::ModelArguments;
use crate::error::CliError;

/// A model file with its name and, where it carries one, its estimate.
struct Model {
    name: String,
    document: ModelDocument,
    fit: Option<Fit<AnyModel>>,
    /// Whether its inputs are its own noise.
    is_noise: bool,
}

/// The models, and with `noise` each as its noise sees it too; of a time series that is all there is.
fn models(arguments: &ModelArguments) -> Result<Vec<Model>, CliError> {
    let mut all = Vec::new();
    for path in &arguments.models {
        let wrong = |error: IdentError| CliError::ModelFile { path: path.clone(), reason: error.to_string() };
        let (document, name) = (model_file::read(path)?, model_file::name(path));
        let noise = document.of_noise().map_err(wrong)?.filter(|_| arguments.noise || document.inputs.is_empty());
        if !document.inputs.is_empty() {
            all.push(Model::new(name.clone(), document, false).map_err(wrong)?);
        }
        all.extend(noise.map(|document| Model::new(name, document, true)).transpose().map_err(wrong)?);
    }
    Ok(all)
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
    fn new(name: String, document: ModelDocument, is_noise: bool) -> Result<Self, IdentError> {
        let fit = document.estimate.as_ref().map(|_| document.fit()).transpose()?;
        Ok(Model { name, document, fit, is_noise })
    }

    /// What it is called beside others.
    fn title(&self) -> String {
        if self.is_noise { format!("{}, noise", self.name) } else { self.name.clone() }
    }

    /// What its way from an input to an output is summed up by.
    fn features(&self, output: usize, input: usize) -> Features<'_, AnyModel> {
        match &self.fit {
            Some(fit) => Features::of_fit(fit, output, input),
            None => Features::of_model(&self.document.model, output, input),
        }
    }

    /// The mode with which it runs away; none of a stable model, nor of one that integrates.
    fn growing_mode(&self) -> Result<Option<Mode>, IdentError> {
        Ok(self.document.model.system()?.growing_mode()?)
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
