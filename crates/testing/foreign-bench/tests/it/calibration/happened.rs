//! True peaks of a test, by the definitions that the program states.

use capability::LimitOf;
use cycle::{Course, Feedback, Judged, Validation, validate};
use foreign_bench::Run;

use super::asked::Asked;

/// T_d* counts by its change within so many milliseconds, the speed by its change within so many.
const TORQUE_CHANGE_MS: usize = 10;
const SPEED_CHANGE_MS: usize = 50;

/// A quantity with a limit; `None` of one that is not looked at.
pub(crate) fn extreme(of: LimitOf, run: &Run) -> Option<f64> {
    let truth = &run.truth;
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    Some(match of {
        LimitOf::ShaftTorque => largest(&truth.shaft_torque_nm),
        LimitOf::ShaftTorqueSlew => change_per_s(&truth.shaft_torque_nm, 1),
        LimitOf::TorqueDemand => largest(&run.torque_demand_nm),
        LimitOf::TorqueSlew => change_per_s(&run.torque_demand_nm, TORQUE_CHANGE_MS),
        LimitOf::Speed => largest(&truth.dyno_speed_rad_s).max(largest(&truth.engine_speed_rad_s)),
        LimitOf::SpeedGradient => change_per_s(&truth.dyno_speed_rad_s, SPEED_CHANGE_MS),
        LimitOf::Power => {
            let powers = run.torque_demand_nm.iter().zip(&truth.dyno_speed_rad_s).map(|(torque, speed)| torque * speed);
            largest(&powers.collect::<Vec<_>>())
        }
        LimitOf::TimeAtResonance | LimitOf::DriveHeat => return None,
    })
}

/// The largest change within some milliseconds over all of them, per s.
fn change_per_s(values: &[f64], within_ms: usize) -> f64 {
    let of_one = |k: usize| {
        let after = &values[k..values.len().min(k + within_ms + 1)];
        after.iter().fold(0.0_f64, |most, value| most.max((value - values[k]).abs()))
    };
    (0..values.len()).map(of_one).fold(0.0, f64::max) / (1e-3 * within_ms as f64)
}

/// Requirements on the speed.
pub(crate) fn own(asked: &Asked, run: &Run) -> Vec<Judged> {
    let Some((_, demands)) = asked.plan() else { return Vec::new() };
    let course = Course {
        sample_time_s: 1e-3,
        demand: &demands.speed_rad_s,
        value: &run.truth.dyno_speed_rad_s,
        timed_demand: None,
    };
    asked.own.iter().map(|own| own.judge(&course)).collect()
}

/// Statistics of a cycle.
pub(crate) fn validations(asked: &Asked, run: &Run) -> Vec<Validation> {
    let Some(reference) = asked.reference() else { return Vec::new() };
    let feedback = Feedback {
        start_s: reference.start_s,
        sample_time_s: 1e-3,
        speed_rad_s: run.truth.engine_speed_rad_s.clone(),
        torque_nm: run.truth.shaft_torque_nm.clone(),
        demand: None,
    };
    asked.sets.iter().map(|set| validate(reference, &feedback, set).unwrap()).collect()
}
