//! Windows: tapers for spectra, filter design and interpolation.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use crate::error::{SignalError, check_range};

/// A window, by its usual name.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Window {
    /// All ones.
    Rectangular,
    /// `0.5 − 0.5 cos`: side lobes fall by 18 dB an octave.
    Hann,
    /// `0.54 − 0.46 cos`: first side lobe lowest for two terms; as a filter about 53 dB of attenuation.
    Hamming,
    /// `0.42 − 0.5 cos + 0.08 cos 2`: as a filter about 74 dB of attenuation.
    Blackman,
    /// `I₀(β √(1 − u²)) / I₀(β)`: `beta` trades the width of the main lobe against the side lobes.
    Kaiser {
        /// Shape, zero (rectangular) or more, at most 700.
        beta: f64,
    },
}

impl Window {
    /// The Kaiser window whose filters attenuate by `attenuation_db` decibels (a positive number).
    ///
    /// # Example
    /// ```
    /// use signal::window::Window;
    /// let Window::Kaiser { beta } = Window::kaiser_for(60.0) else { unreachable!() };
    /// assert!((beta - 5.65326).abs() < 1e-9);
    /// ```
    ///
    /// # Source
    /// Kaiser, J. F. (1974), Proc. IEEE Int. Symp. Circuits and Systems, 20–23.
    #[must_use]
    pub fn kaiser_for(attenuation_db: f64) -> Self {
        let above = attenuation_db - 21.0;
        let beta = if attenuation_db > 50.0 {
            0.1102 * (attenuation_db - 8.7)
        } else if above > 0.0 {
            0.5842 * above.powf(0.4) + 0.07886 * above
        } else {
            0.0
        };
        Window::Kaiser { beta }
    }

    /// `length` values, the first equal to the last: for the design of filters.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a `beta` out of range.
    pub fn symmetric(self, length: usize) -> Result<Vec<f64>, SignalError> {
        self.over(length, length.saturating_sub(1))
    }

    /// `length` values that repeat with that period: for spectra.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a `beta` out of range.
    pub fn periodic(self, length: usize) -> Result<Vec<f64>, SignalError> {
        self.over(length, length)
    }

    fn over(self, length: usize, intervals: usize) -> Result<Vec<f64>, SignalError> {
        self.check()?;
        let position = |i: usize| if intervals == 0 { 0.5 } else { i as f64 / intervals as f64 };
        Ok((0..length).map(|i| self.at(position(i))).collect())
    }

    fn check(self) -> Result<(), SignalError> {
        if let Window::Kaiser { beta } = self { check_range("beta", beta, 0.0, 700.0) } else { Ok(()) }
    }

    /// The value at `position`, 0 at the left end to 1 at the right.
    fn at(self, position: f64) -> f64 {
        let turn = TAU * position;
        match self {
            Window::Rectangular => 1.0,
            Window::Hann => 0.5 - 0.5 * turn.cos(),
            Window::Hamming => 0.54 - 0.46 * turn.cos(),
            Window::Blackman => 0.42 - 0.5 * turn.cos() + 0.08 * (2.0 * turn).cos(),
            Window::Kaiser { beta } => kaiser(2.0 * position - 1.0, beta),
        }
    }
}

/// The Kaiser window at `u` in −1 ..= 1, zero outside, one at its centre.
pub(crate) fn kaiser(u: f64, beta: f64) -> f64 {
    let inside = 1.0 - u * u;
    if inside < 0.0 { 0.0 } else { bessel_i0(beta * inside.sqrt()) / bessel_i0(beta) }
}

/// `sin(πx)/(πx)`.
pub(crate) fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

/// Modified Bessel function of the first kind, order zero, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let (mut term, mut sum, mut k) = (1.0, 1.0, 1.0);
    while term > sum * 1e-17 {
        term *= quarter / (k * k);
        sum += term;
        k += 1.0;
    }
    sum
}
