//! The part of long data from which a delay is found.

use ident::{Dataset, Experiment, IdentError};

/// Samples of the parts of long data that are looked at first, the shortest first. Instants are trusted to a part of a
/// sample, so that as a rule more data make no shorter interval.
pub(super) const PARTS: [usize; 2] = [25_000, 100_000];

/// The stretch of the longest experiment, of so many samples, in which the inputs vary most; none of data that are
/// hardly longer.
pub(super) fn liveliest(data: &Dataset, samples: usize) -> Result<Option<Dataset>, IdentError> {
    let all = data.experiments().iter().enumerate();
    let Some((longest, experiment)) = all.max_by_key(|(_, e)| e.len()).filter(|(_, e)| e.len() > 2 * samples) else {
        return Ok(None);
    };
    let firsts = (0..=experiment.len() - samples).step_by(samples / 2);
    let wholes: Vec<f64> = (0..data.inputs()).map(|k| variance(experiment.input(k))).collect();
    let liveliness = |first: &usize| {
        let part =
            |k: usize| variance(&experiment.input(k)[*first..first + samples]) / wholes[k].max(f64::MIN_POSITIVE);
        (0..data.inputs()).map(part).sum::<f64>()
    };
    let first = firsts.max_by(|a, b| liveliness(a).total_cmp(&liveliness(b))).unwrap_or(0);
    let part = |e: &Experiment| {
        let cut = |m: &faer::Mat<f64>| m.subrows(first, samples).to_owned();
        let start_s = e.start_s + first as f64 * data.sample_time_s();
        Ok(Experiment { name: e.name.clone(), start_s, inputs: cut(&e.inputs), outputs: cut(&e.outputs) })
    };
    data.only_experiments(&[longest])?.map_experiments(part).map(Some)
}

fn variance(x: &[f64]) -> f64 {
    let known = || x.iter().filter(|v| !v.is_nan());
    let count = known().count().max(1) as f64;
    let mean = known().sum::<f64>() / count;
    known().map(|v| (v - mean).powi(2)).sum::<f64>() / count
}
