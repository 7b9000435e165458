//! Periodic records: mean spectra, noise from the scatter of periods, and the response from them.

use super::least_squares::LeastSquares;
use super::{FrequencyResponse, check_records, check_some};
use crate::Complex64;
use crate::error::{SignalError, check_at_least, check_range, check_same_length};
use crate::spectrum::fft_real;

/// Fourier coefficients of several channels, averaged over periods, with the noise on those averages.
///
/// A channel is `x(t) = Σ_k X_k e^{j2πkt/P}` plus noise: a cosine of amplitude `A` has `|X| = A/2`.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicSpectra {
    /// Frequencies in hertz.
    pub freq_hz: Vec<f64>,
    /// The harmonics of the period they are.
    pub harmonics: Vec<usize>,
    /// Number of channels.
    pub channels: usize,
    /// Number of periods averaged.
    pub periods: usize,
    /// Means; channel `c` at frequency `k` is at `k · channels + c`.
    pub mean: Vec<Complex64>,
    /// Covariances of the means, `E (X̂_a − X_a)(X̂_b − X_b)*`, at `(k · channels + a) · channels + b`; each has
    /// `periods − 1` degrees of freedom.
    pub covariance: Vec<Complex64>,
}

/// Mean spectra over the last whole periods of a steady-state record of several channels; samples before them are not
/// used.
///
/// `period` is in samples. `harmonics` between 1 and below `period/2`; none means all of them. Put inputs before
/// outputs to hand the result to [`periodic_response`].
///
/// # Errors
/// [`SignalError::TooShort`] for fewer than two periods or no channel; [`SignalError::Parameter`] for a period or a
/// harmonic out of range; [`SignalError::LengthMismatch`], [`SignalError::NonFinite`], [`SignalError::SampleTime`].
///
/// # Example
/// ```
/// let x: Vec<f64> = (0..40).map(|t| (std::f64::consts::TAU * t as f64 / 10.0).cos()).collect();
/// let spectra = signal::frf::periodic_spectra(&[&x], 10, 0.1, &[1])?;
/// assert!((spectra.mean[0].norm() - 0.5).abs() < 1e-12 && spectra.periods == 4);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Pintelon and Schoukens (2012), *System Identification: A Frequency Domain Approach*, (2-31) to (2-33).
pub fn periodic_spectra(
    channels: &[&[f64]],
    period: usize,
    sample_time_s: f64,
    harmonics: &[usize],
) -> Result<PeriodicSpectra, SignalError> {
    check_some(channels)?;
    let length = check_records(channels, sample_time_s)?;
    check_range("period", period as f64, 3.0, f64::MAX)?;
    check_at_least(period.saturating_mul(2), length)?;
    let highest = (period - 1) / 2;
    for &harmonic in harmonics {
        check_range("harmonic", harmonic as f64, 1.0, highest as f64)?;
    }
    let harmonics = if harmonics.is_empty() { (1..=highest).collect() } else { harmonics.to_vec() };
    let periods = length / period;
    let coefficients = period_coefficients(channels, period, &harmonics)?;
    let freq_hz = harmonics.iter().map(|h| *h as f64 / (period as f64 * sample_time_s)).collect();
    let (mean, covariance) = moments(&coefficients, harmonics.len(), channels.len(), periods);
    Ok(PeriodicSpectra { freq_hz, harmonics, channels: channels.len(), periods, mean, covariance })
}

/// Fourier coefficients of the last whole periods: per period, then channel, then harmonic.
pub(super) fn period_coefficients(
    channels: &[&[f64]],
    period: usize,
    harmonics: &[usize],
) -> Result<Vec<Complex64>, SignalError> {
    let length = channels.first().map_or(0, |x| x.len());
    let periods = length / period;
    let mut coefficients = Vec::with_capacity(periods * channels.len() * harmonics.len());
    for p in 0..periods {
        let start = length - (periods - p) * period;
        for channel in channels {
            let spectrum = fft_real(&channel[start..start + period])?;
            coefficients.extend(harmonics.iter().map(|&h| spectrum[h] / period as f64));
        }
    }
    Ok(coefficients)
}

fn moments(
    coefficients: &[Complex64],
    count: usize,
    channels: usize,
    periods: usize,
) -> (Vec<Complex64>, Vec<Complex64>) {
    let at = |p: usize, c: usize, k: usize| coefficients[(p * channels + c) * count + k];
    let average = |k: usize, c: usize| (0..periods).map(|p| at(p, c, k)).sum::<Complex64>() / periods as f64;
    let mean: Vec<Complex64> = (0..count * channels).map(|i| average(i / channels, i % channels)).collect();
    let scale = 1.0 / (periods * (periods - 1)) as f64;
    let mut covariance = Vec::with_capacity(count * channels * channels);
    for k in 0..count {
        let departure = |p: usize, c: usize| at(p, c, k) - mean[k * channels + c];
        for a in 0..channels {
            for b in 0..channels {
                let sum: Complex64 = (0..periods).map(|p| departure(p, a) * departure(p, b).conj()).sum();
                covariance.push(sum * scale);
            }
        }
    }
    (mean, covariance)
}

/// A response from periodic records.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicResponse {
    /// The response; its variance is that from noise on inputs and outputs.
    pub response: FrequencyResponse,
    /// With two or more realisations: the variance of the (mean) response from its scatter across them, which nonlinear
    /// distortion adds to; in the order of the response.
    pub total_variance: Option<Vec<f64>>,
}

/// The frequency response from mean spectra of periodic records whose first `inputs` channels are inputs, the others
/// outputs: `Ĝ = Ŷ Û⁻¹` with one record a column.
///
/// As many records as inputs determine a response; a multiple of that is taken as realisations (records of one
/// realisation one after the other), over which responses are averaged. Noise may be on inputs and outputs and
/// correlated between them, but not between records. Frequencies where the inputs are not independent are left out.
///
/// # Errors
/// [`SignalError::Parameter`] unless `inputs` is at least one and below the number of channels;
/// [`SignalError::LengthMismatch`] for records not of one set of channels and harmonics, or not a multiple of `inputs`;
/// [`SignalError::TooShort`] without a record; [`SignalError::NotExcited`] where no frequency is left.
///
/// # Source
/// Pintelon and Schoukens (2012), *System Identification: A Frequency Domain Approach*, (2-34) to (2-36), §4.3.
pub fn periodic_response(records: &[PeriodicSpectra], inputs: usize) -> Result<PeriodicResponse, SignalError> {
    check_at_least(1, records.len())?;
    let first = &records[0];
    check_range("inputs", inputs as f64, 1.0, first.channels as f64 - 1.0)?;
    check_same_length(records.len().next_multiple_of(inputs), records.len())?;
    for record in records {
        check_same_length(first.channels, record.channels)?;
        check_same_length(first.harmonics.len(), record.harmonics.len())?;
        let moved = first.freq_hz.iter().zip(&record.freq_hz).find(|(a, b)| (*a - *b).abs() > 1e-9 * a.abs());
        if let Some((a, b)) = moved {
            return Err(SignalError::Parameter { name: "freq_hz", value: *b, low: *a, high: *a });
        }
    }
    average(records, inputs)
}

fn average(records: &[PeriodicSpectra], inputs: usize) -> Result<PeriodicResponse, SignalError> {
    let outputs = records[0].channels - inputs;
    let entries = outputs * inputs;
    let realisations = records.len() / inputs;
    let mut response = FrequencyResponse::empty(outputs, inputs);
    let freedom: usize = records.iter().map(|record| 2 * record.periods.saturating_sub(1)).sum();
    let mut total = Vec::new();
    let mut problem = LeastSquares::new(inputs, inputs);
    // Below this an input counts as absent: rounding.
    let powers =
        |j: usize| records.iter().flat_map(move |r| r.mean[j..].iter().step_by(r.channels)).map(|v| v.norm_sqr());
    let no_power: Vec<f64> = (0..inputs).map(|j| 1e-24 * powers(j).fold(0.0, f64::max)).collect();
    for (k, &freq_hz) in work::checked(&records[0].freq_hz).enumerate() {
        let solutions: Option<Vec<_>> =
            records.chunks(inputs).map(|group| solve_group(&mut problem, group, &no_power, k)).collect();
        let Some(solutions) = solutions else { continue };
        response.freq_hz.push(freq_hz);
        response.degrees_of_freedom.push(freedom as f64);
        let count = realisations as f64;
        for e in 0..entries {
            let mean = solutions.iter().map(|s| s[e].0).sum::<Complex64>() / count;
            let scatter: f64 = solutions.iter().map(|s| (s[e].0 - mean).norm_sqr()).sum();
            response.response.push(mean);
            response.variance.push(solutions.iter().map(|s| s[e].1).sum::<f64>() / (count * count));
            total.push(scatter / (count * (count - 1.0)));
        }
    }
    if response.freq_hz.is_empty() {
        return Err(SignalError::NotExcited { freq_hz: records[0].freq_hz.first().copied().unwrap_or(0.0) });
    }
    Ok(PeriodicResponse { response, total_variance: (realisations > 1).then_some(total) })
}

/// Response and noise variance of every entry at harmonic `k`; none where the inputs are not independent.
fn solve_group(
    problem: &mut LeastSquares,
    group: &[PeriodicSpectra],
    no_power: &[f64],
    k: usize,
) -> Option<Vec<(Complex64, f64)>> {
    let (channels, inputs) = (group[0].channels, no_power.len());
    let mean = |record: &PeriodicSpectra, c: usize| record.mean[k * channels + c];
    problem.clear();
    for j in 0..inputs {
        let power: f64 = group.iter().map(|record| mean(record, j).norm_sqr()).sum();
        if power <= no_power[j] || !problem.push(group.iter().map(|record| mean(record, j))) {
            return None;
        }
    }
    // Column e of the inverse: what a change of the output in record e does to the response.
    let (mut unknowns, mut inverse) = (Vec::new(), Vec::new());
    for e in 0..inputs {
        let mut unit = vec![Complex64::ZERO; inputs];
        unit[e].re = 1.0;
        problem.solve(&mut unit, &mut unknowns);
        inverse.push(unknowns.clone());
    }
    let mut entries = Vec::with_capacity((channels - inputs) * inputs);
    for output in inputs..channels {
        let mut y: Vec<Complex64> = group.iter().map(|record| mean(record, output)).collect();
        problem.solve(&mut y, &mut unknowns);
        let errors: Vec<f64> = group.iter().map(|record| error_variance(record, &unknowns, output, k)).collect();
        for (j, value) in unknowns.iter().enumerate() {
            entries.push((*value, (0..inputs).map(|e| inverse[e][j].norm_sqr() * errors[e]).sum()));
        }
    }
    Some(entries)
}

/// Variance of `Y − Σ_j G_j U_j` in one record.
fn error_variance(record: &PeriodicSpectra, row: &[Complex64], output: usize, k: usize) -> f64 {
    let weight = |c: usize| {
        let unit = if c == output { 1.0 } else { 0.0 };
        row.get(c).map_or(Complex64::new(unit, 0.0), |g| -g)
    };
    let n = record.channels;
    let term = |i: usize| weight(i / n) * weight(i % n).conj() * record.covariance[k * n * n + i];
    (0..n * n).map(term).sum::<Complex64>().re.max(0.0)
}
