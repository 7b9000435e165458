//! Check of a T_d* that is stamped later than the torque that follows it.
//!
//! No torque is ahead of its demand by more than two clocks of a bench are apart. Where it is, the demand is late:
//! delays and feed-forward of the speed controller are then wrong by as much.

use std::ops::RangeInclusive;

use rig::{Experiment, Role};
use signal::Signal;

/// The two clocks of a bench are apart by at most this, s.
const APART_S: f64 = 1.5e-3;
/// Delays that are tried, s.
const TRIED_S: RangeInclusive<f64> = -0.02..=0.03;
/// Steps between them, s.
const TRIED_STEP_S: f64 = 2.5e-4;
/// Changes over so long are compared, s: the drive's ripple at 100 Hz is as it was.
const CHANGE_S: f64 = 0.04;
/// A delay is seen where it leaves less than this part of the changes of T_d,calc.
const LEAVES: f64 = 0.5;
/// Delays that leave hardly more are as good: by how much more. On 130 recordings of 29 simulated benches their middle
/// is 0 to 4.6 ms later than the lag.
const AS_GOOD: f64 = 0.02;

/// By how much T_d,calc is ahead of T_d*, s, where that is more than two clocks are apart; `lag_s` is how late the
/// torque control makes it beside its pure delay.
pub fn advance_s(experiment: &Experiment, lag_s: f64) -> Option<f64> {
    let advance_s = lag_s - delay_s(experiment)?;
    (advance_s > APART_S).then_some(advance_s)
}

/// By how much T_d,calc is later than T_d*, s: the middle of the delays of T_d* that leave least of the changes of
/// T_d,calc. A held T_d* leaves several.
fn delay_s(experiment: &Experiment) -> Option<f64> {
    let (demand, calc) = (experiment.signal(Role::DynoTorqueDemand)?, experiment.signal(Role::AirGapTorque)?);
    let (first, last) = TRIED_S.into_inner();
    let tried = (0..=((last - first) / TRIED_STEP_S).round() as usize).map(|k| first + k as f64 * TRIED_STEP_S);
    let tried: Vec<(f64, f64)> = tried.map(|delay_s| (delay_s, left(demand, calc, delay_s))).collect();
    let least = tried.iter().map(|(_, left)| *left).fold(f64::INFINITY, f64::min);
    let mut as_good =
        tried.iter().filter(|(_, left)| *left <= least + AS_GOOD * (1.0 - least)).map(|(delay_s, _)| *delay_s);
    let earliest = as_good.next().filter(|_| least < LEAVES)?;
    Some(0.5 * (earliest + as_good.next_back().unwrap_or(earliest)))
}

/// Rest that a delay of T_d* leaves of the changes of T_d,calc, as a part of their squares.
fn left(demand: &Signal, calc: &Signal, delay_s: f64) -> f64 {
    let over = ((CHANGE_S / calc.sample_time_s).round() as usize).max(1);
    let demanded: Vec<Option<f64>> = (0..calc.len()).map(|k| value_at(demand, calc.time_s(k) - delay_s)).collect();
    let (mut left, mut all) = (0.0, 0.0);
    for (torques, demands) in calc.samples.windows(over + 1).zip(demanded.windows(over + 1)) {
        let (Some(before), Some(after)) = (demands[0], demands[over]) else { continue };
        let change = torques[over] - torques[0];
        left += (change - (after - before)).powi(2);
        all += change * change;
    }
    left / all
}

/// The value of a signal, straight between its samples.
fn value_at(signal: &Signal, time_s: f64) -> Option<f64> {
    let position = (time_s - signal.start_s) / signal.sample_time_s;
    let before = position.floor().max(0.0) as usize;
    let pair = signal.samples.get(before..before + 2).filter(|_| position >= 0.0)?;
    Some(pair[0] + (position - before as f64) * (pair[1] - pair[0]))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use rig::ExperimentLabel;
    use signal::excitation::Random;

    use super::*;

    #[test]
    fn exact_a_late_demand_is_dated() {
        let mut random = Random::new(3);
        let demand: Vec<f64> = (0..8000).map(|_| 50.0 * random.normal()).collect();
        for delay in [-8.0, -3.5, 0.0, 2.25, 6.0] {
            let demand = Signal::new(0.0, 1e-3, demand.clone()).unwrap();
            let value = |k: usize| value_at(&demand, 4e-3 * (k + 10) as f64 - 1e-3 * delay).unwrap();
            let calc = Signal::new(0.04, 4e-3, (0..1900).map(value).collect()).unwrap();
            let signals = BTreeMap::from([(Role::DynoTorqueDemand, demand), (Role::AirGapTorque, calc)]);
            let experiment = Experiment { file: "x".to_owned(), label: ExperimentLabel::BS_T_NT, signals };
            assert!((delay_s(&experiment).unwrap() - 1e-3 * delay).abs() < 1e-9);
        }
    }
}
