//! Signals to excite a system with: seeded, deterministic, starting at time zero.

mod binary;
mod multisine;
mod noise;
mod steps;
mod sweep;

pub use binary::{Prbs, random_binary};
pub use multisine::{Multisine, Phases};
pub use noise::{band_limited_noise, held_noise};
pub use numerics::random::Random;
pub use steps::{Corner, Step, levels, ramps, stepped_sine};
pub use sweep::{Sweep, chirp};

use serde::{Deserialize, Serialize};

use crate::Signal;
use crate::error::{SignalError, check_at_least, check_finite, check_range, check_sample_time};

/// The clock a signal is made on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

/// Crest factor, the largest magnitude over the root mean square: how much of its range a signal uses. One for a signal
/// that switches between `±a`, `√2` for a sine; the mean counts.
///
/// # Errors
/// [`SignalError::TooShort`] for an empty signal, [`SignalError::Constant`] for one of zeros,
/// [`SignalError::NonFinite`].
///
/// # Example
/// ```
/// let crest = signal::excitation::crest_factor(&[3.0, -1.0, 1.0, -1.0])?;
/// assert!((crest - 3.0 / 3.0_f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn crest_factor(x: &[f64]) -> Result<f64, SignalError> {
    check_at_least(1, x.len())?;
    check_finite(x)?;
    let peak = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if peak == 0.0 {
        return Err(SignalError::Constant);
    }
    // Relative to the peak, so that squares neither overflow nor vanish.
    let square = x.iter().map(|v| (v / peak).powi(2)).sum::<f64>() / x.len() as f64;
    Ok(1.0 / square.sqrt())
}
