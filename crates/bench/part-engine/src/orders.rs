//! Orders of the engine in a speed, without its slow course.

use std::f64::consts::TAU;

use signal::{Complex64, Signal};

/// Orders of a working cycle of four strokes, up to that of 24 cylinders; the order of the turns itself, which encoders
/// and imbalance show too, is left out.
pub(super) const STEP: f64 = 0.5;
const HIGHEST: usize = 24;
/// A working cycle, rad: all orders are multiples of one a cycle.
const CYCLE_RAD: f64 = 2.0 * TAU;
/// An order is seen below this part of the sample rate.
pub(super) const SEEN: f64 = 0.45;
/// The slow course of the speed is its mean over this, taken twice, s.
const TREND_S: f64 = 0.25;
/// So much of a recording is searched, s.
const SEARCHED_S: f64 = 30.0;

/// The middle of a long recording: the search grows with the square of its length.
pub(super) fn middle(speed: &Signal) -> Signal {
    let whole_s = speed.len() as f64 * speed.sample_time_s;
    let start_s = speed.start_s + 0.5 * (whole_s - SEARCHED_S).max(0.0);
    speed.slice(start_s, start_s + SEARCHED_S)
}

/// A speed without its slow course, and the angle that it turns.
#[derive(Debug, Clone)]
pub struct Seen {
    samples: Vec<f64>,
    angle: Vec<f64>,
    mean: f64,
}

impl Seen {
    /// Over the angle that it turns itself.
    pub fn of(speed: &Signal, mean: f64) -> Self {
        let count = speed.len() as f64;
        let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
        let samples = without_trend(speed).iter().enumerate().map(|(k, x)| window(k) * x).collect();
        Seen { samples, angle: angle(speed), mean }
    }

    /// Over the angle that another speed turns, its mean over a working cycle: pulses in the angle would give multiples
    /// of theirs, by more than pass a soft shaft.
    pub fn over_angle_of(speed: &Signal, other: &Signal, mean: f64) -> Self {
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
    pub fn turned(&self) -> f64 {
        self.angle.last().copied().unwrap_or_default()
    }

    /// The power of an order, as an acceleration.
    pub fn power(&self, order: f64) -> f64 {
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (x, angle) in self.samples.iter().zip(&self.angle) {
            let (sine, cosine) = (order * angle).sin_cos();
            real += x * cosine;
            imaginary += x * sine;
        }
        (2.0 / self.samples.len() as f64 * order * self.mean).powi(2) * (real * real + imaginary * imaginary)
    }

    /// The power of so many orders, from the first in steps.
    pub(super) fn powers(&self, first: f64, step: f64, count: usize) -> Vec<(f64, f64)> {
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
    pub(super) fn order_powers(&self, first: f64, highest: f64) -> Vec<(f64, f64)> {
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
