//! Swept sines.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::Timing;
use crate::Signal;
use crate::error::{SignalError, check_at_least, check_finite, check_range, check_sample_time};

/// How the frequency of a sweep moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sweep {
    /// By as many hertz in each second: even power over frequency.
    Linear,
    /// By the same factor in each second: even power over the logarithm of frequency.
    Logarithmic,
}

/// A sine whose frequency moves from `freqs_hz[0]` at the first sample to `freqs_hz[1]` at the end of the record (one
/// sample time after the last sample), `offset + amplitude · sin φ(t)`, `φ(0) = 0`; it may move downwards.
///
/// # Errors
/// [`SignalError::Parameter`] for a frequency outside zero to half the sample rate, or of zero for a logarithmic sweep;
/// [`SignalError::TooShort`] for no sample; [`SignalError::NonFinite`], [`SignalError::SampleTime`].
///
/// # Example
/// ```
/// use signal::excitation::{Sweep, Timing, chirp};
/// let timing = Timing { sample_time_s: 1e-3, length: 1000 };
/// let x = chirp(timing, 0.0, 2.0, [10.0, 20.0], Sweep::Linear)?;
/// // φ = 2π (10 t + 5 t²): 2.8125 turns after a quarter of a second.
/// assert!((x.samples[250] - 2.0 * (std::f64::consts::TAU * 2.8125).sin()).abs() < 1e-9);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn chirp(
    timing: Timing,
    offset: f64,
    amplitude: f64,
    freqs_hz: [f64; 2],
    sweep: Sweep,
) -> Result<Signal, SignalError> {
    check_finite(&[offset, amplitude])?;
    check_sample_time(timing.sample_time_s)?;
    check_at_least(1, timing.length)?;
    let lowest = if sweep == Sweep::Logarithmic { f64::MIN_POSITIVE } else { 0.0 };
    for freq_hz in freqs_hz {
        check_range("freqs_hz", freq_hz, lowest, 0.5 / timing.sample_time_s)?;
    }
    let [start, end] = freqs_hz;
    let duration_s = timing.length as f64 * timing.sample_time_s;
    let growth = (end / start).ln();
    let turns = |t: f64| match sweep {
        Sweep::Linear => t * duration_s * (start + 0.5 * (end - start) * t),
        Sweep::Logarithmic if growth.abs() < 1e-12 => start * duration_s * t,
        Sweep::Logarithmic => start * duration_s * (growth * t).exp_m1() / growth,
    };
    let sample = |i: usize| offset + amplitude * (TAU * turns(i as f64 / timing.length as f64).fract()).sin();
    timing.signal((0..timing.length).map(sample).collect())
}
