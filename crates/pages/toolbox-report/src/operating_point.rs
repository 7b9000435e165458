//! Comparison of the operating points of recordings and of a model.

use ident::prediction::Response;
use ident::{Dataset, Experiment, IdentError, ModelDocument, Trend, TrendScope, TrendShape};

/// Share of the squared errors that a straight line has to explain before it is said that levels differ.
const MOSTLY: f64 = 0.5;
/// Size of that line beside the variation of the output, below which it does not matter.
const MATTERS: f64 = 0.2;

/// Trend that was taken off recordings that a model meets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TakenOff {
    /// The trend of the model's own data.
    OfModel,
    /// The level or the trend of the recordings.
    Own,
    /// Nothing.
    Nothing,
}

/// Says where what a model misses is for the most part a level or a drift, which another operating point makes.
pub fn hint(document: &ModelDocument, data: &Dataset, response: &Response, taken_off: TakenOff) -> Option<String> {
    let remedy = match (taken_off, &document.trend) {
        (TakenOff::Own, Some(_)) | (TakenOff::Nothing, None) => return None,
        (TakenOff::Own, None) => {
            "nothing was subtracted from the model's own data; with --detrend model nothing is subtracted here either"
        }
        (TakenOff::Nothing, Some(_)) => {
            "the model is valid near the operating point of its data; --detrend model subtracts that point, --detrend mean subtracts the mean of each recording"
        }
        (TakenOff::OfModel, Some(_)) => {
            "the recording has another operating point than the data of the model; --detrend mean judges the dynamics alone"
        }
        (TakenOff::OfModel, None) => {
            "nothing was subtracted from the data of the model, nor here; --detrend mean judges the dynamics alone"
        }
    };
    let names: Vec<String> = beside(data, response).ok()?.into_iter().map(|name| format!("\"{name}\"")).collect();
    let names = names.join(", ");
    (!names.is_empty()).then(|| format!("most of the residual of {names} is an offset or a drift: {remedy}"))
}

/// Outputs of the data of an estimate whose simulation is off by a constant or a drift, where no level was estimated.
pub(crate) fn without_level(data: &Dataset, response: &Response) -> Vec<String> {
    beside(data, response).unwrap_or_default()
}

/// Outputs whose errors are mostly a straight line in one of the recordings, and one that matters.
fn beside(data: &Dataset, response: &Response) -> Result<Vec<String>, IdentError> {
    let mut responses = response.outputs.iter();
    let errors = data.map_experiments(|e| {
        let outputs = responses.next().map_or_else(|| e.outputs.clone(), |modelled| &e.outputs - modelled);
        Ok(Experiment { outputs, ..e.clone() })
    })?;
    let without = |data: &Dataset, shape| Trend::estimate(data, shape, TrendScope::PerExperiment)?.remove(data);
    let (left, varied) = (without(&errors, TrendShape::Line)?, without(data, TrendShape::Mean)?);
    let is_beside = |(output, n): (usize, usize)| {
        let [errors, left, varied] = [&errors, &left, &varied].map(|d| squares(d.experiments()[n].output(output)));
        let line = errors - left;
        line > MOSTLY * errors && line > MATTERS * MATTERS * varied
    };
    let experiments = data.experiments().len();
    let outputs = data.output_labels().iter().enumerate();
    let found = outputs.filter(|(output, _)| (0..experiments).any(|n| is_beside((*output, n))));
    Ok(found.map(|(_, label)| label.name.clone()).collect())
}

/// The sum of squares of what is known.
fn squares(values: &[f64]) -> f64 {
    values.iter().filter(|v| !v.is_nan()).map(|v| v * v).sum()
}
