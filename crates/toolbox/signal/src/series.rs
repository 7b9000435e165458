//! [`Signal`]: samples and the clock they were taken on; [`SignalView`]: the same, of samples that are not its own.

use serde::{Deserialize, Serialize};

use crate::error::{SignalError, check_sample_time};

/// Instants are compared with this tolerance, in sample times: time stamps are decimal, sample times often are not.
pub(crate) const TIME_TOLERANCE_SAMPLES: f64 = 1e-6;

/// A uniformly sampled signal: sample `i` was taken at `start_s + i · sample_time_s`.
///
/// # Example
/// ```
/// let x = signal::Signal::new(1.0, 0.5, vec![0.0, 1.0, 2.0, 3.0])?;
/// assert_eq!(x.time_s(2), 2.0);
/// assert_eq!(x.duration_s(), 1.5);
/// assert_eq!(x.slice(1.5, 2.5).samples, vec![1.0, 2.0]);
/// # Ok::<(), signal::SignalError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Signal {
    /// Instant of the first sample, in seconds.
    pub start_s: f64,
    /// Time between two samples, in seconds, positive.
    pub sample_time_s: f64,
    /// The samples, in time order.
    pub samples: Vec<f64>,
}

impl Signal {
    /// A signal from its samples, with the clock checked. Samples may be empty and may hold NaN.
    ///
    /// # Errors
    /// [`SignalError::SampleTime`] where the sample time is not positive and finite, [`SignalError::NonFinite`] where
    /// the start is not finite.
    pub fn new(start_s: f64, sample_time_s: f64, samples: Vec<f64>) -> Result<Self, SignalError> {
        check_instants(start_s, sample_time_s)?;
        Ok(Self { start_s, sample_time_s, samples })
    }

    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.samples.len()
    }

    /// Returns true if there is no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Time from the first to the last sample, in seconds; zero for fewer than two samples.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.len().saturating_sub(1) as f64 * self.sample_time_s
    }

    /// Instant of sample `i`, in seconds; `i` may lie past the end.
    #[must_use]
    pub fn time_s(&self, i: usize) -> f64 {
        self.start_s + i as f64 * self.sample_time_s
    }

    /// Instant of the last sample, in seconds (of the first where there is none).
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.start_s + self.duration_s()
    }

    /// Half the sample rate, in hertz.
    #[must_use]
    pub fn nyquist_hz(&self) -> f64 {
        0.5 / self.sample_time_s
    }

    /// The samples with `from_s <= t < to_s`, on the same clock; empty where none fits.
    ///
    /// Half open, so that `slice(a, b)` and `slice(b, c)` share no sample. Instants are compared with a tolerance of
    /// a millionth of a sample time.
    #[must_use]
    pub fn slice(&self, from_s: f64, to_s: f64) -> Self {
        let first = self.first_at_or_after(from_s);
        let end = self.first_at_or_after(to_s).max(first);
        Self {
            start_s: self.time_s(first),
            sample_time_s: self.sample_time_s,
            samples: self.samples.get(first..end).unwrap_or(&[]).to_vec(),
        }
    }

    /// Index of the first sample at or after an instant, `len()` where there is none.
    fn first_at_or_after(&self, time_s: f64) -> usize {
        let position = (time_s - self.start_s) / self.sample_time_s - TIME_TOLERANCE_SAMPLES;
        // A float-to-integer cast saturates: negative positions and NaN become 0.
        (position.ceil().max(0.0) as usize).min(self.len())
    }

    /// The signal with `f` applied to every sample.
    #[must_use]
    pub fn map(&self, f: impl FnMut(f64) -> f64) -> Self {
        self.with_samples(self.samples.iter().copied().map(f).collect())
    }

    /// Other samples on this signal's clock.
    #[must_use]
    pub fn with_samples(&self, samples: Vec<f64>) -> Self {
        Self { start_s: self.start_s, sample_time_s: self.sample_time_s, samples }
    }

    /// Arithmetic mean of the samples, `None` where there is none.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        mean(&self.samples)
    }
}

/// A uniformly sampled signal whose samples belong to another: long ones need not be copied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalView<'a> {
    pub(crate) start_s: f64,
    pub(crate) sample_time_s: f64,
    pub(crate) samples: &'a [f64],
}

impl<'a> SignalView<'a> {
    /// As [`Signal::new`], of samples that stay where they are.
    ///
    /// # Errors
    /// As [`Signal::new`].
    pub fn new(start_s: f64, sample_time_s: f64, samples: &'a [f64]) -> Result<Self, SignalError> {
        check_instants(start_s, sample_time_s)?;
        Ok(Self { start_s, sample_time_s, samples })
    }

    pub(crate) fn time_s(&self, i: usize) -> f64 {
        self.start_s + i as f64 * self.sample_time_s
    }

    pub(crate) fn end_s(&self) -> f64 {
        self.time_s(self.samples.len().saturating_sub(1))
    }
}

impl<'a> From<&'a Signal> for SignalView<'a> {
    fn from(signal: &'a Signal) -> Self {
        Self { start_s: signal.start_s, sample_time_s: signal.sample_time_s, samples: &signal.samples }
    }
}

fn check_instants(start_s: f64, sample_time_s: f64) -> Result<(), SignalError> {
    check_sample_time(sample_time_s)?;
    if start_s.is_finite() { Ok(()) } else { Err(SignalError::NonFinite { index: 0 }) }
}

pub(crate) fn mean(x: &[f64]) -> Option<f64> {
    (!x.is_empty()).then(|| x.iter().sum::<f64>() / x.len() as f64)
}
