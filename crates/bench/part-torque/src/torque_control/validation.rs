//! A model of the torque against samples it has not seen.

use ident::validate::{self, fit_percent, rms_error};
use ident::{Dataset, IdentError};
use rig::results::{ResidualTest, Stretch, Trace, Validation};
use rig::{Experiment, Role};

use super::held::HeldDemand;
use super::model::{LAGS, LEVEL};
use super::observed::{Observed, demand_at};

/// Fit, traces and residual tests of `modelled` on `seen`, a stretch without missing samples.
///
/// # Errors
/// No samples.
pub(super) fn judge(
    experiment: &Experiment,
    held: &HeldDemand,
    seen: &Observed,
    modelled: &[f64],
) -> Result<Validation, IdentError> {
    let trace = |values: &[f64]| Trace {
        start_s: seen.times_s.first().copied().unwrap_or(0.0),
        sample_time_s: seen.sample_time_s,
        values: values.to_vec(),
    };
    Ok(Validation {
        stretch: Stretch {
            file: experiment.file.clone(),
            start_s: seen.times_s.first().copied().unwrap_or(0.0),
            end_s: seen.times_s.last().copied().unwrap_or(0.0),
        },
        quantity: Role::AirGapTorque.symbol().to_owned(),
        unit: "Nm".to_owned(),
        fit_percent: fit_percent(&seen.values, modelled)?,
        rms_error: rms_error(&seen.values, modelled)?,
        measured: trace(&seen.values),
        modelled: trace(modelled),
        residuals: residual_test(held, seen, modelled),
    })
}

fn residual_test(held: &HeldDemand, seen: &Observed, modelled: &[f64]) -> Option<ResidualTest> {
    let residuals: Vec<f64> = seen.values.iter().zip(modelled).map(|(y, m)| y - m).collect();
    let data = Dataset::siso(seen.sample_time_s, &demand_at(held, &seen.times_s), &residuals).ok()?;
    let test = validate::ResidualTest { lags: LAGS, level: LEVEL, ..Default::default() };
    let found = test.run_on_residuals(&data).ok()?;
    let (own, cross) = (found.whiteness.into_iter().next()?, found.independence.into_iter().flatten().next()?);
    Some(ResidualTest {
        sample_time_s: seen.sample_time_s,
        level: LEVEL,
        autocorrelation_bound: own.widest_bound(),
        autocorrelation: own.auto,
        cross_correlation_bound: cross.widest_bound(),
        cross_correlation: cross.cross,
        input: Role::DynoTorqueDemand.symbol().to_owned(),
    })
}
