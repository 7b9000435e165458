//! Quantities that are compared with the limits of a bench.

use design::safety::{AtResonance, SPEED_CHANGE_S};
use numerics::null::nan_if_null;
use rig::bench_file::{DriveHeat, Limits};
use serde::{Deserialize, Serialize};

use crate::added::Added;
use crate::trace::Trace;

/// Changes of T_d* count over this time, s: an automation system demands as often.
pub(crate) const TORQUE_CHANGE_S: f64 = 0.01;

/// A quantity with a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// Its magnitude, SI.
    #[serde(deserialize_with = "nan_if_null")]
    pub value: f64,
    /// When, s.
    #[serde(deserialize_with = "nan_if_null")]
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

    /// Limits with another one of this quantity, SI. The heat of the drive has none but 1, and stays.
    #[must_use]
    pub fn with(self, limits: Limits, limit: Option<f64>) -> Limits {
        let mut other = limits;
        match self {
            LimitOf::ShaftTorque => other.shaft_torque_nm = limit,
            LimitOf::ShaftTorqueSlew => other.shaft_torque_slew_nm_per_s = limit,
            LimitOf::TorqueDemand => other.torque_nm = limit,
            LimitOf::TorqueSlew => other.torque_slew_nm_per_s = limit,
            LimitOf::Speed => other.speed_rad_s = limit,
            LimitOf::SpeedGradient => other.speed_gradient_rad_s2 = limit,
            LimitOf::Power => other.power_w = limit,
            LimitOf::TimeAtResonance => other.time_at_resonance_s = limit,
            LimitOf::DriveHeat => {}
        }
        other
    }
}

/// The drive's own limits, whatever the limits by which a run is judged.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drive {
    /// The controller demands no more, Nm.
    pub(crate) torque_limit_nm: Option<f64>,
    pub(crate) heat: Option<DriveHeat>,
}

/// The peaks of a run, by the place of each quantity in [`LimitOf::ALL`]. A run that has no pulses of its own comes
/// with what they add to each of its values; another one with an empty slice.
pub(crate) fn peaks(trace: &Trace, added: &[Added], near: &AtResonance<'_>, drive: &Drive) -> [Peak; LimitOf::COUNT] {
    LimitOf::ALL.map(|of| match of {
        LimitOf::TimeAtResonance => longest_at_resonance(trace, near),
        of => peak(trace, course(of, trace, added, drive).into_iter()),
    })
}

/// The magnitudes of a run that are compared with a limit, with what pulses add; none of a stay at the resonance.
pub(crate) fn course(of: LimitOf, trace: &Trace, added: &[Added], drive: &Drive) -> Vec<f64> {
    let (demand, dyno, shaft) = (&trace.dyno_demand_nm, &trace.dyno_speed_rad_s, &trace.shaft_torque_nm);
    let of_pulses = |k: usize| added.get(k).copied().unwrap_or_default();
    let demanded = |k: usize| demanded_nm(demand[k], &of_pulses(k), drive);
    let along = |values: &[f64], value: &dyn Fn(usize) -> f64| (0..values.len()).map(value).collect();
    match of {
        LimitOf::ShaftTorque => {
            along(shaft, &|k| (shaft[k] + of_pulses(k).shaft_above_nm).max(of_pulses(k).shaft_below_nm - shaft[k]))
        }
        LimitOf::ShaftTorqueSlew => along(shaft, &|k| {
            (shaft[k] - shaft[k.saturating_sub(1)]).abs() / trace.step_s + of_pulses(k).shaft_slew_nm_per_s
        }),
        LimitOf::TorqueDemand => along(demand, &demanded),
        LimitOf::TorqueSlew => changes(trace, demand, TORQUE_CHANGE_S, &|k| of_pulses(k).demand_slew_nm_per_s),
        LimitOf::Speed => along(dyno, &|k| {
            let of_dyno = dyno[k].abs() + of_pulses(k).dyno_speed_rad_s;
            let engine = trace.engine_speed_rad_s.get(k);
            engine.map_or(of_dyno, |speed| of_dyno.max(speed.abs() + of_pulses(k).engine_speed_rad_s))
        }),
        LimitOf::SpeedGradient => changes(trace, dyno, SPEED_CHANGE_S, &|k| of_pulses(k).speed_gradient_rad_s2),
        LimitOf::Power => along(demand, &|k| demanded(k) * (dyno[k].abs() + of_pulses(k).dyno_speed_rad_s)),
        LimitOf::TimeAtResonance => Vec::new(),
        LimitOf::DriveHeat => heats(trace, drive, &|k| of_pulses(k).demand_rms_nm),
    }
}

/// |T_d*| with its pulses, which the controller's own limit holds as it does the rest.
fn demanded_nm(demand_nm: f64, added: &Added, drive: &Drive) -> f64 {
    let with_pulses = demand_nm.abs() + added.demand_nm;
    drive.torque_limit_nm.map_or(with_pulses, |limit| with_pulses.min(limit.max(demand_nm.abs())))
}

/// A run that grows without bound reaches every limit at once.
pub(crate) fn unbounded() -> [Peak; LimitOf::COUNT] {
    [Peak { value: f64::INFINITY, time_s: 0.0 }; LimitOf::COUNT]
}

/// The largest of some magnitudes.
fn peak(trace: &Trace, values: impl Iterator<Item = f64>) -> Peak {
    let largest = values.enumerate().fold((0, 0.0), |most, one| if one.1 > most.1 { one } else { most });
    Peak { value: largest.1, time_s: trace.time_s(largest.0) }
}

/// The largest change within a time from each value on, over that time, with what pulses add to it: a step within it
/// counts as one over all of it.
fn changes(trace: &Trace, values: &[f64], within_s: f64, added: &dyn Fn(usize) -> f64) -> Vec<f64> {
    let apart = ((within_s / trace.step_s).round() as usize).max(1);
    let over_s = apart as f64 * trace.step_s;
    let from = |k: usize| {
        let later = values[k..].iter().take(apart + 1);
        later.fold(0.0, |most: f64, value| most.max((value - values[k]).abs())) / over_s + added(k)
    };
    (0..values.len()).map(from).collect()
}

fn longest_at_resonance(trace: &Trace, near: &AtResonance<'_>) -> Peak {
    let (stay, place) = near.longest_stay(&trace.engine_speed_rad_s);
    Peak { value: stay as f64 * trace.step_s, time_s: trace.time_s(place) }
}

/// The heat of the drive: τ dθ/dt = (T/T_c)² − θ, T the torque demand, held from value to value, from rest at the first
/// one; T² with the mean square of the pulses.
fn heats(trace: &Trace, drive: &Drive, pulses_rms_nm: &dyn Fn(usize) -> f64) -> Vec<f64> {
    let Some(drive) = drive.heat else { return Vec::new() };
    let stays = (-trace.step_s / drive.time_constant_s).exp();
    let towards = |(k, torque_nm): (usize, &f64)| {
        (torque_nm * torque_nm + pulses_rms_nm(k).powi(2)) / drive.continuous_torque_nm.powi(2)
    };
    let mut now = trace.dyno_demand_nm.first().map_or(0.0, |first| towards((0, first)));
    let heats = trace.dyno_demand_nm.iter().enumerate().map(|one| {
        let before = now;
        now = towards(one) + (now - towards(one)) * stays;
        before
    });
    heats.collect()
}
