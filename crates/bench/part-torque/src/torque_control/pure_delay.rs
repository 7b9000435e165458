//! The bar to beat: the torque follows the demand after a delay and nothing else.

use bench_model::drive_ripple::{DriveRipple, RippleLine};
use faer::Mat;
use ident::{IdentError, Minimum, Termination};
use rig::results::{Estimate, Parameter, Quantity, Stretch};

use super::held::HeldDemand;
use super::model::{AirGapTorqueModel, PureDelay};
use super::observed::Observed;
use super::ripple::stands_still;
use super::rippled::linear_part;
use super::search::robust_covariance;
use crate::torque_control::bounds::{EARLIEST_S, LONGEST_DELAY_S};

/// Parts of a sample of the demand in which delays are tried.
const PARTS: usize = 20;
/// Costs this close, relatively, are one.
const SAME: f64 = 1e-9;

/// T_d(t) = o + T_d*(t − τ) and ripple, T_d* held.
///
/// Where T_d,calc is sampled at the demand's own instants the cost is a staircase in τ: all delays between two samples
/// fit equally. τ is the middle of the best step, and its variance that of a uniform distribution over the step plus
/// that of noise. The ripple's frequencies are those of `lagged`.
///
/// # Errors
/// Too few samples or dependent regressors.
pub(super) fn fit(
    held: &HeldDemand,
    observed: &Observed,
    lagged: &AirGapTorqueModel,
    stretch: &Stretch,
) -> Result<(Estimate, PureDelay), IdentError> {
    let (delay_s, step_s) = best_step(held, observed, lagged);
    let modelled = delayed(held, observed, delay_s);
    let is_folded = |line: &RippleLine| stands_still(line.frequency_hz, observed.sample_time_s);
    let (folded, seen): (Vec<_>, Vec<_>) = lagged.ripple.lines.iter().copied().partition(is_folded);
    let first_s = observed.times_s.first().map_or(0.0, |first| first - lagged.ripple.reference_s);
    let gain = folded.iter().fold(1.0, |gain, line| gain + line.parts(first_s).0);
    let frequencies: Vec<f64> = seen.iter().map(|line| line.frequency_hz).collect();
    let (offset_nm, mut lines) = linear_part(&modelled, gain, observed, &frequencies)?;
    lines.extend(folded);
    let ripple = DriveRipple { offset_nm, lines, reference_s: lagged.ripple.reference_s };
    let dressing = AirGapTorqueModel { ripple, ..lagged.clone() };
    let model = PureDelay { delay_s, dressing };
    let (noise, freedom) = noise_variance(held, observed, &model)?;
    let variance = step_s * step_s / 12.0 + noise;
    let estimate = Estimate {
        parameters: vec![Parameter::new(Quantity::TorqueControlDelay, delay_s, variance.sqrt(), freedom)],
        covariance: vec![vec![variance]],
        stretches: vec![stretch.clone()],
        iterations: 0,
        condition: 1.0,
    };
    Ok((estimate, model))
}

fn delayed(held: &HeldDemand, observed: &Observed, delay_s: f64) -> Vec<f64> {
    observed.times_s.iter().map(|t| held.at(t - delay_s)).collect()
}

/// Middle and width of the range of delays with the smallest cost. Offset and ripple are the lagged model's: they
/// hardly depend on the response.
fn best_step(held: &HeldDemand, observed: &Observed, lagged: &AirGapTorqueModel) -> (f64, f64) {
    let cell_s = held.sample_time_s() / PARTS as f64;
    let count = ((LONGEST_DELAY_S + EARLIEST_S) / cell_s).ceil() as usize;
    let ripple: Vec<(f64, f64)> = observed.times_s.iter().map(|t| lagged.ripple.at(*t)).collect();
    let cost = |j: usize| -> f64 {
        let delay_s = (j as f64 + 0.5) * cell_s - EARLIEST_S;
        let error = |((t, y), (relative, added_nm)): ((&f64, &f64), &(f64, f64))| {
            let torque_nm = held.at(t - delay_s);
            (y - (torque_nm + (added_nm + torque_nm * relative))).powi(2)
        };
        observed.times_s.iter().zip(&observed.values).zip(&ripple).map(error).sum()
    };
    let costs: Vec<f64> = (0..count).map(cost).collect();
    let best = (0..count).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
    let same = |j: &usize| costs[*j] <= costs[best] * (1.0 + SAME);
    let first = (0..=best).rev().take_while(same).last().unwrap_or(best);
    let last = (best..count).take_while(same).last().unwrap_or(best);
    (0.5 * (first + last + 1) as f64 * cell_s - EARLIEST_S, (last + 1 - first) as f64 * cell_s)
}

/// Variance of the delay by noise and by what the model misses, with the slope taken over one sample to either side.
fn noise_variance(held: &HeldDemand, observed: &Observed, model: &PureDelay) -> Result<(f64, f64), IdentError> {
    let step = held.sample_time_s();
    let modelled = model.torque_at(held, &observed.times_s);
    let later = delayed(held, observed, model.delay_s + step);
    let earlier = delayed(held, observed, model.delay_s - step);
    let jacobian = Mat::from_fn(observed.len(), 1, |i, _| -(later[i] - earlier[i]) / (2.0 * step));
    let residuals: Vec<f64> = observed.values.iter().zip(&modelled).map(|(y, m)| y - m).collect();
    let information = jacobian.col(0).squared_norm_l2();
    if information.is_nan() || information <= 0.0 {
        // A demand that is held longer than that, and sampled between its steps alone: noise does not move the delay.
        return Ok((0.0, (observed.len() as f64 - 1.0).max(1.0)));
    }
    let fit = Minimum {
        parameters: vec![model.delay_s],
        cost: residuals.iter().map(|r| r * r).sum(),
        residuals,
        jacobian,
        unscaled_covariance: Mat::full(1, 1, 1.0 / information),
        at_bound: vec![false],
        iterations: 0,
        termination: Termination::SmallStep,
        condition: 1.0,
    };
    let (covariance, freedom) = robust_covariance(&fit, observed.sample_time_s)?;
    Ok((covariance[(0, 0)], freedom))
}
