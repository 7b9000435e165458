//! Delays read without a model: slope of the phase, and peak of the cross-correlation.

use std::f64::consts::TAU;

use faer::Mat;
use ident::least_squares;
use signal::correlation::delay_by_correlation;
use signal::resample::{Interpolation, interpolate_at};
use signal::spectrum::{CrossSpectrum, Welch, cross_spectrum};
use signal::{Complex64, Signal, SignalError};

/// Length of a segment of the cross-spectrum, s.
const SEGMENT_S: f64 = 4.0;
/// Longest delay the correlation looks for, s.
const LONGEST_S: f64 = 0.06;
/// Stretches between which the peak of the correlation scatters, and the fewest that say how much.
const PARTS: usize = 8;
const FEWEST: usize = 4;
/// The coherence from which on the phase of a bin is a guide to that of the next.
const LEADING: f64 = 0.5;
/// Coherences closer to one than this count as this close.
const NEAREST_TO_ONE: f64 = 1e-9;

/// A delay and its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Measured {
    pub(super) delay_s: f64,
    pub(super) standard_error_s: f64,
    pub(super) degrees_of_freedom: f64,
    /// Mean coherence over the band.
    pub(super) coherence: f64,
}

impl Measured {
    /// The same with a systematic part that is uniform within ±`most_s`.
    pub(super) fn off_by(self, most_s: f64) -> Self {
        Measured { standard_error_s: self.standard_error_s.hypot(most_s / 3f64.sqrt()), ..self }
    }
}

/// Bend of the phase beside its fall with the frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Curvature {
    /// −ωτ + c ω³: a low-pass at low frequencies.
    Cubic,
    /// −ωτ + c/ω: what is left of a coupling above its resonance.
    Hyperbolic,
}

/// Two signals on the raster of the first, over the time both were recorded.
///
/// # Errors
/// No time in common.
pub(super) fn on_one_raster(first: &Signal, second: &Signal) -> Result<(Signal, Signal), SignalError> {
    let (from, to) = (first.start_s.max(second.start_s), first.end_s().min(second.end_s()));
    let common = first.slice(from, to + 0.5 * first.sample_time_s);
    let inside = |t: &f64| *t <= second.end_s() + 1e-7 * second.sample_time_s;
    let times: Vec<f64> = (0..common.len()).map(|i| common.time_s(i)).take_while(inside).collect();
    let moved = interpolate_at(second, &times, Interpolation::BandLimited)?;
    let common = common.with_samples(common.samples[..times.len()].to_vec());
    Ok((common.clone(), common.with_samples(moved)))
}

/// Delay of `later` against `earlier` (one raster) from the phase of their cross-spectrum between two frequencies,
/// weighted by γ²/(1 − γ²), the inverse variance of a measured phase.
///
/// Returns `None` where nothing is coherent.
///
/// # Errors
/// Those of the cross-spectrum.
///
/// # Source
/// Bendat & Piersol, *Random Data*, 4th ed., §9.1 (variance of the phase).
pub(super) fn phase_slope(
    earlier: &Signal,
    later: &Signal,
    band_hz: (f64, f64),
    curvature: Curvature,
) -> Result<Option<Measured>, SignalError> {
    let segment = ((SEGMENT_S / earlier.sample_time_s) as usize).min(earlier.len() / 4);
    let welch = Welch::half_overlapping(segment);
    let spectrum = cross_spectrum(&earlier.samples, &later.samples, earlier.sample_time_s, welch)?;
    Ok(regress_phase(&spectrum, band_hz, curvature))
}

fn regress_phase(spectrum: &CrossSpectrum, (low, high): (f64, f64), curvature: Curvature) -> Option<Measured> {
    let coherence = spectrum.coherence();
    let inside = |k: &usize| spectrum.freq_hz[*k] >= low && spectrum.freq_hz[*k] <= high;
    let bins: Vec<usize> = (0..spectrum.freq_hz.len()).filter(inside).collect();
    let phases = unwrapped(bins.iter().map(|k| (spectrum.pxy[*k], coherence[*k])));
    let scale = TAU * high;
    let weight = |k: usize| (coherence[k] / (1.0 - coherence[k]).max(NEAREST_TO_ONE)).sqrt();
    let regressors = Mat::from_fn(bins.len(), 2, |i, j| {
        let relative = TAU * spectrum.freq_hz[bins[i]] / scale;
        let column = match (j, curvature) {
            (0, _) => -relative,
            (_, Curvature::Cubic) => relative.powi(3),
            (_, Curvature::Hyperbolic) => 1.0 / relative,
        };
        weight(bins[i]) * column
    });
    let target: Vec<f64> = bins.iter().zip(&phases).map(|(k, p)| weight(*k) * p).collect();
    let fit = least_squares(regressors.as_ref(), &target).ok()?;
    Some(Measured {
        delay_s: fit.parameters[0] / scale,
        standard_error_s: fit.covariance()[(0, 0)].sqrt() / scale,
        degrees_of_freedom: fit.degrees_of_freedom(),
        coherence: bins.iter().map(|k| coherence[*k]).sum::<f64>() / bins.len() as f64,
    })
}

/// Phases without jumps of whole turns, from cross-spectra and coherences. The phase of an incoherent bin, as that on
/// an engine order, is by chance: none follows it.
fn unwrapped(values: impl Iterator<Item = (Complex64, f64)>) -> Vec<f64> {
    let mut last = 0.0;
    let unwrap = |(z, coherence): (Complex64, f64)| {
        let phase = z.arg() - TAU * ((z.arg() - last) / TAU).round();
        if coherence >= LEADING {
            last = phase;
        }
        phase
    };
    values.map(unwrap).collect()
}

/// Delay by the peak of the cross-correlation, if it lies inside the range searched, with the standard error that the
/// scatter between stretches of equal length gives it; infinite where these are too few.
///
/// # Errors
/// Those of the cross-correlation.
pub(super) fn correlation_peak(earlier: &Signal, later: &Signal) -> Result<Option<Measured>, SignalError> {
    let peak = |from: usize, to: usize| {
        let (x, y) = (&earlier.samples[from..to], &later.samples[from..to]);
        let found = delay_by_correlation(x, y, earlier.sample_time_s, LONGEST_S)?;
        Ok((!found.at_edge).then_some(found.delay_s))
    };
    let Some(delay_s) = peak(0, earlier.len())? else { return Ok(None) };
    let length = earlier.len() / PARTS;
    let is_flat = |x: &[f64]| x.iter().all(|v| *v == x[0]);
    let moving = |k: &usize| length > 1 && !is_flat(&earlier.samples[k * length..(k + 1) * length]);
    // A stretch in which nothing happens has no peak of its own.
    let parts: Vec<f64> =
        (0..PARTS).filter(moving).filter_map(|k| peak(k * length, (k + 1) * length).ok().flatten()).collect();
    let count = parts.len() as f64;
    let mean = parts.iter().sum::<f64>() / count;
    let variance = parts.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let standard_error_s = if parts.len() < FEWEST { f64::INFINITY } else { (variance / count).sqrt() };
    Ok(Some(Measured { delay_s, standard_error_s, degrees_of_freedom: count - 1.0, coherence: 1.0 }))
}
