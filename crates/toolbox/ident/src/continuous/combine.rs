//! One model of all outputs from the estimate of each.

use faer::Mat;
use numerics::linalg;

use super::channel::ContinuousChannel;
use super::estimate::{Combined, OutputFit, Settings, doubts, errors, resting};
use super::model::ContinuousModel;
use super::output_error::Nuisance;
use super::record::{Beginning, records};
use super::{followed, initial, joint};
use crate::data::band_limited::Ground;
use crate::data::excited_lines::Lines;
use crate::{Dataset, Doubt, Fit, IdentError, Parametric, Termination};

/// Ends of a profile this close to those of the covariance are the same, as a part of these.
const SAME: f64 = 0.1;

/// One model of all outputs, from the estimate of each.
pub(crate) fn combine<C: ContinuousChannel>(
    ground: &Ground<'_>,
    beginning: Beginning,
    parts: &[OutputFit<C>],
    settings: Settings,
) -> Result<Fit<ContinuousModel<C>>, IdentError> {
    let combined = match joint::together(ground, beginning, parts, settings)? {
        Some(combined) => combined,
        None => side_by_side(ground, beginning, parts)?,
    };
    let channels: Vec<C> = parts.iter().flat_map(|p| p.model.channels().to_vec()).collect();
    let data = ground.plain;
    let moments = joint::moments(&combined.series);
    let scale = |i: usize| parts[i].minimum.residuals.len() as f64 / parts[i].remaining();
    let noise_covariance =
        Mat::from_fn(parts.len(), parts.len(), |i, j| moments[(i, j)] * (scale(i) * scale(j)).sqrt());
    let model = ContinuousModel::new(channels, data.inputs(), noise_covariance.clone())?;
    let model = model.with_parameters(&combined.parameters)?;
    let levels = levels(ground, beginning, &model, parts, settings)?;
    let followed = followed::doubts(ground, beginning, parts, settings.nuisance.offset)?;
    let resting = combined.resting.iter().map(|parameter| Doubt::AtBound { parameter: *parameter }).collect();
    let samples = parts.iter().map(|p| p.minimum.residuals.len()).min().unwrap_or(0);
    let usual = doubts(data, samples, combined.termination.converged(), combined.condition);
    let past = match (beginning.is_held, beginning.is_refuted) {
        (_, true) => vec![Doubt::HeldBeforeRefuted],
        (true, false) => vec![Doubt::HeldBefore],
        (false, false) => Vec::new(),
    };
    let missed = (0..parts.len()).filter(|output| !parts[*output].is_least);
    let missed = missed.map(|output| Doubt::NotTheLeast { output }).collect();
    let few = few_lines(data, parts)?;
    let fit = Fit {
        covariance: by_profiles(combined.covariance, parts),
        degrees_of_freedom: combined.degrees_of_freedom,
        noise_covariance,
        // Rounding may take the determinant of a singular covariance below zero.
        loss: linalg::determinant(moments.as_ref()).max(0.0),
        samples,
        free_parameters: combined.at_bound.iter().filter(|b| !**b).count(),
        initial_states: Vec::new(),
        levels,
        termination: combined.termination,
        iterations: combined.iterations,
        condition: combined.condition,
        doubts: [few, usual, past, missed, resting, followed].concat(),
        origin: None,
        model,
    };
    let about = fit.without_levels(data)?;
    let nuisance = Nuisance { offset: false, ..settings.nuisance };
    let initial_states = initial::initial_states(&fit.model, &about, nuisance)?;
    Ok(Fit { initial_states, ..fit }.doubting(data).doubting_feedback(&about))
}

/// The covariance with every parameter as uncertain as its profile shows it, where there is one and the covariance
/// differs: the further end counts.
fn by_profiles<C: ContinuousChannel>(mut covariance: Mat<f64>, parts: &[OutputFit<C>]) -> Mat<f64> {
    let (mut first, total) = (0, covariance.nrows());
    for part in parts {
        for ends in &part.ends {
            let (factor, at) = (ends.over_covariance(part), first + ends.parameter);
            if !factor.is_finite() || (factor - 1.0).abs() <= SAME {
                continue;
            }
            for other in 0..total {
                covariance[(at, other)] *= factor;
                covariance[(other, at)] *= factor;
            }
        }
        first += part.minimum.parameters.len();
    }
    covariance
}

/// The constant of every output in each experiment, of one too short to have any their mean; none where none are
/// estimated.
fn levels<C: ContinuousChannel>(
    ground: &Ground<'_>,
    beginning: Beginning,
    model: &ContinuousModel<C>,
    parts: &[OutputFit<C>],
    settings: Settings,
) -> Result<Vec<Vec<f64>>, IdentError> {
    let experiments = ground.plain.experiments();
    if !settings.nuisance.offset {
        return Ok(Vec::new());
    }
    let mut all = vec![vec![0.0; parts.len()]; experiments.len()];
    for (output, part) in parts.iter().enumerate() {
        let channels = model.channels().iter().skip(output * model.channels().len() / parts.len());
        let own = channels.take(ground.plain.inputs()).flat_map(C::parameters).collect::<Vec<f64>>();
        let records = records(ground, output, beginning)?;
        let found = errors(&part.model, &records, ground.plain, settings).levels(&own)?;
        let mean = found.iter().sum::<f64>() / found.len().max(1) as f64;
        let mut found = found.into_iter();
        for (of, experiment) in all.iter_mut().zip(experiments) {
            of[output] = if experiment.len() > beginning.first { found.next().unwrap_or(mean) } else { mean };
        }
    }
    Ok(all)
}

/// The inputs with fewer lines of frequency than the free parameters of a channel ask for; beside a delay that is
/// searched one value more has to be there to refute it.
fn few_lines<C: ContinuousChannel>(data: &Dataset, parts: &[OutputFit<C>]) -> Result<Vec<Doubt>, IdentError> {
    let mut needed = vec![0; data.inputs()];
    for part in parts {
        for ((channel, first), needed) in part.model.channels().iter().zip(part.model.offsets()).zip(&mut needed) {
            let is_free = |j: usize| part.bounds[first + j].lower < part.bounds[first + j].upper;
            let free = (0..channel.parameters().len()).filter(|j| is_free(*j)).count();
            let has_delay = channel.delay_parameter().is_some_and(is_free);
            *needed = (*needed).max(if has_delay { free / 2 + 1 } else { free.div_ceil(2) });
        }
    }
    let doubt = |(input, needed): (usize, usize)| {
        let found = Lines::of(data, input, None, 0.0).all_hz;
        let (lines, strongest_hz) = (found.len(), found.first().copied().unwrap_or(0.0));
        (lines > 0 && lines < needed).then_some(Doubt::FewLines { input, lines, needed, strongest_hz })
    };
    Ok(needed.into_iter().enumerate().filter_map(doubt).collect())
}

/// The estimates of the outputs as they are, those of different outputs taken as uncorrelated.
fn side_by_side<C: ContinuousChannel>(
    ground: &Ground<'_>,
    beginning: Beginning,
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
        series.push(part.residual_series(&records(ground, i, beginning)?).concat());
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
