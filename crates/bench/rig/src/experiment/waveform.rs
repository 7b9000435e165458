//! Demands over time.

use std::f64::consts::TAU;

use numerics::random::Stream;
use serde::{Deserialize, Serialize};

use super::error::{PlanError, require, require_positive};

/// Guards the division of times against rounding, as a part of the divisor.
const ROUNDING: f64 = 1e-9;

/// A demand over time, in the unit of the demanded quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Waveform {
    /// Always the same.
    Constant {
        /// The value.
        value: f64,
    },
    /// One of two values at random, drawn anew at every tick of a clock.
    RandomBinary {
        /// One value.
        low: f64,
        /// The other.
        high: f64,
        /// Time between draws, s.
        clock_s: f64,
    },
    /// Independent normal values, drawn anew whenever the demand may change; the first is the mean.
    WhiteNoise {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        standard_deviation: f64,
    },
    /// Two values in turn.
    Square {
        /// The first.
        first: f64,
        /// The second.
        second: f64,
        /// Time at each, s.
        dwell_s: f64,
    },
    /// Ramps up and down between two values, again and again.
    Ramps {
        /// Lower value, at the start.
        low: f64,
        /// Upper value.
        high: f64,
        /// Start of the first ramp, s.
        first_s: f64,
        /// Length of a ramp, s.
        ramp_s: f64,
        /// Rest between ramps, s.
        dwell_s: f64,
    },
    /// Random levels, approached with random slopes.
    RandomLevels {
        /// Lowest level.
        low: f64,
        /// Highest level.
        high: f64,
        /// Time from the start of one approach to that of the next, s.
        dwell_s: f64,
        /// Lowest slope, per s.
        lowest_slope_per_s: f64,
        /// Highest slope, per s.
        highest_slope_per_s: f64,
    },
    /// Sines, one after another, the last one to the end.
    SineLadder {
        /// Mean.
        mean: f64,
        /// Amplitude.
        amplitude: f64,
        /// Their frequencies, Hz.
        frequencies_hz: Vec<f64>,
        /// Time for each, s.
        dwell_s: f64,
    },
    /// Sines at once: mean + Σ a cos(2πft + φ); the first value is the mean.
    Multisine {
        /// Mean.
        mean: f64,
        /// The sines.
        sines: Vec<Sine>,
    },
    /// Values held one after another, again and again from the first; only at the start the mean takes the place of it.
    Periodic {
        /// Time from one value to the next, s.
        sample_time_s: f64,
        /// The values of one period.
        values: Vec<f64>,
    },
    /// Values of one's own, each held until the next; the last one to the end.
    Sampled {
        /// Time from one value to the next, s.
        sample_time_s: f64,
        /// The values.
        values: Vec<f64>,
    },
}

/// One sine of a multisine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Sine {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Amplitude.
    pub amplitude: f64,
    /// φ, phase of the cosine at time zero, rad.
    pub phase_rad: f64,
}

impl Waveform {
    /// The values at k · `update_s`, k = 0 … `updates` − 1.
    pub(super) fn sample(&self, random: &mut Stream, update_s: f64, updates: usize) -> Vec<f64> {
        let mut values = self.unsettled(random, update_s, updates);
        if let (Some(rest), Some(first)) = (self.rest(), values.first_mut()) {
            *first = rest;
        }
        values
    }

    /// Where the bench settles before an excitation about a mean starts: a bench that settles at the first value it
    /// happens to have drifts until its mean has arrived.
    fn rest(&self) -> Option<f64> {
        match self {
            Self::WhiteNoise { mean, .. } | Self::Multisine { mean, .. } => Some(*mean),
            Self::Periodic { values, .. } => Some(values.iter().sum::<f64>() / values.len().max(1) as f64),
            _ => None,
        }
    }

    fn unsettled(&self, random: &mut Stream, update_s: f64, updates: usize) -> Vec<f64> {
        let times = (0..updates).map(|k| k as f64 * update_s);
        match self {
            Self::Constant { value } => vec![*value; updates],
            Self::WhiteNoise { mean, standard_deviation } => {
                times.map(|_| mean + standard_deviation * random.normal()).collect()
            }
            Self::RandomBinary { low, high, clock_s } => {
                let ticks = ticks_at(update_s * updates as f64, *clock_s);
                let values: Vec<f64> = (0..=ticks).map(|_| random.either(*low, *high)).collect();
                times.map(|t| values[ticks_at(t, *clock_s).min(ticks)]).collect()
            }
            Self::Square { first, second, dwell_s } => {
                times.map(|t| if ticks_at(t, *dwell_s).is_multiple_of(2) { *first } else { *second }).collect()
            }
            Self::Ramps { low, high, first_s, ramp_s, dwell_s } => {
                times.map(|t| low + (high - low) * ramp_at(t - first_s, *ramp_s, *dwell_s)).collect()
            }
            Self::RandomLevels { .. } => self.sample_levels(random, update_s, updates),
            Self::SineLadder { mean, amplitude, frequencies_hz, dwell_s } => {
                times.map(|t| mean + amplitude * ladder_at(t, frequencies_hz, *dwell_s)).collect()
            }
            Self::Multisine { mean, sines } => {
                times.map(|t| mean + sines.iter().map(|s| s.at(t)).sum::<f64>()).collect()
            }
            Self::Periodic { sample_time_s, values } => {
                let period = values.len().max(1);
                let at = |t| values.get(ticks_at(t, *sample_time_s) % period).copied().unwrap_or(0.0);
                times.map(at).collect()
            }
            Self::Sampled { sample_time_s, values } => {
                let last = values.len().saturating_sub(1);
                let at = |t| values.get(ticks_at(t, *sample_time_s).min(last)).copied().unwrap_or(0.0);
                times.map(at).collect()
            }
        }
    }

    fn sample_levels(&self, random: &mut Stream, update_s: f64, updates: usize) -> Vec<f64> {
        let Self::RandomLevels { low, high, dwell_s, lowest_slope_per_s, highest_slope_per_s } = self else {
            return Vec::new();
        };
        let mut value = random.between(*low, *high);
        let (mut level, mut slope, mut last_tick) = (value, 0.0, 0);
        let mut values = Vec::with_capacity(updates);
        for k in 0..updates {
            let tick = ticks_at(k as f64 * update_s, *dwell_s);
            if tick > last_tick {
                level = random.between(*low, *high);
                slope = random.between(*lowest_slope_per_s, *highest_slope_per_s);
                last_tick = tick;
            }
            value += (level - value).clamp(-slope * update_s, slope * update_s);
            values.push(value);
        }
        values
    }

    pub(super) fn check(&self, name: &'static str) -> Result<(), PlanError> {
        let finite = |value: f64| require(name, value, true, "finite");
        match self {
            Self::Constant { value } => finite(*value),
            Self::RandomBinary { low, high, clock_s } => {
                finite(*low)?;
                finite(*high)?;
                require_time(name, *clock_s)
            }
            Self::WhiteNoise { mean, standard_deviation } => {
                finite(*mean)?;
                finite(*standard_deviation)
            }
            Self::Square { first, second, dwell_s } => {
                finite(*first)?;
                finite(*second)?;
                require_time(name, *dwell_s)
            }
            Self::Ramps { low, high, first_s, ramp_s, dwell_s } => {
                finite(*low)?;
                finite(*high)?;
                finite(*first_s)?;
                require_time(name, *ramp_s)?;
                require_time(name, *dwell_s)
            }
            Self::RandomLevels { low, high, dwell_s, lowest_slope_per_s, highest_slope_per_s } => {
                finite(*low)?;
                finite(*high)?;
                require_time(name, *dwell_s)?;
                require_positive(name, *lowest_slope_per_s)?;
                require_positive(name, *highest_slope_per_s)
            }
            Self::SineLadder { mean, amplitude, frequencies_hz, dwell_s } => {
                finite(*mean)?;
                finite(*amplitude)?;
                frequencies_hz.iter().try_for_each(|&f| finite(f))?;
                require_time(name, *dwell_s)
            }
            Self::Multisine { mean, sines } => {
                finite(*mean)?;
                let numbers = sines.iter().flat_map(|s| [s.frequency_hz, s.amplitude, s.phase_rad]);
                numbers.into_iter().try_for_each(finite)
            }
            Self::Sampled { sample_time_s, values } | Self::Periodic { sample_time_s, values } => {
                require(name, values.len() as f64, !values.is_empty(), "at least one value")?;
                values.iter().try_for_each(|&value| finite(value))?;
                require_time(name, *sample_time_s)
            }
        }
    }
}

impl Sine {
    fn at(&self, time_s: f64) -> f64 {
        self.amplitude * (TAU * self.frequency_hz * time_s + self.phase_rad).cos()
    }
}

fn require_time(name: &'static str, time_s: f64) -> Result<(), PlanError> {
    require(name, time_s, time_s >= 0.001, "a time of at least 1 ms")
}

/// Keeps a demand for `hold` updates at a time.
pub(super) fn hold(values: &mut [f64], hold: usize) {
    for chunk in values.chunks_mut(hold.max(1)) {
        let first = chunk[0];
        chunk.fill(first);
    }
}

/// Whole clock times in a time.
fn ticks_at(time_s: f64, clock_s: f64) -> usize {
    (time_s / clock_s + ROUNDING).floor() as usize
}

/// 0 … 1: up, rest, down, rest, again and again from time zero on.
fn ramp_at(time_s: f64, ramp_s: f64, dwell_s: f64) -> f64 {
    if time_s <= 0.0 {
        return 0.0;
    }
    let half_s = ramp_s + dwell_s;
    let half = ticks_at(time_s, half_s);
    let progress = ((time_s - half as f64 * half_s) / ramp_s).clamp(0.0, 1.0);
    if half.is_multiple_of(2) { progress } else { 1.0 - progress }
}

fn ladder_at(time_s: f64, frequencies_hz: &[f64], dwell_s: f64) -> f64 {
    let rung = ticks_at(time_s, dwell_s).min(frequencies_hz.len().saturating_sub(1));
    let frequency_hz = frequencies_hz.get(rung).copied().unwrap_or(0.0);
    (TAU * frequency_hz * (time_s - rung as f64 * dwell_s)).sin()
}
