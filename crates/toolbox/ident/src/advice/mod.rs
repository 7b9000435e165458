//! [`advise`]: what to know about data before a model is estimated from them.

mod dynamics;
pub(crate) mod feedback;

use std::fmt;

use signal::frf::{RepeatedResponse, repeated_response};
use signal::quality::{QualityOptions, check_quality};

use self::dynamics::{Dynamics, TO_COME, look_for_dynamics, matters_beside_longer_past};
use crate::data::excitation::ExcitationOptions;
use crate::data::{Channel, Dataset, Experiment, Line, Trend, TrendScope, TrendShape};
use crate::fit::degenerate::dependent_inputs;

/// A mean above this many standard deviations is an offset.
const OFFSET: f64 = 0.3;

/// A straight line that rises by more than this many standard deviations of what is around it is a drift.
const DRIFT: f64 = 1.0;

/// Inputs correlated by more than this are nearly the same.
const CORRELATION: f64 = 0.95;

/// A weight so near to one is one.
const SAME: f64 = 1e-6;

/// Orders of excitation below this leave little to estimate.
const ORDER: usize = 6;

/// Part of the power of an input that may differ from period to period by rounding.
const UNREPEATED: f64 = 1e-6;

/// A share of equal neighbours above this, away from the extremes, is that of a held signal, not of a clipped one.
const HELD: f64 = 0.2;

/// Samples that a switch from one level to the other takes, on average and at most.
const SWITCH: f64 = 2.0;

/// A rise of the step response is sampled well by so many samples (4 to 10 are ideal).
const RISE: std::ops::RangeInclusive<f64> = 2.0..=50.0;

/// One sample of a data set. Written down as a pair, experiment first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(from = "(usize, usize)", into = "(usize, usize)")]
pub struct SampleIndex {
    /// Index of the experiment.
    pub experiment: usize,
    /// Row in it.
    pub row: usize,
}

impl From<(usize, usize)> for SampleIndex {
    fn from((experiment, row): (usize, usize)) -> Self {
        SampleIndex { experiment, row }
    }
}

impl From<SampleIndex> for (usize, usize) {
    fn from(index: SampleIndex) -> Self {
        (index.experiment, index.row)
    }
}

/// Something to know about data. Numbers are in the channel's unit unless said otherwise.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Advice {
    /// Samples are missing: fill short gaps, split the data at long ones.
    Missing {
        /// The channel.
        channel: Channel,
        /// Samples missing.
        samples: usize,
        /// Of how many.
        of: usize,
    },
    /// A channel never varies: leave it out.
    Constant {
        /// The channel.
        channel: Channel,
    },
    /// A channel rests at its smallest or largest value in runs, as a saturated sensor does.
    Clipped {
        /// The channel.
        channel: Channel,
        /// Samples in such runs.
        samples: usize,
        /// Of how many.
        of: usize,
    },
    /// Samples stand out from their neighbours: mark them as missing if they are faults.
    Outliers {
        /// The channel.
        channel: Channel,
        /// Where each is.
        at: Vec<SampleIndex>,
    },
    /// A channel varies about a level other than zero: take the means off, or estimate an offset.
    Offset {
        /// The channel.
        channel: Channel,
        /// Its mean.
        mean: f64,
        /// Its standard deviation.
        standard_deviation: f64,
    },
    /// A channel drifts: take a line off, difference, or high-pass filter.
    Drift {
        /// The channel.
        channel: Channel,
        /// Index of the experiment.
        experiment: usize,
        /// Rise of its straight line over the experiment.
        rise: f64,
        /// Standard deviation about that line.
        standard_deviation: f64,
    },
    /// The inputs, means taken off, excite so few orders that only the parameters of small models can be estimated.
    WeakExcitation {
        /// They are persistently exciting up to this order.
        order: usize,
    },
    /// An input is a combination of others, `Σ weight · u + level`: no data can separate their effects. Leave one out.
    Dependent {
        /// Index of the input.
        input: usize,
        /// Indices of the others and their weights.
        of: Vec<(usize, f64)>,
        /// The constant beside them.
        level: f64,
    },
    /// Two inputs move together: their effects are hard to separate.
    Collinear {
        /// Indices of the inputs.
        inputs: [usize; 2],
        /// Their coefficient of correlation.
        correlation: f64,
    },
    /// Later inputs help to explain an output: the input is computed from it. Correlation methods and output-error
    /// models of a wrong noise model are biased; estimate a full noise model, or use a method for closed loop.
    Feedback {
        /// The input.
        input: usize,
        /// The output.
        output: usize,
        /// χ² statistic of the inputs to come.
        statistic: f64,
        /// Threshold that the statistic stays below in 99.9 % of cases without feedback.
        threshold: f64,
    },
    /// The input of an instant bears on the output of the same instant: use `nk = 0`. Under feedback without delay this
    /// says nothing.
    Feedthrough {
        /// The input.
        input: usize,
        /// The output.
        output: usize,
        /// χ² statistic of the simultaneous input.
        statistic: f64,
        /// Threshold that the statistic stays below in 99.9 % of cases without feedthrough.
        threshold: f64,
    },
    /// The step response takes very many samples to rise: models in the shift operator are badly conditioned. Resample,
    /// or estimate in continuous time.
    SampledTooFast {
        /// The input.
        input: usize,
        /// The output.
        output: usize,
        /// Samples from 10 % to 90 % of the step response.
        rise_samples: f64,
    },
    /// The step response is over within a sample or two: the dynamics are not resolved.
    SampledTooSlowly {
        /// The input.
        input: usize,
        /// The output.
        output: usize,
        /// Samples from 10 % to 90 % of the step response.
        rise_samples: f64,
    },
    /// An output integrates an input, or forgets it more slowly than the record is long: taking a mean or a line off
    /// takes part of the response off.
    Integrating {
        /// The input.
        input: usize,
        /// The output.
        output: usize,
    },
    /// The record is short.
    Short {
        /// Rows there are.
        samples: usize,
        /// Rows there should be.
        needed: usize,
    },
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Channel::Input(index) => write!(f, "input {}", index + 1),
            Channel::Output(index) => write!(f, "output {}", index + 1),
        }
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Advice::Missing { channel, samples, of } => write!(f, "{channel} misses {samples} of {of} samples"),
            Advice::Constant { channel } => write!(f, "{channel} does not vary"),
            Advice::Clipped { channel, samples, of } => {
                write!(f, "{channel} rests at its extremes for {samples} of {of} samples")
            }
            Advice::Outliers { channel, at } => match at.len() {
                1 => write!(f, "{channel} has 1 sample that stands out"),
                count => write!(f, "{channel} has {count} samples that stand out"),
            },
            Advice::Offset { channel, mean, standard_deviation } => {
                write!(f, "{channel} varies by {standard_deviation:.3} about {mean:.3}, not about zero")
            }
            Advice::Drift { channel, experiment, rise, .. } => {
                write!(f, "{channel} drifts by {rise:.3} over experiment {}", experiment + 1)
            }
            Advice::WeakExcitation { order } => write!(f, "the inputs excite only {order} orders"),
            Advice::Dependent { input, of, level } => {
                write!(
                    f,
                    "{}, so that no data can separate their effects; leave one of them out",
                    combination(*input, of, *level)
                )
            }
            Advice::Collinear { inputs, correlation } => {
                write!(f, "inputs {} and {} are correlated by {correlation:.3}", inputs[0] + 1, inputs[1] + 1)
            }
            Advice::Feedback { input, output, .. } => {
                let (input, output) = (input + 1, output + 1);
                write!(
                    f,
                    "input {input} follows output {output}, as under feedback, behind a filter without phase shift, or where one \
                     of them is clipped"
                )
            }
            Advice::Feedthrough { input, output, .. } => {
                let (input, output) = (input + 1, output + 1);
                write!(
                    f,
                    "input {input} and output {output} move together within a sample: the input acts without delay, or the output \
                     on it"
                )
            }
            Advice::SampledTooFast { input, output, rise_samples } => {
                write!(f, "output {} takes {rise_samples:.0} samples to follow input {}", output + 1, input + 1)
            }
            Advice::SampledTooSlowly { input, output, rise_samples } => {
                write!(f, "output {} follows input {} within {rise_samples:.1} samples", output + 1, input + 1)
            }
            Advice::Integrating { input, output } => {
                write!(f, "output {} seems to integrate input {}", output + 1, input + 1)
            }
            Advice::Short { samples, needed } => write!(f, "{samples} samples where {needed} are advisable"),
        }
    }
}

/// Describes an input as a combination of others, in words.
fn combination(input: usize, of: &[(usize, f64)], level: f64) -> String {
    let is_one = |weight: f64| (weight - 1.0).abs() < SAME;
    let besides = if level == 0.0 { "" } else { " but for a constant" };
    if let [(other, weight)] = of
        && is_one(*weight)
    {
        return format!("input {} is the same as input {}{besides}", input + 1, other + 1);
    }
    let part = |(place, (other, weight)): (usize, &(usize, f64))| {
        let sign = match (place, *weight < 0.0) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        };
        match is_one(weight.abs()) {
            true => format!("{sign}input {}", other + 1),
            false => format!("{sign}{} times input {}", shortened(weight.abs()), other + 1),
        }
    };
    let parts: String = of.iter().enumerate().map(part).collect();
    format!("input {} is {parts}{besides}", input + 1)
}

/// A number with six digits at most.
fn shortened(value: f64) -> String {
    format!("{:.5e}", value).parse::<f64>().unwrap_or(value).to_string()
}

/// Looks through data for what bears on how to estimate from them; nothing is changed. Channel by channel first, then
/// the inputs, then what goes on between inputs and outputs.
///
/// The dynamics are judged by a regression of each output on ten past values of itself and of each input (fewer for
/// short records), on present and on five future inputs.
///
/// # Example
/// ```
/// use ident::{Advice, Channel, Dataset, advise};
/// let u: Vec<f64> = (0..300).map(|t| ((t * t) as f64).sin()).collect();
/// let found = advise(&Dataset::siso(0.1, &u, &[7.0; 300])?);
/// assert!(found.contains(&Advice::Constant { channel: Channel::Output(0) }));
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, ch. 13 and 14; feedback: Geweke, Meese & Dent, *Comparing alternative tests of causality in temporal
/// systems*, 1983; integrators: Dickey & Fuller, *Distribution of the estimators for autoregressive time series with a
/// unit root*, 1979; samples per rise time: Åström & Wittenmark, *Computer-Controlled Systems*, 3rd ed., §3.
#[must_use]
pub fn advise(data: &Dataset) -> Vec<Advice> {
    let mut found = Vec::new();
    let channels: Vec<Channel> = data.all_channels().collect();
    let quiet: Vec<bool> = channels.iter().map(|c| channel_advice(data, *c, &mut found)).collect();
    let lively = |wanted: fn(&Channel) -> Option<usize>| -> Vec<usize> {
        channels.iter().zip(&quiet).filter(|(_, quiet)| !**quiet).filter_map(|(c, _)| wanted(c)).collect()
    };
    let inputs = lively(|c| if let Channel::Input(k) = c { Some(*k) } else { None });
    let outputs = lively(|c| if let Channel::Output(i) = c { Some(*i) } else { None });
    let all_outputs: Vec<usize> = (0..data.outputs()).collect();
    let Ok(varying) = data.channels(&inputs, &all_outputs) else { return found };
    let means = Trend::estimate(&varying, TrendShape::Mean, TrendScope::PerExperiment);
    let Ok(centred) = means.and_then(|trend| trend.remove(&varying)) else { return found };
    let dependent = dependence_advice(&varying, &inputs, &mut found);
    input_advice(&centred, &inputs, &dependent, &mut found);
    dynamics_advice(&centred, &inputs, &outputs, &mut found);
    found
}

/// Adds the advice that a channel gives by itself; returns true if the channel does not vary.
fn channel_advice(data: &Dataset, channel: Channel, found: &mut Vec<Advice>) -> bool {
    let of = data.samples();
    let mut known = Vec::with_capacity(of);
    let is_input = matches!(channel, Channel::Input(_));
    let (mut clipped, mut outliers) = (0, Vec::new());
    for (index, e) in data.experiments().iter().enumerate() {
        let x = e.channel(channel);
        known.extend(x.iter().copied().filter(|v| !v.is_nan()));
        if let Ok(quality) = check_quality(x, &QualityOptions::default()) {
            outliers.extend(quality.spikes.into_iter().map(|row| SampleIndex { experiment: index, row }));
            let runs = quality.clipped_low.into_iter().chain(quality.clipped_high);
            clipped += if is_held(x) || (is_input && switches(x)) { 0 } else { runs.map(|r| r.len()).sum() };
        }
    }
    if known.len() < of {
        found.push(Advice::Missing { channel, samples: of - known.len(), of });
    }
    if known.windows(2).all(|w| w[0] == w[1]) {
        found.push(Advice::Constant { channel });
        return true;
    }
    if clipped > 0 {
        found.push(Advice::Clipped { channel, samples: clipped, of });
    }
    if !outliers.is_empty() {
        found.push(Advice::Outliers { channel, at: outliers });
    }
    let (mean, standard_deviation) = moments(&known);
    if mean.abs() > OFFSET * standard_deviation {
        found.push(Advice::Offset { channel, mean, standard_deviation });
    }
    drift_advice(data, channel, found);
    false
}

fn drift_advice(data: &Dataset, channel: Channel, found: &mut Vec<Advice>) {
    let Ok(trend) = Trend::estimate(data, TrendShape::Line, TrendScope::PerExperiment) else { return };
    for (experiment, e) in data.experiments().iter().enumerate() {
        let line: Line = match channel {
            Channel::Input(k) => trend.inputs(experiment)[k],
            Channel::Output(i) => trend.outputs(experiment)[i],
        };
        let time = |i: usize| e.start_s + i as f64 * data.sample_time_s();
        let about = e.channel(channel).iter().enumerate().map(|(i, v)| v - line.at(time(i)));
        let (_, standard_deviation) = moments(&about.filter(|v| !v.is_nan()).collect::<Vec<f64>>());
        let rise = line.slope_per_s * data.sample_time_s() * e.len() as f64;
        // What rounding makes of a large level is no drift.
        if rise.abs() > DRIFT * standard_deviation && rise.abs() > 1e-9 * line.level.abs() {
            found.push(Advice::Drift { channel, experiment, rise, standard_deviation });
        }
    }
}

/// Which of the varying inputs depend on others.
fn dependence_advice(varying: &Dataset, inputs: &[usize], found: &mut Vec<Advice>) -> Vec<usize> {
    let all = dependent_inputs(varying);
    found.extend(all.iter().filter(|c| !c.of.is_empty()).map(|c| Advice::Dependent {
        input: inputs[c.input],
        of: c.of.iter().map(|(other, weight)| (inputs[*other], *weight)).collect(),
        level: c.level,
    }));
    all.iter().map(|c| c.input).collect()
}

/// Adds the advice that the inputs give together, without those that depend on others.
fn input_advice(centred: &Dataset, inputs: &[usize], dependent: &[usize], found: &mut Vec<Advice>) {
    let free: Vec<usize> = (0..inputs.len()).filter(|k| !dependent.contains(k)).collect();
    let outputs: Vec<usize> = (0..centred.outputs()).collect();
    if let Ok(free) = centred.channels(&free, &outputs)
        && let Ok(excitation) = ExcitationOptions::default().of_inputs(&free)
        && excitation.order < ORDER
        && !excitation.at_least
    {
        found.push(Advice::WeakExcitation { order: excitation.order });
    }
    for (index, b) in free.iter().enumerate() {
        for a in &free[..index] {
            let correlation = correlation(centred.experiments(), *a, *b);
            if correlation.abs() > CORRELATION {
                found.push(Advice::Collinear { inputs: [inputs[*a], inputs[*b]], correlation });
            }
        }
    }
}

/// Returns true if an input repeats period by period without noise. Under feedback it cannot, for the noise does not
/// repeat. Its future is known from its past, and a regression with too short a past uses that.
pub(crate) fn repeats_exactly(data: &Dataset, input: usize) -> bool {
    data.experiments().iter().all(|experiment| {
        let u = experiment.input(input);
        let found = repeated_response(&[u], &[u], data.sample_time_s(), None);
        let Ok(Some(RepeatedResponse { repetition, .. })) = found else { return false };
        let period = repetition.period_samples.round() as usize;
        let used = &u[repetition.first..u.len().min(repetition.first + repetition.periods * period)];
        let changed: f64 = used.iter().zip(&used[period..]).map(|(a, b)| (a - b).powi(2)).sum();
        changed <= UNREPEATED * used.iter().map(|u| u * u).sum::<f64>()
    })
}

fn dynamics_advice(centred: &Dataset, inputs: &[usize], outputs: &[usize], found: &mut Vec<Advice>) {
    let mut needed = 50 * (inputs.len() + 1);
    for output in outputs {
        let Some(Dynamics { channels, threshold_ahead, threshold_present }) = look_for_dynamics(centred, *output)
        else {
            continue;
        };
        for (k, (channel, input)) in channels.iter().zip(inputs).enumerate() {
            let (input, output) = (*input, *output);
            if channel.ahead > threshold_ahead {
                if !repeats_exactly(centred, k) && matters_beside_longer_past(centred, k, output, &TO_COME) {
                    found.push(Advice::Feedback {
                        input,
                        output,
                        statistic: channel.ahead,
                        threshold: threshold_ahead,
                    });
                }
                // What the output does to the input reads like a response to it.
                continue;
            }
            if channel.present > threshold_present && matters_beside_longer_past(centred, k, output, &[0]) {
                let (statistic, threshold) = (channel.present, threshold_present);
                found.push(Advice::Feedthrough { input, output, statistic, threshold });
            }
            if channel.integrates {
                found.push(Advice::Integrating { input, output });
            }
            let Some(rise_samples) = channel.rise_samples else { continue };
            needed = needed.max((10.0 * rise_samples) as usize);
            if rise_samples > *RISE.end() {
                found.push(Advice::SampledTooFast { input, output, rise_samples });
            } else if rise_samples < *RISE.start() {
                found.push(Advice::SampledTooSlowly { input, output, rise_samples });
            }
        }
    }
    if centred.samples() < needed {
        found.push(Advice::Short { samples: centred.samples(), needed });
    }
}

/// Returns true if neighbours away from the extremes are often equal, as in a command that is held.
fn is_held(x: &[f64]) -> bool {
    let (low, high) = extremes(x);
    let inner = |w: &&[f64]| w[0] > low && w[0] < high;
    let count = x.windows(2).filter(inner).count();
    let equal = x.windows(2).filter(inner).filter(|w| w[0] == w[1]).count();
    equal as f64 > HELD * count as f64
}

/// Returns true if a signal switches between two levels, as a binary excitation does. It is hardly ever between them,
/// and not for longer than a switch takes. The response of a linear system does not switch; an output that does is cut
/// off.
fn switches(x: &[f64]) -> bool {
    let (low, high) = extremes(x);
    let is_inner = |v: &f64| *v > low && *v < high;
    let inner = x.iter().filter(|v| is_inner(v)).count();
    let ways = x.windows(2).filter(|w| !is_inner(&w[0]) && is_inner(&w[1])).count();
    (inner as f64) < HELD * x.len() as f64 && inner as f64 <= SWITCH * ways.max(1) as f64
}

fn extremes(x: &[f64]) -> (f64, f64) {
    x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)))
}

fn moments(x: &[f64]) -> (f64, f64) {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    (mean, (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len() as f64).sqrt())
}

/// Coefficient of correlation of two inputs over the rows where both are known.
fn correlation(experiments: &[Experiment], a: usize, b: usize) -> f64 {
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for e in experiments {
        for (x, y) in e.input(a).iter().zip(e.input(b)).filter(|(x, y)| !x.is_nan() && !y.is_nan()) {
            (ab, aa, bb) = (ab + x * y, aa + x * x, bb + y * y);
        }
    }
    ab / (aa.sqrt() * bb.sqrt())
}
