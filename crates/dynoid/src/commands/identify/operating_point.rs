//! Where a model rests, and whether the recordings that it meets rest there too.

use ident::prediction::Response;
use ident::{Dataset, Experiment, IdentError, Line, ModelDocument, Source, Trend, TrendScope, TrendShape};

use super::data;
use crate::cli::identify::{Detrend, MeetDetrend};

/// Share of the squared errors that a straight line has to explain before it is said that levels differ.
const MOSTLY: f64 = 0.5;
/// Size of that line beside the variation of the output, below which it does not matter.
const MATTERS: f64 = 0.2;

/// What is taken off recordings that a model meets.
pub(super) fn trend(
    document: &ModelDocument,
    detrend: MeetDetrend,
    data: &Dataset,
    sources: &[Source],
) -> Result<Option<Trend>, IdentError> {
    match detrend {
        MeetDetrend::Model => of_model(document, sources),
        MeetDetrend::Mean => data::trend(data, Detrend::Mean),
        MeetDetrend::Line => data::trend(data, Detrend::Line),
        MeetDetrend::None => Ok(None),
    }
}

fn of_model(document: &ModelDocument, sources: &[Source]) -> Result<Option<Trend>, IdentError> {
    let own = document.estimate.as_ref().map_or(&[][..], |estimate| &estimate.sources);
    of_data(document.trend.as_ref(), own, sources)
}

/// What was taken off a model's own data: of a recording among them its own lines, of any other the mean of their levels.
pub(super) fn of_data(trend: Option<&Trend>, own: &[Source], sources: &[Source]) -> Result<Option<Trend>, IdentError> {
    let Some(trend) = trend else { return Ok(None) };
    let known = |source: &Source| own.iter().position(|own| own.sha256 == source.sha256);
    let lines = |of: &dyn Fn(usize) -> Vec<Line>| {
        let rest = mean_levels(&(0..trend.count()).map(of).collect::<Vec<_>>());
        sources.iter().map(|source| known(source).map_or_else(|| rest.clone(), of)).collect()
    };
    let inputs = lines(&|n| trend.inputs(n).to_vec());
    Trend::per_experiment(inputs, lines(&|n| trend.outputs(n).to_vec())).map(Some)
}

/// The mean level of each channel over several recordings.
fn mean_levels(all: &[Vec<Line>]) -> Vec<Line> {
    let channels = all.first().map_or(0, Vec::len);
    let mean = |k: usize| all.iter().map(|lines| lines[k].level).sum::<f64>() / all.len() as f64;
    (0..channels).map(|k| Line::level(mean(k))).collect()
}

/// Says where what a model misses is for the most part a level or a drift, which another operating point makes.
pub(super) fn hint(
    document: &ModelDocument,
    data: &Dataset,
    response: &Response,
    detrend: MeetDetrend,
) -> Option<String> {
    let remedy = match (detrend, &document.trend) {
        (MeetDetrend::Mean | MeetDetrend::Line, Some(_)) | (MeetDetrend::None, None) => return None,
        (MeetDetrend::Mean | MeetDetrend::Line, None) => {
            "nothing was taken off the model's own data; with --detrend model nothing is taken off here either"
        }
        (MeetDetrend::None, Some(_)) => {
            "the model holds about the operating point of its data; --detrend model takes that off, --detrend mean the level of each recording"
        }
        (MeetDetrend::Model, Some(_)) => {
            "the recording rests elsewhere than the data of the model did; --detrend mean judges the dynamics alone"
        }
        (MeetDetrend::Model, None) => {
            "nothing was taken off the data of the model, nor is anything here; --detrend mean judges the dynamics alone"
        }
    };
    let names: Vec<String> = beside(data, response).ok()?.into_iter().map(|name| format!("\"{name}\"")).collect();
    let names = names.join(", ");
    (!names.is_empty()).then(|| format!("most of what the model misses of {names} is a level or a drift: {remedy}"))
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
