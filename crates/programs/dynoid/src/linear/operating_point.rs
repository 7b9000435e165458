//! Where a model rests: what is taken off the recordings that it meets.

use faer::Mat;
use ident::{AnyModel, Dataset, Experiment, Fit, IdentError, Line, ModelDocument, Source, Trend, TrendShape};
use toolbox_report::operating_point::TakenOff;

use super::data;
use super::loaded::Loaded;
use crate::error::Error;

/// Levels that are taken off recordings which a model meets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeetingTrend {
    /// The operating point of the model.
    Model,
    /// The recordings' own mean or line.
    Own(TrendShape),
    /// Nothing.
    Nothing,
}

/// Trend that is taken off recordings that a model meets.
///
/// # Errors
/// Data without samples.
pub fn trend(
    document: &ModelDocument,
    off: MeetingTrend,
    data: &Dataset,
    sources: &[Source],
) -> Result<Option<Trend>, IdentError> {
    match off {
        MeetingTrend::Model => of_model(document, sources),
        MeetingTrend::Own(shape) => data::trend(data, Some(shape)),
        MeetingTrend::Nothing => Ok(None),
    }
}

fn of_model(document: &ModelDocument, sources: &[Source]) -> Result<Option<Trend>, IdentError> {
    let own = document.estimate.as_ref().map_or(&[][..], |estimate| &estimate.sources);
    of_data(document.trend.as_ref(), own, sources)
}

/// Trend that was taken off a model's own data: of a recording among them its own lines, of any other the mean of their
/// levels.
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

/// Levels taken off, of which [`toolbox_report::operating_point::hint`] speaks.
pub fn taken_off(off: MeetingTrend) -> TakenOff {
    match off {
        MeetingTrend::Model => TakenOff::OfModel,
        MeetingTrend::Own(_) => TakenOff::Own,
        MeetingTrend::Nothing => TakenOff::Nothing,
    }
}

/// Data less the levels that were estimated with a model, which become part of its operating point: of the estimation
/// data, and of others those of the same recording, or the mean of all.
pub(super) fn with_levels(
    fit: &Fit<AnyModel>,
    estimation: Loaded,
    unseen: Option<Loaded>,
) -> Result<(Loaded, Option<Loaded>), Error> {
    if fit.levels.is_empty() {
        return Ok((estimation, unseen));
    }
    let failed = |source| Error::identify("the level of the outputs", source);
    let levels: Vec<Vec<f64>> = (0..estimation.sources.len()).map(|n| level_of(n, fit, &estimation)).collect();
    let own = estimation.sources.clone();
    let data = fit.without_levels(&estimation.data).map_err(failed)?;
    let trend = raised(estimation.trend.as_ref(), &levels, data.inputs()).map_err(failed)?;
    let estimation = Loaded { data, trend: Some(trend), ..estimation };
    let Some(unseen) = unseen else { return Ok((estimation, None)) };
    let outputs = estimation.data.outputs();
    let mean = (0..outputs).map(|i| levels.iter().map(|of| of[i]).sum::<f64>() / levels.len() as f64);
    let mean: Vec<f64> = mean.collect();
    let known = |source: &Source| own.iter().position(|own| own.sha256 == source.sha256);
    let of = |source: &Source| known(source).map_or_else(|| mean.clone(), |n| levels[n].clone());
    let levels: Vec<Vec<f64>> = unseen.sources.iter().map(of).collect();
    let mut places = unseen.recording.iter();
    let data = unseen.data.map_experiments(|e| {
        let level = places.next().map_or(&mean, |n| &levels[*n]);
        let outputs = Mat::from_fn(e.len(), level.len(), |t, i| e.outputs[(t, i)] - level[i]);
        Ok(Experiment { outputs, ..e.clone() })
    });
    let data = data.map_err(failed)?;
    let trend = raised(unseen.trend.as_ref(), &levels, data.inputs()).map_err(failed)?;
    Ok((estimation, Some(Loaded { data, trend: Some(trend), ..unseen })))
}

/// The level of each output in a recording: the mean over its parts, by their lengths.
fn level_of(recording: usize, fit: &Fit<AnyModel>, data: &Loaded) -> Vec<f64> {
    let parts = || {
        let all = data.recording.iter().zip(data.data.experiments()).zip(&fit.levels);
        all.filter(|((of, _), _)| **of == recording).map(|((_, experiment), level)| (experiment.len() as f64, level))
    };
    let whole: f64 = parts().map(|(length, _)| length).sum();
    let mean = |i: usize| parts().map(|(length, level)| length * level[i]).sum::<f64>() / whole.max(1.0);
    (0..data.data.outputs()).map(mean).collect()
}

/// Trend that was taken off, with these levels of the outputs besides, one list a recording.
///
/// # Errors
/// None for a trend of the same channels.
pub fn raised(trend: Option<&Trend>, levels: &[Vec<f64>], inputs: usize) -> Result<Trend, IdentError> {
    let rest = vec![Line::level(0.0); inputs];
    let of_inputs = |n: usize| trend.map_or_else(|| rest.clone(), |trend| trend.inputs(n).to_vec());
    let of_outputs = |(n, levels): (usize, &Vec<f64>)| {
        let line = |(i, level): (usize, &f64)| {
            let before = trend.and_then(|trend| trend.outputs(n).get(i).copied()).unwrap_or(Line::level(0.0));
            Line { level: before.level + level, ..before }
        };
        levels.iter().enumerate().map(line).collect()
    };
    let outputs = levels.iter().enumerate().map(of_outputs).collect();
    Trend::per_experiment((0..levels.len()).map(of_inputs).collect(), outputs)
}
