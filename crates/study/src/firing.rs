//! Whether the engine fires as often as its cylinders and strokes in the bench file say, and as its speed says.
//!
//! The torque of the engine repeats with each working cycle, and but for differences between the cylinders with each firing: of its
//! multiples of half the speed, those of the firing frequency are the strong ones. What an order of N_e is as an acceleration is
//! that order of the torque over J_e, above the resonance.

use std::f64::consts::TAU;

use rig::{Experiment, Finding, Role};
use signal::Signal;

use crate::findings::Findings;

/// Orders of a working cycle of four strokes, up to that of 24 cylinders; the order of the turns itself, which encoders and imbalance
/// show too, is left out.
const STEP: f64 = 0.5;
const HIGHEST: usize = 24;
/// Firings a turn of engines of 3 to 12 cylinders, and of one or two.
const ENGINES: [f64; 9] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0];
/// An order is seen below this part of the sample rate.
const SEEN: f64 = 0.45;
/// The slow course of the speed is its mean over this, taken twice, s.
const TREND_S: f64 = 0.25;
/// Parts of the power of all orders: the stated engine has less than the first in its multiples, or less than the second in its firing
/// order itself; the engine found has more than the third and the fourth. On 38 recordings of ten simulated benches the right engine
/// has 0.90 and more, and 0.43 and more in its firing order; the best wrong one has 0.50.
const STATED: (f64, f64) = (0.6, 0.02);
const FOUND: (f64, f64) = (0.85, 0.2);
/// Pulses are looked for at so many times the speed about its own, in steps; beyond so many steps, where their power is so many times
/// that at the speed itself, they are not of this speed.
const OFF_SPEED: (f64, f64) = (0.02, 5e-4);
const OFF: (f64, f64) = (0.003, 10.0);
/// Smallest amplitude of the firing order, as a part of the speed: an engine that does not fire has less.
const LEAST: f64 = 2e-4;

/// Doubts the stated engine, and the speed, where most recordings show another.
pub(super) fn doubt(findings: &mut Findings<'_>) {
    let stated = findings.bench.engine().firings_per_turn();
    doubt_speed(findings, stated);
    let experiments = findings.experiments;
    let with_shaft = experiments.iter().filter(|e| !e.label.is_without_shaft());
    let seen: Vec<(&str, Option<f64>)> =
        with_shaft.filter_map(|e| Some((e.file.as_str(), contradiction(e, stated)?))).collect();
    let against: Vec<(&str, f64)> = seen.iter().filter_map(|(file, found)| Some((*file, (*found)?))).collect();
    let Some((file, found)) = against.first().copied() else { return };
    if 2 * against.len() > seen.len() {
        let finding = Finding::FiringOrderDisagrees { stated, found };
        findings.doubt_channel(file, Role::EngineSpeed, finding);
    }
}

/// Doubts the speed where in most recordings the pulses do not come as often as it says.
fn doubt_speed(findings: &mut Findings<'_>, stated: f64) {
    let experiments = findings.experiments;
    let with_shaft = experiments.iter().filter(|e| !e.label.is_without_shaft());
    let seen: Vec<(&str, f64)> =
        with_shaft.filter_map(|e| Some((e.file.as_str(), pulses_over_speed(e, stated)?))).collect();
    let off: Vec<&(&str, f64)> = seen.iter().filter(|(_, ratio)| (ratio - 1.0).abs() > OFF.0).collect();
    if let Some((file, ratio)) = off.first().filter(|_| 2 * off.len() > seen.len()) {
        findings.doubt_channel(file, Role::EngineSpeed, Finding::PulsesOffSpeed { ratio: *ratio });
    }
}

/// How often the pulses of the stated firing order come over what the speed says; one unless another ratio is far clearer. Nothing
/// where they are not seen.
fn pulses_over_speed(experiment: &Experiment, stated: f64) -> Option<f64> {
    let speed = experiment.signal(Role::EngineSpeed)?;
    let mean = speed.mean()?.abs();
    let highest = SEEN * TAU / (speed.sample_time_s * mean);
    if stated == 0.0 || stated * (1.0 + OFF_SPEED.0) > highest {
        return None;
    }
    let seen = Seen::of(speed, mean);
    let steps = (OFF_SPEED.0 / OFF_SPEED.1).round() as i32;
    let tried = (-steps..=steps).map(|k| 1.0 + f64::from(k) * OFF_SPEED.1);
    let powers = tried.map(|ratio| (ratio, seen.power(stated * ratio)));
    let (ratio, power) = powers.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let others: f64 = order_powers(speed, mean, highest).iter().map(|(_, power)| power).sum();
    (power > (LEAST * mean * mean).powi(2) && power > FOUND.1 * others)
        .then(|| if power > OFF.1 * seen.power(stated) { ratio } else { 1.0 })
}

/// The firings a turn that a recording shows in place of those stated, or none; nothing where the stated order is not to be seen.
fn contradiction(experiment: &Experiment, stated: f64) -> Option<Option<f64>> {
    let speed = experiment.signal(Role::EngineSpeed)?;
    let mean = speed.mean()?.abs();
    let highest = SEEN * TAU / (speed.sample_time_s * mean);
    if stated > highest {
        return None;
    }
    let powers = order_powers(speed, mean, highest);
    let all: f64 = powers.iter().map(|(_, power)| power).sum();
    let of = |wanted: &dyn Fn(f64) -> bool| {
        powers.iter().filter(|(order, _)| wanted(*order)).map(|(_, power)| power).sum::<f64>() / all
    };
    let multiples = |firing: f64| of(&|order| (order / firing).fract() == 0.0);
    let itself = |firing: f64| of(&|order| order == firing);
    // The order of the turns is no evidence; two cylinders show its odd multiples too.
    let own = if stated == 1.0 { of(&|order| order % 2.0 == 1.0) } else { itself(stated) };
    let is_stated = stated > 0.0 && multiples(stated) > STATED.0 && own > STATED.1;
    let least = (LEAST * mean * mean).powi(2);
    let is_engine = |firing: &f64| {
        *firing != stated && multiples(*firing) > FOUND.0 && itself(*firing) > FOUND.1 && itself(*firing) * all > least
    };
    Some(ENGINES.into_iter().find(is_engine).filter(|_| !is_stated))
}

/// A speed without its slow course, and the angle that it turns.
struct Seen {
    samples: Vec<f64>,
    angle: Vec<f64>,
    mean: f64,
}

impl Seen {
    fn of(speed: &Signal, mean: f64) -> Self {
        let count = speed.len() as f64;
        let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
        let samples = without_trend(speed).iter().enumerate().map(|(k, x)| window(k) * x).collect();
        Seen { samples, angle: angle(speed), mean }
    }

    /// The power of an order, as an acceleration.
    fn power(&self, order: f64) -> f64 {
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (x, angle) in self.samples.iter().zip(&self.angle) {
            let (sine, cosine) = (order * angle).sin_cos();
            real += x * cosine;
            imaginary += x * sine;
        }
        (2.0 / self.samples.len() as f64 * order * self.mean).powi(2) * (real * real + imaginary * imaginary)
    }
}

/// The power of each order of a speed.
fn order_powers(speed: &Signal, mean: f64, highest: f64) -> Vec<(f64, f64)> {
    let seen = Seen::of(speed, mean);
    let orders = (1..=HIGHEST).map(|k| STEP * k as f64).filter(|order| *order != 1.0 && *order <= highest);
    orders.map(|order| (order, seen.power(order))).collect()
}

/// The crank angle at each sample, rad: the speed is straight between samples.
fn angle(speed: &Signal) -> Vec<f64> {
    let mut angle = 0.0;
    let mut before = speed.samples.first().copied().unwrap_or_default();
    let turned = |omega: &f64| {
        angle += 0.5 * speed.sample_time_s * (omega + before);
        before = *omega;
        angle
    };
    speed.samples.iter().map(turned).collect()
}

fn without_trend(speed: &Signal) -> Vec<f64> {
    let half = (0.5 * TREND_S / speed.sample_time_s).round() as usize;
    let trend = moving_mean(&moving_mean(&speed.samples, half), half);
    speed.samples.iter().zip(trend).map(|(x, trend)| x - trend).collect()
}

fn moving_mean(samples: &[f64], half: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    samples.iter().for_each(|x| sums.push(sums[sums.len() - 1] + x));
    let mean = |k: usize| {
        let (from, to) = (k.saturating_sub(half), (k + half + 1).min(samples.len()));
        (sums[to] - sums[from]) / (to - from) as f64
    };
    (0..samples.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use rig::ExperimentLabel;
    use signal::excitation::Random;

    use super::*;

    /// The speed of an engine that fires so often a turn, whose cylinders differ a little, with multiples nearly as strong.
    fn recorded(firing: f64, sample_time_s: f64) -> Experiment {
        let mut random = Random::new(7);
        let omega = 130.0;
        let value = |k: usize| {
            let angle = omega * k as f64 * sample_time_s;
            let order = |order: f64, amplitude: f64| amplitude / order * (order * angle).sin();
            let of_firing = order(firing, 1.0) + order(2.0 * firing, 0.8) + order(3.0 * firing, 0.5);
            let orders = of_firing + order(0.5, 0.05) + order(1.0, 0.3);
            omega + orders + 0.01 * random.normal()
        };
        let speed = Signal::new(0.0, sample_time_s, (0..8000).map(value).collect()).unwrap();
        let signals = BTreeMap::from([(Role::EngineSpeed, speed)]);
        Experiment { file: "x".to_owned(), label: ExperimentLabel::BS_T_NT, signals }
    }

    #[test]
    fn exact_another_engine_is_named_and_the_right_one_is_not_doubted() {
        for found in [1.0, 1.5, 2.0, 2.5, 3.0, 4.0] {
            let experiment = recorded(found, 2e-3);
            for stated in [0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0] {
                let expected = (stated != found).then_some(found);
                // Cylinders that fire half as often leave every second multiple to the same orders; two show their turns.
                let is_open = stated == 2.0 * found || found == 1.0 || stated == 1.0;
                let answer = contradiction(&experiment, stated).unwrap();
                assert!(answer == expected || is_open && answer.is_none(), "{found}, stated {stated}: {answer:?}");
            }
        }
    }

    #[test]
    fn exact_pulses_date_the_speed() {
        for gain in [0.99, 1.0, 1.001, 1.01] {
            let mut experiment = recorded(2.0, 2e-3);
            let speed = experiment.signals.get_mut(&Role::EngineSpeed).unwrap();
            speed.samples.iter_mut().for_each(|x| *x *= gain);
            let found = pulses_over_speed(&experiment, 2.0).unwrap();
            assert!((found * gain - 1.0).abs() < 1e-3 + OFF_SPEED.1, "{found} at {gain}");
        }
        assert_eq!(pulses_over_speed(&recorded(3.0, 1e-2), 3.0), None);
    }

    #[test]
    fn exact_an_order_above_the_sampling_is_not_judged() {
        assert_eq!(contradiction(&recorded(3.0, 1e-2), 3.0), None);
    }
}
