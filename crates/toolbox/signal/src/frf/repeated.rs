//! The response at the lines that inputs which repeat excite.

use super::FrequencyResponse;
use super::periodic::periodic_response;
use super::repetition::{Periods, Repetition, find};
use crate::error::SignalError;

/// Result of [`repeated_response`].
#[derive(Debug, Clone, PartialEq)]
pub struct RepeatedResponse {
    /// How the inputs repeat.
    pub repetition: Repetition,
    /// For each input the response of every output to it, at the lines that it alone excites; no frequency where there
    /// is no such line.
    pub responses: Vec<FrequencyResponse>,
    /// Frequencies in hertz that several inputs excite at once: one recording does not separate what each contributes.
    pub shared_hz: Vec<f64>,
}

/// Response at the excited lines from one record whose inputs repeat, averaged over periods, with the noise variance
/// from the differences between periods; none where the inputs do not repeat at least twice.
///
/// The period, the stretch in which it holds and the excited harmonics are found, unless `period_s` is given. Periods
/// at the start in which the outputs have not settled are left out, and a drift is taken off. A period that is not a
/// whole number of samples is resampled to one. Noise may be on inputs and outputs. There is no value where nothing is
/// excited.
///
/// # Errors
/// [`SignalError::TooShort`] without an input or for fewer than eight samples; [`SignalError::Parameter`] for a period
/// given in which fewer than two repetitions fit, or after which the inputs do not repeat;
/// [`SignalError::LengthMismatch`], [`SignalError::NonFinite`], [`SignalError::SampleTime`].
///
/// # Example
/// ```
/// let u: Vec<f64> = (0..400).map(|t| if t % 20 < 7 { 1.0 } else { 0.0 }).collect();
/// let y: Vec<f64> = (0..400).map(|t| if t % 20 < 7 { 3.0 } else { 0.0 }).collect();
/// let found = signal::frf::repeated_response(&[&u], &[&y], 0.1, None)?.ok_or(signal::SignalError::Constant)?;
/// assert_eq!((found.repetition.period_samples, found.repetition.periods), (20.0, 20));
/// assert!((found.responses[0].response[0].norm() - 3.0).abs() < 1e-12);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Pintelon and Schoukens (2012), *System Identification: A Frequency Domain Approach*, §2.5 and (2-31) to (2-36).
pub fn repeated_response(
    inputs: &[&[f64]],
    outputs: &[&[f64]],
    sample_time_s: f64,
    period_s: Option<f64>,
) -> Result<Option<RepeatedResponse>, SignalError> {
    let Some((repetition, periods)) = find(inputs, outputs, sample_time_s, period_s)? else { return Ok(None) };
    let step_s = sample_time_s * repetition.period_samples / periods.period as f64;
    let is_shared = |input: usize, harmonic: &usize| {
        let others = repetition.excited.iter().enumerate().filter(|(other, _)| *other != input);
        others.into_iter().any(|(_, excited)| excited.contains(harmonic))
    };
    let mut shared: Vec<usize> = Vec::new();
    let mut responses = Vec::with_capacity(inputs.len());
    for (input, excited) in repetition.excited.iter().enumerate() {
        let (both, alone): (Vec<usize>, Vec<usize>) = excited.iter().partition(|harmonic| is_shared(input, harmonic));
        shared.extend(both);
        if alone.is_empty() {
            responses.push(FrequencyResponse::empty(outputs.len(), 1));
            continue;
        }
        let channels = std::iter::once(input).chain(inputs.len()..inputs.len() + outputs.len());
        let of_input = Periods { channels: channels.map(|c| periods.channels[c].clone()).collect(), ..periods };
        let spectra = of_input.spectra(repetition.unsettled, step_s, &alone)?;
        responses.push(periodic_response(&[spectra], 1)?.response);
    }
    shared.sort_unstable();
    shared.dedup();
    let shared_hz = shared.iter().map(|h| *h as f64 / (repetition.period_samples * sample_time_s)).collect();
    Ok(Some(RepeatedResponse { repetition, responses, shared_hz }))
}
