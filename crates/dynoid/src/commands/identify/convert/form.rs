//! A model in its new form, whichever it is.

use faer::Mat;
use ident::{Label, LinearModel, ModelDocument};
use lti::{LtiError, TransferFunction};

use super::failed;
use super::ratio::{print_ratio, ratio_model};
use super::system::System;
use crate::cli::identify::Representation;
use crate::error::CliError;
use crate::terminal::Terminal;

/// A model in its new form.
pub(super) enum Converted {
    System(Box<System>),
    /// Every way, output by output and in each from the first input on.
    Ratios(Vec<TransferFunction>),
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
    pub(super) fn document(&self, source: &ModelDocument) -> Result<ModelDocument, CliError> {
        let model = match self {
            Converted::System(system) => system.model(source)?,
            Converted::Ratios(all) => ratio_model(all, source).map_err(failed)?,
        };
        let sample_time_s = self.sample_time_s().unwrap_or(source.sample_time_s);
        let mut document = ModelDocument::new(model, source.inputs.clone(), source.outputs.clone(), sample_time_s);
        (document.intersample, document.trend) = (source.intersample, source.trend.clone());
        Ok(document)
    }

    fn sample_time_s(&self) -> Option<f64> {
        match self {
            Converted::System(system) => system.system.sample_time_s(),
            Converted::Ratios(all) => all.first().and_then(TransferFunction::sample_time_s),
        }
    }

    pub(super) fn zeros_and_poles(&self, source: &ModelDocument) -> Result<Vec<serde_json::Value>, CliError> {
        let Converted::Ratios(all) = self else { return Ok(Vec::new()) };
        let value = |(name, h): (String, &TransferFunction)| {
            Ok(serde_json::json!({"channel": name, "zpk": h.to_zero_pole_gain().map_err(failed)?}))
        };
        names(source).into_iter().zip(all).map(value).collect()
    }

    pub(super) fn print(
        &self,
        source: &ModelDocument,
        to: Representation,
        terminal: &mut Terminal,
    ) -> Result<(), CliError> {
        match self {
            Converted::System(system) => system.print(source, terminal),
            Converted::Ratios(all) => {
                for (name, h) in names(source).iter().zip(all) {
                    print_ratio(name, h, to, terminal)?;
                }
            }
        }
        Ok(())
    }
}

pub(super) fn clock_words(sample_time_s: Option<f64>) -> String {
    sample_time_s.map_or("continuous".to_owned(), |t| format!("every {t} s"))
}

/// The covariance of the source's innovations.
pub(super) fn noise_covariance(source: &ModelDocument) -> Result<Mat<f64>, LtiError> {
    Ok(source.model.innovations(source.sample_time_s, source.intersample)?.noise_covariance().to_owned())
}
