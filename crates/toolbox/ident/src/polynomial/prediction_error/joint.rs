//! The covariance of the equations of all outputs together.
//!
//! To first order `θ̂_i − θ_i = −U_i Σ_t ψ_i(t) e_i(t)` with `ψ_i(t)` the gradient of the error `e_i(t)` of output `i`,
//! the initial states projected out of it, and `U_i = (Σ ψ_i ψ_iᵀ)⁻¹`. Hence
//! `P_ij = U_i (Σ_t Σ_s ψ_i(t) E[e_i(t) e_j(s)] ψ_j(s)ᵀ) U_j`, which is `λ_ij U_i (Σ_t ψ_i ψ_jᵀ) U_j` for white errors.

use faer::Mat;

use super::evaluate::Evaluator;
use super::line::BLOCK;
use super::orders::Orders;
use super::segment::Segment;
use super::signals::Aim;
use crate::colour::{Colour, Sandwich};
use crate::dense::covariance_root::{inverse_root, root};
use crate::{Dataset, IdentError};

/// Combinations of the outputs whose errors have less than this part of the variance have none.
const DEPENDENT: f64 = 1e-10;

/// Properties of the errors of an estimate.
#[derive(Debug, Clone, Copy)]
pub(super) enum Errors {
    /// White.
    White,
    /// Of the autocorrelation they show, and independent of the gradient.
    Coloured,
    /// Anything, judged by the scatter between so many stretches.
    Stretches(usize),
}

/// One search for coefficients of one equation, at its minimum.
pub(super) struct Stage<'a> {
    pub(super) orders: Orders,
    pub(super) segments: Vec<Segment<'a>>,
    pub(super) aim: Aim,
    pub(super) estimate_states: bool,
    pub(super) theta: Vec<f64>,
    /// `U`, zero for what was held.
    pub(super) unscaled: Mat<f64>,
    /// The sum of squared errors.
    pub(super) cost: f64,
    pub(super) freedom: f64,
    pub(super) errors: Errors,
    /// Effect of one unit of each coefficient on all of the equation's.
    pub(super) share: Mat<f64>,
}

impl Stage<'_> {
    fn count(&self) -> usize {
        self.orders.count()
    }

    fn variance(&self) -> f64 {
        self.cost / self.freedom
    }

    /// The covariance of the coefficients where the errors are white.
    fn white(&self) -> Mat<f64> {
        faer::Scale(self.variance()) * &self.unscaled
    }

    fn evaluator(&self) -> Evaluator<'_> {
        Evaluator::new(&self.orders, &self.segments, self.aim, self.estimate_states)
    }
}

/// The covariance of the coefficients of all equations, and the degrees of freedom of its intervals. Every equation
/// comes with the stages of its estimate, which are alike for all.
///
/// # Errors
/// Stretches fewer than two, or shorter than a stage has coefficients.
pub(super) fn covariance(equations: &[&[Stage<'_>]], data: &Dataset) -> Result<(Mat<f64>, f64), IdentError> {
    let lengths: Vec<usize> = data.experiments().iter().map(|e| e.len()).collect();
    let total = equations.iter().filter_map(|stages| stages.first()).map(|s| s.share.nrows()).sum();
    let (mut whole, mut freedom) = (Mat::zeros(total, total), f64::INFINITY);
    for k in 0..equations.first().map_or(0, |stages| stages.len()) {
        let stages: Vec<&Stage<'_>> = equations.iter().map(|stages| &stages[k]).collect();
        let (own, of_own) = of_stage(&stages, &lengths)?;
        let share = block_diagonal(stages.iter().map(|s| s.share.clone()));
        whole += &share * own * share.transpose();
        freedom = freedom.min(of_own);
    }
    Ok((whole, freedom))
}

fn of_stage(stages: &[&Stage<'_>], lengths: &[usize]) -> Result<(Mat<f64>, f64), IdentError> {
    let freedom = stages.iter().map(|s| s.freedom).fold(f64::INFINITY, f64::min);
    let coloured = match stages[0].errors {
        Errors::Stretches(count) => return Ok((by_stretches(stages, lengths, count)?, count as f64 - 1.0)),
        kind => matches!(kind, Errors::Coloured),
    };
    if let ([one], false) = (stages, coloured) {
        return Ok((one.white(), freedom));
    }
    let mut errors = series(stages, lengths)?;
    let noise = simultaneous(stages, &errors);
    let inverse = inverse_root(&noise, DEPENDENT)?;
    let mixing = noise * &inverse;
    // Without any error there is no colour.
    if coloured && inverse.ncols() > 0 {
        errors.iter_mut().for_each(|e| *e = unmixed(e, &inverse));
        let colour = Colour::of(&errors, inverse.ncols());
        if !colour.is_white() {
            let known = |s: &Stage<'_>| s.segments.iter().map(Segment::known).sum::<usize>() as f64;
            let scale = |s: &&Stage<'_>| faer::Scale((known(s) / s.freedom).sqrt()) * identity(s.count());
            let scale = block_diagonal(stages.iter().map(scale));
            let covariance = &scale * sandwich(stages, lengths, &mixing, &colour)? * &scale;
            return Ok((covariance, freedom.min(colour.degrees_of_freedom())));
        }
    }
    match stages {
        [one] => Ok((one.white(), freedom)),
        _ => Ok((sandwich(stages, lengths, &mixing, &Colour::white(inverse.ncols()))?, freedom)),
    }
}

/// The errors of every experiment, instant by instant those of all outputs, NaN where one has none.
fn series(stages: &[&Stage<'_>], lengths: &[usize]) -> Result<Vec<Vec<f64>>, IdentError> {
    let outputs = stages.len();
    let mut all: Vec<Vec<f64>> = lengths.iter().map(|length| vec![f64::NAN; length * outputs]).collect();
    for (output, stage) in stages.iter().enumerate() {
        let errors = stage.evaluator().residuals(&stage.theta)?;
        for (segment, errors) in stage.segments.iter().zip(&errors) {
            let places = all[segment.experiment].iter_mut().skip(output).step_by(outputs).skip(segment.first);
            places.zip(errors).for_each(|(slot, e)| *slot = *e);
            segment.missing.iter().for_each(|t| all[segment.experiment][(segment.first + t) * outputs] = f64::NAN);
        }
    }
    for instant in all.iter_mut().flat_map(|one| one.chunks_exact_mut(outputs)) {
        if instant.iter().any(|e| e.is_nan()) {
            instant.fill(f64::NAN);
        }
    }
    Ok(all)
}

/// The errors of an experiment as `Wᵀ e(t)`, instant by instant.
fn unmixed(errors: &[f64], inverse: &Mat<f64>) -> Vec<f64> {
    let one = |e: &[f64], k: usize| (0..e.len()).map(|i| inverse[(i, k)] * e[i]).sum::<f64>();
    let instants = errors.chunks_exact(inverse.nrows());
    instants.flat_map(|e| (0..inverse.ncols()).map(move |k| one(e, k))).collect()
}

/// The covariance of the errors of an instant: the correlation where all outputs have one, with the variance of each.
fn simultaneous(stages: &[&Stage<'_>], series: &[Vec<f64>]) -> Mat<f64> {
    let n = stages.len();
    let mut moments = Mat::<f64>::zeros(n, n);
    for e in series.iter().flat_map(|one| one.chunks_exact(n)).filter(|e| !e[0].is_nan()) {
        (0..n).for_each(|i| (0..n).for_each(|j| moments[(i, j)] += e[i] * e[j]));
    }
    let deviation = |i: usize| stages[i].variance().sqrt();
    Mat::from_fn(n, n, |i, j| {
        let size = (moments[(i, i)] * moments[(j, j)]).sqrt();
        let correlation = if size > 0.0 { moments[(i, j)] / size } else { 0.0 };
        deviation(i) * deviation(j) * if i == j { 1.0 } else { correlation }
    })
}

/// `U Ψᵀ R Ψ U` with `R` the covariance in time of errors that are `mixing` times errors of this colour.
fn sandwich(
    stages: &[&Stage<'_>],
    lengths: &[usize],
    mixing: &Mat<f64>,
    colour: &Colour,
) -> Result<Mat<f64>, IdentError> {
    let roots = stages.iter().map(|s| root(&s.unscaled)).collect::<Result<Vec<_>, _>>()?;
    let unit = block_diagonal(roots.into_iter());
    let total = unit.nrows();
    if mixing.ncols() == 0 {
        return Ok(Mat::zeros(total, total));
    }
    let mut sandwich = Sandwich::with_unit(colour, unit);
    let mut streams = stages.iter().map(|s| Stream::new(s)).collect::<Result<Vec<_>, _>>()?;
    let mut rows = vec![0.0; total * mixing.ncols()];
    for (experiment, length) in lengths.iter().enumerate() {
        for first in (0..*length).step_by(BLOCK) {
            let count = BLOCK.min(length - first);
            streams.iter_mut().for_each(|s| s.read(experiment, first, count));
            for t in 0..count {
                for (k, rows) in rows.chunks_exact_mut(total).enumerate() {
                    let mixed = streams.iter().enumerate().flat_map(|(i, s)| s.row(t).iter().map(move |v| (i, v)));
                    rows.iter_mut().zip(mixed).for_each(|(slot, (i, v))| *slot = mixing[(i, k)] * v);
                }
                sandwich.push(&rows);
            }
        }
        sandwich.finish_series();
    }
    Ok(sandwich.covariance())
}

/// The sandwich whose middle is the scatter of `Σ ψ e` between stretches of equally many instants at which any output
/// is known.
fn by_stretches(stages: &[&Stage<'_>], lengths: &[usize], stretches: usize) -> Result<Mat<f64>, IdentError> {
    let known = known(stages, lengths);
    let total = known.iter().flatten().filter(|k| **k).count();
    let widest = stages.iter().map(|s| s.count()).max().unwrap_or(0);
    if stretches < 2 || total / stretches <= widest {
        return Err(IdentError::TooFewSamples { samples: total, parameters: widest * stretches.max(2) });
    }
    let mut streams = stages.iter().map(|s| Stream::new(s)).collect::<Result<Vec<_>, _>>()?;
    let mut sums = Mat::zeros(stretches, stages.iter().map(|s| s.count()).sum());
    let mut before = 0;
    for (experiment, length) in lengths.iter().enumerate() {
        for first in (0..*length).step_by(BLOCK) {
            let count = BLOCK.min(length - first);
            streams.iter_mut().for_each(|s| s.read(experiment, first, count));
            for t in (0..count).filter(|t| known[experiment][first + t]) {
                let scores = streams.iter().flat_map(|s| s.row(t).iter().map(|v| v * s.errors[t]));
                scores.enumerate().for_each(|(j, score)| sums[(before * stretches / total, j)] += score);
                before += 1;
            }
        }
    }
    let unscaled = block_diagonal(stages.iter().map(|s| s.unscaled.clone()));
    Ok(&unscaled * crate::covariance::middle_of_batches(&sums) * &unscaled)
}

/// Of every experiment, the rows that some equation uses.
fn known(stages: &[&Stage<'_>], lengths: &[usize]) -> Vec<Vec<bool>> {
    let mut known: Vec<Vec<bool>> = lengths.iter().map(|length| vec![false; *length]).collect();
    for segment in stages.iter().flat_map(|s| &s.segments) {
        known[segment.experiment][segment.first..segment.first + segment.len()].fill(true);
    }
    known
}

fn identity(n: usize) -> Mat<f64> {
    Mat::identity(n, n)
}

fn block_diagonal(blocks: impl Iterator<Item = Mat<f64>>) -> Mat<f64> {
    let blocks: Vec<Mat<f64>> = blocks.collect();
    let mut whole = Mat::zeros(blocks.iter().map(Mat::nrows).sum(), blocks.iter().map(Mat::ncols).sum());
    let (mut top, mut left) = (0, 0);
    for block in &blocks {
        whole.get_mut(top..top + block.nrows(), left..left + block.ncols()).copy_from(block);
        (top, left) = (top + block.nrows(), left + block.ncols());
    }
    whole
}

/// The errors and their gradient of one stage, window by window of the experiments.
struct Stream<'s> {
    stage: &'s Stage<'s>,
    evaluator: Evaluator<'s>,
    /// For each segment, what the initial state explains of the gradient.
    explained: Vec<Mat<f64>>,
    /// Where reading goes on: a segment, and a row in it.
    segment: usize,
    at: usize,
    /// The window: gradients by rows, and errors; zero where there are none.
    rows: Vec<f64>,
    errors: Vec<f64>,
}

impl<'s> Stream<'s> {
    fn new(stage: &'s Stage<'s>) -> Result<Self, IdentError> {
        let mut evaluator = stage.evaluator();
        let explained = evaluator.linearise(&stage.theta)?;
        let (rows, errors) = (vec![0.0; BLOCK * stage.count()], vec![0.0; BLOCK]);
        Ok(Stream { stage, evaluator, explained, segment: 0, at: 0, rows, errors })
    }

    /// The gradient at row `t` of the window.
    fn row(&self, t: usize) -> &[f64] {
        let n = self.stage.count();
        &self.rows[t * n..(t + 1) * n]
    }

    /// Reads the window of `count` rows from `first` on, which follows the one before.
    fn read(&mut self, experiment: usize, first: usize, count: usize) {
        let n = self.stage.count();
        self.rows.fill(0.0);
        self.errors.fill(0.0);
        while let Some(segment) = self.stage.segments.get(self.segment) {
            let start = segment.first + self.at;
            if segment.experiment != experiment || start >= first + count {
                break;
            }
            let end = (segment.first + segment.len()).min(first + count);
            let rows = &mut self.rows[(start - first) * n..(end - first) * n];
            let errors = &mut self.errors[start - first..end - first];
            let explained = &self.explained[self.segment];
            self.evaluator.gradient(&self.stage.theta, self.segment, self.at, explained, rows, errors);
            self.at += end - start;
            if self.at == segment.len() {
                (self.segment, self.at) = (self.segment + 1, 0);
            }
        }
    }
}
