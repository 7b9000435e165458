//! Check that the engine fires as often as its cylinders and strokes in the bench file say, and as its speed says.
//!
//! The torque of the engine repeats with each working cycle, and but for differences between the cylinders with each
//! firing: of its multiples of half the speed, those of the firing frequency are the strong ones. What an order of N_e
//! is as an acceleration is that order of the torque over J_e, above the resonance.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use numerics::parallel::map;
use rig::{Experiment, Finding, Role, Severity};
use signal::{Complex64, Signal};

use crate::findings::Findings;

/// Orders of a working cycle of four strokes, up to that of 24 cylinders; the order of the turns itself, which encoders
/// and imbalance show too, is left out.
const STEP: f64 = 0.5;
const HIGHEST: usize = 24;
/// A working cycle, rad: all orders are multiples of one a cycle.
const CYCLE_RAD: f64 = 2.0 * TAU;
/// Firings a turn of engines of 3 to 12 cylinders, and of one or two.
const ENGINES: [f64; 9] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0];
/// An order is seen below this part of the sample rate.
pub(super) const SEEN: f64 = 0.45;
/// The slow course of the speed is its mean over this, taken twice, s.
const TREND_S: f64 = 0.25;
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
/// So much of a recording is searched, s.
const SEARCHED_S: f64 = 30.0;
/// Orders of what turns, such as an encoder off its centre.
const OF_THE_TURNS: [f64; 2] = [1.0, 2.0];
/// An order this near to one of those, as a part of it, may be theirs.
const NEAR_THE_TURNS: f64 = 0.01;
/// Smallest amplitude of the firing order, as a part of the speed: an engine that does not fire has less.
const LEAST: f64 = 2e-4;

/// Doubts the stated engine where most recordings show another, else the recordings that do; and where pulses do not
/// come as often as the speed says, the recording. Answers with how often they come, where that is seen.
pub(super) fn doubt(findings: &mut Findings<'_>) -> Vec<(String, f64)> {
    let stated = findings.bench.engine().firings_per_turn();
    let experiments = findings.experiments;
    let with_shaft: Vec<&Experiment> = experiments.iter().filter(|e| !e.label.is_without_shaft()).collect();
    let seen = map(&with_shaft, |one| (contradiction(one, stated), pulses_over_speed(one, stated)));
    let engines = with_shaft.iter().zip(&seen).filter_map(|(one, (engine, _))| Some((*one, (*engine)?)));
    let engines: Vec<(&Experiment, Option<f64>)> = engines.collect();
    let others: Vec<(&Experiment, f64)> = engines.iter().filter_map(|(one, found)| Some((*one, (*found)?))).collect();
    let disagrees = |found: f64| Finding::FiringOrderDisagrees { stated, found };
    match others.first() {
        Some((_, found)) if 2 * others.len() > engines.len() => {
            findings.doubt_bench(Severity::Error, disagrees(*found));
        }
        _ => others.iter().for_each(|(one, found)| findings.doubt(&one.file, Severity::Error, disagrees(*found))),
    }
    let named = |one: &&Experiment| others.iter().any(|(other, _)| other.file == one.file);
    let ratios = with_shaft.iter().zip(&seen).filter_map(|(one, (_, ratio))| Some((*one, (*ratio)?)));
    let ratios: Vec<(&Experiment, f64)> = ratios.filter(|(one, _)| !named(one)).collect();
    for (experiment, ratio) in ratios.iter().filter(|(_, ratio)| (ratio - 1.0).abs() > OFF_PART) {
        findings.doubt(&experiment.file, Severity::Error, Finding::PulsesOffSpeed { ratio: *ratio });
    }
    ratios.into_iter().map(|(experiment, ratio)| (experiment.file.clone(), ratio)).collect()
}

/// How often the pulses of the stated firing order come over what the speed says, by N_e or, where its samples are too
/// few, by N_d; one unless another ratio is far clearer. Nothing where they are not seen.
fn pulses_over_speed(experiment: &Experiment, stated: f64) -> Option<f64> {
    let of = |role| pulses_over(&middle(experiment.signal(role)?), stated);
    of(Role::EngineSpeed).or_else(|| of(Role::DynoSpeed))
}

/// The middle of a long recording: the search grows with the square of its length.
pub(super) fn middle(speed: &Signal) -> Signal {
    let whole_s = speed.len() as f64 * speed.sample_time_s;
    let start_s = speed.start_s + 0.5 * (whole_s - SEARCHED_S).max(0.0);
    speed.slice(start_s, start_s + SEARCHED_S)
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

/// The firings a turn that a recording shows in place of those stated, or none; nothing where the stated order is not
/// to be seen.
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

/// A speed without its slow course, and the angle that it turns.
pub(super) struct Seen {
    samples: Vec<f64>,
    angle: Vec<f64>,
    mean: f64,
}

impl Seen {
    pub(super) fn of(speed: &Signal, mean: f64) -> Self {
        let count = speed.len() as f64;
        let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
        let samples = without_trend(speed).iter().enumerate().map(|(k, x)| window(k) * x).collect();
        Seen { samples, angle: angle(speed), mean }
    }

    /// Over the angle that another speed turns, its mean over a working cycle: pulses in the angle would give multiples
    /// of theirs, by more than pass a soft shaft.
    pub(super) fn over_angle_of(speed: &Signal, other: &Signal, mean: f64) -> Self {
        let half = (0.5 * CYCLE_RAD / (mean * other.sample_time_s)).round() as usize;
        let turned = angle(&Signal { samples: moving_mean(&other.samples, half), ..other.clone() });
        let last = turned.len().saturating_sub(1) as f64;
        let at = |k: usize| {
            let position = ((speed.time_s(k) - other.start_s) / other.sample_time_s).clamp(0.0, last);
            let (before, after) = (turned[position.floor() as usize], turned[position.ceil() as usize]);
            before + position.fract() * (after - before)
        };
        Seen { angle: (0..speed.len()).map(at).collect(), ..Seen::of(speed, mean) }
    }

    /// The angle that it turns, rad.
    pub(super) fn turned(&self) -> f64 {
        self.angle.last().copied().unwrap_or_default()
    }

    /// The power of an order, as an acceleration.
    pub(super) fn power(&self, order: f64) -> f64 {
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (x, angle) in self.samples.iter().zip(&self.angle) {
            let (sine, cosine) = (order * angle).sin_cos();
            real += x * cosine;
            imaginary += x * sine;
        }
        (2.0 / self.samples.len() as f64 * order * self.mean).powi(2) * (real * real + imaginary * imaginary)
    }

    /// The power of so many orders, from the first in steps.
    fn powers(&self, first: f64, step: f64, count: usize) -> Vec<(f64, f64)> {
        let mut sums = vec![Complex64::ZERO; count];
        for (x, angle) in self.samples.iter().zip(&self.angle) {
            let (mut wave, turn) = (x * Complex64::cis(first * angle), Complex64::cis(step * angle));
            for sum in &mut sums {
                *sum += wave;
                wave *= turn;
            }
        }
        let order = |k: usize| first + k as f64 * step;
        let power = |(k, sum): (usize, &Complex64)| {
            (order(k), (2.0 / self.samples.len() as f64 * order(k) * self.mean).powi(2) * sum.norm_sqr())
        };
        sums.iter().enumerate().map(power).collect()
    }

    /// The power of the orders of a working cycle, of which the first is this one.
    fn order_powers(&self, first: f64, highest: f64) -> Vec<(f64, f64)> {
        let is_turns = |k: &usize| *k as f64 * STEP == 1.0;
        let orders = (1..=HIGHEST).filter(|k| !is_turns(k)).map(|k| first * k as f64).filter(|order| *order <= highest);
        orders.map(|order| (order, self.power(order))).collect()
    }
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

    /// The speed of an engine that fires so often a turn, whose cylinders differ a little, with multiples nearly as
    /// strong.
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

    /// Over an angle with the pulses in it, a tenth of the first order came to the second.
    #[test]
    fn regress_strong_pulses_leave_nothing_at_their_multiples() {
        let (omega, sample_time_s) = (110.0, 1e-3);
        let value = |k: usize| omega + 6.0 * (1.5 * omega * k as f64 * sample_time_s).sin();
        let speed = Signal::new(0.0, sample_time_s, (0..20_000).map(value).collect()).unwrap();
        let seen = Seen::over_angle_of(&speed, &speed, omega);
        let part = (seen.power(3.0) / seen.power(1.5)).sqrt();
        assert!(part < 5e-3, "{part}");
        let with_pulses = Seen::of(&speed, omega);
        let part = (with_pulses.power(3.0) / with_pulses.power(1.5)).sqrt();
        assert!(part > 0.05, "{part}");
    }

    #[test]
    fn exact_another_engine_is_named_and_the_right_one_is_not_doubted() {
        for found in [1.0, 1.5, 2.0, 2.5, 3.0, 4.0] {
            let experiment = recorded(found, 2e-3);
            for stated in [0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0] {
                let expected = (stated != found).then_some(found);
                // Cylinders that fire half as often leave every second multiple to the same orders; two show their
                // turns.
                let is_open = stated == 2.0 * found || found == 1.0 || stated == 1.0;
                let answer = contradiction(&experiment, stated).unwrap();
                assert!(answer == expected || is_open && answer.is_none(), "{found}, stated {stated}: {answer:?}");
            }
        }
    }

    #[test]
    fn exact_pulses_date_the_speed() {
        for gain in [0.7, 0.9, 0.99, 1.0, 1.001, 1.01, 1.05, 1.3] {
            let mut experiment = recorded(2.0, 2e-3);
            let speed = experiment.signals.get_mut(&Role::EngineSpeed).unwrap();
            speed.samples.iter_mut().for_each(|x| *x *= gain);
            let found = pulses_over_speed(&experiment, 2.0).unwrap();
            assert!((found * gain - 1.0).abs() < 1.5e-3, "{found} at {gain}");
        }
        assert_eq!(pulses_over_speed(&recorded(3.0, 1e-2), 3.0), None);
    }

    #[test]
    fn exact_an_order_above_the_sampling_is_not_judged() {
        assert_eq!(contradiction(&recorded(3.0, 1e-2), 3.0), None);
    }
}
