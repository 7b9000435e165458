//! Where a model rests: what is taken off the recordings that it meets.

use ident::{Dataset, IdentError, Line, ModelDocument, Source, Trend, TrendShape};
use toolbox_report::operating_point::TakenOff;

use super::data;
use crate::cli::identify::MeetDetrend;

/// What is taken off recordings that a model meets.
pub(super) fn trend(
    document: &ModelDocument,
    detrend: MeetDetrend,
    data: &Dataset,
    sources: &[Source],
) -> Result<Option<Trend>, IdentError> {
    match detrend {
        MeetDetrend::Model => of_model(document, sources),
        MeetDetrend::Mean => data::trend(data, Some(TrendShape::Mean)),
        MeetDetrend::Line => data::trend(data, Some(TrendShape::Line)),
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

/// What was taken off, of which [`toolbox_report::operating_point::hint`] speaks.
pub(super) fn taken_off(detrend: MeetDetrend) -> TakenOff {
    match detrend {
        MeetDetrend::Model => TakenOff::OfModel,
        MeetDetrend::Mean | MeetDetrend::Line => TakenOff::Own,
        MeetDetrend::None => TakenOff::Nothing,
    }
}
