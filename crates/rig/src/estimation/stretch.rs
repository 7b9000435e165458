//! Which stretch of a recording an estimate may use.

use std::ops::Range;

use signal::{Signal, runs};

use crate::align::{common_window, cut};
use crate::estimation::EstimateError;
use crate::{Experiment, Role};

/// Within this part of the limit a torque counts as limited.
const AT_LIMIT: f64 = 0.995;

/// The signal of a role.
///
/// # Errors
/// It was not recorded.
pub fn need(experiment: &Experiment, role: Role) -> Result<&Signal, EstimateError> {
    experiment.signal(role).ok_or_else(|| EstimateError::MissingSignal { file: experiment.file.clone(), role })
}

/// The longest stretch in which T_d* stays below the limit and every signal of the speed controller is there.
///
/// # Errors
/// It is shorter than `shortest_s`.
pub fn longest_unsaturated(
    experiment: &Experiment,
    torque_limit_nm: Option<f64>,
    shortest_s: f64,
) -> Result<(f64, f64), EstimateError> {
    let roles = [Role::DynoTorqueDemand, Role::DynoSpeedDemand, Role::DynoSpeed];
    for role in roles {
        need(experiment, role)?;
    }
    let (from, to) = common_window(experiment, &roles).unwrap_or((0.0, 0.0));
    if to - from < shortest_s {
        return Err(EstimateError::TooShort {
            file: experiment.file.clone(),
            duration_s: to - from,
            needed_s: shortest_s,
        });
    }
    let demand = cut(need(experiment, Role::DynoTorqueDemand)?, from, to);
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
    // The first of those that are equally long.
    let longer = |best: Range<usize>, run: Range<usize>| if run.len() > best.len() { run } else { best };
    let longest = runs(values.len(), |i| condition(values[i])).fold(0..0, longer);
    (longest.start, longest.len())
}
