//! A quick look at what goes on between inputs and an output.

use faer::Mat;

use super::Dataset;
use crate::distributions::chi_squared_quantile;
use crate::least_squares::solve_factor;
use crate::regression::{Lagged, Regression, factor_of};

/// Past values of the output and of each input, at most.
const PAST: usize = 10;

/// Future values of each input for every two past ones.
const PAST_FOR_ONE_AHEAD: usize = 2;

/// Level of the tests.
const LEVEL: f64 = 0.999;

/// Residuals below this part of the output are rounding, and show nothing.
const ROUNDING: f64 = 1e-10;

/// Samples of the step response looked at.
const HORIZON: usize = 5000;

/// What one output shows, input by input.
pub(super) struct Dynamics {
    pub(super) channels: Vec<ChannelDynamics>,
    /// What `ahead` and `present` stay below by chance.
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
    let signals = data
        .experiments()
        .iter()
        .map(|e| std::iter::once(e.output(output)).chain((0..inputs).map(|k| e.input(k))).collect())
        .collect();
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
    let parameters = if matters { causal_parameters(&factor, first_ahead, samples) } else { None };
    let channel = |k: usize| ChannelDynamics {
        ahead: explained(first_ahead + k * ahead..first_ahead + (k + 1) * ahead),
        present: explained(first_present + k..first_present + k + 1),
        rise_samples: parameters.as_ref().and_then(|p| rise_samples(p, past, k, first_present)),
    };
    Some(Dynamics {
        channels: (0..inputs).map(channel).collect(),
        threshold_ahead: chi_squared_quantile(LEVEL, ahead as f64),
        threshold_present: chi_squared_quantile(LEVEL, 1.0),
    })
}

/// Past of the output, past of each input, present inputs, future of each input, the output itself.
fn columns(inputs: usize, past: usize, ahead: usize) -> Vec<Lagged> {
    let back = |signal: usize| Lagged::each(signal, 1..=past as isize);
    let present = (1..=inputs).map(|k| Lagged::new(k, 0));
    let future = (1..=inputs).flat_map(|k| Lagged::each(k, (1..=ahead as isize).map(|lead| -lead)));
    (0..=inputs).flat_map(back).chain(present).chain(future).chain([Lagged::new(0, 0)]).collect()
}

/// Coefficients without the future inputs.
fn causal_parameters(factor: &Mat<f64>, count: usize, samples: usize) -> Option<Vec<f64>> {
    let columns: Vec<usize> = (0..count).chain([factor.ncols() - 1]).collect();
    Some(solve_factor(&factor_of(factor, &columns), samples).ok()?.parameters)
}

/// Samples between 10 % and 90 % of the step response from an input; `None` where it does not settle.
fn rise_samples(parameters: &[f64], past: usize, input: usize, first_present: usize) -> Option<f64> {
    let own = &parameters[..past];
    let from_input = &parameters[past * (input + 1)..past * (input + 2)];
    let direct = parameters[first_present + input];
    let mut step: Vec<f64> = Vec::with_capacity(HORIZON);
    for t in 0..HORIZON {
        let fed: f64 = from_input[..t.min(past)].iter().sum();
        let back: f64 = own[..t.min(past)].iter().enumerate().map(|(i, a)| a * step[t - 1 - i]).sum();
        step.push(direct + fed + back);
    }
    let end = step[HORIZON - 1];
    let settled = step[HORIZON / 2..].iter().all(|v| (v - end).abs() <= 0.01 * end.abs());
    let crossing = |share: f64| {
        let after = step.iter().position(|v| v / end >= share)?;
        let before = if after == 0 { 0.0 } else { step[after - 1] / end };
        Some(after as f64 - (step[after] / end - share) / (step[after] / end - before))
    };
    if settled && end.is_finite() && end != 0.0 { Some(crossing(0.9)? - crossing(0.1)?) } else { None }
}
