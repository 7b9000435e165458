//! Quantities that are compared with limits.

use bench_model::model::BenchModel;
use bench_model::prediction::{Prediction, PredictionInputs};
use rig::bench_file::Limits;
use rig::experiment::ExperimentPlan;
use serde::{Deserialize, Serialize};

use super::course::{AtResonance, largest_change};
use super::ladder::demand_samples;

/// Changes of the speed count over this time, s.
pub const SPEED_CHANGE_S: f64 = 0.05;

/// A number of a run that matters for safety.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Largest |T_shaft|, Nm.
    ShaftTorque,
    /// Largest |dT_shaft/dt|, Nm/s, from one sample to the next.
    ShaftTorqueSlew,
    /// Largest |T_d*|, Nm, held by the torque limit.
    TorqueDemand,
    /// Largest change of T_d* within 10 ms over that time, Nm/s: how often it is updated does not matter.
    TorqueSlew,
    /// Largest |N_d| or |N_e|, rad/s.
    Speed,
    /// Largest change of N_d within 50 ms over that time, rad/s².
    SpeedGradient,
    /// Largest |T_d* N_d|, W.
    Power,
    /// Longest stay, s, during which the firing frequency, or the sine of a sine test, lies within 10 % of the
    /// resonance.
    TimeAtResonance,
    /// Lowest |N_d| or |N_e|, rad/s; no limit.
    LowestSpeed,
    /// Share of the time at which T_d* rests at the torque limit, 0 … 1; no limit.
    LimitedShare,
}

impl Quantity {
    /// How many there are.
    pub(super) const COUNT: usize = 10;

    /// Those that a plan has.
    pub(super) fn of_plan(plan: &ExperimentPlan) -> &'static [Quantity] {
        use Quantity::{
            LimitedShare, LowestSpeed, Power, ShaftTorque, ShaftTorqueSlew, Speed, SpeedGradient, TimeAtResonance,
            TorqueDemand, TorqueSlew,
        };
        match plan.has_shaft {
            true => &[
                ShaftTorque,
                ShaftTorqueSlew,
                TorqueDemand,
                TorqueSlew,
                Speed,
                SpeedGradient,
                Power,
                TimeAtResonance,
                LowestSpeed,
                LimitedShare,
            ],
            false => &[TorqueDemand, TorqueSlew, Speed, SpeedGradient, Power, LowestSpeed, LimitedShare],
        }
    }

    /// The limit that bears on it.
    pub(super) fn limit(self, limits: &Limits) -> Option<f64> {
        match self {
            Quantity::ShaftTorque => limits.shaft_torque_nm,
            Quantity::ShaftTorqueSlew => limits.shaft_torque_slew_nm_per_s,
            Quantity::TorqueDemand => limits.torque_nm,
            Quantity::TorqueSlew => limits.torque_slew_nm_per_s,
            Quantity::Speed => limits.speed_rad_s,
            Quantity::SpeedGradient => limits.speed_gradient_rad_s2,
            Quantity::Power => limits.power_w,
            Quantity::TimeAtResonance => limits.time_at_resonance_s,
            Quantity::LowestSpeed | Quantity::LimitedShare => None,
        }
    }

    /// Tells whether a limit of it could be stated.
    pub fn has_limit(self) -> bool {
        !matches!(self, Quantity::LowestSpeed | Quantity::LimitedShare)
    }

    /// Tells whether one value is worse than another.
    pub(super) fn is_worse(self, value: f64, than: f64) -> bool {
        if self == Quantity::LowestSpeed { value < than } else { value > than }
    }
}

/// Tells whether a value reaches a limit; nothing at all reaches none.
pub fn reaches(value: f64, limit: f64) -> bool {
    value >= limit && value > 0.0
}

/// The quantities of a run, by [`Quantity`].
pub(super) fn values(
    inputs: &PredictionInputs<'_>,
    bench: &BenchModel,
    prediction: &Prediction,
) -> [f64; Quantity::COUNT] {
    let (response, step_s) = (&prediction.response, prediction.sample_time_s);
    let engine_speed: &[f64] = if prediction.has_shaft { &response.engine_speed_rad_s } else { &[] };
    let speeds = || response.dyno_speed_rad_s.iter().chain(engine_speed).map(|speed| speed.abs());
    let mut values = [0.0; Quantity::COUNT];
    let mut set = |of: Quantity, value: f64| values[of as usize] = value;
    set(Quantity::ShaftTorque, largest(&response.shaft_torque_nm));
    set(Quantity::ShaftTorqueSlew, slew(&response.shaft_torque_nm, 1, step_s));
    set(Quantity::TorqueDemand, largest(&response.torque_demand_nm));
    set(Quantity::TorqueSlew, slew(&response.torque_demand_nm, demand_samples(step_s), step_s));
    set(Quantity::Speed, speeds().fold(0.0, f64::max));
    set(Quantity::SpeedGradient, slew(&response.dyno_speed_rad_s, speed_samples(step_s), step_s));
    let power = response.torque_demand_nm.iter().zip(&response.dyno_speed_rad_s).map(|(torque, speed)| torque * speed);
    set(Quantity::Power, power.fold(0.0, |most: f64, power| most.max(power.abs())));
    set(Quantity::LowestSpeed, speeds().fold(f64::INFINITY, f64::min));
    set(Quantity::LimitedShare, response.limited_share);
    if prediction.has_shaft {
        let near = AtResonance::of(&bench.mechanics, inputs.engine, Some(inputs.plan));
        set(Quantity::TimeAtResonance, near.longest_stay(engine_speed).0 as f64 * step_s);
    }
    values
}

/// Samples over which changes of the speed count.
pub(super) fn speed_samples(step_s: f64) -> usize {
    ((SPEED_CHANGE_S / step_s).round() as usize).max(1)
}

/// The values of a bench that is not stable.
pub(super) fn unbounded() -> [f64; Quantity::COUNT] {
    let mut values = [f64::INFINITY; Quantity::COUNT];
    values[Quantity::LowestSpeed as usize] = 0.0;
    values[Quantity::LimitedShare as usize] = 1.0;
    values[Quantity::TimeAtResonance as usize] = 0.0;
    values
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

/// The largest change between values at most `apart` samples from each other, over the time of `apart`, per s.
pub(super) fn slew(values: &[f64], apart: usize, step_s: f64) -> f64 {
    largest_change(values, apart).0 / (apart as f64 * step_s)
}
