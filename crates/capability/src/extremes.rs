//! What is compared with the limits of a bench.

use design::safety::{AtResonance, largest_change};
use numerics::order::largest_of_pairs;
use rig::bench_file::Limits;
use serde::Serialize;

use crate::pulses::Pulses;
use crate::trace::Trace;

/// Changes of T_d* count over this time, s: an automation system demands as often.
const TORQUE_CHANGE_S: f64 = 0.01;
/// Changes of the speed count over this time, s.
const SPEED_CHANGE_S: f64 = 0.05;

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
    /// Longest stay of the firing frequency, or of the sine of a sine test, near the resonance, s.
    TimeAtResonance,
    /// I²t of the drive, where it is stated: its heat as a part of that of the continuous torque.
    DriveHeat,
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
    /// How many there are.
    pub(crate) const COUNT: usize = 9;

    /// Every quantity.
    pub const ALL: [LimitOf; LimitOf::COUNT] = [
        LimitOf::ShaftTorque,
        LimitOf::ShaftTorqueSlew,
        LimitOf::TorqueDemand,
        LimitOf::TorqueSlew,
        LimitOf::Speed,
        LimitOf::SpeedGradient,
        LimitOf::Power,
        LimitOf::TimeAtResonance,
        LimitOf::DriveHeat,
    ];

    /// Those that a test has, with a shaft or without; the heat of the drive only where its limit is stated.
    pub fn of_test(has_shaft: bool, limits: &Limits) -> impl Iterator<Item = LimitOf> {
        let of_shaft = [LimitOf::ShaftTorque, LimitOf::ShaftTorqueSlew, LimitOf::TimeAtResonance];
        let has_heat = limits.drive_heat.is_some();
        let is_in = move |of: &LimitOf| match of {
            LimitOf::DriveHeat => has_heat,
            of => has_shaft || !of_shaft.contains(of),
        };
        LimitOf::ALL.into_iter().filter(is_in)
    }

    /// Those that a map counts: it does not know how long a test stays anywhere.
    pub fn of_map(limits: &Limits) -> impl Iterator<Item = LimitOf> {
        LimitOf::of_test(true, limits).filter(|of| *of != LimitOf::TimeAtResonance)
    }

    /// Its key in the table `[limits]` of a bench file.
    pub fn key(self) -> &'static str {
        match self {
            LimitOf::ShaftTorque => "shaft_torque",
            LimitOf::ShaftTorqueSlew => "shaft_torque_slew",
            LimitOf::TorqueDemand => "torque",
            LimitOf::TorqueSlew => "torque_slew",
            LimitOf::Speed => "speed",
            LimitOf::SpeedGradient => "speed_gradient",
            LimitOf::Power => "power",
            LimitOf::TimeAtResonance => "time_at_resonance",
            LimitOf::DriveHeat => "continuous_torque",
        }
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
            LimitOf::DriveHeat => limits.drive_heat.map(|_| 1.0),
        }
    }
}

/// The peaks of a run, by the place of each quantity in [`LimitOf::ALL`]. Pulses are added where the run has none of its own;
/// with them comes the torque of the engine.
pub(crate) fn peaks(
    trace: &Trace,
    pulses: Option<(&Pulses, &[f64])>,
    near: &AtResonance<'_>,
    limits: &Limits,
) -> [Peak; LimitOf::COUNT] {
    let shaft = shaft(trace, pulses);
    LimitOf::ALL.map(|of| {
        let of_shaft = if of == LimitOf::ShaftTorque { shaft.0 } else { shaft.1 };
        of_course(of, trace, near, limits).unwrap_or(of_shaft)
    })
}

/// The peak of a quantity that the pulses do not move; `None` of the others.
pub(crate) fn of_course(of: LimitOf, trace: &Trace, near: &AtResonance<'_>, limits: &Limits) -> Option<Peak> {
    let product = |a: &[f64], b: &[f64]| {
        let (value, place) = largest_of_pairs(a, b, |a, b| (a * b).abs());
        Peak { value, time_s: trace.time_s(place) }
    };
    let magnitude = |values: &[f64]| {
        let (value, place) = largest_of_pairs(values, values, |value, _| value.abs());
        Peak { value, time_s: trace.time_s(place) }
    };
    Some(match of {
        LimitOf::ShaftTorque | LimitOf::ShaftTorqueSlew => return None,
        LimitOf::TorqueDemand => magnitude(&trace.dyno_demand_nm),
        LimitOf::TorqueSlew => change(trace, &trace.dyno_demand_nm, TORQUE_CHANGE_S),
        LimitOf::Speed => {
            let speeds = [magnitude(&trace.dyno_speed_rad_s), magnitude(&trace.engine_speed_rad_s)];
            if speeds[1].value > speeds[0].value { speeds[1] } else { speeds[0] }
        }
        LimitOf::SpeedGradient => change(trace, &trace.dyno_speed_rad_s, SPEED_CHANGE_S),
        LimitOf::Power => product(&trace.dyno_demand_nm, &trace.dyno_speed_rad_s),
        LimitOf::TimeAtResonance => longest_at_resonance(trace, near),
        LimitOf::DriveHeat => heat(trace, limits),
    })
}

/// A run that grows without bound reaches every limit at once.
pub(crate) fn unbounded() -> [Peak; LimitOf::COUNT] {
    [Peak { value: f64::INFINITY, time_s: 0.0 }; LimitOf::COUNT]
}

/// The peaks of T_shaft and of its slope.
pub(crate) fn shaft(trace: &Trace, pulses: Option<(&Pulses, &[f64])>) -> (Peak, Peak) {
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

/// The largest change within a time, over that time: a step within it counts as one over all of it.
fn change(trace: &Trace, values: &[f64], within_s: f64) -> Peak {
    let apart = ((within_s / trace.step_s).round() as usize).max(1);
    let (change, place) = largest_change(values, apart);
    Peak { value: change / (apart as f64 * trace.step_s), time_s: trace.time_s(place) }
}

fn longest_at_resonance(trace: &Trace, near: &AtResonance<'_>) -> Peak {
    let (stay, place) = near.longest_stay(&trace.engine_speed_rad_s);
    Peak { value: stay as f64 * trace.step_s, time_s: trace.time_s(place) }
}

/// The largest heat of the drive: τ dθ/dt = (T/T_c)² − θ, T the torque demand, held from value to value, from rest at the first one.
fn heat(trace: &Trace, limits: &Limits) -> Peak {
    let Some(drive) = limits.drive_heat else { return Peak { value: 0.0, time_s: trace.start_s } };
    let stays = (-trace.step_s / drive.time_constant_s).exp();
    let towards = |torque_nm: &f64| (torque_nm / drive.continuous_torque_nm).powi(2);
    let mut now = trace.dyno_demand_nm.first().map_or(0.0, towards);
    let heats = trace.dyno_demand_nm.iter().map(|torque_nm| {
        let before = now;
        now = towards(torque_nm) + (now - towards(torque_nm)) * stays;
        before
    });
    peak(trace, heats)
}
