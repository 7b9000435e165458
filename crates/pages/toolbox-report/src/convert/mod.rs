//! A model in another form.

mod clock;
mod error;
mod ratio;
mod system;

use ident::{IdentError, Label, LinearModel, ModelDocument};
use lti::{TransferFunction, ZeroPoleGain};
use page::{Blocks, Figure, Page};
use serde::{Deserialize, Serialize};

use crate::level::LEVEL;
use crate::models::{Model, bode};
use ratio::{ratio_model, ratios};
use system::{System, system};

pub use clock::{Conversion, Form};
pub use error::ConvertError;

/// A model in its new form, and as it was.
pub struct Converted {
    source: ModelDocument,
    form: Form,
    content: Content,
}

/// Zeros, poles and gain of the way from an input to an output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ZeroPoleGainFacts {
    /// Names of the input and of the output.
    pub channel: String,
    /// Zeros, poles and gain.
    pub zpk: ZeroPoleGain,
}

enum Content {
    System(Box<System>),
    /// Every way, output by output and in each from the first input on.
    Ratios(Vec<TransferFunction>),
}

/// Converts a model.
///
/// # Errors
/// Where it has no such form.
pub fn convert(source: ModelDocument, asked: &Conversion) -> Result<Converted, ConvertError> {
    let source = from_noise(source, asked)?;
    let content = match asked.form {
        Form::StateSpace => Content::System(Box::new(system(&source, asked)?)),
        Form::Ratio | Form::ZerosAndPoles => Content::Ratios(ratios(&source, asked)?),
    };
    Ok(Converted { source, form: asked.form, content })
}

/// A time series has no way but the one from its noise, which a state space on its own clock holds anyway.
fn from_noise(source: ModelDocument, asked: &Conversion) -> Result<ModelDocument, ConvertError> {
    if !source.inputs.is_empty() || (asked.form == Form::StateSpace && asked.keeps_clock()) {
        return Ok(source);
    }
    source.of_noise()?.ok_or(ConvertError::WhiteNoise)
}

/// The names of the ways through a model, in the order of its ratios.
fn names(document: &ModelDocument) -> Vec<String> {
    let of = |output: &Label| {
        let output = output.name.clone();
        document.inputs.iter().map(move |input| format!("{} → {output}", input.name))
    };
    document.outputs.iter().flat_map(of).collect()
}

impl Converted {
    /// The model as a file holds it. Its noise is that of the source, white on the outputs unless the form keeps the
    /// noise model; an estimate it has none.
    ///
    /// # Errors
    /// Where no kind of model has this form.
    pub fn document(&self) -> Result<ModelDocument, ConvertError> {
        let source = &self.source;
        let model = match &self.content {
            Content::System(system) => system.model(source)?,
            Content::Ratios(all) => ratio_model(all, source)?,
        };
        let sample_time_s = self.sample_time_s().unwrap_or(source.sample_time_s);
        let mut document = ModelDocument::new(model, source.inputs.clone(), source.outputs.clone(), sample_time_s);
        (document.intersample, document.trend) = (source.intersample, source.trend.clone());
        Ok(document)
    }

    /// Parts of the model that its new form does not hold.
    ///
    /// # Errors
    /// Where a model has no innovations form.
    pub fn lost(&self, converted: &ModelDocument) -> Result<Option<&'static str>, IdentError> {
        lost_between(&self.source, converted)
    }

    fn sample_time_s(&self) -> Option<f64> {
        match &self.content {
            Content::System(system) => system.system.sample_time_s(),
            Content::Ratios(all) => all.first().and_then(TransferFunction::sample_time_s),
        }
    }

    /// Zeros, poles and gain of every way, in numbers.
    ///
    /// # Errors
    /// Where the roots cannot be computed.
    pub fn zeros_and_poles(&self) -> Result<Vec<ZeroPoleGainFacts>, ConvertError> {
        let Content::Ratios(all) = &self.content else { return Ok(Vec::new()) };
        let of =
            |(channel, h): (String, &TransferFunction)| Ok(ZeroPoleGainFacts { channel, zpk: h.to_zero_pole_gain()? });
        names(&self.source).into_iter().zip(all).map(of).collect()
    }

    /// The new form in words and tables, without [`Converted::figures`].
    ///
    /// # Errors
    /// Where the roots cannot be computed.
    pub fn page(&self, title: &str) -> Result<Page, ConvertError> {
        let mut all = Blocks::default();
        match &self.content {
            Content::System(system) => all.push(system.blocks(&self.source)),
            Content::Ratios(ratios) => {
                for (name, h) in names(&self.source).iter().zip(ratios) {
                    all.push(Vec::from(ratio::blocks(name, h, self.form)?));
                }
            }
        }
        Ok(Page::new(title, all.into_vec()))
    }

    /// Both forms over frequency.
    ///
    /// # Errors
    /// Where one of them has no frequency response.
    pub fn figures(&self) -> Result<Vec<Figure>, ConvertError> {
        let model = |name: &str, document| Model::new(name.to_owned(), document);
        let both = vec![model("as it was", self.source.clone())?, model("converted", self.document()?)?];
        Ok(bode(both, LEVEL)?.figures())
    }
}

/// Parts of a model that its new form does not hold.
fn lost_between(source: &ModelDocument, converted: &ModelDocument) -> Result<Option<&'static str>, IdentError> {
    let models_noise = |document: &ModelDocument| -> Result<bool, IdentError> {
        let form = document.model.innovations(document.sample_time_s, document.intersample)?;
        Ok(form.k().norm_max() > 0.0)
    };
    let loses_noise = models_noise(source)? && !models_noise(converted)?;
    Ok(match (loses_noise, source.estimate.is_some()) {
        (true, true) => Some(
            "the noise model and the covariance of the estimate are left out: the noise model is kept by --to ss on the model's own clock alone, a covariance by no other form",
        ),
        (true, false) => Some("the noise model is left out: it is kept by --to ss on the model's own clock alone"),
        (false, true) => {
            Some("the covariance of the estimate is left out: it belongs to the parameters of the old form")
        }
        (false, false) => None,
    })
}
