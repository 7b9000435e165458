//! Signals made of parts one after the other: levels, ramps, stepped sines.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::Timing;
use crate::Signal;
use crate::error::{SignalError, check_at_least, check_finite, check_range, check_sample_time};

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
pub fn stepped_sine(sample_time_s: f64, offset: f64, amplitude: f64, steps: &[Step]) -> Result<Signal, SignalError> {
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
    let samples = expand(sample_time_s, steps)?.into_iter().map(sample).collect();
    Signal::new(0.0, sample_time_s, samples)
}

fn expand(sample_time_s: f64, steps: &[Step]) -> Result<Vec<f64>, SignalError> {
    let timing = Timing { sample_time_s, length: 0 };
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
        check_finite(&[corner.time_s, corner.value]).map_err(|_| SignalError::NonFinite { index })?;
        if index > 0 {
            check_range("time_s", corner.time_s, corners[index - 1].time_s, f64::MAX)?;
        }
    }
    let value = |i: usize| {
        let time_s = i as f64 * timing.sample_time_s;
        let next = corners.partition_point(|c| c.time_s <= time_s);
        match (next.checked_sub(1).map(|i| corners[i]), corners.get(next)) {
            (Some(a), Some(b)) => a.value + (b.value - a.value) * (time_s - a.time_s) / (b.time_s - a.time_s),
            (Some(corner), None) => corner.value,
            (None, _) => corners[0].value,
        }
    };
    timing.signal((0..timing.length).map(value).collect())
}
