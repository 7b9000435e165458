//! One model of all outputs from the estimate of each.

use faer::Mat;
use numerics::linalg;

use super::channel::ContinuousChannel;
use super::estimate::{Combined, OutputFit, Settings, doubts, resting};
use super::model::ContinuousModel;
use super::record::records;
use super::{followed, initial, joint};
use crate::band_limited::Ground;
use crate::{Doubt, Fit, IdentError, Parametric, Termination};

/// One model of all outputs, from the estimate of each.
pub(crate) fn combine<C: ContinuousChannel>(
    ground: &Ground<'_>,
    first: usize,
    parts: &[OutputFit<C>],
    settings: Settings,
) -> Result<Fit<ContinuousModel<C>>, IdentError> {
    let combined = match joint::together(ground, first, parts, settings)? {
        Some(combined) => combined,
        None => side_by_side(ground, first, parts)?,
    };
    let channels: Vec<C> = parts.iter().flat_map(|p| p.model.channels().to_vec()).collect();
    let data = ground.plain;
    let moments = joint::moments(&combined.series);
    let scale = |i: usize| parts[i].minimum.residuals.len() as f64 / parts[i].remaining();
    let noise_covariance =
        Mat::from_fn(parts.len(), parts.len(), |i, j| moments[(i, j)] * (scale(i) * scale(j)).sqrt());
    let model = ContinuousModel::new(channels, data.inputs(), noise_covariance.clone())?;
    let model = model.with_parameters(&combined.parameters)?;
    let initial_states = initial::initial_states(&model, data, settings.nuisance)?;
    let followed = followed::doubts(ground, first, parts, settings.nuisance.offset)?;
    let resting = combined.resting.iter().map(|parameter| Doubt::AtBound { parameter: *parameter }).collect();
    let samples = parts.iter().map(|p| p.minimum.residuals.len()).min().unwrap_or(0);
    let usual = doubts(data, samples, combined.termination.converged(), combined.condition);
    Ok(Fit {
        covariance: combined.covariance,
        degrees_of_freedom: combined.degrees_of_freedom,
        noise_covariance,
        // Rounding may take the determinant of a singular covariance below zero.
        loss: linalg::determinant(moments.as_ref()).max(0.0),
        samples,
        free_parameters: combined.at_bound.iter().filter(|b| !**b).count(),
        initial_states,
        termination: combined.termination,
        iterations: combined.iterations,
        condition: combined.condition,
        doubts: [usual, resting, followed].concat(),
        origin: None,
        model,
    }
    .doubting(data))
}

/// The estimates of the outputs as they are, those of different outputs taken as uncorrelated.
fn side_by_side<C: ContinuousChannel>(
    ground: &Ground<'_>,
    first: usize,
    parts: &[OutputFit<C>],
) -> Result<Combined, IdentError> {
    let total = parts.iter().map(|p| p.minimum.parameters.len()).sum();
    let (mut covariance, mut at_bound) = (Mat::zeros(total, total), Vec::with_capacity(total));
    let (mut offset, mut all_resting, mut series) = (0, Vec::new(), Vec::with_capacity(parts.len()));
    for (i, part) in parts.iter().enumerate() {
        let n = part.minimum.parameters.len();
        all_resting.extend(resting(&part.minimum, &part.bounds).iter().map(|j| offset + j));
        covariance.submatrix_mut(offset, offset, n, n).copy_from(&part.covariance);
        at_bound.extend_from_slice(&part.minimum.at_bound);
        series.push(part.residual_series(&records(ground, i, first)?).concat());
        offset += n;
    }
    let worst = parts.iter().map(|p| p.minimum.termination).find(|t| !t.converged());
    Ok(Combined {
        series,
        parameters: parts.iter().flat_map(|p| p.minimum.parameters.clone()).collect(),
        covariance,
        degrees_of_freedom: parts.iter().map(|p| p.degrees_of_freedom).fold(f64::INFINITY, f64::min),
        at_bound,
        resting: all_resting,
        condition: parts.iter().map(|p| p.minimum.condition).fold(1.0, f64::max),
        termination: worst.or(parts.first().map(|p| p.minimum.termination)).unwrap_or(Termination::Direct),
        iterations: parts.iter().map(|p| p.minimum.iterations).sum(),
    })
}
