//! A quick look at what goes on between inputs and an output.

use faer::Mat;

use crate::data::regression::{Lagged, Regression, Signals};
use crate::distributions::chi_squared_quantile;
use crate::least_squares::{LinearFit, solve_factor};
use crate::{Dataset, Experiment};
use fitting::equation::factor_of;

/// Past values of the output and of each input, at most.
const PAST: usize = 10;

/// Future values of each input for every two past ones.
const PAST_FOR_ONE_AHEAD: usize = 2;

/// Past values looked at again where later inputs seem to matter: noise on the output, or an input that changes slowly,
/// needs more of them, and what a short past lacks is in the inputs to come too.
const LONGER: [usize; 3] = [20, 40, 80];

/// Rows times squared columns that such a look may take.
const AFFORDABLE: usize = 2_000_000_000;

/// Part of the variance of a residual that later inputs have to explain.
const NOTABLE: f64 = 1e-3;

/// Level of the tests.
const LEVEL: f64 = 0.999;

/// Residuals below this part of the output are rounding, and show nothing.
const ROUNDING: f64 = 1e-10;

/// Samples of the step response looked at.
const HORIZON: usize = 5000;

/// Most samples over which a step response is watched for whether it still rises.
const LONGEST: usize = 200_000;

/// The statistic of Dickey and Fuller above which 95 % of series with an integrator and a mean stay.
const UNIT_ROOT: f64 = -2.86;

/// The share of a step response that comes in the second half of a record, above which it is still rising: a single lag
/// that long has a time constant of 0.72 records.
const STILL_RISING: f64 = 1.0 / 3.0;

/// Evidence about the dynamics of one output, input by input.
pub(super) struct Dynamics {
    pub(super) channels: Vec<ChannelDynamics>,
    /// Thresholds that `ahead` and `present` exceed by chance only rarely.
    pub(super) threshold_ahead: f64,
    pub(super) threshold_present: f64,
}

pub(super) struct ChannelDynamics {
    /// χ² of the inputs to come, with those of the inputs listed before known.
    pub(super) ahead: f64,
    /// χ² of the simultaneous input.
    pub(super) present: f64,
    /// Samples from 10 % to 90 % of the step response, where the input matters and the response settles.
    pub(super) rise_samples: Option<f64>,
    /// True if the output integrates the input, as far as the data show.
    pub(super) integrates: bool,
}

/// Regresses an output on its past and on past, present and future inputs; `None` where the data are too few, or the
/// regression leaves nothing but rounding.
pub(super) fn look_for_dynamics(data: &Dataset, output: usize) -> Option<Dynamics> {
    let inputs = data.inputs();
    let rows = data.samples();
    let past = PAST.min(rows / (8 * (inputs + 1)));
    if past < 2 || inputs == 0 {
        return None;
    }
    let ahead = past / PAST_FOR_ONE_AHEAD;
    let columns = columns(inputs, past, ahead);
    let signals = signals(data, output, usize::MAX);
    let last = columns.len() - 1;
    let regression = Regression::new(&signals, columns);
    let samples = regression.rows;
    if samples < 2 * (last + 1) {
        return None;
    }
    let factor = regression.factor();
    let residual = factor[(last, last)].abs();
    let variance = residual * residual / (samples - last) as f64;
    if residual <= ROUNDING * factor.col(last).norm_l2() {
        return None;
    }
    let explained = |range: std::ops::Range<usize>| range.map(|i| factor[(i, last)].powi(2)).sum::<f64>() / variance;
    let first_present = past * (inputs + 1);
    let first_ahead = first_present + inputs;
    let threshold_past = chi_squared_quantile(LEVEL, (past * inputs) as f64);
    let matters = explained(past..first_present) > threshold_past;
    let causal = if matters { causal_regression(&factor, first_ahead, samples) } else { None };
    let unit_root = causal.as_ref().is_some_and(|c| may_have_unit_root(c, past));
    let threshold_own = chi_squared_quantile(LEVEL, past as f64);
    let length = (rows / data.experiments().len().max(1)).min(LONGEST);
    let channel = |k: usize| {
        let response = |c: &LinearFit, horizon| step_response(&c.parameters, past, k, first_present, horizon);
        let acts = explained(past * (k + 1)..past * (k + 2)) > threshold_own;
        ChannelDynamics {
            ahead: explained(first_ahead + k * ahead..first_ahead + (k + 1) * ahead),
            present: explained(first_present + k..first_present + k + 1),
            rise_samples: causal.as_ref().and_then(|c| rise_samples(&response(c, HORIZON))),
            integrates: unit_root && acts && causal.as_ref().is_some_and(|c| still_rises(&response(c, length))),
        }
    };
    Some(Dynamics {
        channels: (0..inputs).map(channel).collect(),
        threshold_ahead: chi_squared_quantile(LEVEL, ahead as f64),
        threshold_present: chi_squared_quantile(LEVEL, 1.0),
    })
}

/// Returns true if values of an input `lags` samples before help to explain an output beside its longer past. Akaike's
/// criterion chooses the length of that past; negative lags are values to come.
///
/// # Source
/// Geweke, Meese & Dent, *Comparing alternative tests of causality in temporal systems*, J. Econometrics 21, 1983;
/// Ljung 1999, (16.36) (the criterion).
pub(super) fn matters_beside_longer_past(data: &Dataset, input: usize, output: usize, lags: &[isize]) -> bool {
    let looks = std::iter::once(PAST).chain(LONGER).map_while(|past| Beside::new(data, input, output, lags, past));
    let best = looks.min_by(|a, b| a.criterion.total_cmp(&b.criterion));
    best.is_some_and(|best| best.matters)
}

/// The values of an input that are still to come.
pub(super) const TO_COME: [isize; 5] = [-1, -2, -3, -4, -5];

/// Part of an output that further values of an input explain, beside a past of some length.
struct Beside {
    /// Of the regression without them.
    criterion: f64,
    matters: bool,
}

impl Beside {
    /// None where the data are too few for so long a past.
    fn new(data: &Dataset, input: usize, output: usize, lags: &[isize], past: usize) -> Option<Self> {
        let inputs = data.inputs();
        let back = |signal: usize| Lagged::each(signal, 1..=past as isize);
        // The present of the others, and of this one where that is not what is asked for.
        let present = (1..=inputs).filter(|k| *k != input + 1 || !lags.contains(&0)).map(|k| Lagged::new(k, 0));
        let known: Vec<Lagged> = (0..=inputs).flat_map(back).chain(present).collect();
        let first = known.len();
        let all = known.into_iter().chain(Lagged::each(input + 1, lags.iter().copied())).chain([Lagged::new(0, 0)]);
        let last = first + lags.len();
        let most = AFFORDABLE / (last + 1).pow(2) / data.experiments().len().max(1);
        let signals = signals(data, output, most);
        let regression = Regression::new(&signals, all.collect());
        let rows = regression.rows;
        if rows < 4 * (last + 1) {
            return None;
        }
        let factor = regression.factor();
        let explained: f64 = (first..last).map(|i| factor[(i, last)].powi(2)).sum();
        let left = factor[(last, last)].powi(2);
        let variance = left / (rows - last) as f64;
        Some(Beside {
            criterion: ((left + explained) / rows as f64).ln() + 2.0 * first as f64 / rows as f64,
            matters: explained > variance * chi_squared_quantile(LEVEL, lags.len() as f64)
                && explained > NOTABLE * (left + explained),
        })
    }
}

/// The output and the inputs of each experiment, at most so many samples.
fn signals(data: &Dataset, output: usize, most: usize) -> Signals<'_> {
    let record = |e| {
        let e: &Experiment = e;
        let all = std::iter::once(e.output(output)).chain((0..data.inputs()).map(|k| e.input(k)));
        all.map(|x| &x[..x.len().min(most)]).collect()
    };
    data.experiments().iter().map(record).collect()
}

/// Past of the output, past of each input, present inputs, future of each input, the output itself.
fn columns(inputs: usize, past: usize, ahead: usize) -> Vec<Lagged> {
    let back = |signal: usize| Lagged::each(signal, 1..=past as isize);
    let present = (1..=inputs).map(|k| Lagged::new(k, 0));
    let future = (1..=inputs).flat_map(|k| Lagged::each(k, (1..=ahead as isize).map(|lead| -lead)));
    (0..=inputs).flat_map(back).chain(present).chain(future).chain([Lagged::new(0, 0)]).collect()
}

/// The regression without the future inputs.
fn causal_regression(factor: &Mat<f64>, count: usize, samples: usize) -> Option<LinearFit> {
    let columns: Vec<usize> = (0..count).chain([factor.ncols() - 1]).collect();
    solve_factor(&factor_of(factor, &columns), samples).ok()
}

/// Returns true if the sum of the coefficients of past outputs may be one: the test of Dickey and Fuller.
fn may_have_unit_root(regression: &LinearFit, past: usize) -> bool {
    let excess = regression.parameters[..past].iter().sum::<f64>() - 1.0;
    let own = regression.unscaled_covariance.submatrix(0, 0, past, past);
    let variance = regression.noise_variance() * own.sum();
    excess >= UNIT_ROOT * variance.sqrt()
}

/// The first samples of the response to a step of an input, whose present value has its coefficient at `first_present`.
fn step_response(parameters: &[f64], past: usize, input: usize, first_present: usize, horizon: usize) -> Vec<f64> {
    let own = &parameters[..past];
    let from_input = &parameters[past * (input + 1)..past * (input + 2)];
    let direct = parameters[first_present + input];
    let mut step: Vec<f64> = Vec::with_capacity(horizon);
    for t in 0..horizon {
        let fed: f64 = from_input[..t.min(past)].iter().sum();
        let back: f64 = own[..t.min(past)].iter().enumerate().map(|(i, a)| a * step[t - 1 - i]).sum();
        step.push(direct + fed + back);
    }
    step
}

/// Returns true if a good part of a step response comes in its second half.
fn still_rises(step: &[f64]) -> bool {
    let Some(end) = step.last() else { return false };
    let middle = step[step.len() / 2];
    // What has overflowed has risen too.
    !end.is_finite() || (end - middle) / end > STILL_RISING
}

/// Samples between 10 % and 90 % of a step response; `None` where it does not settle.
fn rise_samples(step: &[f64]) -> Option<f64> {
    let end = step[HORIZON - 1];
    let settled = step[HORIZON / 2..].iter().all(|v| (v - end).abs() <= 0.01 * end.abs());
    let crossing = |share: f64| {
        let after = step.iter().position(|v| v / end >= share)?;
        let before = if after == 0 { 0.0 } else { step[after - 1] / end };
        Some(after as f64 - (step[after] / end - share) / (step[after] / end - before))
    };
    if settled && end.is_finite() && end != 0.0 { Some(crossing(0.9)? - crossing(0.1)?) } else { None }
}
