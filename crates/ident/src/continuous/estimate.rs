//! The search from given starting models, and the estimate made of what it finds.

use faer::Mat;

use super::channel::ContinuousChannel;
use super::model::ContinuousModel;
use super::output_error::{Nuisance, OutputError};
use super::record::{Record, records};
use crate::band_limited::Ground;
use crate::colour::{Colour, Sandwich};
use crate::structure_error::StructureError;
use crate::{Bounds, Dataset, Doubt, Fit, IdentError, Minimum, NonlinearOptions, Parametric, Termination, minimise};

/// Samples that starting models are compared on.
const COMPARED: usize = 20_000;

/// Steps each starting model gets before the best is kept.
const TRIAL_STEPS: usize = 15;

/// Condition numbers above this are doubted.
const ILL_CONDITIONED: f64 = 1e7;

/// How the errors are made and minimised.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settings {
    pub(crate) nuisance: Nuisance,
    pub(crate) stable: bool,
    pub(crate) search: NonlinearOptions,
}

/// The estimate of one output.
pub(crate) struct OutputFit<C> {
    pub(crate) model: ContinuousModel<C>,
    pub(crate) minimum: Minimum,
    /// Of the parameters; that of coloured errors where the residuals are.
    pub(crate) covariance: Mat<f64>,
    /// Of Student's t for intervals.
    pub(crate) degrees_of_freedom: f64,
    /// Initial states and offsets that took degrees of freedom.
    nuisance: usize,
    /// Parameters that rest on a bound they were free to leave.
    pub(crate) resting: Vec<usize>,
}

impl<C: ContinuousChannel> OutputFit<C> {
    /// Residuals less whatever was estimated.
    pub(crate) fn remaining(&self) -> f64 {
        self.minimum.degrees_of_freedom() - self.nuisance as f64
    }
}

pub(crate) fn errors<'a, C: ContinuousChannel>(
    model: &ContinuousModel<C>,
    records: &'a [Record<'a>],
    data: &Dataset,
    settings: Settings,
) -> OutputError<'a, C> {
    OutputError {
        model: model.clone(),
        records,
        sample_time_s: data.sample_time_s(),
        intersample: data.intersample(),
        nuisance: settings.nuisance,
        stable: settings.stable,
    }
}

/// Minimises the errors of one output from the best of several starting models.
pub(crate) fn fit_output<C: ContinuousChannel>(
    data: &Dataset,
    records: &[Record<'_>],
    starts: &[ContinuousModel<C>],
    bounds: &[Bounds],
    settings: Settings,
) -> Result<OutputFit<C>, IdentError> {
    let short: Vec<Record<'_>> = records.iter().map(|r| r.shortened(COMPARED / records.len().max(1))).collect();
    let trial = NonlinearOptions { iteration_limit: TRIAL_STEPS, ..settings.search };
    let mut best: Option<(f64, Vec<f64>)> = None;
    let mut failure = None;
    for start in starts {
        let theta = clamped(&start.parameters(), bounds);
        if starts.len() == 1 {
            best = Some((0.0, theta));
            break;
        }
        match minimise(&mut errors(start, &short, data, settings), &theta, bounds, trial) {
            Ok(m) if best.as_ref().is_none_or(|(cost, _)| m.cost < *cost) => best = Some((m.cost, m.parameters)),
            Ok(_) => {}
            Err(error) => failure = Some(error),
        }
    }
    let Some((_, theta)) = best else {
        return Err(failure.unwrap_or(StructureError::NoStart.into()));
    };
    let mut problem = errors(&starts[0], records, data, settings);
    let minimum = minimise(&mut problem, &theta, bounds, settings.search)?;
    judged(&starts[0], minimum, &problem, bounds, records)
}

/// A model that needs no search as the estimate of one output.
pub(crate) fn judge_at<C: ContinuousChannel>(
    data: &Dataset,
    records: &[Record<'_>],
    model: &ContinuousModel<C>,
    bounds: &[Bounds],
    settings: Settings,
    termination: Termination,
) -> Result<OutputFit<C>, IdentError> {
    let mut problem = errors(model, records, data, settings);
    let stay = NonlinearOptions { iteration_limit: 0, ..settings.search };
    let minimum = minimise(&mut problem, &model.parameters(), bounds, stay)?;
    judged(model, Minimum { termination, ..minimum }, &problem, bounds, records)
}

fn judged<C: ContinuousChannel>(
    start: &ContinuousModel<C>,
    minimum: Minimum,
    problem: &OutputError<'_, C>,
    bounds: &[Bounds],
    records: &[Record<'_>],
) -> Result<OutputFit<C>, IdentError> {
    let nuisance = problem.nuisance_rank(&minimum.parameters)?;
    if minimum.degrees_of_freedom() - nuisance as f64 <= 0.0 {
        let parameters = minimum.parameters.len() + nuisance;
        return Err(IdentError::TooFewSamples { samples: minimum.residuals.len(), parameters });
    }
    let free = |j: &usize| bounds[*j].lower < bounds[*j].upper;
    let resting = (0..bounds.len()).filter(free).filter(|j| minimum.at_bound[*j]).collect();
    let (covariance, degrees_of_freedom) = covariance(&minimum, records, nuisance)?;
    let model = start.with_parameters(&minimum.parameters)?;
    Ok(OutputFit { model, minimum, covariance, degrees_of_freedom, nuisance, resting })
}

/// The covariance of the parameters under errors with the autocorrelation of the residuals, and its degrees of freedom.
fn covariance(minimum: &Minimum, records: &[Record<'_>], nuisance: usize) -> Result<(Mat<f64>, f64), IdentError> {
    let remaining = minimum.degrees_of_freedom() - nuisance as f64;
    let mut residuals = minimum.residuals.iter();
    let mut placed = |y: &f64| if y.is_nan() { f64::NAN } else { residuals.next().copied().unwrap_or(f64::NAN) };
    let series: Vec<Vec<f64>> = records.iter().map(|r| r.output[r.first..].iter().map(&mut placed).collect()).collect();
    let colour = Colour::of(&series, 1);
    if colour.is_white() {
        return Ok((faer::Scale(minimum.cost / remaining) * &minimum.unscaled_covariance, remaining));
    }
    let n = minimum.parameters.len();
    let (mut sandwich, mut row, mut index) = (Sandwich::new(&colour, &minimum.unscaled_covariance)?, vec![0.0; n], 0);
    for errors in &series {
        for error in errors {
            row.fill(0.0);
            if !error.is_nan() {
                row.iter_mut().enumerate().for_each(|(j, v)| *v = minimum.jacobian[(index, j)]);
                index += 1;
            }
            sandwich.push(&row);
        }
        sandwich.finish_series();
    }
    let scale = minimum.residuals.len() as f64 / remaining;
    Ok((faer::Scale(scale) * sandwich.covariance(), remaining.min(colour.degrees_of_freedom())))
}

fn clamped(theta: &[f64], bounds: &[Bounds]) -> Vec<f64> {
    theta.iter().zip(bounds).map(|(v, b)| v.max(b.lower).min(b.upper)).collect()
}

/// One model of all outputs. Parameters of different outputs are taken as uncorrelated.
pub(crate) fn combine<C: ContinuousChannel>(
    ground: &Ground<'_>,
    first: usize,
    parts: &[OutputFit<C>],
    settings: Settings,
) -> Result<Fit<ContinuousModel<C>>, IdentError> {
    let channels: Vec<C> = parts.iter().flat_map(|p| p.model.channels().to_vec()).collect();
    let data = ground.plain;
    let noise_covariance = noise_covariance(ground, first, parts)?;
    let model = ContinuousModel::new(channels, data.inputs(), noise_covariance.clone())?;
    let total = model.parameters().len();
    let (mut covariance, mut at_bound) = (Mat::zeros(total, total), Vec::with_capacity(total));
    let (mut offset, mut resting) = (0, Vec::new());
    for part in parts {
        resting.extend(part.resting.iter().map(|j| Doubt::AtBound { parameter: offset + j }));
        let n = part.minimum.parameters.len();
        covariance.submatrix_mut(offset, offset, n, n).copy_from(&part.covariance);
        at_bound.extend_from_slice(&part.minimum.at_bound);
        offset += n;
    }
    let initial_states = super::initial::initial_states(&model, data, settings.nuisance)?;
    let condition = parts.iter().map(|p| p.minimum.condition).fold(1.0, f64::max);
    let samples = parts.iter().map(|p| p.minimum.residuals.len()).min().unwrap_or(0);
    let worst = parts.iter().map(|p| p.minimum.termination).find(|t| !t.converged());
    let loss = parts.iter().map(|p| p.minimum.cost / p.minimum.residuals.len() as f64).product();
    let termination = worst.or(parts.first().map(|p| p.minimum.termination)).unwrap_or(crate::Termination::Direct);
    Ok(Fit {
        covariance,
        degrees_of_freedom: parts.iter().map(|p| p.degrees_of_freedom).fold(f64::INFINITY, f64::min),
        noise_covariance,
        loss,
        samples,
        free_parameters: at_bound.iter().filter(|b| !**b).count(),
        initial_states,
        termination,
        iterations: parts.iter().map(|p| p.minimum.iterations).sum(),
        condition,
        doubts: [doubts(data, samples, termination.converged(), condition), resting].concat(),
        origin: None,
        model,
    }
    .doubting(data))
}

fn doubts(data: &Dataset, samples: usize, converged: bool, condition: f64) -> Vec<Doubt> {
    let mut doubts = Vec::new();
    if !converged {
        doubts.push(Doubt::NotConverged);
    }
    if condition > ILL_CONDITIONED {
        doubts.push(Doubt::IllConditioned { condition });
    }
    if samples < data.samples() {
        doubts.push(Doubt::RowsLeftOut { rows: data.samples() - samples, of: data.samples() });
    }
    doubts
}

/// Covariance of the errors over the rows that all outputs share, degrees of freedom taken off.
fn noise_covariance<C: ContinuousChannel>(
    ground: &Ground<'_>,
    first: usize,
    parts: &[OutputFit<C>],
) -> Result<Mat<f64>, IdentError> {
    let count = parts.len();
    let mut series = Vec::with_capacity(count);
    for (i, part) in parts.iter().enumerate() {
        let mut errors = part.minimum.residuals.iter();
        let spread = records(ground, i, first)?.iter().flat_map(|r| r.output[first..].to_vec()).collect::<Vec<f64>>();
        let aligned = |y: f64| if y.is_nan() { f64::NAN } else { errors.next().copied().unwrap_or(f64::NAN) };
        series.push(spread.into_iter().map(aligned).collect::<Vec<f64>>());
    }
    let scale = |i: usize| parts[i].minimum.residuals.len() as f64 / parts[i].remaining();
    Ok(Mat::from_fn(count, count, |i, j| {
        let products = series[i].iter().zip(&series[j]).map(|(x, y)| x * y).filter(|p| p.is_finite());
        let (sum, rows) = products.fold((0.0, 0.0_f64), |(sum, rows), p| (sum + p, rows + 1.0));
        sum / rows.max(1.0) * (scale(i) * scale(j)).sqrt()
    }))
}
