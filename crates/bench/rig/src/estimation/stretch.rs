//! Which stretch of a recording an estimate may use.

use std::borrow::Cow;
use std::ops::Range;

use signal::{Signal, runs};

use crate::align::{common_window, cut, window_of};
use crate::estimation::EstimateError;
use crate::{Experiment, Role};

/// Share of a recording that is estimated from; the rest judges.
pub const ESTIMATION_SHARE: f64 = 0.7;

/// Within this part of the limit a torque counts as limited.
const AT_LIMIT: f64 = 0.995;
/// Longest part of a recording that a part is estimated from, s: of it noise already leaves K, the gains and the delays
/// less uncertain than the models of the signals do.
const LONGEST_S: f64 = 240.0;
/// Time within which a signal has to change to count as lively, s: a change of speed within it twists the shaft.
const TWISTING_S: f64 = 0.02;

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

/// A recording, or of a longer one the four minutes in which the signal of a role changes most.
pub fn liveliest_part(experiment: &Experiment, role: Role) -> Cow<'_, Experiment> {
    let of = |signal: &Signal| (window_of(signal), liveliest(signal, window_of(signal)));
    match experiment.signal(role).map(of) {
        Some((whole, part)) if part != whole => Cow::Owned(experiment.within(part)),
        _ => Cow::Borrowed(experiment),
    }
}

/// A window, s, or of a longer one the four minutes in which a signal changes most.
pub fn liveliest(signal: &Signal, (start_s, end_s): (f64, f64)) -> (f64, f64) {
    if end_s - start_s <= LONGEST_S {
        return (start_s, end_s);
    }
    let signal = cut(signal, start_s, end_s);
    let samples = |time_s: f64| ((time_s / signal.sample_time_s).round() as usize).max(1);
    let lag = samples(TWISTING_S);
    let squares: Vec<f64> = signal.samples.windows(lag + 1).map(|part| (part[lag] - part[0]).powi(2)).collect();
    let of_seconds: Vec<f64> = squares.chunks_exact(samples(1.0)).map(|second| second.iter().sum()).collect();
    let mut best = (0, f64::NEG_INFINITY);
    for (first, part) in of_seconds.windows(LONGEST_S as usize).enumerate() {
        let sum: f64 = part.iter().sum();
        if sum > best.1 {
            best = (first, sum);
        }
    }
    let start_s = start_s + best.0 as f64;
    (start_s, start_s + LONGEST_S)
}

/// First index and length of the longest run of values that fulfil a condition.
fn longest_run(values: &[f64], condition: impl Fn(f64) -> bool) -> (usize, usize) {
    // The first of those that are equally long.
    let longer = |best: Range<usize>, run: Range<usize>| if run.len() > best.len() { run } else { best };
    let longest = runs(values.len(), |i| condition(values[i])).fold(0..0, longer);
    (longest.start, longest.len())
}
