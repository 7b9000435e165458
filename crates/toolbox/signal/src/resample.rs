//! Values between and off the samples: interpolation, fractional delay, hold, decimation, change of rate.

use serde::{Deserialize, Serialize};

use crate::error::{SignalError, check_at_least, check_finite, check_range};
use crate::extend::odd_extended;
use crate::filter::kaiser_design;
use crate::series::TIME_TOLERANCE_SAMPLES;
use crate::{Fir, Signal, Sos, sinc};

/// How values between the samples are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Interpolation {
    /// A straight line between neighbours: local, never overshoots, attenuates high frequencies.
    Linear,
    /// A Kaiser-windowed sinc over 32 samples a side: better than 1e-4 up to 0.45 of the sample rate, 1e-5 up to 0.4;
    /// rings at steps. Beyond the ends the record is continued by odd reflection.
    BandLimited,
}

/// The signal's values at arbitrary instants.
///
/// `times_s` in any order, in seconds on the signal's clock. Returns one value an instant; an instant on a sample
/// gives that sample.
///
/// # Errors
/// [`SignalError::OutsideRecord`] for an instant more than a millionth of a sample outside the record,
/// [`SignalError::TooShort`] for an empty signal.
///
/// # Example
/// ```
/// use signal::resample::{Interpolation, interpolate_at};
/// let x = signal::Signal::new(0.0, 0.1, vec![0.0, 1.0, 4.0])?;
/// let y = interpolate_at(&x, &[0.05, 0.15], Interpolation::Linear)?;
/// assert!((y[0] - 0.5).abs() < 1e-12 && (y[1] - 2.5).abs() < 1e-12);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn interpolate_at(x: &Signal, times_s: &[f64], method: Interpolation) -> Result<Vec<f64>, SignalError> {
    let value = |&time_s: &f64| Ok(value_at(&x.samples, position(x, time_s)?, method));
    work::checked(times_s).map(value).collect()
}

/// The signal delayed by `delay_s` (negative advances it), on the same clock: `y(t) = x(t − delay_s)`.
///
/// Where `t − delay_s` falls outside the record the end sample is held.
///
/// # Errors
/// [`SignalError::TooShort`] for an empty signal, [`SignalError::NonFinite`] for a delay that is not finite.
///
/// # Example
/// ```
/// use signal::resample::{Interpolation, fractional_delay};
/// let x = signal::Signal::new(0.0, 1.0, vec![0.0, 1.0, 2.0, 3.0])?;
/// let y = fractional_delay(&x, 0.5, Interpolation::Linear)?;
/// assert_eq!(y.samples, vec![0.0, 0.5, 1.5, 2.5]);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn fractional_delay(x: &Signal, delay_s: f64, method: Interpolation) -> Result<Signal, SignalError> {
    check_at_least(1, x.len())?;
    check_finite(&[delay_s])?;
    let shift = delay_s / x.sample_time_s;
    let last = (x.len() - 1) as f64;
    let value = |i| value_at(&x.samples, (i as f64 - shift).clamp(0.0, last), method);
    Ok(x.with_samples(work::checked(0..x.len()).map(value).collect()))
}

/// The value of a held (zero-order-hold) signal at arbitrary instants: the last sample at or before each.
///
/// An instant up to a millionth of a sample time before a sample counts as on it. The last sample holds for ever.
///
/// # Errors
/// [`SignalError::OutsideRecord`] for an instant before the first sample, [`SignalError::TooShort`] for an empty
/// signal.
///
/// # Example
/// ```
/// let x = signal::Signal::new(0.0, 0.1, vec![5.0, 6.0, 7.0])?;
/// assert_eq!(signal::resample::hold(&x, &[0.0999, 0.1, 9.0])?, vec![5.0, 6.0, 7.0]);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn hold(x: &Signal, times_s: &[f64]) -> Result<Vec<f64>, SignalError> {
    check_at_least(1, x.len())?;
    let last = x.len() - 1;
    let value = |&time_s: &f64| {
        let position = (time_s - x.start_s) / x.sample_time_s + TIME_TOLERANCE_SAMPLES;
        if position >= 0.0 { Ok(x.samples[(position as usize).min(last)]) } else { Err(outside(x, time_s)) }
    };
    work::checked(times_s).map(value).collect()
}

/// Every `factor`-th sample, after a zero-phase anti-alias filter.
///
/// The filter is an eighth-order Butterworth low-pass at 0.8 of the new Nyquist frequency, run both ways: −6 dB there,
/// at least −31 dB at the new Nyquist frequency. The first sample is kept in place; a factor of one changes nothing.
///
/// # Errors
/// [`SignalError::Parameter`] for a factor of zero, [`SignalError::TooShort`] for 27 samples or fewer.
pub fn decimate(x: &Signal, factor: usize) -> Result<Signal, SignalError> {
    check_range("factor", factor as f64, 1.0, f64::INFINITY)?;
    if factor == 1 {
        return Ok(x.clone());
    }
    let cutoff_hz = 0.8 * x.nyquist_hz() / factor as f64;
    let smooth = Sos::butterworth_lowpass(8, cutoff_hz, x.sample_time_s)?.filtfilt(&x.samples)?;
    let samples = smooth.into_iter().step_by(factor).collect();
    Signal::new(x.start_s, x.sample_time_s * factor as f64, samples)
}

/// The signal at `up/down` times its sample rate, through one low-pass that takes off images and aliases.
///
/// The filter is a linear-phase FIR by the Kaiser window whose delay is taken off: flat to 1e-4 up to 0.8 of the lower
/// of the two Nyquist frequencies, −80 dB from that on. Constants pass unchanged. Sample 0 is kept in place, and there
/// are `⌈len · up/down⌉` samples; beyond its ends the record continues by odd reflection. The ratio is reduced first.
///
/// # Errors
/// [`SignalError::Parameter`] for a factor of zero or above 10 000 after reduction, [`SignalError::TooShort`] for an
/// empty signal.
///
/// # Example
/// ```
/// let x = signal::Signal::new(0.0, 1e-3, (0..900).map(|t| (0.1 * t as f64).sin()).collect())?;
/// let y = signal::resample::resample_rational(&x, 2, 3)?;
/// assert_eq!((y.len(), y.sample_time_s), (600, 1.5e-3));
/// assert!((y.samples[300] - x.samples[450]).abs() < 1e-3);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Crochiere and Rabiner (1983), *Multirate Digital Signal Processing*, ch. 4 (polyphase structure).
pub fn resample_rational(x: &Signal, up: usize, down: usize) -> Result<Signal, SignalError> {
    let common = greatest_common_divisor(up, down).max(1);
    let (up, down) = (up / common, down / common);
    check_range("up", up as f64, 1.0, MAX_FACTOR)?;
    check_range("down", down as f64, 1.0, MAX_FACTOR)?;
    check_at_least(1, x.len())?;
    if up == down {
        return Ok(x.clone());
    }
    let (branches, half) = polyphase(up, down)?;
    let reach = (half / up) as i64 + 1;
    let padded: Vec<f64> = (-reach..x.len() as i64 + reach).map(|i| odd_extended(&x.samples, i)).collect();
    let length = (x.len() * up).div_ceil(down);
    let value = |i: usize| {
        // On the fine grid output `i` lies at `i·down`; tap `k` there meets `x[(i·down + half − k)/up]`.
        let newest = i * down + half;
        let branch = &branches[newest % up];
        let end = newest / up + reach as usize + 1;
        branch.iter().zip(padded[..end].iter().rev()).map(|(h, v)| h * v).sum()
    };
    Signal::new(x.start_s, x.sample_time_s * down as f64 / up as f64, work::checked(0..length).map(value).collect())
}

/// Content below the Nyquist frequency of the signal that holds each sample until the next, on the same clock.
///
/// The held signal at `t` has there the mean of the band-limited signal through the samples over the sample time before
/// `t`: half a sample later, and lower by `sin(ωT/2)/(ωT/2)`. This is what a low-pass filter has to be given before a
/// held signal is brought to a longer sample time. Beyond the ends the record continues by odd reflection.
///
/// # Errors
/// [`SignalError::TooShort`] for an empty signal.
///
/// # Example
/// ```
/// let x = signal::Signal::new(0.0, 1.0, (0..200).map(f64::from).collect())?;
/// let y = signal::resample::band_of_held(&x)?;
/// assert!((y.samples[100] - 99.5).abs() < 1e-6);
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn band_of_held(x: &Signal) -> Result<Signal, SignalError> {
    let nodes = GAUSS.map(|(at, weight)| (0.5 + 0.5 * at, 0.5 * weight));
    averaged(x, &nodes)
}

/// Content below the Nyquist frequency of the signal that runs straight from sample to sample, on the same clock. It is
/// lower than the band-limited signal through the samples by `(sin(ωT/2)/(ωT/2))²`, and no later. See [`band_of_held`].
///
/// # Errors
/// [`SignalError::TooShort`] for an empty signal.
pub fn band_of_straight(x: &Signal) -> Result<Signal, SignalError> {
    let after = GAUSS.map(|(at, weight)| (0.5 + 0.5 * at, 0.5 * weight * (0.5 - 0.5 * at)));
    let before = after.map(|(at, weight)| (-at, weight));
    averaged(x, &[after, before].concat())
}

/// Nodes and weights of Gauss and Legendre on −1 … 1.
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// The sum of the band-limited signal at so many samples before each, weighed.
fn averaged(x: &Signal, nodes: &[(f64, f64)]) -> Result<Signal, SignalError> {
    check_at_least(1, x.len())?;
    let reach = sinc::HALF_WIDTH as i64 + 1;
    let tap = |place: i64| -> f64 {
        let lone = |index: i64| f64::from(u8::from(index == place));
        nodes.iter().map(|(late, weight)| weight * sinc::interpolate(lone, -late)).sum()
    };
    let taps: Vec<f64> = (-reach..=reach).map(tap).collect();
    let padded: Vec<f64> = (-reach..x.len() as i64 + reach).map(|i| odd_extended(&x.samples, i)).collect();
    let sum = |near: &[f64]| near.iter().zip(&taps).map(|(v, tap)| v * tap).sum();
    Ok(x.with_samples(work::checked(padded.windows(taps.len())).map(sum).collect()))
}

const MAX_FACTOR: f64 = 1e4;

/// The anti-alias filter, tap `k` in branch `k mod up`, each branch of gain one at rest; and its delay in fine samples.
fn polyphase(up: usize, down: usize) -> Result<(Vec<Vec<f64>>, usize), SignalError> {
    let nyquist = 0.5 / up.max(down) as f64;
    let (taps, window) = kaiser_design(80.0, 0.2 * nyquist, 1.0)?;
    let low = Fir::lowpass(taps, 0.9 * nyquist, window, 1.0)?;
    let branch = |phase: usize| {
        let taps: Vec<f64> = low.taps().iter().skip(phase).step_by(up).copied().collect();
        let gain: f64 = taps.iter().sum();
        taps.into_iter().map(|h| h / gain).collect()
    };
    Ok(((0..up).map(branch).collect(), taps / 2))
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}

/// The index of an instant, between 0 and the last.
fn position(x: &Signal, time_s: f64) -> Result<f64, SignalError> {
    check_at_least(1, x.len())?;
    let last = (x.len() - 1) as f64;
    let position = (time_s - x.start_s) / x.sample_time_s;
    if position >= -TIME_TOLERANCE_SAMPLES && position <= last + TIME_TOLERANCE_SAMPLES {
        Ok(position.clamp(0.0, last))
    } else {
        Err(outside(x, time_s))
    }
}

fn outside(x: &Signal, time_s: f64) -> SignalError {
    SignalError::OutsideRecord { time_s, start_s: x.start_s, end_s: x.end_s() }
}

/// `position` must lie within the samples, which must not be empty.
fn value_at(x: &[f64], position: f64, method: Interpolation) -> f64 {
    let nearest = position.round();
    if (position - nearest).abs() < 1e-9 {
        return x[nearest as usize];
    }
    match method {
        Interpolation::Linear => {
            let below = position.floor();
            let fraction = position - below;
            x[below as usize] * (1.0 - fraction) + x[below as usize + 1] * fraction
        }
        Interpolation::BandLimited => sinc::interpolate_slice(x, |i| odd_extended(x, i), position),
    }
}
