//! Nonparametric frequency responses, and how far to trust them.
//!
//! | method | for |
//! | --- | --- |
//! | [`LocalModel`] | any excitation, resolution and noise level at once; handles leakage |
//! | [`suited_response`] | the same, by the kind of local model that follows the data |
//! | [`repeated_response`] | periodic excitation: finds period, settled periods and excited lines by itself |
//! | [`PeriodicSpectra`], [`periodic_response`] | periodic excitation over several known periods: noise from their scatter |
//! | [`Etfe`] | a quick look; exact for periodic data |
//! | [`BlackmanTukey`] | smooth responses and noise spectra from random excitation |
//!
//! Conventions: `Y(f) = G(f) U(f) + V(f)` with transforms by `e^{−jωt}`, so a lag has a negative phase. The variance of
//! a complex quantity is `E|Ĝ − EĜ|²`, the sum of those of its real and imaginary parts, which are alike.

mod blackman_tukey;
mod etfe;
mod least_squares;
mod local;
mod periodic;
mod repeated;
mod repetition;
mod resonance;
mod sharpness;

pub use blackman_tukey::{BlackmanTukey, SpectralAnalysis};
pub use etfe::Etfe;
pub use local::{LocalEstimate, LocalKind, LocalModel};
pub use periodic::{PeriodicResponse, PeriodicSpectra, periodic_response, periodic_spectra};
pub use repeated::{RepeatedResponse, repeated_response};
pub use repetition::Repetition;
pub use resonance::{Estimated, Resonance, resonance};
pub use sharpness::{SuitedResponse, suited_response};

use crate::Complex64;
use crate::distributions::{f_quantile, interval};
use crate::error::{SignalError, check_at_least, check_finite, check_same_length, check_sample_time};

/// A frequency response at discrete frequencies, with its variance.
///
/// Matrices lie one after the other, rows (outputs) first: entry `(i, j)` at frequency `k` is at
/// `(k · outputs + i) · inputs + j`.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyResponse {
    /// Frequencies in hertz, rising.
    pub freq_hz: Vec<f64>,
    /// Number of outputs.
    pub outputs: usize,
    /// Number of inputs.
    pub inputs: usize,
    /// The response, (unit of output)/(unit of input).
    pub response: Vec<Complex64>,
    /// Variance `E|Ĝ − EĜ|²` of each entry; NaN where the method knows none.
    pub variance: Vec<f64>,
    /// Degrees of freedom ν of the variances at each frequency: `ν·V̂/V` is distributed as χ² with ν of them, so that
    /// the real part, with half the variance, has an interval by Student's t. Zero where no variance is known.
    pub degrees_of_freedom: Vec<f64>,
}

impl FrequencyResponse {
    /// No frequency yet.
    fn empty(outputs: usize, inputs: usize) -> Self {
        let (freq_hz, response, variance, degrees_of_freedom) = (vec![], vec![], vec![], vec![]);
        FrequencyResponse { freq_hz, outputs, inputs, response, variance, degrees_of_freedom }
    }

    /// The response from one input to one output, one value a frequency; empty where there is no such channel.
    #[must_use]
    pub fn response_of(&self, output: usize, input: usize) -> Vec<Complex64> {
        self.pick(&self.response, output, input)
    }

    /// The variance of [`FrequencyResponse::response_of`].
    #[must_use]
    pub fn variance_of(&self, output: usize, input: usize) -> Vec<f64> {
        self.pick(&self.variance, output, input)
    }

    /// The interval that holds the magnitude of [`FrequencyResponse::response_of`] with probability `level`, one a
    /// frequency: by Student's t from the part of the variance along the gain, which is half of it. Where the gain may
    /// be zero, by the F test of both parts, the interval begins at zero: along a gain that is all noise there is no
    /// direction.
    #[must_use]
    pub fn magnitude_interval(&self, output: usize, input: usize, level: f64) -> Vec<(f64, f64)> {
        let gains = self.response_of(output, input).into_iter().zip(self.variance_of(output, input));
        // Most frequencies have as many degrees of freedom as the one before.
        let (mut known, mut reach, mut clear) = (f64::NAN, 0.0, 0.0);
        let one = |((gain, variance), freedom): ((Complex64, f64), &f64)| {
            if *freedom != known {
                (known, reach) = (*freedom, interval(0.0, 1.0, *freedom, level).1);
                clear = if *freedom > 0.0 { f_quantile(level, 2.0, *freedom) } else { f64::INFINITY };
            }
            let (size, error) = (gain.norm(), (0.5 * variance).sqrt());
            let low = if size * size > variance * clear { (size - reach * error).max(0.0) } else { 0.0 };
            (low, size + reach * error)
        };
        gains.zip(&self.degrees_of_freedom).map(one).collect()
    }

    fn pick<T: Copy>(&self, values: &[T], output: usize, input: usize) -> Vec<T> {
        if output >= self.outputs || input >= self.inputs {
            return vec![];
        }
        values.iter().skip(output * self.inputs + input).step_by(self.outputs * self.inputs).copied().collect()
    }
}

/// Checks that records are equally long, finite, and on a clock; returns their length, zero where there is none.
fn check_records(records: &[&[f64]], sample_time_s: f64) -> Result<usize, SignalError> {
    check_sample_time(sample_time_s)?;
    let length = records.first().map_or(0, |r| r.len());
    for record in records {
        check_same_length(length, record.len())?;
        check_finite(record)?;
    }
    Ok(length)
}

/// Checks that there is at least one record of a kind.
fn check_some(records: &[&[f64]]) -> Result<(), SignalError> {
    check_at_least(1, records.len())
}
