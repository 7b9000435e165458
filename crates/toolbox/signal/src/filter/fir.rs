//! Filters of finite impulse response: window design, causal and without phase.

use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::band::Band;
use crate::Complex64;
use crate::error::{SignalError, check_at_least, check_finite, check_range, check_sample_time};
use crate::extend::odd_extended;
use crate::window::{Window, sinc};

/// Longest filter that is designed.
const MAX_TAPS: f64 = 1e7;

/// A filter of finite impulse response, `y[t] = Σ_k h[k] x[t−k]`, for one sample time.
///
/// # Example
/// ```
/// use signal::Fir;
/// use signal::window::Window;
/// let low = Fir::lowpass(101, 50.0, Window::Hamming, 1e-3)?;
/// // One at rest, one half (−6 dB) at the cut-off, nothing to speak of beyond.
/// assert!((low.response(0.0).norm() - 1.0).abs() < 1e-12);
/// assert!((low.response(50.0).norm() - 0.5).abs() < 1e-2);
/// assert!(low.response(80.0).norm() < 3e-3);
/// // The delay of 50 samples is made good.
/// let slow: Vec<f64> = (0..400).map(|t| (0.02 * t as f64).sin()).collect();
/// assert!((low.filter_centred(&slow)?[200] - slow[200]).abs() < 3e-3);
/// # Ok::<(), signal::SignalError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fir {
    taps: Vec<f64>,
    sample_time_s: f64,
}

/// The memory of a running [`Fir`]: its last inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct FirState(Vec<f64>);

impl Fir {
    /// A filter from its impulse response.
    ///
    /// # Errors
    /// [`SignalError::TooShort`] without a tap, [`SignalError::NonFinite`], [`SignalError::SampleTime`].
    pub fn new(taps: Vec<f64>, sample_time_s: f64) -> Result<Self, SignalError> {
        check_sample_time(sample_time_s)?;
        check_at_least(1, taps.len())?;
        check_finite(&taps)?;
        Ok(Self { taps, sample_time_s })
    }

    /// Low-pass by the window method: gain one half (−6 dB) at `cutoff_hz`, one at rest. Linear phase.
    ///
    /// # Errors
    /// [`SignalError::Cutoff`] unless `0 < cutoff_hz < 1/(2·sample_time_s)`; [`SignalError::Parameter`] without a tap
    /// or for an impossible window; [`SignalError::SampleTime`].
    ///
    /// # Source
    /// Oppenheim and Schafer, *Discrete-Time Signal Processing* (2010), §7.5. Scaled as `scipy.signal.firwin`.
    pub fn lowpass(taps: usize, cutoff_hz: f64, window: Window, sample_time_s: f64) -> Result<Self, SignalError> {
        design(taps, Band::Low(cutoff_hz), window, sample_time_s)
    }

    /// High-pass by the window method: gain one half at `cutoff_hz`, one at half the sample rate; `taps` must be odd.
    ///
    /// # Errors
    /// As [`Fir::lowpass`], and [`SignalError::EvenTaps`].
    pub fn highpass(taps: usize, cutoff_hz: f64, window: Window, sample_time_s: f64) -> Result<Self, SignalError> {
        design(taps, Band::High(cutoff_hz), window, sample_time_s)
    }

    /// Band-pass by the window method: gain one half at both edges, one in the middle.
    ///
    /// # Errors
    /// As [`Fir::lowpass`], and [`SignalError::Cutoff`] unless `low_hz < high_hz`.
    pub fn bandpass(
        taps: usize,
        low_hz: f64,
        high_hz: f64,
        window: Window,
        sample_time_s: f64,
    ) -> Result<Self, SignalError> {
        design(taps, Band::Pass(low_hz, high_hz), window, sample_time_s)
    }

    /// Band-stop by the window method: gain one half at both edges, one at rest; `taps` must be odd.
    ///
    /// # Errors
    /// As [`Fir::bandpass`], and [`SignalError::EvenTaps`].
    pub fn bandstop(
        taps: usize,
        low_hz: f64,
        high_hz: f64,
        window: Window,
        sample_time_s: f64,
    ) -> Result<Self, SignalError> {
        design(taps, Band::Stop(low_hz, high_hz), window, sample_time_s)
    }

    /// The impulse response.
    #[must_use]
    pub fn taps(&self) -> &[f64] {
        &self.taps
    }

    /// The sample time the filter was designed for, in seconds.
    #[must_use]
    pub fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// The complex gain `Σ_k h[k] e^{−jωkT}` at a frequency in hertz; a lag has a negative phase.
    #[must_use]
    pub fn response(&self, freq_hz: f64) -> Complex64 {
        let angle = TAU * freq_hz * self.sample_time_s;
        self.taps.iter().enumerate().map(|(k, h)| Complex64::cis(-angle * k as f64) * h).sum()
    }

    /// The state of a filter that has seen only zeros.
    #[must_use]
    pub fn state_at_rest(&self) -> FirState {
        self.state_at_level(0.0)
    }

    /// The state of a filter that has seen the constant `level` for ever, so that filtering starts without a transient.
    #[must_use]
    pub fn state_at_level(&self, level: f64) -> FirState {
        FirState(vec![level; self.taps.len() - 1])
    }

    /// Filters `x` causally from `state`, which is left where the record ends, so that a next block continues it.
    ///
    /// `state` must come from this filter; a shorter one is taken to follow zeros.
    #[must_use]
    pub fn filter(&self, x: &[f64], state: &mut FirState) -> Vec<f64> {
        let memory = self.taps.len() - 1;
        let mut line = vec![0.0; memory.saturating_sub(state.0.len())];
        line.extend_from_slice(&state.0);
        line.extend_from_slice(x);
        let extra = line.len() - x.len() - memory;
        let y = work::checked(line[extra..].windows(memory + 1)).map(|w| self.output(w)).collect();
        state.0 = line.split_off(line.len() - memory);
        y
    }

    /// The output for inputs in time order, as many as taps.
    fn output(&self, inputs: &[f64]) -> f64 {
        self.taps.iter().zip(inputs.iter().rev()).map(|(h, v)| h * v).sum()
    }

    /// Filters `x` with the delay of `(taps − 1)/2` samples of a linear-phase filter taken off, so that the pass band
    /// is not shifted in time: no phase, the gain once. Beyond its ends the record continues by odd reflection.
    ///
    /// # Errors
    /// [`SignalError::EvenTaps`] where that delay is not a whole number of samples; [`SignalError::TooShort`] for an
    /// empty record, or one not longer than the delay.
    pub fn filter_centred(&self, x: &[f64]) -> Result<Vec<f64>, SignalError> {
        let taps = self.taps.len();
        if taps.is_multiple_of(2) {
            return Err(SignalError::EvenTaps { taps });
        }
        let half = taps / 2;
        check_at_least(half + 1, x.len())?;
        let line: Vec<f64> = (-(half as i64)..(x.len() + half) as i64).map(|i| odd_extended(x, i)).collect();
        Ok(work::checked(line.windows(taps)).map(|w| self.output(w)).collect())
    }

    /// Filters `x` forwards and backwards: no phase whatever the taps, the gain squared.
    ///
    /// The record is extended by odd reflection over three times the taps and the filter started in the steady state of
    /// the first extended sample, as `scipy.signal.filtfilt` does.
    ///
    /// # Errors
    /// [`SignalError::TooShort`] where the record is not longer than the reflection.
    pub fn filtfilt(&self, x: &[f64]) -> Result<Vec<f64>, SignalError> {
        let pad = 3 * self.taps.len();
        check_at_least(pad + 1, x.len())?;
        let mut y: Vec<f64> = (-(pad as i64)..(x.len() + pad) as i64).map(|i| odd_extended(x, i)).collect();
        for _ in 0..2 {
            y = self.filter(&y, &mut self.state_at_level(y[0]));
            y.reverse();
        }
        Ok(y[pad..pad + x.len()].to_vec())
    }
}

/// Taps and window of a filter that departs from the ideal by at most `attenuation_db` (positive, the ripple of pass
/// and stop band alike) outside transitions `transition_hz` wide; the rule is empirical and may miss by two or three
/// decibels, more below 40 dB. The number of taps is odd, so any band may be made of it.
///
/// # Errors
/// [`SignalError::Parameter`] for an attenuation below 8 dB or above 200 dB, or a transition that is not between zero
/// and half the sample rate or asks for more than ten million taps; [`SignalError::SampleTime`].
///
/// # Example
/// ```
/// let (taps, window) = signal::filter::kaiser_design(60.0, 20.0, 1e-3)?;
/// assert_eq!(taps, 183);
/// let low = signal::Fir::lowpass(taps, 100.0, window, 1e-3)?;
/// assert!(low.response(110.0).norm() < 1.1e-3 && (low.response(90.0).norm() - 1.0).abs() < 1.1e-3);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Kaiser, J. F. (1974), Proc. IEEE Int. Symp. Circuits and Systems, 20–23.
pub fn kaiser_design(
    attenuation_db: f64,
    transition_hz: f64,
    sample_time_s: f64,
) -> Result<(usize, Window), SignalError> {
    check_sample_time(sample_time_s)?;
    check_range("attenuation_db", attenuation_db, 8.0, 200.0)?;
    let length = |width_hz: f64| (attenuation_db - 7.95) / (2.285 * TAU * width_hz * sample_time_s) + 1.0;
    let narrowest = (attenuation_db - 7.95) / (2.285 * TAU * sample_time_s) / MAX_TAPS;
    check_range("transition_hz", transition_hz, narrowest, 0.5 / sample_time_s)?;
    let taps = length(transition_hz).ceil() as usize;
    Ok((taps | 1, Window::kaiser_for(attenuation_db)))
}

fn design(taps: usize, band: Band, window: Window, sample_time_s: f64) -> Result<Fir, SignalError> {
    check_sample_time(sample_time_s)?;
    band.check(sample_time_s)?;
    check_range("taps", taps as f64, 1.0, MAX_TAPS)?;
    if taps.is_multiple_of(2) && matches!(band, Band::High(_) | Band::Stop(..)) {
        return Err(SignalError::EvenTaps { taps });
    }
    // Edges as fractions of half the sample rate.
    let edge = |hz: f64| 2.0 * hz * sample_time_s;
    let low = |c: f64, m: f64| c * sinc(c * m);
    // At the middle tap an all-pass is one, elsewhere zero: only odd numbers of taps get here.
    let all = |m: f64| if m == 0.0 { 1.0 } else { 0.0 };
    let ideal = |m: f64| match band {
        Band::Low(c) => low(edge(c), m),
        Band::High(c) => all(m) - low(edge(c), m),
        Band::Pass(a, b) => low(edge(b), m) - low(edge(a), m),
        Band::Stop(a, b) => all(m) - low(edge(b), m) + low(edge(a), m),
    };
    let centre = 0.5 * (taps as f64 - 1.0);
    let mut h: Vec<f64> = (0..taps).map(|k| ideal(k as f64 - centre)).collect();
    for (h, w) in h.iter_mut().zip(window.symmetric(taps)?) {
        *h *= w;
    }
    let reference = match band {
        Band::Low(_) | Band::Stop(..) => 0.0,
        Band::High(_) => 1.0,
        Band::Pass(a, b) => 0.5 * (edge(a) + edge(b)),
    };
    let gain: f64 = h.iter().enumerate().map(|(k, h)| h * (PI * reference * (k as f64 - centre)).cos()).sum();
    h.iter_mut().for_each(|h| *h /= gain);
    Fir::new(h, sample_time_s)
}
