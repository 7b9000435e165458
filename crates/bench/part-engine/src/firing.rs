//! Check that the engine fires as often as its cylinders and strokes in the bench file say, and as its speed says.
//!
//! The torque of the engine repeats with each working cycle, and but for differences between the cylinders with each
//! firing: of its multiples of half the speed, those of the firing frequency are the strong ones. What an order of N_e
//! is as an acceleration is that order of the torque over J_e, above the resonance.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use rig::{Experiment, Role};
use signal::Signal;

use crate::orders::{SEEN, STEP, Seen, middle};

/// Firings a turn of engines of 3 to 12 cylinders, and of one or two.
const ENGINES: [f64; 9] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0];
/// The stated engine has more than this part of the power of all orders in its multiples, ...
const STATED_MULTIPLES: f64 = 0.6;
/// ... and more than this part in its firing order itself.
const STATED_ITSELF: f64 = 0.02;
/// The engine found has more than this part in its multiples, ... On 38 recordings of ten simulated benches the right
/// engine has 0.90 and more, the best wrong one 0.50.
const FOUND_MULTIPLES: f64 = 0.85;
/// ... and more than this part in its firing order itself. The right engine has 0.43 and more.
const FOUND_ITSELF: f64 = 0.2;
/// Pulses are looked for between so many times the speed.
const OFF_SPEED: RangeInclusive<f64> = 0.65..=1.45;
/// Pulses are not of this speed beyond this part of it, ...
const OFF_PART: f64 = 0.003;
/// ... where their power is so many times that at the speed itself.
const OFF_POWER: f64 = 10.0;
/// Steps of that search, as a part of what separates two orders over the whole recording.
const STEP_OF_ORDERS: f64 = 0.5;
/// Orders of what turns, such as an encoder off its centre.
const OF_THE_TURNS: [f64; 2] = [1.0, 2.0];
/// An order this near to one of those, as a part of it, may be theirs.
const NEAR_THE_TURNS: f64 = 0.01;
/// Smallest amplitude of the firing order, as a part of the speed: an engine that does not fire has less.
const LEAST: f64 = 2e-4;

/// Findings of a recording on how often the engine fires.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Firing {
    /// The firings a turn that it shows in place of those stated, or none; nothing where the stated order is not to be
    /// seen.
    pub contradiction: Option<Option<f64>>,
    /// How often the pulses of the stated firing order come over what the speed says, by N_e or, where its samples are
    /// too few, by N_d; one unless another ratio is far clearer. Nothing where they are not seen.
    pub pulses_over_speed: Option<f64>,
}

impl Firing {
    /// Looks for the firings a turn that the bench file states.
    pub fn of(experiment: &Experiment, stated: f64) -> Self {
        let contradiction = contradiction(experiment, stated);
        Firing { contradiction, pulses_over_speed: pulses_over_speed(experiment, stated) }
    }

    /// Tells whether the pulses come at another speed than the recorded one.
    pub fn is_off_speed(ratio: f64) -> bool {
        (ratio - 1.0).abs() > OFF_PART
    }
}

fn pulses_over_speed(experiment: &Experiment, stated: f64) -> Option<f64> {
    let of = |role| pulses_over(&middle(experiment.signal(role)?), stated);
    of(Role::EngineSpeed).or_else(|| of(Role::DynoSpeed))
}

fn pulses_over(speed: &Signal, stated: f64) -> Option<f64> {
    let mean = speed.mean()?.abs();
    let highest = SEEN * TAU / (speed.sample_time_s * mean);
    let longest = OFF_SPEED.end().min(highest / stated);
    if stated == 0.0 || longest < 1.0 + OFF_PART {
        return None;
    }
    let seen = Seen::of(speed, mean);
    let step = STEP_OF_ORDERS * TAU / seen.turned();
    let powers =
        seen.powers(OFF_SPEED.start() * stated, step, ((longest - OFF_SPEED.start()) * stated / step) as usize);
    let (order, power) = powers.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let ratio = order / stated;
    let is_of = |turns: &f64| *turns != stated && (order / turns - 1.0).abs() < NEAR_THE_TURNS;
    if OF_THE_TURNS.iter().any(is_of) {
        return None;
    }
    let others: f64 = seen.order_powers(ratio * STEP, highest).iter().map(|(_, power)| power).sum();
    (power > (LEAST * mean * mean).powi(2) && power > FOUND_ITSELF * others)
        .then(|| if power > OFF_POWER * seen.power(stated) { ratio } else { 1.0 })
}

fn contradiction(experiment: &Experiment, stated: f64) -> Option<Option<f64>> {
    let speed = experiment.signal(Role::EngineSpeed)?;
    let mean = speed.mean()?.abs();
    let highest = SEEN * TAU / (speed.sample_time_s * mean);
    if stated > highest {
        return None;
    }
    let powers = Seen::of(speed, mean).order_powers(STEP, highest);
    let all: f64 = powers.iter().map(|(_, power)| power).sum();
    let of = |wanted: &dyn Fn(f64) -> bool| {
        powers.iter().filter(|(order, _)| wanted(*order)).map(|(_, power)| power).sum::<f64>() / all
    };
    let multiples = |firing: f64| of(&|order| (order / firing).fract() == 0.0);
    let itself = |firing: f64| of(&|order| order == firing);
    // The order of the turns is no evidence; two cylinders show its odd multiples too.
    let own = if stated == 1.0 { of(&|order| order % 2.0 == 1.0) } else { itself(stated) };
    let is_stated = stated > 0.0 && multiples(stated) > STATED_MULTIPLES && own > STATED_ITSELF;
    let least = (LEAST * mean * mean).powi(2);
    let is_engine = |firing: &f64| {
        *firing != stated
            && multiples(*firing) > FOUND_MULTIPLES
            && itself(*firing) > FOUND_ITSELF
            && itself(*firing) * all > least
    };
    Some(ENGINES.into_iter().find(is_engine).filter(|_| !is_stated))
}
