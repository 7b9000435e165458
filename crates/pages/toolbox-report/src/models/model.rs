//! A model to be looked at.

use ident::uncertainty::{Dynamics, Features};
use ident::{AnyModel, Fit, IdentError, LinearModel, ModelDocument};
use lti::Mode;

/// A model with its name and, where it carries one, its estimate.
pub struct Model {
    pub(super) name: String,
    pub(super) document: ModelDocument,
    pub(super) fit: Option<Fit<AnyModel>>,
    /// True if its inputs are its own noise.
    pub(super) is_noise: bool,
    /// Which loop its stability margins are of.
    pub(super) margins: LoopMargins,
}

/// Which loop the stability margins of a model are of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoopMargins {
    /// The one that the model itself closes with a unit feedback.
    OfModel,
    /// One within the model, which is closed in it.
    Within {
        /// By how much the gain of the opened loop may grow, dB.
        gain_db: f64,
        /// Phase margin of the opened loop, degrees.
        phase_deg: f64,
        /// Where the gain of the opened loop is one, Hz.
        crossover_hz: f64,
    },
    /// There is no loop whose margins mean anything.
    None,
}

/// Every way from an input to an output of a model.
pub(super) fn channels(model: &Model) -> impl Iterator<Item = (usize, usize)> + use<> {
    let (inputs, outputs) = (model.document.model.inputs(), model.document.model.outputs());
    (0..outputs).flat_map(move |output| (0..inputs).map(move |input| (output, input)))
}

pub(super) fn channel_name(model: &Model, output: usize, input: usize) -> String {
    format!("{} → {}", model.document.inputs[input].name, model.document.outputs[output].name)
}

impl Model {
    /// A model as its inputs see it.
    ///
    /// # Errors
    /// Where the document holds an estimate that does not belong to its model.
    pub fn new(name: String, document: ModelDocument) -> Result<Self, IdentError> {
        let fit = document.estimate.as_ref().map(|_| document.fit()).transpose()?;
        Ok(Model { name, document, fit, is_noise: false, margins: LoopMargins::OfModel })
    }

    /// A model as its inputs see it, and with `noise` as its noise does too; of a time series that is all there is.
    ///
    /// # Errors
    /// As for [`Model::new`].
    pub fn with_noise(name: &str, document: ModelDocument, noise: bool) -> Result<Vec<Self>, IdentError> {
        let of_noise = document.of_noise()?.filter(|_| noise || document.inputs.is_empty());
        let whole = (!document.inputs.is_empty()).then(|| Model::new(name.to_owned(), document)).transpose()?;
        let of_noise = of_noise.map(|document| Model::new(name.to_owned(), document)).transpose()?;
        let of_noise = of_noise.map(|model| Model { is_noise: true, ..model });
        Ok(whole.into_iter().chain(of_noise).collect())
    }

    /// The same model, with margins of this loop.
    #[must_use]
    pub fn with_margins(self, margins: LoopMargins) -> Self {
        Model { margins, ..self }
    }

    /// Name of the model beside others.
    pub(super) fn title(&self) -> String {
        if self.is_noise { format!("{}, noise", self.name) } else { self.name.clone() }
    }

    /// Features of its way from an input to an output.
    pub(super) fn features(&self, output: usize, input: usize) -> Features<'_, AnyModel> {
        match &self.fit {
            Some(fit) => Features::of_fit(fit, output, input),
            None => Features::of_model(&self.document.model, output, input),
        }
    }

    /// The mode with which it runs away; none of a stable model, nor of one that integrates.
    pub(super) fn growing_mode(&self) -> Result<Option<Mode>, IdentError> {
        Ok(self.document.model.system()?.growing_mode()?)
    }

    /// `None` for a continuous model.
    pub(super) fn sample_time_s(&self) -> Option<f64> {
        self.document.model.system().ok().and_then(|s| s.sample_time_s())
    }
}

/// The longest delay of a continuous model; a discrete one holds its delays as states.
pub(super) fn longest_delay_s(model: &Model) -> Result<f64, IdentError> {
    let delays = channels(model).map(|(output, input)| model.document.model.delay_s(output, input));
    Ok(delays.collect::<Result<Vec<f64>, _>>()?.into_iter().fold(0.0, f64::max))
}
