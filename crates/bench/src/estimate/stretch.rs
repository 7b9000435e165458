//! Which stretch of a recording an estimate may use.

use signal::Signal;

use crate::estimate::EstimateError;
use crate::study::Stretch;
use crate::{Experiment, Role};

/// Within this part of the limit a torque counts as limited.
const AT_LIMIT: f64 = 0.995;

/// The signal of a role.
///
/// # Errors
/// It was not recorded.
pub(crate) fn need(experiment: &Experiment, role: Role) -> Result<&Signal, EstimateError> {
    experiment
        .signal(role)
        .ok_or_else(|| EstimateError::MissingSignal { file: experiment.file.clone(), role })
}

/// Start and end common to all signals of an experiment, s. The end is one sample after the last of the shortest.
pub(crate) fn common_window(experiment: &Experiment, roles: &[Role]) -> Result<(f64, f64), EstimateError> {
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    for role in roles {
        let signal = need(experiment, *role)?;
        from = from.max(signal.start_s);
        to = to.min(signal.start_s + signal.len() as f64 * signal.sample_time_s);
    }
    Ok((from, to))
}

/// The longest stretch in which T_d* stays below the limit and every signal of the speed controller is there.
///
/// # Errors
/// It is shorter than `shortest_s`.
pub(crate) fn longest_unsaturated(
    experiment: &Experiment,
    torque_limit_nm: Option<f64>,
    shortest_s: f64,
) -> Result<(f64, f64), EstimateError> {
    let roles = [Role::DynoTorqueDemand, Role::DynoSpeedDemand, Role::DynoSpeed];
    let (from, to) = common_window(experiment, &roles)?;
    if to - from < shortest_s {
        return Err(EstimateError::TooShort { file: experiment.file.clone(), duration_s: to - from, needed_s: shortest_s });
    }
    let demand = need(experiment, Role::DynoTorqueDemand)?.slice(from, to);
    let limit = AT_LIMIT * torque_limit_nm.unwrap_or(f64::INFINITY);
    let (first, length) = longest_run(&demand.samples, |torque| torque.abs() < limit);
    let longest = length as f64 * demand.sample_time_s;
    if longest < shortest_s {
        let limited = demand.samples.iter().filter(|t| t.abs() >= limit).count();
        return Err(EstimateError::Saturated {
            file: experiment.file.clone(),
            role: Role::DynoTorqueDemand,
            share: limited as f64 / demand.len() as f64,
        });
    }
    Ok((demand.time_s(first), demand.time_s(first) + longest))
}

/// First index and length of the longest run of values that fulfil a condition.
fn longest_run(values: &[f64], condition: impl Fn(f64) -> bool) -> (usize, usize) {
    let (mut best, mut start) = ((0, 0), 0);
    for (i, value) in values.iter().enumerate() {
        if !condition(*value) {
            start = i + 1;
        } else if i + 1 - start > best.1 {
            best = (start, i + 1 - start);
        }
    }
    best
}

/// A stretch cut in two: what is estimated from, and what judges.
pub(crate) fn split(stretch: &Stretch, share: f64) -> ((f64, f64), (f64, f64)) {
    let middle = stretch.start_s + share * (stretch.end_s - stretch.start_s);
    ((stretch.start_s, middle), (middle, stretch.end_s))
}
