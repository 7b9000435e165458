//! Check that local polynomials follow a response, or miss a resonance that is narrower than their window.

use super::{LocalEstimate, LocalKind, LocalModel};
use crate::distributions::f_quantile;
use crate::error::SignalError;

/// Probability with which no window of a record that polynomials do for is taken for one with a resonance.
///
/// Over 300 records of smooth responses of other seeds, rational models were taken in 1 %.
const NO_FALSE_ALARM: f64 = 0.999;

/// Noise below this part of what the output has there is rounding.
const ROUNDING: f64 = 1e-18;

/// A response by local models of second order: polynomials, or rational models where polynomials miss a resonance.
#[derive(Debug, Clone, PartialEq)]
pub struct SuitedResponse {
    /// The estimate by the models that suit the data.
    pub estimate: LocalEstimate,
    /// Which these are.
    pub kind: LocalKind,
    /// Where polynomials leave most beyond what rational models leave, Hz; none where they follow the response.
    pub missed_hz: Option<f64>,
}

/// The response of one output by local polynomials, or by local rational models where what polynomials leave in a
/// window is more than chance makes of what rational models leave there.
///
/// Polynomials have the least variance where they follow the response; beside a resonance that is narrower than a
/// window they leave most of it, and its top comes out too low.
///
/// # Errors
/// Those of [`LocalModel::estimate`] for polynomials; where data are too short for rational models, polynomials remain.
///
/// # Source
/// Pintelon and Schoukens (2012), *System Identification: A Frequency Domain Approach*, §7.2.2.3, for the error of the
/// polynomials; the test is that of F.
pub fn suited_response(inputs: &[&[f64]], output: &[f64], sample_time_s: f64) -> Result<SuitedResponse, SignalError> {
    let smooth = LocalModel::polynomial(2, inputs.len()).estimate(inputs, &[output], sample_time_s)?;
    let sharp = LocalModel::rational(2, inputs.len()).estimate(inputs, &[output], sample_time_s);
    let missed_hz = sharp.as_ref().ok().and_then(|sharp| missed_hz(&smooth, sharp));
    Ok(match (missed_hz, sharp) {
        (Some(_), Ok(sharp)) => SuitedResponse { estimate: sharp, kind: LocalKind::Rational, missed_hz },
        _ => SuitedResponse { estimate: smooth, kind: LocalKind::Polynomial, missed_hz },
    })
}

/// Where the noise by polynomials stands most above that by rational models, if it does so beyond chance.
fn missed_hz(smooth: &LocalEstimate, sharp: &LocalEstimate) -> Option<f64> {
    let count = smooth.noise_density.len();
    let level = NO_FALSE_ALARM.powf(1.0 / count.max(1) as f64);
    let (above, below) = (2.0 * smooth.degrees_of_freedom as f64, 2.0 * sharp.degrees_of_freedom as f64);
    let limit = f_quantile(level, above, below);
    let strongest = smooth.noise_density.iter().copied().fold(0.0, f64::max);
    let mut others = sharp.response.freq_hz.iter().zip(&sharp.noise_density).peekable();
    let mut most: Option<(f64, f64)> = None;
    for (freq_hz, noise) in smooth.response.freq_hz.iter().zip(&smooth.noise_density) {
        while others.next_if(|(other, _)| *other < freq_hz).is_some() {}
        let Some((_, other)) = others.next_if(|(other, _)| *other == freq_hz) else { continue };
        let ratio = noise / other.max(ROUNDING * strongest);
        if ratio > limit && most.is_none_or(|(_, before)| ratio > before) {
            most = Some((*freq_hz, ratio));
        }
    }
    most.map(|(freq_hz, _)| freq_hz)
}
