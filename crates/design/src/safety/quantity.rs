//! What is compared with limits.

use std::f64::consts::TAU;

use bench_model::model::BenchModel;
use bench_model::prediction::{Prediction, PredictionInputs};
use rig::bench_file::Limits;
use rig::experiment::ExperimentPlan;
use rig::facts::Engine;
use serde::Serialize;

use super::ladder::{Ladder, demand_samples};

/// Frequencies closer to the resonance than this part of it lie at the resonance.
const RESONANCE_BAND: f64 = 0.1;

/// A number of a run that matters for safety.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
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
    /// Longest stay, s, during which the firing frequency, or the sine of a sine test, lies within 10 % of the resonance.
    TimeAtResonance,
    /// Lowest |N_d| or |N_e|, rad/s; no limit.
    LowestSpeed,
    /// Share of the time at which T_d* rests at the torque limit, 0 … 1; no limit.
    LimitedShare,
}

impl Quantity {
    /// How many there are.
    pub(super) const COUNT: usize = 8;

    /// Those that a plan has.
    pub(super) fn of_plan(plan: &ExperimentPlan) -> &'static [Quantity] {
        use Quantity::{
            LimitedShare, LowestSpeed, ShaftTorque, ShaftTorqueSlew, Speed, TimeAtResonance, TorqueDemand, TorqueSlew,
        };
        match plan.has_shaft {
            true => &[
                ShaftTorque,
                ShaftTorqueSlew,
                TorqueDemand,
                TorqueSlew,
                Speed,
                TimeAtResonance,
                LowestSpeed,
                LimitedShare,
            ],
            false => &[TorqueDemand, TorqueSlew, Speed, LowestSpeed, LimitedShare],
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
            Quantity::TimeAtResonance => limits.time_at_resonance_s,
            Quantity::LowestSpeed | Quantity::LimitedShare => None,
        }
    }

    /// Whether a limit of it could be stated.
    pub fn has_limit(self) -> bool {
        !matches!(self, Quantity::LowestSpeed | Quantity::LimitedShare)
    }

    /// Whether one value is worse than another.
    pub(super) fn is_worse(self, value: f64, than: f64) -> bool {
        if self == Quantity::LowestSpeed { value < than } else { value > than }
    }
}

/// Whether a value reaches a limit; nothing at all reaches none.
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
    set(Quantity::LowestSpeed, speeds().fold(f64::INFINITY, f64::min));
    set(Quantity::LimitedShare, response.limited_share);
    if prediction.has_shaft {
        set(Quantity::TimeAtResonance, longest_at_resonance(inputs, bench, prediction));
    }
    values
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
    let change = |apart: usize| {
        let pairs = values.iter().zip(values.iter().skip(apart));
        pairs.fold(0.0_f64, |most, (before, after)| most.max((after - before).abs()))
    };
    (1..=apart).map(change).fold(0.0, f64::max) / (apart as f64 * step_s)
}

fn longest_at_resonance(inputs: &PredictionInputs<'_>, bench: &BenchModel, prediction: &Prediction) -> f64 {
    let resonance_hz = bench.mechanics.resonance().frequency_hz;
    let is_near = |frequency_hz: f64| (frequency_hz - resonance_hz).abs() <= RESONANCE_BAND * resonance_hz;
    let engine = Engine { cylinders: inputs.engine.cylinder_factors.len() as u32, strokes: inputs.engine.strokes };
    let firing_per_rad = engine.firings_per_turn() / TAU;
    let ladder = Ladder::of(inputs.plan);
    let (mut longest, mut stay) = (0_usize, 0_usize);
    for (k, speed) in prediction.response.engine_speed_rad_s.iter().enumerate() {
        let sine_hz = ladder.as_ref().map(|ladder| ladder.frequencies_hz[ladder.rung(k)]);
        stay = if is_near(speed.abs() * firing_per_rad) || sine_hz.is_some_and(is_near) { stay + 1 } else { 0 };
        longest = longest.max(stay);
    }
    longest as f64 * prediction.sample_time_s
}
