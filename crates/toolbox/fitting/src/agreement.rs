//! How well modelled values agree with measured ones.

use numerics::vector::variation;

use crate::IdentError;

/// 100(1 − ‖y − ŷ‖/‖y − ȳ‖): 100 is perfect, 0 no better than the mean, negative worse than it. NaN where y does not
/// vary by more than rounding: of nothing, no part is explained.
///
/// # Errors
/// Lengths that differ, or no data.
///
/// # Source
/// The normalised root-mean-square fit customary since Ljung's System Identification Toolbox.
pub fn fit_percent(measured: &[f64], modelled: &[f64]) -> Result<f64, IdentError> {
    same_length(measured, modelled)?;
    let error: f64 = measured.iter().zip(modelled).map(|(y, m)| (y - m).powi(2)).sum();
    Ok(variation(|| measured.iter().copied()).map_or(f64::NAN, |whole| 100.0 * (1.0 - (error / whole).sqrt())))
}

/// Root of the mean squared difference.
///
/// # Errors
/// Lengths that differ, or no data.
pub fn rms_error(measured: &[f64], modelled: &[f64]) -> Result<f64, IdentError> {
    same_length(measured, modelled)?;
    let error: f64 = measured.iter().zip(modelled).map(|(y, m)| (y - m).powi(2)).sum();
    Ok((error / measured.len() as f64).sqrt())
}

fn same_length(a: &[f64], b: &[f64]) -> Result<(), IdentError> {
    if a.len() != b.len() {
        return Err(IdentError::Length { what: "modelled output", expected: a.len(), found: b.len() });
    }
    if a.is_empty() {
        return Err(IdentError::TooFewSamples { samples: 0, parameters: 1 });
    }
    Ok(())
}
