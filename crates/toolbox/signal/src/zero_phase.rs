//! Zero-phase smoothing, differentiation and shift of a recorded signal in one step.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use numerics::vector::dot;

use crate::{Complex64, Signal};

/// Half length of the kernels, s.
const REACH_S: f64 = 0.1;
/// The low-pass falls from one at the band to zero at this factor of it.
const STOP: f64 = 1.4;
/// Points of the integral over frequency.
const POINTS: usize = 200;
/// Instants are rounded to this part of a sample, so that kernels can be used again.
const PHASES: f64 = 4096.0;
/// Highest band as a part of the Nyquist frequency: the middle of the transition then lies on the latter.
const NYQUIST_PART: f64 = 2.0 / (1.0 + STOP);

/// Quantity that is wanted of the signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// Its value.
    Value,
    /// Its derivative.
    Derivative,
}

/// A symmetric filter: a low-pass with a raised-cosine edge from `band_hz` to 1.4 times that, divided by the sinc of
/// the gate over which the signal was averaged. Beyond the ends the record is continued by odd reflection.
#[derive(Debug, Clone, Copy)]
pub struct ZeroPhase {
    /// Highest frequency that passes unchanged, Hz.
    pub band_hz: f64,
    /// Time over which the signal was averaged, s.
    pub gate_s: f64,
    /// The value or its derivative.
    pub wanted: Wanted,
}

impl ZeroPhase {
    /// The filtered signal at `start_s + i · step_s`, `count` values. The band is lowered to what the sampling allows.
    pub fn at(&self, x: &Signal, start_s: f64, step_s: f64, count: usize) -> Vec<f64> {
        let mut kernels: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
        let half = (REACH_S / x.sample_time_s).ceil() as i64;
        let value = |i: usize| {
            let position = (start_s + i as f64 * step_s - x.start_s) / x.sample_time_s;
            let rounded = (position * PHASES).round() / PHASES;
            let below = rounded.floor();
            let phase = ((rounded - below) * PHASES) as u32;
            let kernel = kernels.entry(phase).or_insert_with(|| self.kernel(rounded - below, half, x));
            let first = below as i64 - half;
            product(&x.samples, first, kernel)
        };
        work::checked(0..count).map(value).collect()
    }

    /// Weights of the samples −half … half + 1 about an instant `fraction` of a sample after sample 0.
    fn kernel(&self, fraction: f64, half: i64, x: &Signal) -> Vec<f64> {
        let step = x.sample_time_s;
        let band = self.band_hz.min(NYQUIST_PART * x.nyquist_hz());
        let response = self.response(band);
        let times: Vec<f64> = (-half..=half + 1).map(|n| (fraction - n as f64) * step).collect();
        let weight = |t: &f64| {
            let window = (0.5 * PI * t / (REACH_S + step)).cos().max(0.0).powi(2);
            window * self.wave(&response, *t)
        };
        let mut weights: Vec<f64> = times.iter().map(weight).collect();
        let sum: f64 = weights.iter().sum();
        match self.wanted {
            Wanted::Value => weights.iter_mut().for_each(|w| *w /= sum),
            Wanted::Derivative => {
                let mean = sum / weights.len() as f64;
                weights.iter_mut().for_each(|w| *w -= mean);
                let ramp: f64 = weights.iter().zip(&times).map(|(w, t)| -w * t).sum();
                weights.iter_mut().for_each(|w| *w /= ramp);
            }
        }
        weights
    }

    /// The sum of all frequencies' waves at `t`. Equally spaced frequencies turn on by the same angle each.
    fn wave(&self, response: &[(f64, f64)], t: f64) -> f64 {
        let omega = TAU * response.first().map_or(0.0, |(f, _)| *f);
        let (mut wave, turn) = (Complex64::cis(omega * t), Complex64::cis(2.0 * omega * t));
        let mut sum = 0.0;
        for (f, h) in response {
            sum += match self.wanted {
                Wanted::Value => h * wave.re,
                Wanted::Derivative => -h * TAU * f * wave.im,
            };
            wave *= turn;
        }
        sum
    }

    /// Frequencies, odd multiples of the first, and the response there.
    fn response(&self, band: f64) -> Vec<(f64, f64)> {
        let point = |i: usize| {
            let f = STOP * band * (i as f64 + 0.5) / POINTS as f64;
            let edge = ((f / band - 1.0) / (STOP - 1.0)).clamp(0.0, 1.0);
            let half = PI * f * self.gate_s;
            let gate = if half > 0.0 && half < 0.9 * PI { half.sin() / half } else { 1.0 };
            (f, 0.5 * (1.0 + (PI * edge).cos()) / gate)
        };
        (0..POINTS).map(point).collect()
    }
}

/// Σ x[first + j] kernel[j] with odd reflection beyond the ends.
fn product(x: &[f64], first: i64, kernel: &[f64]) -> f64 {
    let end = x.len() as i64;
    if first >= 0 && first + kernel.len() as i64 <= end {
        return dot(&x[first as usize..], kernel);
    }
    (first..).zip(kernel).map(|(i, k)| k * reflected(x, i)).sum()
}

fn reflected(x: &[f64], i: i64) -> f64 {
    let last = x.len() as i64 - 1;
    match i {
        _ if last < 0 => 0.0,
        i if i < 0 => 2.0 * x[0] - x[(-i).min(last) as usize],
        i if i > last => 2.0 * x[last as usize] - x[(2 * last - i).max(0) as usize],
        i => x[i as usize],
    }
}
