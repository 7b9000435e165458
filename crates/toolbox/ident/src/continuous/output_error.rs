//! The errors of simulated outputs and their derivatives, exact at the samples.
//!
//! Initial states and an offset enter linearly: they are projected out of the errors and of the Jacobian, so that the
//! search sees the parameters alone and their covariance is already that of the whole problem.
//!
//! # Source
//! Golub & Pereyra, *Separable nonlinear least squares*, Inverse Problems 19, 2003; Kaufman, BIT 15, 1975 (the
//! Jacobian); Ljung 1999, §10.2.

use faer::{Mat, MatMut};

use super::channel::{ContinuousChannel, Degrees};
use super::companion::Companion;
use super::model::ContinuousModel;
use super::projection::Basis;
use super::record::{Course, Record};
use super::sampled::Sampled;
use crate::{IdentError, Intersample, Parametric, ResidualModel};
use fitting::{StructureError, UnstablePart};

/// Assumptions about the time before a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Nuisance {
    /// Initial states are estimated; otherwise the system is at rest and the input zero before the record.
    pub(crate) initial_state: bool,
    /// A constant is added to the output of each experiment.
    pub(crate) offset: bool,
}

/// Errors of a model with one output over its records.
pub(crate) struct OutputError<'a, C> {
    pub(crate) model: ContinuousModel<C>,
    pub(crate) records: &'a [Record<'a>],
    pub(crate) sample_time_s: f64,
    pub(crate) intersample: Intersample,
    pub(crate) nuisance: Nuisance,
    /// Unstable models are refused.
    pub(crate) stable: bool,
}

/// A channel ready to be run: sampled once for all records, of which there are many where data have gaps.
pub(super) struct Ready {
    companion: Companion,
    sampled: Sampled,
    slopes: Option<Slopes>,
}

/// Parts that derivatives are made of.
struct Slopes {
    cascade: Sampled,
    /// Derivatives of numerator, denominator and delay (rows) by the channel's own parameters.
    of_coefficients: Mat<f64>,
}

impl<C: ContinuousChannel> OutputError<'_, C> {
    pub(super) fn ready(&self, theta: &[f64], with_slopes: bool) -> Result<Vec<Ready>, IdentError> {
        let model = self.model.with_parameters(theta)?;
        let mut ready = Vec::with_capacity(model.channels().len());
        for channel in model.channels() {
            let companion = Companion::new(channel, self.sample_time_s)?;
            if self.stable && !companion.is_stable()? {
                return Err(StructureError::Unstable(UnstablePart::Model).into());
            }
            let sampled = companion.sampled(self.intersample)?;
            let slopes = if with_slopes { Some(self.slopes(channel, &companion)?) } else { None };
            ready.push(Ready { companion, sampled, slopes });
        }
        Ok(ready)
    }

    fn slopes(&self, channel: &C, companion: &Companion) -> Result<Slopes, IdentError> {
        Ok(Slopes { cascade: companion.cascade(self.intersample)?, of_coefficients: slopes(channel)? })
    }

    /// Independent columns of initial states and offsets, over all records.
    pub(crate) fn nuisance_rank(&self, theta: &[f64]) -> Result<usize, IdentError> {
        let ready = self.ready(theta, false)?;
        Ok(self.records.iter().map(|r| self.basis(&ready, r).rank()).sum())
    }

    /// The constant of each record, where one is estimated.
    pub(crate) fn levels(&self, theta: &[f64]) -> Result<Vec<f64>, IdentError> {
        let ready = self.ready(theta, false)?;
        let of = |record: &Record<'_>| {
            let mut error = self.forced_error(&ready, record);
            let found = self.basis(&ready, record).take_out(&mut error);
            found.last().copied().filter(|_| self.nuisance.offset).unwrap_or(0.0)
        };
        Ok(self.records.iter().map(of).collect())
    }

    fn basis(&self, ready: &[Ready], record: &Record<'_>) -> Basis {
        Basis::new(self.nuisance_columns(ready, record))
    }

    /// Responses to the initial state of each channel, as far as anything is left of them, and an offset.
    pub(super) fn nuisance_columns(&self, ready: &[Ready], record: &Record<'_>) -> Vec<Vec<f64>> {
        let length = record.output.len() - record.first;
        let mut columns = Vec::new();
        if self.nuisance.initial_state {
            for part in ready {
                columns.append(&mut part.sampled.free_responses(&part.companion.output().0, length));
            }
        }
        if self.nuisance.offset {
            columns.push(vec![1.0; length]);
        }
        columns.iter_mut().for_each(|c| record.keep(c));
        columns
    }

    /// Number of [`Self::nuisance_columns`].
    pub(super) fn nuisance_count(&self, ready: &[Ready]) -> usize {
        let states = ready.iter().map(|part| part.companion.order()).sum::<usize>();
        usize::from(self.nuisance.initial_state) * states + usize::from(self.nuisance.offset)
    }

    /// The measured output less every forced response.
    pub(super) fn forced_error(&self, ready: &[Ready], record: &Record<'_>) -> Vec<f64> {
        let mut error: Vec<f64> = record.output[record.first..].to_vec();
        for (part, u) in ready.iter().zip(&record.inputs) {
            let (c, d) = part.companion.output();
            part.sampled.run(u, record.first, &mut vec![0.0; c.len()], |k, z, v, _| {
                error[k - record.first] -= c.iter().zip(z).map(|(c, z)| c * z).sum::<f64>() + d * v;
            });
        }
        record.keep(&mut error);
        error
    }

    /// Derivatives of the error by all parameters in turn, from the initial states of the channels; none of channels
    /// that were made ready without slopes.
    pub(super) fn derivatives(&self, ready: &[Ready], record: &Record<'_>, initial: &[f64]) -> Vec<Vec<f64>> {
        let (mut taken, mut all) = (0, Vec::new());
        for (part, u) in ready.iter().zip(&record.inputs) {
            let states = if self.nuisance.initial_state { part.companion.order() } else { 0 };
            let x0 = initial.get(taken..taken + states).unwrap_or(&[]);
            taken += states;
            all.extend(part.slopes.iter().flat_map(|slopes| part.derivatives(slopes, u, record, x0)));
        }
        all
    }

    fn evaluate_record(
        &self,
        ready: &[Ready],
        record: &Record<'_>,
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) {
        let basis = self.basis(ready, record);
        let mut error = self.forced_error(ready, record);
        let initial = basis.take_out(&mut error);
        residuals.copy_from_slice(&error);
        let Some(mut jacobian) = jacobian else { return };
        for (j, column) in self.derivatives(ready, record, &initial).iter_mut().enumerate() {
            basis.take_out(column);
            let into = jacobian.as_mut().col_mut(j);
            into.iter_mut().zip(column.iter()).for_each(|(slot, value)| *slot = *value);
        }
    }
}

impl Ready {
    /// Derivatives of the error by the parameters of the channel.
    fn derivatives(&self, slopes: &Slopes, u: &Course<'_>, record: &Record<'_>, initial: &[f64]) -> Vec<Vec<f64>> {
        let mut state = vec![0.0; 2 * self.companion.order()];
        state[..initial.len()].copy_from_slice(initial);
        let mut by_coefficient = vec![0.0; slopes.of_coefficients.nrows()];
        let mut columns = vec![Vec::with_capacity(record.rows()); slopes.of_coefficients.ncols()];
        slopes.cascade.run(u, record.first, &mut state, |k, state, v, slope| {
            if record.output[k].is_nan() {
                return;
            }
            self.companion.sensitivities(state, v, slope, &mut by_coefficient);
            for (j, column) in columns.iter_mut().enumerate() {
                let slopes = slopes.of_coefficients.col(j).iter();
                column.push(-slopes.zip(&by_coefficient).map(|(s, d)| s * d).sum::<f64>());
            }
        });
        columns
    }
}

/// Derivatives of `b_m … b₀`, `a_n … a₀` and the delay by the parameters of a channel. Coefficients are of degree two
/// at most in each parameter, so that central differences are exact for any step.
fn slopes<C: ContinuousChannel>(channel: &C) -> Result<Mat<f64>, IdentError> {
    let theta = channel.parameters();
    let Degrees { numerator: m, poles: n } = channel.degrees();
    let mut slopes = Mat::zeros(m + n + 3, theta.len());
    for j in 0..theta.len() {
        if channel.delay_parameter() == Some(j) {
            slopes[(m + n + 2, j)] = 1.0;
            continue;
        }
        let step = if theta[j] == 0.0 { 1.0 } else { 0.5 * theta[j] };
        let moved = |by: f64| -> Result<Vec<f64>, IdentError> {
            let mut point = theta.clone();
            point[j] += by;
            let system = channel.with_parameters(&point)?.transfer_function()?;
            let padded = |p: &[f64], length: usize| [vec![0.0; length - p.len()], p.to_vec()].concat();
            Ok([padded(system.num(), m + 1), padded(system.den(), n + 1)].concat())
        };
        for (i, (above, below)) in moved(step)?.into_iter().zip(moved(-step)?).enumerate() {
            slopes[(i, j)] = (above - below) / (2.0 * step);
        }
    }
    Ok(slopes)
}

impl<C: ContinuousChannel> ResidualModel for OutputError<'_, C> {
    fn parameter_count(&self) -> usize {
        self.model.parameters().len()
    }

    fn residual_count(&self) -> usize {
        self.records.iter().map(Record::rows).sum()
    }

    fn evaluate(
        &mut self,
        theta: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let ready = self.ready(theta, jacobian.is_some())?;
        let mut first = 0;
        for record in self.records {
            let rows = record.rows();
            let part = jacobian.as_mut().map(|j| j.as_mut().subrows_mut(first, rows));
            self.evaluate_record(&ready, record, &mut residuals[first..first + rows], part);
            first += rows;
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use lti::ProcessModel;
    use proptest::prelude::*;

    use super::*;
    use crate::continuous::RationalChannel;

    /// The coefficients of a band-limited course through samples.
    fn course(samples: &[f64]) -> Vec<Vec<f64>> {
        let data = crate::Dataset::siso(0.1, samples, samples).unwrap();
        let courses = crate::data::band_limited::with_courses(&data, &[(0, 0.0)], true).unwrap();
        (0..courses.inputs()).map(|j| courses.experiments()[0].input(j).to_vec()).collect()
    }

    fn input(columns: &[Vec<f64>], before: f64) -> Course<'_> {
        Course { columns: columns.iter().map(Vec::as_slice).collect(), before }
    }

    /// Before the record it is what it is at the first sample.
    fn held(columns: &[Vec<f64>]) -> Course<'_> {
        input(columns, columns[0][0])
    }

    /// Gradients on channels of this kind under every behaviour of the inputs, from a state not at zero or from rest.
    fn check_all<C: ContinuousChannel>(channels: &[C], signals: &[f64]) {
        let rows = signals.len() / 3;
        let (u, v) = (&signals[..rows], &signals[rows..2 * rows]);
        let drifting = |(k, y): (usize, &f64)| 10.0 * y + 3.0 * 0.97_f64.powi(k as i32);
        let y: Vec<f64> = signals[2 * rows..].iter().enumerate().map(drifting).collect();
        for intersample in [Intersample::ZeroOrderHold, Intersample::FirstOrderHold, Intersample::BandLimited] {
            let [us, vs] = [u, v].map(|x| match intersample {
                Intersample::BandLimited => course(x),
                _ => vec![x.to_vec()],
            });
            let late = [Record { inputs: vec![held(&us), held(&vs)], output: &y, first: 9 }];
            let from_rest = [Record { inputs: vec![input(&us, 0.0), input(&vs, 0.0)], output: &y, first: 0 }];
            for (initial_state, offset) in [(true, true), (true, false), (false, true)] {
                check(&mut OutputError {
                    model: ContinuousModel::new(channels.to_vec(), 2, Mat::identity(1, 1)).unwrap(),
                    records: if initial_state { &late } else { &from_rest },
                    sample_time_s: 0.1,
                    intersample,
                    nuisance: Nuisance { initial_state, offset },
                    stable: true,
                });
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(6))]

        /// Projected errors and derivatives on two channels with delays between samples.
        #[test]
        fn prop_gradient_equals_differences(
            gain in 1.0_f64..40.0, damping in 0.5_f64..5.0, stiffness in 15.0_f64..35.0, lag in 1.0_f64..5.0,
            delay in 0.21_f64..0.29, later in 0.51_f64..0.59, signals in prop::collection::vec(-6.0_f64..6.0, 3 * 250),
        ) {
            let one = RationalChannel::new(vec![1.0, gain], vec![damping, stiffness], delay).unwrap();
            let two = RationalChannel::new(vec![2.0], vec![lag], later).unwrap();
            check_all(&[one, two], &signals);
        }

        /// The same on process models, by their gains, times and damping.
        #[test]
        fn prop_gradient_of_process_models_equals_differences(
            gain in 1.0_f64..4.0, fast in 0.2_f64..0.5, slow in 0.8_f64..2.0, zero in 0.1_f64..0.7,
            damping in 0.2_f64..0.8, delay in 0.21_f64..0.29, signals in prop::collection::vec(-6.0_f64..6.0, 3 * 250),
        ) {
            let lags = ProcessModel::new(gain).unwrap().with_lags(vec![slow, fast]).unwrap();
            let pair = ProcessModel::new(-gain).unwrap().with_pair(fast, damping).unwrap();
            check_all(&[lags.with_zero(zero).unwrap(), pair.with_delay(delay).unwrap()], &signals);
        }
    }

    /// The projected Jacobian is that of the errors up to a part within what is projected out, so gradients are
    /// compared.
    fn check<C: ContinuousChannel>(problem: &mut OutputError<'_, C>) {
        let theta = problem.model.parameters();
        let (rows, columns) = (problem.residual_count(), theta.len());
        let (mut residuals, mut jacobian) = (vec![0.0; rows], Mat::zeros(rows, columns));
        problem.evaluate(&theta, &mut residuals, Some(jacobian.as_mut())).unwrap();
        let mut cost = |point: &[f64]| {
            let mut residuals = vec![0.0; rows];
            problem.evaluate(point, &mut residuals, None).unwrap();
            residuals.iter().map(|r| r * r).sum::<f64>()
        };
        for j in 0..columns {
            let analytic: f64 = 2.0 * (0..rows).map(|i| jacobian[(i, j)] * residuals[i]).sum::<f64>();
            let step = 1e-5 * theta[j];
            let moved = |sign: f64| {
                let mut point = theta.clone();
                point[j] += sign * step;
                point
            };
            let difference = (cost(&moved(1.0)) - cost(&moved(-1.0))) / (2.0 * step);
            let scale = 2.0 * jacobian.col(j).norm_l2() * residuals.iter().map(|r| r * r).sum::<f64>().sqrt();
            assert!((analytic - difference).abs() < 1e-6 * scale, "{j}: {analytic} {difference} {scale}");
        }
    }
}
