//! The search from given starting models, and the estimate made of what it finds.

use faer::Mat;
use numerics::vector::sum_of_squares;

use super::channel::ContinuousChannel;
use super::model::ContinuousModel;
use super::output_error::{Nuisance, OutputError};
use super::record::{Record, liveliest};
use crate::colour::{Colour, Sandwich, no_less_than};
use crate::distributions::student_t_quantile;
use crate::{
    Bounds, Dataset, Doubt, IdentError, Minimum, NonlinearOptions, Parametric, ResidualModel, Termination, minimise,
};
use fitting::StructureError;
use fitting::nonlinear::lowest_point;

/// Samples that starting models are compared on.
const COMPARED: usize = 20_000;

/// Rows from which on a search goes by way of so many.
const LONG: usize = 5 * COMPARED;

/// Best of the starting models after a few steps that short data are searched from to the end.
const POLISHED: usize = 3;

/// Steps each starting model gets before the best is kept.
const TRIAL_STEPS: usize = 15;

/// Confidence of the intervals by profiles.
const LEVEL: f64 = 0.95;

/// Condition numbers above this are doubted.
const ILL_CONDITIONED: f64 = 1e7;

/// How the errors are made and minimised.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settings {
    pub(crate) nuisance: Nuisance,
    pub(crate) stable: bool,
    pub(crate) search: NonlinearOptions,
}

impl Settings {
    /// The same for stretches of the records: one that begins later than its record does not begin at rest.
    pub(crate) fn within(self, stretches: &[Record<'_>], records: &[Record<'_>]) -> Self {
        let later = stretches.iter().zip(records).any(|(stretch, record)| stretch.first > record.first);
        let initial_state = self.nuisance.initial_state || later;
        Settings { nuisance: Nuisance { initial_state, ..self.nuisance }, ..self }
    }
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
    pub(crate) nuisance: usize,
    pub(crate) bounds: Vec<Bounds>,
    /// Of the parameters whose profiles were looked at, such as delays.
    pub(crate) ends: Vec<Ends>,
    /// True if no profile has shown smaller errors of other parameters.
    pub(crate) is_least: bool,
    /// True if the errors are smallest here; otherwise the estimate is of another kind.
    pub(crate) is_searched: bool,
}

/// The values of one parameter that the errors do not refute.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ends {
    /// Index of the parameter.
    pub(crate) parameter: usize,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Ends {
    /// How far the further end is from the estimate, over what the covariance has.
    pub(crate) fn over_covariance<C: ContinuousChannel>(&self, part: &OutputFit<C>) -> f64 {
        let (below, above) = self.about(part);
        below.max(above) / (quantile(part) * part.covariance[(self.parameter, self.parameter)].sqrt())
    }

    /// How far the ends are below and above the estimate.
    pub(crate) fn about<C: ContinuousChannel>(&self, part: &OutputFit<C>) -> (f64, f64) {
        let value = part.minimum.parameters[self.parameter];
        (value - self.low, self.high - value)
    }
}

/// That of Student's t which intervals of this confidence take.
pub(crate) fn quantile<C: ContinuousChannel>(part: &OutputFit<C>) -> f64 {
    student_t_quantile(0.5 + 0.5 * LEVEL, part.degrees_of_freedom)
}

/// Combination of the estimates of all outputs.
pub(crate) struct Combined {
    /// The errors of each output over all records, NaN where it is not measured.
    pub(crate) series: Vec<Vec<f64>>,
    pub(crate) parameters: Vec<f64>,
    pub(crate) covariance: Mat<f64>,
    pub(crate) degrees_of_freedom: f64,
    pub(crate) at_bound: Vec<bool>,
    /// Parameters that rest on a bound they were free to leave.
    pub(crate) resting: Vec<usize>,
    pub(crate) condition: f64,
    pub(crate) termination: Termination,
    pub(crate) iterations: usize,
}

impl<C: ContinuousChannel> OutputFit<C> {
    /// Residuals less whatever was estimated.
    pub(crate) fn remaining(&self) -> f64 {
        self.minimum.degrees_of_freedom() - self.nuisance as f64
    }

    /// The residuals of each record from its first sample on, NaN where the output is not measured.
    pub(crate) fn residual_series(&self, records: &[Record<'_>]) -> Vec<Vec<f64>> {
        residual_series(&self.minimum, records)
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

/// Minimises the errors of one output from the best of several starting models, and from the next best where that turns
/// out to be better on all of the data.
pub(crate) fn fit_output<C: ContinuousChannel>(
    data: &Dataset,
    records: &[Record<'_>],
    starts: &[ContinuousModel<C>],
    bounds: &[Bounds],
    settings: Settings,
) -> Result<OutputFit<C>, IdentError> {
    let tried = try_starts(data, records, starts, bounds, settings)?;
    let mut problem = errors(&starts[0], records, data, settings);
    // One that was given has been searched for.
    let is_long = starts.len() > 1 && records.iter().map(Record::rows).sum::<usize>() >= LONG;
    let begin = match is_long {
        true => refined(data, records, &starts[0], &tried[0], bounds, settings),
        false => tried[0].clone(),
    };
    let mut found = minimum_from(&mut problem, &begin, bounds, settings);
    let (mut residuals, is_short) = (vec![0.0; problem.residual_count()], problem.residual_count() < COMPARED);
    for (place, theta) in tried.iter().enumerate().skip(1) {
        let least = found.as_ref().map_or(f64::INFINITY, |minimum| minimum.cost);
        // The start that is best after a few steps need not lead lowest.
        let is_better = problem.evaluate(theta, &mut residuals, None).is_ok() && sum_of_squares(&residuals) < least;
        if !(is_better || is_short && place < POLISHED) {
            continue;
        }
        match minimum_from(&mut problem, theta, bounds, settings) {
            Ok(other) if other.cost < least => found = Ok(other),
            _ => {}
        }
    }
    let minimum = found?;
    judged(&starts[0], minimum, &problem, bounds, records)
}

/// The minimum from these parameters; where it has equal time constants, with these a little apart.
fn minimum_from<C: ContinuousChannel>(
    problem: &mut OutputError<'_, C>,
    theta: &[f64],
    bounds: &[Bounds],
    settings: Settings,
) -> Result<Minimum, IdentError> {
    let first = minimise(problem, theta, bounds, settings.search);
    if !matches!(first, Err(IdentError::RankDeficient { .. })) {
        return first;
    }
    let lowest = lowest_point(problem, theta, bounds, settings.search)?;
    let model = problem.model.with_parameters(&lowest.parameters)?;
    let apart: Vec<f64> =
        model.channels().iter().flat_map(|c| c.apart().unwrap_or_else(|| c.clone()).parameters()).collect();
    if apart == lowest.parameters {
        return first;
    }
    let stay = NonlinearOptions { iteration_limit: 0, ..settings.search };
    let minimum = minimise(problem, &clamped(&apart, bounds), bounds, stay)?;
    Ok(Minimum { termination: lowest.termination, iterations: lowest.iterations, ..minimum })
}

/// Where a search in long data begins: at the minimum of their liveliest part, from which few steps are left.
fn refined<C: ContinuousChannel>(
    data: &Dataset,
    records: &[Record<'_>],
    start: &ContinuousModel<C>,
    theta: &[f64],
    bounds: &[Bounds],
    settings: Settings,
) -> Vec<f64> {
    let short = liveliest(records, COMPARED);
    let within = settings.within(&short, records);
    let found = lowest_point(&mut errors(start, &short, data, within), theta, bounds, within.search);
    found.map_or_else(|_| theta.to_vec(), |lowest| lowest.parameters)
}

/// The model with the least errors on the liveliest part of the data that the best of these starting models leads to,
/// whether the errors determine its parameters or not.
pub(crate) fn lowest_model<C: ContinuousChannel>(
    data: &Dataset,
    records: &[Record<'_>],
    starts: &[ContinuousModel<C>],
    bounds: &[Bounds],
    settings: Settings,
) -> Option<ContinuousModel<C>> {
    let start = starts.first()?;
    let tried = try_starts(data, records, starts, bounds, settings).ok()?;
    start.with_parameters(&refined(data, records, start, &tried[0], bounds, settings)).ok()
}

/// The sum of squared errors of a model, where it has one.
pub(crate) fn cost<C: ContinuousChannel>(
    data: &Dataset,
    records: &[Record<'_>],
    model: &ContinuousModel<C>,
    settings: Settings,
) -> Option<f64> {
    let mut problem = errors(model, records, data, settings);
    let mut residuals = vec![0.0; problem.residual_count()];
    problem.evaluate(&model.parameters(), &mut residuals, None).ok()?;
    Some(sum_of_squares(&residuals)).filter(|cost| cost.is_finite())
}

/// Improves each starting model by a few steps on the liveliest part of the data, best first; a single one stays as it
/// is.
fn try_starts<C: ContinuousChannel>(
    data: &Dataset,
    records: &[Record<'_>],
    starts: &[ContinuousModel<C>],
    bounds: &[Bounds],
    settings: Settings,
) -> Result<Vec<Vec<f64>>, IdentError> {
    if let [start] = starts {
        return Ok(vec![clamped(&start.parameters(), bounds)]);
    }
    let short = liveliest(records, COMPARED);
    let settings = settings.within(&short, records);
    let trial = NonlinearOptions { iteration_limit: TRIAL_STEPS, ..settings.search };
    let (mut tried, mut failure) = (Vec::with_capacity(starts.len()), None);
    for start in starts {
        let theta = clamped(&start.parameters(), bounds);
        match lowest_point(&mut errors(start, &short, data, settings), &theta, bounds, trial) {
            Ok(lowest) => tried.push(lowest),
            Err(error) => failure = Some(error),
        }
    }
    if tried.is_empty() {
        return Err(failure.unwrap_or(StructureError::NoStart.into()));
    }
    tried.sort_by(|x, y| x.cost.total_cmp(&y.cost));
    Ok(tried.into_iter().map(|lowest| lowest.parameters).collect())
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
    let found = judged(model, Minimum { termination, ..minimum }, &problem, bounds, records)?;
    Ok(OutputFit { is_searched: false, ..found })
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
    let (covariance, degrees_of_freedom) = covariance(&minimum, records, nuisance)?;
    let model = start.with_parameters(&minimum.parameters)?;
    Ok(OutputFit {
        model,
        minimum,
        covariance,
        degrees_of_freedom,
        nuisance,
        bounds: bounds.to_vec(),
        ends: Vec::new(),
        is_least: true,
        is_searched: true,
    })
}

/// Parameters that rest on a bound they were free to leave.
pub(crate) fn resting(minimum: &Minimum, bounds: &[Bounds]) -> Vec<usize> {
    let free = |j: &usize| bounds[*j].lower < bounds[*j].upper;
    (0..bounds.len()).filter(free).filter(|j| minimum.at_bound[*j]).collect()
}

fn residual_series(minimum: &Minimum, records: &[Record<'_>]) -> Vec<Vec<f64>> {
    let mut residuals = minimum.residuals.iter();
    let mut placed = |y: &f64| if y.is_nan() { f64::NAN } else { residuals.next().copied().unwrap_or(f64::NAN) };
    records.iter().map(|r| r.output[r.first..].iter().map(&mut placed).collect()).collect()
}

/// The covariance of the parameters under errors with the autocorrelation of the residuals, and its degrees of freedom.
fn covariance(minimum: &Minimum, records: &[Record<'_>], nuisance: usize) -> Result<(Mat<f64>, f64), IdentError> {
    let remaining = minimum.degrees_of_freedom() - nuisance as f64;
    let series = residual_series(minimum, records);
    let colour = Colour::of(&series, 1);
    let white = faer::Scale(minimum.cost / remaining) * &minimum.unscaled_covariance;
    if colour.is_white() {
        return Ok((white, remaining));
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
    let coloured = faer::Scale(scale) * sandwich.covariance();
    Ok((no_less_than(&white, &coloured), remaining.min(colour.degrees_of_freedom())))
}

fn clamped(theta: &[f64], bounds: &[Bounds]) -> Vec<f64> {
    theta.iter().zip(bounds).map(|(v, b)| v.max(b.lower).min(b.upper)).collect()
}

pub(super) fn doubts(data: &Dataset, samples: usize, converged: bool, condition: f64) -> Vec<Doubt> {
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use lti::ProcessModel;

    use super::*;
    use crate::continuous::ProcessSystem;
    use crate::continuous::record::{Beginning, records};
    use crate::data::band_limited::Ground;

    #[test]
    fn regress_a_search_that_its_limit_ends_at_equal_lags_is_not_said_to_converge() {
        let mut random = signal::excitation::Random::new(4);
        let u: Vec<f64> = (0..200).map(|_| random.normal()).collect();
        let mut y = vec![0.0; 200];
        for t in 1..200 {
            y[t] = 0.8 * y[t - 1] + 0.2 * u[t - 1];
        }
        let data = Dataset::siso(0.1, &u, &y).unwrap();
        let ground = Ground::new(&data, true).unwrap();
        let records = records(&ground, 0, Beginning { first: 0, is_held: false, is_refuted: false }).unwrap();
        let channel = ProcessModel::new(1.0).unwrap().with_lags(vec![0.5, 0.5]).unwrap();
        let model = ProcessSystem::new(vec![channel], 1, Mat::identity(1, 1)).unwrap();
        let bounds = [Bounds::NONE, Bounds::new(0.01, 10.0), Bounds::new(0.01, 10.0)];
        // One step from equal lags, whose columns are the same, leads to equal lags.
        let search = NonlinearOptions { iteration_limit: 1, ..NonlinearOptions::default() };
        let nuisance = Nuisance { initial_state: false, offset: false };
        let settings = Settings { nuisance, stable: true, search };
        let mut problem = errors(&model, &records, &data, settings);
        let minimum = minimum_from(&mut problem, &model.parameters(), &bounds, settings).unwrap();
        assert_eq!((minimum.termination, minimum.iterations), (Termination::IterationLimit, 1));
    }
}
