//! How well a model simulates what repeats in the outputs, where the inputs repeat: noise between the lines that the
//! inputs excite says nothing about the dynamics, and lowers the fit of a perfect model.

use ident::prediction::Response;
use ident::validate::fit_percent;
use ident::{Dataset, Experiment};
use page::decimal::{digits, percent};
use signal::frf::repeated_response;

use crate::words::counted;
use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

/// A period this close to a whole number of samples is one.
const WHOLE: f64 = 1e-3;
/// A fit this far below what the noise allows misses most of what repeats, percent.
const MISSED: f64 = 30.0;
/// Shortest record in which periods are looked for, samples.
const FEWEST: usize = 9;

/// Judgement of a simulation by the mean over the periods of the inputs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RepeatedFacts {
    /// Name of the experiment.
    pub experiment: String,
    /// Length of a period, s.
    pub period_s: f64,
    /// Number of periods.
    pub periods: usize,
    /// Fit of each output, %.
    #[serde(deserialize_with = "nan_if_null")]
    pub fit_percent_simulated: Vec<f64>,
    /// Fit that a perfect model would reach, %.
    #[serde(deserialize_with = "nan_if_null")]
    pub fit_percent_attainable: Vec<f64>,
}

/// One experiment, by the mean over its periods.
pub(super) struct Repeated {
    experiment: String,
    period_s: f64,
    periods: usize,
    /// Of each output.
    fit_percent: Vec<f64>,
    /// Fit that a perfect model would reach with the noise left in the mean of each output.
    attainable_percent: Vec<f64>,
}

/// Of each experiment whose inputs repeat.
pub(super) fn repeated(data: &Dataset, simulated: &Response) -> Vec<Repeated> {
    data.experiments().iter().zip(&simulated.outputs).filter_map(|(e, modelled)| one(data, e, modelled)).collect()
}

fn one(data: &Dataset, experiment: &Experiment, modelled: &faer::Mat<f64>) -> Option<Repeated> {
    if data.inputs() == 0 || experiment.len() < FEWEST {
        return None;
    }
    let inputs: Vec<&[f64]> = (0..data.inputs()).map(|k| experiment.input(k)).collect();
    let outputs: Vec<&[f64]> = (0..data.outputs()).map(|k| experiment.output(k)).collect();
    let found = repeated_response(&inputs, &outputs, data.sample_time_s(), None).ok()??.repetition;
    let period = found.period_samples.round();
    if (found.period_samples - period).abs() > WHOLE {
        return None;
    }
    let mean = |x: &[f64]| {
        let mut sums = vec![0.0; period as usize];
        let used = x.iter().skip(found.first).take(found.periods * sums.len());
        used.enumerate().for_each(|(t, x)| sums[t % period as usize] += x / found.periods as f64);
        sums
    };
    let attainable = |y: &&[f64]| {
        let (mean, used) = (mean(y), found.periods * period as usize);
        let level = mean.iter().sum::<f64>() / period;
        let repeated: f64 = mean.iter().map(|m| (m - level).powi(2)).sum::<f64>() / period;
        let apart = y.iter().skip(found.first).take(used).enumerate();
        let noise: f64 = apart.map(|(t, y)| (y - mean[t % period as usize]).powi(2)).sum();
        // The noise between periods, and what of it is left in their mean.
        let left = noise / (used as f64 - period).max(1.0) / found.periods as f64;
        100.0 * (1.0 - (left / repeated).sqrt())
    };
    let fit = |(k, y): (usize, &&[f64])| fit_percent(&mean(y), &mean(modelled.col_as_slice(k))).unwrap_or(f64::NAN);
    Some(Repeated {
        experiment: experiment.name.clone(),
        period_s: period * data.sample_time_s(),
        periods: found.periods,
        fit_percent: outputs.iter().enumerate().map(fit).collect(),
        attainable_percent: outputs.iter().map(attainable).collect(),
    })
}

impl Repeated {
    /// In words; `is_one_of_several` experiments, it is named.
    pub(super) fn sentence(&self, outputs: &[ident::Label], is_one_of_several: bool) -> String {
        let experiment = if is_one_of_several { format!("{}: ", self.experiment) } else { String::new() };
        let fit = |(label, fit): (&ident::Label, &f64)| format!("{} {}", label.name, percent(*fit));
        let fits: Vec<String> = outputs.iter().zip(&self.fit_percent).map(fit).collect();
        format!(
            "{experiment}the inputs repeat every {} s; over the mean of {}, the simulated fit is {}",
            digits(self.period_s, 4),
            counted(self.periods, "period"),
            fits.join(", ")
        )
    }

    /// Returns true if the model explains most of what the noise lets show in the mean period of an output.
    pub(super) fn explains(&self, output: usize) -> bool {
        self.fit_percent[output] >= self.attainable_percent[output] - MISSED
    }

    /// Outputs of whose mean period the model misses most, in words.
    pub(super) fn doubts(&self, outputs: &[ident::Label]) -> Vec<String> {
        let all = outputs.iter().zip(self.fit_percent.iter().zip(&self.attainable_percent));
        let missed = all.filter(|(_, (fit, attainable))| **fit < **attainable - MISSED);
        let text = |(label, (fit, attainable)): (&ident::Label, (&f64, &f64))| {
            format!(
                "the model misses most of what repeats in {}: its fit over the mean period is {}, and the noise allows {}; noise \
                 beside the lines of the input governs the estimate: remove drift, or take `fit oe --band`",
                label.name,
                percent(*fit),
                percent(*attainable)
            )
        };
        missed.map(text).collect()
    }

    pub(super) fn facts(&self) -> RepeatedFacts {
        RepeatedFacts {
            experiment: self.experiment.clone(),
            period_s: self.period_s,
            periods: self.periods,
            fit_percent_simulated: self.fit_percent.clone(),
            fit_percent_attainable: self.attainable_percent.clone(),
        }
    }
}
