//! Ripple of the drive: lines in the spectrum of what the response does not explain.

use std::f64::consts::TAU;

use ident::distributions::chi_squared_quantile;
use numerics::order;
use signal::SignalError;
use signal::spectrum::fft_real;

/// Below this frequency a line cannot be separated from the demand's own content, Hz.
const LOWEST_HZ: f64 = 20.0;
/// Lines are searched up to this fraction of the sample rate.
const HIGHEST: f64 = 0.49;
/// The floor beside a line is taken within this distance, Hz.
const NEIGHBOURHOOD_HZ: f64 = 10.0;
/// Two lines must be further apart than this, Hz.
const SEPARATION_HZ: f64 = 1.0;
/// Chance of taking noise for a line.
const FALSE_ALARM: f64 = 0.01;
/// Where an inverter's ripple is, Hz: at twice and six times the frequency of mains of 50 and 60 Hz (a rectifier's
/// pulses).
pub const OF_MAINS_HZ: [f64; 4] = [100.0, 120.0, 300.0, 360.0];
/// A line this near to a multiple of the sample rate, in parts of that, cannot be separated from what stands still.
const STANDS_STILL: f64 = 1e-3;

/// The ripple of mains that samples this far apart fold to zero frequency, Hz: what it adds looks like an offset, and
/// what it multiplies by looks like a gain.
pub(crate) fn folded_to_zero_hz(sample_time_s: f64) -> Option<f64> {
    OF_MAINS_HZ.into_iter().find(|frequency_hz| stands_still(*frequency_hz, sample_time_s))
}

/// Tells whether samples this far apart fold a frequency to zero.
pub(crate) fn stands_still(frequency_hz: f64, sample_time_s: f64) -> bool {
    let turns = frequency_hz * sample_time_s;
    turns > 0.5 && (turns - turns.round()).abs() < STANDS_STILL
}

/// The strongest line of the residuals above 20 Hz that is none of `known_hz`, if it stands out of the floor beside it.
///
/// `residuals` lie at `places` of a raster; what is missing counts as zero. Under the hypothesis of no line the
/// periodogram at each of N/2 frequencies is exponentially distributed about the floor, which is its median over ln 2.
///
/// # Errors
/// Those of the Fourier transform.
///
/// # Source
/// Fisher, *Tests of significance in harmonic analysis*, 1929, with a local floor in place of the global one.
pub(crate) fn strongest_line(
    residuals: &[f64],
    places: &[usize],
    sample_time_s: f64,
    known_hz: &[f64],
) -> Result<Option<f64>, SignalError> {
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return Ok(None) };
    let span = last - first + 1;
    let length = (2 * span).next_power_of_two();
    let mut windowed = vec![0.0; length];
    for (place, r) in places.iter().zip(residuals) {
        let at = place - first;
        windowed[at] = r * (0.5 - 0.5 * (TAU * (at as f64 + 0.5) / span as f64).cos());
    }
    let power: Vec<f64> = fft_real(&windowed)?.iter().map(|x| x.norm_sqr()).collect();
    let bin_hz = 1.0 / (length as f64 * sample_time_s);
    let taken = |k: usize| known_hz.iter().any(|f| (k as f64 * bin_hz - f).abs() < SEPARATION_HZ);
    let (low, high) = ((LOWEST_HZ / bin_hz).ceil() as usize, (HIGHEST * length as f64) as usize);
    let peak = (low..high.min(power.len())).filter(|k| !taken(*k)).max_by(|a, b| power[*a].total_cmp(&power[*b]));
    let threshold = (span as f64 / (2.0 * FALSE_ALARM)).ln();
    let width_hz = 4.0 / (span as f64 * sample_time_s);
    Ok(peak.filter(|k| power[*k] > threshold * floor(&power, *k, bin_hz, width_hz)).map(|k| k as f64 * bin_hz))
}

/// Mean of the periodogram beside a line, from its median.
fn floor(power: &[f64], peak: usize, bin_hz: f64, width_hz: f64) -> f64 {
    let reach = (NEIGHBOURHOOD_HZ / bin_hz) as usize;
    let beside = |k: &usize| k.abs_diff(peak) as f64 * bin_hz > width_hz;
    let mut around: Vec<f64> =
        (peak.saturating_sub(reach)..(peak + reach).min(power.len())).filter(beside).map(|k| power[k]).collect();
    order::upper_median(&mut around).map_or(f64::INFINITY, |median| median / std::f64::consts::LN_2)
}

/// Tells whether a further line lowers the cost by more than chance would, considering that its frequency was searched
/// for.
pub(crate) fn lowers_cost(before: f64, after: f64, samples: usize, parameters: usize) -> bool {
    let frequencies = (samples as f64 / 2.0).max(1.0);
    let freedom = samples.saturating_sub(parameters).max(1) as f64;
    (before - after) > chi_squared_quantile(1.0 - FALSE_ALARM / frequencies, 5.0) * after / freedom
}
