//! What is compared with the limits of a bench.

use std::f64::consts::TAU;

use rig::bench_file::Limits;
use serde::Serialize;

use crate::pulses::Pulses;
use crate::trace::Trace;

/// Changes of T_d* count over this time, s: an automation system demands as often.
const TORQUE_CHANGE_S: f64 = 0.01;
/// Changes of the speed count over this time, s.
const SPEED_CHANGE_S: f64 = 0.05;
/// Firing frequencies closer to the resonance than this part of it are at the resonance.
const RESONANCE_BAND: f64 = 0.1;

/// A quantity with a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitOf {
    /// Largest |T_shaft|, Nm.
    ShaftTorque,
    /// Largest |dT_shaft/dt|, Nm/s.
    ShaftTorqueSlew,
    /// Largest |T_d*|, Nm.
    TorqueDemand,
    /// Largest change of T_d* within 10 ms, Nm/s.
    TorqueSlew,
    /// Largest speed of either end, rad/s.
    Speed,
    /// Largest change of ω_d within 50 ms, rad/s².
    SpeedGradient,
    /// Largest |T_d* ω_d|, W.
    Power,
    /// Longest stay of the firing frequency near the resonance, s.
    TimeAtResonance,
}

/// The largest value of a run, and when.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Peak {
    /// Its magnitude, SI.
    pub value: f64,
    /// When, s.
    pub time_s: f64,
}

impl LimitOf {
    /// Every quantity.
    pub const ALL: [LimitOf; 8] = [
        LimitOf::ShaftTorque,
        LimitOf::ShaftTorqueSlew,
        LimitOf::TorqueDemand,
        LimitOf::TorqueSlew,
        LimitOf::Speed,
        LimitOf::SpeedGradient,
        LimitOf::Power,
        LimitOf::TimeAtResonance,
    ];

    /// Those that a test has, with a shaft or without.
    pub fn of_test(has_shaft: bool) -> impl Iterator<Item = LimitOf> {
        let of_shaft = [LimitOf::ShaftTorque, LimitOf::ShaftTorqueSlew, LimitOf::TimeAtResonance];
        LimitOf::ALL.into_iter().filter(move |of| has_shaft || !of_shaft.contains(of))
    }

    /// The limit that a bench file states, SI.
    pub fn limit(self, limits: &Limits) -> Option<f64> {
        match self {
            LimitOf::ShaftTorque => limits.shaft_torque_nm,
            LimitOf::ShaftTorqueSlew => limits.shaft_torque_slew_nm_per_s,
            LimitOf::TorqueDemand => limits.torque_nm,
            LimitOf::TorqueSlew => limits.torque_slew_nm_per_s,
            LimitOf::Speed => limits.speed_rad_s,
            LimitOf::SpeedGradient => limits.speed_gradient_rad_s2,
            LimitOf::Power => limits.power_w,
            LimitOf::TimeAtResonance => limits.time_at_resonance_s,
        }
    }
}

/// The resonance of a bench, and how often its engine fires.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Firing {
    pub(crate) resonance_hz: f64,
    pub(crate) firings_per_turn: f64,
}

/// The peaks of a run, by the place of each quantity in [`LimitOf::ALL`]. Pulses are added where the run has none of its own;
/// with them comes the torque of the engine.
pub(crate) fn peaks(trace: &Trace, pulses: Option<(&Pulses, &[f64])>, firing: &Firing) -> [Peak; 8] {
    let shaft = shaft(trace, pulses);
    let magnitude = |values: &[f64]| peak(trace, values.iter().map(|value| value.abs()));
    let speeds = [magnitude(&trace.dyno_speed_rad_s), magnitude(&trace.engine_speed_rad_s)];
    let speed = if speeds[1].value > speeds[0].value { speeds[1] } else { speeds[0] };
    let power = trace.dyno_demand_nm.iter().zip(&trace.dyno_speed_rad_s).map(|(torque, speed)| (torque * speed).abs());
    [
        shaft.0,
        shaft.1,
        magnitude(&trace.dyno_demand_nm),
        change(trace, &trace.dyno_demand_nm, TORQUE_CHANGE_S),
        speed,
        change(trace, &trace.dyno_speed_rad_s, SPEED_CHANGE_S),
        peak(trace, power),
        longest_at_resonance(trace, firing),
    ]
}

/// A run that grows without bound reaches every limit at once.
pub(crate) fn unbounded() -> [Peak; 8] {
    [Peak { value: f64::INFINITY, time_s: 0.0 }; 8]
}

fn shaft(trace: &Trace, pulses: Option<(&Pulses, &[f64])>) -> (Peak, Peak) {
    let none = Peak { value: 0.0, time_s: trace.start_s };
    let (mut torque, mut slew) = (none, none);
    let mut before = trace.shaft_torque_nm.first().copied().unwrap_or(0.0);
    for (k, now) in trace.shaft_torque_nm.iter().copied().enumerate() {
        let (high, low, of_pulses) = match pulses {
            Some((pulses, engine_nm)) => pulses.around(now, engine_nm[k], trace.engine_speed_rad_s[k]),
            None => (now, now, 0.0),
        };
        let reach = Peak { value: high.abs().max(low.abs()), time_s: trace.time_s(k) };
        let slope = Peak { value: (now - before).abs() / trace.step_s + of_pulses, time_s: trace.time_s(k) };
        torque = if reach.value > torque.value { reach } else { torque };
        slew = if slope.value > slew.value { slope } else { slew };
        before = now;
    }
    (torque, slew)
}

/// The largest of some magnitudes.
fn peak(trace: &Trace, values: impl Iterator<Item = f64>) -> Peak {
    let largest = values.enumerate().fold((0, 0.0), |most, one| if one.1 > most.1 { one } else { most });
    Peak { value: largest.1, time_s: trace.time_s(largest.0) }
}

/// The largest change within a time, over that time.
fn change(trace: &Trace, values: &[f64], within_s: f64) -> Peak {
    let apart = ((within_s / trace.step_s).round() as usize).max(1);
    let over_s = apart as f64 * trace.step_s;
    let of = |apart: usize| {
        let pairs = values.iter().zip(values.iter().skip(apart));
        peak(trace, pairs.map(|(before, after)| (after - before).abs() / over_s))
    };
    // A step within the time counts as one over all of it.
    [of(1), of(apart)]
        .into_iter()
        .fold(Peak { value: 0.0, time_s: trace.start_s }, |most, one| if one.value > most.value { one } else { most })
}

fn longest_at_resonance(trace: &Trace, firing: &Firing) -> Peak {
    let is_near = |speed: f64| {
        let firing_hz = speed.abs() * firing.firings_per_turn / TAU;
        (firing_hz - firing.resonance_hz).abs() <= RESONANCE_BAND * firing.resonance_hz
    };
    let (mut longest, mut stay) = (Peak { value: 0.0, time_s: trace.start_s }, 0);
    for (k, speed) in trace.engine_speed_rad_s.iter().enumerate() {
        stay = if is_near(*speed) { stay + 1 } else { 0 };
        let value = f64::from(stay) * trace.step_s;
        if value > longest.value {
            longest = Peak { value, time_s: trace.time_s(k) };
        }
    }
    longest
}
