//! Signals to excite a system with: seeded, deterministic, starting at time zero.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::Signal;
use crate::error::{SignalError, check_at_least, check_finite, check_range, check_sample_time};

/// A small random generator of our own, xoshiro256++ seeded by splitmix64: the same numbers on every machine and in
/// every version. Not for secrets.
///
/// # Example
/// ```
/// let mut random = signal::excitation::Random::new(7);
/// let first = random.uniform();
/// assert!((0.0..1.0).contains(&first));
/// assert_eq!(first, signal::excitation::Random::new(7).uniform());
/// ```
///
/// # Source
/// Blackman, D. and Vigna, S. (2021), ACM Trans. Math. Softw. 47(4), 36.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Random {
    state: [u64; 4],
}

impl Random {
    /// A generator whose numbers depend on the seed alone.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut counter = seed;
        let mut splitmix = || {
            counter = counter.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (counter ^ (counter >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        };
        Self {
            state: [splitmix(), splitmix(), splitmix(), splitmix()],
        }
    }

    fn next(&mut self) -> u64 {
        let s = &mut self.state;
        let result = s[0].wrapping_add(s[3]).rotate_left(23).wrapping_add(s[0]);
        let shifted = s[1] << 17;
        s[2] ^= s[0];
        s[3] ^= s[1];
        s[1] ^= s[2];
        s[0] ^= s[3];
        s[2] ^= shifted;
        s[3] = s[3].rotate_left(45);
        result
    }

    /// Uniform in 0 ..< 1, with 53 random bits.
    pub fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller's transform).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }
}

/// The clock a signal is made on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Sample time, in seconds.
    pub sample_time_s: f64,
    /// Number of samples.
    pub length: usize,
}

impl Timing {
    fn signal(self, samples: Vec<f64>) -> Result<Signal, SignalError> {
        Signal::new(0.0, self.sample_time_s, samples)
    }

    /// A duration in whole samples, at least one.
    fn samples_in(self, name: &'static str, duration_s: f64) -> Result<usize, SignalError> {
        check_sample_time(self.sample_time_s)?;
        check_range(name, duration_s, 0.0, f64::MAX)?;
        Ok(((duration_s / self.sample_time_s).round() as usize).max(1))
    }
}

/// A signal that switches between two levels: every `hold_s` it changes with the given probability.
///
/// `hold_s` is rounded to whole samples, at least one. With a probability of 0.5 the holds are independent.
///
/// # Errors
/// [`SignalError::Parameter`], [`SignalError::SampleTime`], [`SignalError::NonFinite`] for the levels.
///
/// # Example
/// ```
/// use signal::excitation::{Random, Timing, random_binary};
/// let timing = Timing { sample_time_s: 1e-3, length: 1000 };
/// let x = random_binary(&mut Random::new(1), timing, [-5.0, 5.0], 0.01, 0.5)?;
/// assert!(x.samples.chunks(10).all(|c| c.iter().all(|v| *v == c[0] && v.abs() == 5.0)));
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn random_binary(
    random: &mut Random,
    timing: Timing,
    levels: [f64; 2],
    hold_s: f64,
    switch_probability: f64,
) -> Result<Signal, SignalError> {
    check_finite(&levels)?;
    check_range("switch_probability", switch_probability, 0.0, 1.0)?;
    let hold = timing.samples_in("hold_s", hold_s)?;
    let mut high = random.uniform() < 0.5;
    let sample = |i: usize| {
        if i > 0 && i.is_multiple_of(hold) && random.uniform() < switch_probability {
            high = !high;
        }
        levels[usize::from(high)]
    };
    timing.signal((0..timing.length).map(sample).collect())
}

/// Normal white noise, each value held for `hold_s` (rounded to whole samples, at least one).
///
/// # Errors
/// [`SignalError::Parameter`], [`SignalError::SampleTime`], [`SignalError::NonFinite`] for the mean.
pub fn held_noise(
    random: &mut Random,
    timing: Timing,
    mean: f64,
    standard_deviation: f64,
    hold_s: f64,
) -> Result<Signal, SignalError> {
    check_finite(&[mean])?;
    check_range("standard_deviation", standard_deviation, 0.0, f64::MAX)?;
    let hold = timing.samples_in("hold_s", hold_s)?;
    let mut value = 0.0;
    let sample = |i: usize| {
        if i.is_multiple_of(hold) {
            value = mean + standard_deviation * random.normal();
        }
        value
    };
    timing.signal((0..timing.length).map(sample).collect())
}

/// One part of a signal made of parts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The level, or the frequency in hertz.
    pub value: f64,
    /// How long it lasts, in seconds, rounded to whole samples, at least one.
    pub duration_s: f64,
}

/// Levels one after the other, each held for its duration; as long as they last together.
///
/// # Errors
/// [`SignalError::Parameter`] for a negative duration, [`SignalError::SampleTime`], [`SignalError::NonFinite`].
pub fn levels(sample_time_s: f64, steps: &[Step]) -> Result<Signal, SignalError> {
    Signal::new(0.0, sample_time_s, expand(sample_time_s, steps)?)
}

/// Sines of stepped frequency, `offset + amplitude · sin φ`, phase and so value continuous at the steps; `value` of a
/// step is its frequency in hertz.
///
/// # Errors
/// Those of [`levels`], and [`SignalError::Parameter`] for a frequency outside zero to half the sample rate.
///
/// # Example
/// ```
/// use signal::excitation::{Step, stepped_sine};
/// let x = stepped_sine(0.01, 1.0, 2.0, &[Step { value: 25.0, duration_s: 1.0 }])?;
/// assert!((x.samples[1] - 3.0).abs() < 1e-12 && x.len() == 100);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn stepped_sine(
    sample_time_s: f64,
    offset: f64,
    amplitude: f64,
    steps: &[Step],
) -> Result<Signal, SignalError> {
    check_finite(&[offset, amplitude])?;
    check_sample_time(sample_time_s)?;
    for step in steps {
        check_range("freq_hz", step.value, 0.0, 0.5 / sample_time_s)?;
    }
    let mut turns = 0.0_f64;
    let sample = |freq_hz: f64| {
        let value = offset + amplitude * (TAU * turns).sin();
        turns = (turns + freq_hz * sample_time_s).fract();
        value
    };
    let samples = expand(sample_time_s, steps)?
        .into_iter()
        .map(sample)
        .collect();
    Signal::new(0.0, sample_time_s, samples)
}

fn expand(sample_time_s: f64, steps: &[Step]) -> Result<Vec<f64>, SignalError> {
    let timing = Timing {
        sample_time_s,
        length: 0,
    };
    let mut samples = Vec::new();
    for (index, step) in steps.iter().enumerate() {
        check_finite(&[step.value]).map_err(|_| SignalError::NonFinite { index })?;
        let count = timing.samples_in("duration_s", step.duration_s)?;
        samples.resize(samples.len() + count, step.value);
    }
    Ok(samples)
}

/// A corner of a piecewise linear signal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Corner {
    /// Instant, in seconds.
    pub time_s: f64,
    /// Value there.
    pub value: f64,
}

/// Ramps: straight lines between corners in rising time, the outermost values held outside them.
///
/// Two corners at one instant make a jump; at that instant the later corner's value holds.
///
/// # Errors
/// [`SignalError::TooShort`] without a corner, [`SignalError::Parameter`] where the instants fall,
/// [`SignalError::NonFinite`], [`SignalError::SampleTime`].
///
/// # Example
/// ```
/// use signal::excitation::{Corner, Timing, ramps};
/// let corners = [Corner { time_s: 1.0, value: 0.0 }, Corner { time_s: 3.0, value: 4.0 }];
/// let x = ramps(Timing { sample_time_s: 1.0, length: 5 }, &corners)?;
/// assert_eq!(x.samples, vec![0.0, 0.0, 2.0, 4.0, 4.0]);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn ramps(timing: Timing, corners: &[Corner]) -> Result<Signal, SignalError> {
    check_at_least(1, corners.len())?;
    for (index, corner) in corners.iter().enumerate() {
        check_finite(&[corner.time_s, corner.value])
            .map_err(|_| SignalError::NonFinite { index })?;
        if index > 0 {
            check_range("time_s", corner.time_s, corners[index - 1].time_s, f64::MAX)?;
        }
    }
    let value = |i: usize| {
        let time_s = i as f64 * timing.sample_time_s;
        let next = corners.partition_point(|c| c.time_s <= time_s);
        match (next.checked_sub(1).map(|i| corners[i]), corners.get(next)) {
            (Some(a), Some(b)) => {
                a.value + (b.value - a.value) * (time_s - a.time_s) / (b.time_s - a.time_s)
            }
            (Some(corner), None) => corner.value,
            (None, _) => corners[0].value,
        }
    };
    timing.signal((0..timing.length).map(value).collect())
}

/// A multisine of equal amplitudes with Schroeder's phases, which keep its peaks low:
/// `x(t) = A Σ_k cos(2π h_k t/P + φ_k)`, `φ_k = −π k (k − 1)/F` for the `k`-th of `F` harmonics.
///
/// `harmonics` are multiples of `1/P`, `P = period · sample_time_s`, each between 1 and below `period/2`; `A` is such
/// that the root mean square over a period is `rms`.
///
/// # Errors
/// [`SignalError::Parameter`] for a harmonic or `rms` out of range, [`SignalError::TooShort`] without a harmonic,
/// [`SignalError::SampleTime`].
///
/// # Example
/// ```
/// use signal::excitation::{Timing, schroeder_multisine};
/// let harmonics: Vec<usize> = (1..=30).collect();
/// let x = schroeder_multisine(Timing { sample_time_s: 1e-3, length: 1000 }, 1000, &harmonics, 2.0)?;
/// let power = x.samples.iter().map(|v| v * v).sum::<f64>() / 1000.0;
/// assert!((power - 4.0).abs() < 1e-9);
/// let peak = x.samples.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
/// assert!(peak / 2.0 < 1.8); // crest factor; 7.7 with equal phases
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Schroeder, M. R. (1970), IEEE Trans. Inf. Theory 16(1), 85–89.
pub fn schroeder_multisine(
    timing: Timing,
    period: usize,
    harmonics: &[usize],
    rms: f64,
) -> Result<Signal, SignalError> {
    check_at_least(1, harmonics.len())?;
    check_range("rms", rms, 0.0, f64::MAX)?;
    for &harmonic in harmonics {
        check_range(
            "harmonic",
            harmonic as f64,
            1.0,
            (period as f64 - 1.0) / 2.0,
        )?;
    }
    let count = harmonics.len() as f64;
    let amplitude = rms * (2.0 / count).sqrt();
    let phase = |k: usize| -PI * (k * (k + 1)) as f64 / count;
    let value = |t: usize| {
        // Whole turns are taken off in integers.
        let turns = |h: usize| (h * t) % period;
        let wave =
            |(k, &h): (usize, &usize)| (TAU * turns(h) as f64 / period as f64 + phase(k)).cos();
        amplitude * harmonics.iter().enumerate().map(wave).sum::<f64>()
    };
    let one_period: Vec<f64> = (0..period.min(timing.length)).map(value).collect();
    timing.signal((0..timing.length).map(|t| one_period[t % period]).collect())
}
