//! Recursive filters as second-order sections and filters of finite impulse response, causal and zero-phase; the moving
//! average.

mod band;
mod butterworth;
mod fir;

pub use fir::{Fir, FirState, kaiser_design};

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

use crate::Complex64;
use crate::error::{SignalError, check_at_least, check_finite, check_range, check_sample_time};
use crate::extend::odd_extended;

/// One second-order section, `H(z) = (b0 + b1 z⁻¹ + b2 z⁻²) / (1 + a1 z⁻¹ + a2 z⁻²)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Section {
    /// Numerator `[b0, b1, b2]`.
    pub b: [f64; 3],
    /// Denominator `[a1, a2]`; `a0` is one.
    pub a: [f64; 2],
}

impl Section {
    fn dc_gain(&self) -> f64 {
        self.b.iter().sum::<f64>() / (1.0 + self.a[0] + self.a[1])
    }

    fn at(&self, z: Complex64) -> Complex64 {
        let w = z.inv();
        let num = (w * self.b[2] + self.b[1]) * w + self.b[0];
        let den = (w * self.a[1] + self.a[0]) * w + 1.0;
        num / den
    }

    /// The stability triangle of a second-order denominator.
    fn is_stable(&self) -> bool {
        self.a[1].abs() < 1.0 && self.a[0].abs() < 1.0 + self.a[1]
    }

    fn step(&self, state: &mut [f64; 2], x: f64) -> f64 {
        let y = self.b[0] * x + state[0];
        state[0] = self.b[1] * x - self.a[0] * y + state[1];
        state[1] = self.b[2] * x - self.a[1] * y;
        y
    }
}

/// A recursive digital filter: second-order sections in cascade, for one sample time.
///
/// # Example
/// ```
/// use signal::Sos;
/// let low = Sos::butterworth_lowpass(2, 50.0, 1e-3)?;
/// // −3 dB at the cut-off, one at rest.
/// assert!((low.response(50.0).norm() - 0.5_f64.sqrt()).abs() < 1e-12);
/// assert!((low.response(0.0).re - 1.0).abs() < 1e-12);
/// # Ok::<(), signal::SignalError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sos {
    sections: Vec<Section>,
    sample_time_s: f64,
}

/// The memory of a running [`Sos`]: two numbers a section (transposed direct form II).
#[derive(Debug, Clone, PartialEq)]
pub struct SosState(Vec<[f64; 2]>);

impl Sos {
    /// A filter from its sections.
    ///
    /// # Errors
    /// [`SignalError::SampleTime`], [`SignalError::NonFinite`] (with the section's index), or
    /// [`SignalError::UnstableSection`] where a pole is not strictly inside the unit circle.
    pub fn new(sections: Vec<Section>, sample_time_s: f64) -> Result<Self, SignalError> {
        check_sample_time(sample_time_s)?;
        for (index, section) in sections.iter().enumerate() {
            check_finite(&section.b).map_err(|_| SignalError::NonFinite { index })?;
            check_finite(&section.a).map_err(|_| SignalError::NonFinite { index })?;
            if !section.is_stable() {
                return Err(SignalError::UnstableSection { section: index });
            }
        }
        Ok(Self { sections, sample_time_s })
    }

    /// The sections, in the order they are applied.
    #[must_use]
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// The sample time the filter was designed for, in seconds.
    #[must_use]
    pub fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// The complex gain `H(e^{jωT})` at a frequency in hertz; a lag has a negative phase.
    #[must_use]
    pub fn response(&self, freq_hz: f64) -> Complex64 {
        self.at(Complex64::cis(TAU * freq_hz * self.sample_time_s))
    }

    fn at(&self, z: Complex64) -> Complex64 {
        self.sections.iter().fold(Complex64::new(1.0, 0.0), |gain, s| gain * s.at(z))
    }

    /// The state of a filter that has seen only zeros.
    #[must_use]
    pub fn state_at_rest(&self) -> SosState {
        SosState(vec![[0.0; 2]; self.sections.len()])
    }

    /// The state of a filter that has seen the constant `level` for ever, so that filtering starts without a transient.
    #[must_use]
    pub fn state_at_level(&self, level: f64) -> SosState {
        let mut input = level;
        let state = |s: &Section| {
            let (x, y) = (input, input * s.dc_gain());
            input = y;
            [y - s.b[0] * x, s.b[2] * x - s.a[1] * y]
        };
        SosState(self.sections.iter().map(state).collect())
    }

    /// The filter's output for one sample, updating its state.
    ///
    /// `state` must come from this filter; sections without a state are left out.
    pub fn step(&self, state: &mut SosState, x: f64) -> f64 {
        self.sections.iter().zip(&mut state.0).fold(x, |value, (section, s)| section.step(s, value))
    }

    /// Filters `x` causally from `state`, which is left where the record ends, so that a next block continues it.
    ///
    /// # Example
    /// ```
    /// let low = signal::Sos::butterworth_lowpass(4, 10.0, 1e-3)?;
    /// let y = low.filter(&[3.0; 5], &mut low.state_at_level(3.0));
    /// assert!(y.iter().all(|v| (v - 3.0).abs() < 1e-9));
    /// # Ok::<(), signal::SignalError>(())
    /// ```
    #[must_use]
    pub fn filter(&self, x: &[f64], state: &mut SosState) -> Vec<f64> {
        work::checked(x).map(|&v| self.step(state, v)).collect()
    }

    /// Filters `x` forwards and backwards: no phase, the magnitude squared.
    ///
    /// The record is extended at both ends by odd reflection and the filter started in the steady state of the first
    /// extended sample, as `scipy.signal.sosfiltfilt` does. Returns as many samples as given.
    ///
    /// # Errors
    /// [`SignalError::TooShort`] where the record is not longer than the reflection, three times the filter's taps
    /// (`2·sections + 1`, less one for an odd order).
    ///
    /// # Source
    /// Gustafsson, F. (1996), Determining the initial states in forward-backward filtering, for the problem; SciPy's
    /// `sosfiltfilt` for the choice made.
    pub fn filtfilt(&self, x: &[f64]) -> Result<Vec<f64>, SignalError> {
        let pad = self.padding();
        check_at_least(pad + 1, x.len())?;
        let indices = -(pad as i64)..(x.len() + pad) as i64;
        let mut y: Vec<f64> = work::checked(indices).map(|i| odd_extended(x, i)).collect();
        for _ in 0..2 {
            let mut state = self.state_at_level(y[0]);
            for v in work::checked(&mut y) {
                *v = self.step(&mut state, *v);
            }
            y.reverse();
        }
        Ok(y[pad..pad + x.len()].to_vec())
    }

    fn padding(&self) -> usize {
        let zeros = self.sections.iter().filter(|s| s.b[2] == 0.0).count();
        let poles = self.sections.iter().filter(|s| s.a[1] == 0.0).count();
        3 * (2 * self.sections.len() + 1 - zeros.min(poles))
    }
}

/// Causal moving average, `y[t] = (x[t] + … + x[t−n+1]) / n`; the first samples average what there is.
///
/// It delays by `(n − 1)/2` samples. A non-finite sample spoils only the outputs whose window holds it.
///
/// # Errors
/// [`SignalError::Parameter`] for `n = 0`.
///
/// # Example
/// ```
/// let y = signal::filter::moving_average(&[1.0, 3.0, 5.0, 7.0], 2)?;
/// assert_eq!(y, vec![1.0, 2.0, 4.0, 6.0]);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn moving_average(x: &[f64], n: usize) -> Result<Vec<f64>, SignalError> {
    check_range("n", n as f64, 1.0, f64::INFINITY)?;
    let window_mean = |t: usize| {
        let window = &x[(t + 1).saturating_sub(n)..=t];
        window.iter().sum::<f64>() / window.len() as f64
    };
    Ok(work::checked(0..x.len()).map(window_mean).collect())
}
