//! All outputs together: the smallest determinant of the covariance that their errors have at an instant.
//!
//! Errors are made white by that covariance and their squares minimised; the covariance is then that of the errors
//! found, until it no longer changes. That is the minimum of `det Σ ε εᵀ`, and the covariance of the parameters is that
//! of all outputs. An output that is missing at an instant takes nothing from what the others say there.
//!
//! # Source
//! Ljung 1999, (7.89) for the criterion and §9.4 for the covariance; Oberhofer & Kmenta, *A general procedure for
//! obtaining maximum likelihood estimates in generalized regression models*, Econometrica 42, 1974, for the iteration.

use faer::{Mat, MatMut};

use super::channel::ContinuousChannel;
use super::estimate::{Combined, OutputFit, Settings, errors};
use super::output_error::{OutputError, Ready};
use super::projection::Basis;
use super::record::{Beginning, Record, records};
use crate::colour::{Colour, Sandwich, no_less_than};
use crate::data::band_limited::Ground;
use crate::dense::{WEIGHT_FLOOR, whitening};
use crate::{Bounds, IdentError, Minimum, ResidualModel, minimise};

/// Rounds of weights.
const ROUNDS: usize = 20;

/// Weights that change by less than this part have settled.
const SETTLED: f64 = 1e-8;

/// Outputs that share fewer than this part of their samples are estimated one by one: too little shows what their
/// errors have in common.
const SHARED: f64 = 0.5;

/// The joint estimate that starts at those of each output; `None` for a single output, one that was not searched for,
/// or outputs sampled at different instants.
pub(super) fn together<C: ContinuousChannel>(
    ground: &Ground<'_>,
    beginning: Beginning,
    parts: &[OutputFit<C>],
    settings: Settings,
) -> Result<Option<Combined>, IdentError> {
    if parts.len() < 2 || parts.iter().any(|part| !part.is_searched) {
        return Ok(None);
    }
    let records = (0..parts.len()).map(|i| records(ground, i, beginning)).collect::<Result<Vec<_>, _>>()?;
    let instants = Instants::new(&records);
    if !instants.are_shared() {
        return Ok(None);
    }
    let outputs: Vec<OutputError<'_, C>> =
        parts.iter().zip(&records).map(|(part, own)| errors(&part.model, own, ground.plain, settings)).collect();
    let bounds: Vec<Bounds> = parts.iter().flat_map(|part| part.bounds.clone()).collect();
    let theta: Vec<f64> = parts.iter().flat_map(|part| part.minimum.parameters.clone()).collect();
    let floor: Vec<f64> = records.iter().map(|own| WEIGHT_FLOOR * WEIGHT_FLOOR * mean_square(own)).collect();
    let series = parts.iter().zip(&records).map(|(part, own)| part.residual_series(own).concat()).collect::<Vec<_>>();
    let start = moments(&series);
    let weights = instants.weights(&start, &floor)?;
    let joint = JointError { outputs: &outputs, instants: &instants, weights };
    let (minimum, joint) = search(joint, theta, &bounds, &floor, settings)?;
    joint.combined(minimum, &bounds, parts.iter().map(|part| part.minimum.iterations).sum()).map(Some)
}

/// Minimises and weighs anew until the weights have settled.
fn search<'p, 'a, C: ContinuousChannel>(
    mut joint: JointError<'p, 'a, C>,
    theta: Vec<f64>,
    bounds: &[Bounds],
    floor: &[f64],
    settings: Settings,
) -> Result<(Minimum, JointError<'p, 'a, C>), IdentError> {
    let mut minimum = minimise(&mut joint, &theta, bounds, settings.search)?;
    let mut before = moments(&joint.series(&minimum));
    for _ in 0..ROUNDS {
        joint.weights = joint.instants.weights(&before, floor)?;
        minimum = minimise(&mut joint, &minimum.parameters, bounds, settings.search)?;
        let now = moments(&joint.series(&minimum));
        let size = |i: usize| (now[(i, i)] + floor[i]).sqrt();
        let change = |i: usize, j: usize| (now[(i, j)] - before[(i, j)]).abs() / (size(i) * size(j));
        let count = now.nrows();
        let largest = (0..count * count).map(|k| change(k / count, k % count)).fold(0.0, f64::max);
        before = now;
        if largest.is_nan() || largest < SETTLED {
            break;
        }
    }
    Ok((minimum, joint))
}

fn mean_square(records: &[Record<'_>]) -> f64 {
    records.iter().map(Record::energy).sum::<f64>() / records.iter().map(Record::rows).sum::<usize>().max(1) as f64
}

/// Mean products of series, one an output: the variance of each, and the correlation where all are there.
pub(super) fn moments(series: &[Vec<f64>]) -> Mat<f64> {
    let count = series.len();
    let mut sums = Mat::<f64>::zeros(count, count);
    for t in 0..series.first().map_or(0, Vec::len) {
        if series.iter().all(|s| !s[t].is_nan()) {
            (0..count).for_each(|i| (0..count).for_each(|j| sums[(i, j)] += series[i][t] * series[j][t]));
        }
    }
    let variance = |s: &Vec<f64>| {
        let known = s.iter().filter(|v| !v.is_nan());
        let (sum, rows) = known.fold((0.0, 0.0_f64), |(sum, rows), v| (sum + v * v, rows + 1.0));
        sum / rows.max(1.0)
    };
    let variances: Vec<f64> = series.iter().map(variance).collect();
    Mat::from_fn(count, count, |i, j| {
        let size = (sums[(i, i)] * sums[(j, j)]).sqrt();
        let correlation = if size > 0.0 { sums[(i, j)] / size } else { 0.0 };
        if i == j { variances[i] } else { correlation * (variances[i] * variances[j]).sqrt() }
    })
}

/// Which outputs are measured at each instant of each record.
struct Instants {
    /// The sets of outputs that occur.
    patterns: Vec<Vec<usize>>,
    /// For each record, the set of every instant from the first on.
    of: Vec<Vec<usize>>,
    /// Samples of every output, and instants with all of them.
    rows: Vec<usize>,
    complete: usize,
}

impl Instants {
    fn new(records: &[Vec<Record<'_>>]) -> Self {
        let mut instants = Instants { patterns: Vec::new(), of: Vec::new(), rows: vec![0; records.len()], complete: 0 };
        for r in 0..records[0].len() {
            let (first, length) = (records[0][r].first, records[0][r].output.len());
            let of = (first..length).map(|t| {
                let there: Vec<usize> = (0..records.len()).filter(|i| !records[*i][r].output[t].is_nan()).collect();
                there.iter().for_each(|i| instants.rows[*i] += 1);
                instants.complete += usize::from(there.len() == records.len());
                instants.place_of(there)
            });
            let of = of.collect();
            instants.of.push(of);
        }
        instants
    }

    fn place_of(&mut self, there: Vec<usize>) -> usize {
        let known = self.patterns.iter().position(|pattern| *pattern == there);
        known.unwrap_or_else(|| {
            self.patterns.push(there);
            self.patterns.len() - 1
        })
    }

    fn are_shared(&self) -> bool {
        self.rows.iter().all(|rows| self.complete as f64 >= SHARED * *rows as f64) && self.complete > 0
    }

    /// Matrices that make the errors of each set white.
    fn weights(&self, moments: &Mat<f64>, floor: &[f64]) -> Result<Vec<Mat<f64>>, IdentError> {
        let raised = |i: usize, j: usize| moments[(i, j)] + if i == j { floor[i] } else { 0.0 };
        let of = |pattern: &Vec<usize>| {
            let n = pattern.len();
            whitening(Mat::from_fn(n, n, |i, j| raised(pattern[i], pattern[j])).as_ref())
        };
        self.patterns.iter().map(of).collect()
    }

    /// White values of record `r`, instant by instant, from those of some outputs at their samples; zero for the
    /// others, and where values end early.
    fn white(&self, r: usize, weights: &[Mat<f64>], values: &[(usize, &[f64])]) -> Vec<f64> {
        let mut next = vec![0; values.len()];
        let mut all = Vec::new();
        for place in &self.of[r] {
            let (pattern, weight) = (&self.patterns[*place], &weights[*place]);
            let begin = all.len();
            all.resize(begin + pattern.len(), 0.0);
            for ((output, own), next) in values.iter().zip(&mut next) {
                let Some(column) = pattern.iter().position(|i| i == output) else { continue };
                let value = own.get(*next).copied().unwrap_or(0.0);
                *next += 1;
                for (i, slot) in all[begin..].iter_mut().enumerate().skip(column) {
                    *slot += weight[(i, column)] * value;
                }
            }
        }
        all
    }
}

/// White errors of all outputs.
struct JointError<'p, 'a, C> {
    outputs: &'p [OutputError<'a, C>],
    instants: &'p Instants,
    weights: Vec<Mat<f64>>,
}

impl<C: ContinuousChannel> JointError<'_, '_, C> {
    /// The parameters of each output.
    fn split<'t>(&self, theta: &'t [f64]) -> Vec<&'t [f64]> {
        let mut rest = theta;
        let mut take = |output: &OutputError<'_, C>| {
            let (own, others) = rest.split_at(output.parameter_count());
            rest = others;
            own
        };
        self.outputs.iter().map(&mut take).collect()
    }

    fn rows(&self, r: usize) -> usize {
        self.instants.of[r].iter().map(|place| self.instants.patterns[*place].len()).sum()
    }

    /// White columns of initial states and offsets of record `r`, output by output.
    fn nuisance(&self, r: usize, ready: &[Vec<Ready>]) -> Vec<Vec<f64>> {
        let mut columns = Vec::new();
        for (i, (output, ready)) in self.outputs.iter().zip(ready).enumerate() {
            let own = output.nuisance_columns(ready, &output.records[r]);
            columns.extend(own.iter().map(|column| self.instants.white(r, &self.weights, &[(i, column)])));
        }
        columns
    }

    fn ready(&self, theta: &[f64], with_slopes: bool) -> Result<Vec<Vec<Ready>>, IdentError> {
        self.outputs.iter().zip(self.split(theta)).map(|(output, own)| output.ready(own, with_slopes)).collect()
    }

    fn evaluate_record(
        &self,
        r: usize,
        ready: &[Vec<Ready>],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) {
        let of_output =
            |(output, ready): (&OutputError<'_, C>, &Vec<_>)| output.forced_error(ready, &output.records[r]);
        let raw: Vec<Vec<f64>> = self.outputs.iter().zip(ready).map(of_output).collect();
        let placed: Vec<(usize, &[f64])> = raw.iter().enumerate().map(|(i, e)| (i, e.as_slice())).collect();
        let mut error = self.instants.white(r, &self.weights, &placed);
        let basis = Basis::new(self.nuisance(r, ready));
        let initial = basis.take_out(&mut error);
        residuals.copy_from_slice(&error);
        let Some(mut jacobian) = jacobian else { return };
        let (mut column, mut taken) = (0, 0);
        for (i, (output, ready)) in self.outputs.iter().zip(ready).enumerate() {
            let own = output.nuisance_count(ready);
            let initial = initial.get(taken..taken + own).unwrap_or(&[]);
            for derivative in output.derivatives(ready, &output.records[r], initial) {
                let mut white = self.instants.white(r, &self.weights, &[(i, &derivative)]);
                basis.take_out(&mut white);
                let into = jacobian.as_mut().col_mut(column);
                into.iter_mut().zip(&white).for_each(|(slot, value)| *slot = *value);
                column += 1;
            }
            taken += own;
        }
    }

    /// The errors of each output over all records, NaN where it is not measured.
    fn series(&self, minimum: &Minimum) -> Vec<Vec<f64>> {
        let mut series = vec![Vec::new(); self.outputs.len()];
        let mut rest = minimum.residuals.as_slice();
        for place in self.instants.of.iter().flatten() {
            let (pattern, weight) = (&self.instants.patterns[*place], &self.weights[*place]);
            let (white, others) = rest.split_at(pattern.len());
            rest = others;
            let mut raw = Mat::from_fn(pattern.len(), 1, |i, _| white[i]);
            numerics::linalg::solve_lower(weight.as_ref(), raw.as_mut());
            series.iter_mut().for_each(|s| s.push(f64::NAN));
            for (i, output) in pattern.iter().enumerate() {
                series[*output].last_mut().into_iter().for_each(|slot| *slot = raw[(i, 0)]);
            }
        }
        series
    }

    /// The covariance of the parameters under errors with the autocorrelation of the residuals, and its degrees of
    /// freedom.
    fn covariance(&self, minimum: &Minimum, remaining: f64) -> Result<(Mat<f64>, f64), IdentError> {
        let (count, n) = (self.outputs.len(), minimum.parameters.len());
        let (mut series, mut index) = (Vec::with_capacity(self.instants.of.len()), 0);
        for of in &self.instants.of {
            let mut all = Vec::with_capacity(of.len() * count);
            for place in of {
                let width = self.instants.patterns[*place].len();
                let white = &minimum.residuals[index..index + width];
                all.extend((0..count).map(|i| if width == count { white[i] } else { f64::NAN }));
                index += width;
            }
            series.push(all);
        }
        let colour = Colour::of(&series, count);
        let scale = minimum.residuals.len() as f64 / remaining;
        let white = faer::Scale(scale) * &minimum.unscaled_covariance;
        if colour.is_white() {
            return Ok((white, remaining));
        }
        let (mut sandwich, mut index) = (Sandwich::new(&colour, &minimum.unscaled_covariance)?, 0);
        let mut rows = vec![0.0; count * n];
        for of in &self.instants.of {
            for place in of {
                rows.fill(0.0);
                for (i, output) in self.instants.patterns[*place].iter().enumerate() {
                    let row = &mut rows[output * n..(output + 1) * n];
                    row.iter_mut().enumerate().for_each(|(j, v)| *v = minimum.jacobian[(index + i, j)]);
                }
                index += self.instants.patterns[*place].len();
                sandwich.push(&rows);
            }
            sandwich.finish_series();
        }
        let coloured = faer::Scale(scale) * sandwich.covariance();
        Ok((no_less_than(&white, &coloured), remaining.min(colour.degrees_of_freedom())))
    }

    fn combined(&self, minimum: Minimum, bounds: &[Bounds], iterations: usize) -> Result<Combined, IdentError> {
        let ready = self.ready(&minimum.parameters, false)?;
        let mut nuisance = 0;
        for r in 0..self.instants.of.len() {
            nuisance += Basis::new(self.nuisance(r, &ready)).rank();
        }
        let remaining = minimum.degrees_of_freedom() - nuisance as f64;
        if remaining <= 0.0 {
            let parameters = minimum.parameters.len() + nuisance;
            return Err(IdentError::TooFewSamples { samples: minimum.residuals.len(), parameters });
        }
        let (covariance, degrees_of_freedom) = self.covariance(&minimum, remaining)?;
        Ok(Combined {
            series: self.series(&minimum),
            covariance,
            degrees_of_freedom,
            resting: super::estimate::resting(&minimum, bounds),
            condition: minimum.condition,
            termination: minimum.termination,
            iterations: iterations + minimum.iterations,
            at_bound: minimum.at_bound,
            parameters: minimum.parameters,
        })
    }
}

impl<C: ContinuousChannel> ResidualModel for JointError<'_, '_, C> {
    fn parameter_count(&self) -> usize {
        self.outputs.iter().map(ResidualModel::parameter_count).sum()
    }

    fn residual_count(&self) -> usize {
        self.instants.rows.iter().sum()
    }

    fn evaluate(
        &mut self,
        theta: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let ready = self.ready(theta, jacobian.is_some())?;
        let mut first = 0;
        for r in 0..self.instants.of.len() {
            let rows = self.rows(r);
            let part = jacobian.as_mut().map(|j| j.as_mut().subrows_mut(first, rows));
            self.evaluate_record(r, &ready, &mut residuals[first..first + rows], part);
            first += rows;
        }
        Ok(())
    }
}
