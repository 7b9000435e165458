//! Generalised least squares on integrated torques.

use std::ops::RangeInclusive;

use faer::{Mat, mat};
use fitting::covariance::at_least_white;
use fitting::smoothing::{Belief, NoisySystem, likeliest};
use fitting::{Bounds, IdentError, Minimum, Termination, least_squares};
use lti::StateSpace;
use rig::estimation::timing_floor_s;
use rig::results::{Parameter, Quantity};
use signal::distributions::student_t_quantile;

use super::fitted::Fitted;
use super::fitted::{Drive, LEVEL};
use super::free_run::{FreeRun, integral};
use crate::options::{LONGEST_DELAY_S, ROUNDS, SHIFTED_S, Term};

/// With less than this many events nothing is known of their scatter; the interval is then wide as it is.
const FEWEST_EVENTS: f64 = 3.0;
/// Batches of the robust covariance.
const BATCHES: usize = 16;
/// ln of the random walk's variance a sample over that of the encoder's noise, where the search starts.
const WALK_START: f64 = -6.0;
/// Range of that logarithm.
const WALK_RANGE: RangeInclusive<f64> = -30.0..=12.0;
/// Rounds of noise ratio and estimate in turn.
const NOISE_ROUNDS: usize = 3;
/// Fewest means that are compared.
const FEWEST_BLOCKS: f64 = 100.0;
/// Variance of the speed at the start of a stretch, of which the first sample was taken off, in variances of the noise.
const START_VARIANCE: f64 = 1e6;

/// T_d is none below this part of the torque that acts.
const TORQUE_FREE: f64 = 0.05;
/// It shows J_d where what friction cannot do of it is more than this part of the torque that acts.
const EXCITED: f64 = 0.3;

/// Excitation by T_d.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Excitation {
    NotRecorded,
    None,
    Little,
    Enough,
}

/// Speeds and torques with what was found of noise and delay.
pub(super) struct Problem<'a> {
    free_runs: &'a [FreeRun],
    delay_s: f64,
    /// ln of the variance of the random walk over that of the noise.
    walk: f64,
    /// Means over this are compared, s.
    block_s: f64,
}

impl<'a> Problem<'a> {
    pub(super) fn new(free_runs: &'a [FreeRun]) -> Self {
        let whole_s: f64 = free_runs.iter().map(|free_run| free_run.speed.duration_s()).sum();
        let block_s = free_runs.iter().map(|free_run| free_run.block_s).fold(0.0, f64::max);
        Problem { free_runs, delay_s: 0.0, walk: WALK_START, block_s: block_s.min(whole_s / FEWEST_BLOCKS) }
    }

    /// Excitation by T_d beyond noise and ripple, of a dynamometer of about this inertia.
    pub(super) fn excitation(&self, inertia_kg_m2: f64) -> Excitation {
        let Some(free_runs) = self.free_runs.iter().map(FreeRun::blocks).collect::<Option<Vec<_>>>() else {
            return Excitation::NotRecorded;
        };
        let blocks: Vec<(f64, f64)> = free_runs.iter().flat_map(|(blocks, _)| blocks.iter().copied()).collect();
        // The torque that slows it or speeds it up, block by block.
        let changes = free_runs
            .iter()
            .flat_map(|(blocks, s)| blocks.windows(2).map(move |w| inertia_kg_m2 * (w[1].1 - w[0].1) / s));
        let acting = rms(changes);
        if rms(blocks.iter().map(|b| b.0)) < TORQUE_FREE * acting {
            return Excitation::None;
        }
        // What friction could do as well tells nothing of inertia.
        let alike = Mat::from_fn(blocks.len(), 2, |i, j| if j == 0 { 1.0 } else { blocks[i].1 });
        let torque: Vec<f64> = blocks.iter().map(|b| b.0).collect();
        let own = least_squares(alike.as_ref(), &torque).map_or(0.0, |fit| fit.noise_variance().sqrt());
        if own > EXCITED * acting { Excitation::Enough } else { Excitation::Little }
    }

    /// Finds by how much T_d is late, and how noisy all is, with J_d free; returns the estimate there.
    pub(super) fn settle_delay(&mut self, terms: &[Term]) -> Result<Fitted, IdentError> {
        for _ in 0..ROUNDS {
            self.settle_noise(terms, Drive::Free)?;
            let shift_s = self.fit(terms, Drive::Free)?.shift_s();
            self.delay_s = (self.delay_s + shift_s).clamp(-LONGEST_DELAY_S, LONGEST_DELAY_S);
            if shift_s.abs() < SHIFTED_S {
                break;
            }
        }
        self.fit(terms, Drive::Free)
    }

    pub(super) fn forget_delay(&mut self) {
        self.delay_s = 0.0;
    }

    /// Finds the likeliest ratio of random walk and noise, in turn with the estimate.
    pub(super) fn settle_noise(&mut self, terms: &[Term], drive: Drive) -> Result<(), IdentError> {
        let Some((index, longest)) = self.free_runs.iter().enumerate().max_by_key(|(_, free_run)| free_run.speed.len())
        else {
            return Ok(());
        };
        for _ in 0..NOISE_ROUNDS {
            let parameters = self.fit(terms, drive)?.linear.parameters;
            let columns = self.columns(&self.free_runs[index], terms, drive);
            let left = |k: usize| {
                columns.target[k] - columns.regressors.iter().zip(&parameters).map(|(c, p)| c[k] * p).sum::<f64>()
            };
            let left: Vec<f64> = (0..longest.speed.len()).map(left).collect();
            let outputs = self.means(longest, &left);
            let none = Mat::zeros(outputs.nrows(), 0);
            let bounds = [Bounds::new(*WALK_RANGE.start(), *WALK_RANGE.end())];
            let found = likeliest(&[vec![self.walk]], &bounds, |p| walk(p[0]), none.as_ref(), outputs.as_ref())?;
            let change = found.parameters[0] - self.walk;
            self.walk = found.parameters[0];
            if change.abs() < 0.01 {
                break;
            }
        }
        Ok(())
    }

    /// The estimate with these terms.
    pub(super) fn fit(&self, terms: &[Term], drive: Drive) -> Result<Fitted, IdentError> {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let (system, start) = walk(self.walk)?;
        for free_run in self.free_runs {
            let columns = self.columns(free_run, terms, drive);
            let whitened = |column: &Vec<f64>| {
                let outputs = self.means(free_run, column);
                system.innovations(&start, Mat::zeros(outputs.nrows(), 0).as_ref(), outputs.as_ref())
            };
            let target = whitened(&columns.target)?;
            let all = columns.regressors.iter().map(whitened).collect::<Result<Vec<_>, _>>()?;
            let jumps = free_run.jumps(self.delay_s).map_or_else(
                || vec![0.0; free_run.speed.len()],
                // The 95 % half width of an instant that is anywhere between two samples.
                |(jumps, between_s)| jumps.iter().map(|nm| 0.5 * LEVEL * between_s * nm).collect(),
            );
            let jumps = whitened(&jumps)?;
            let row = |k: usize| all.iter().map(|c| c[k]).chain([target[k], jumps[k]]).collect();
            rows.extend((0..target.len()).map(row));
        }
        self.solved(terms, drive, &rows)
    }

    /// From rows of regressors, the target, and what is wrong with ∫T_d where all its jumps are half a sample off, Nm
    /// s.
    fn solved(&self, terms: &[Term], drive: Drive, rows: &[Vec<f64>]) -> Result<Fitted, IdentError> {
        let count = rows.first().map_or(0, |row| row.len().saturating_sub(2));
        let regressors = Mat::from_fn(rows.len(), count, |i, j| rows[i][j]);
        let target: Vec<f64> = rows.iter().map(|row| row[count]).collect();
        let linear = least_squares(regressors.as_ref(), &target)?;
        let residual =
            |i: usize| target[i] - (0..count).map(|j| regressors[(i, j)] * linear.parameters[j]).sum::<f64>();
        let samples = rows.len() as f64;
        let jumps: Vec<f64> = rows.iter().map(|row| row[count + 1]).collect();
        let by_jumps = least_squares(regressors.as_ref(), &jumps)?.parameters;
        let per_torque = match drive {
            Drive::Known { inertia_kg_m2 } => 1.0 / inertia_kg_m2,
            Drive::Free => linear.parameters[0],
        };
        let bic = samples * (linear.cost / samples).ln() + count as f64 * samples.ln();
        let minimum = Minimum {
            parameters: linear.parameters.clone(),
            residuals: (0..rows.len()).map(residual).collect(),
            jacobian: regressors,
            unscaled_covariance: linear.unscaled_covariance.clone(),
            cost: linear.cost,
            at_bound: vec![false; count],
            iterations: 0,
            termination: Termination::Direct,
            condition: linear.condition,
        };
        let (covariance, freedom) = with_few_events(&minimum)?;
        let moved = per_torque / student_t_quantile(0.5 + 0.5 * LEVEL, freedom);
        let covariance =
            Mat::from_fn(count, count, |i, j| covariance[(i, j)] + moved * moved * by_jumps[i] * by_jumps[j]);
        Ok(Fitted { terms: terms.to_vec(), delay_s: self.delay_s, bic, drive, linear, covariance, freedom })
    }

    /// Means of a column over the blocks of a free_run, without drop-outs: one column, NaN where all of a block dropped
    /// out. What is linear in columns is so in their means.
    fn means(&self, free_run: &FreeRun, column: &[f64]) -> Mat<f64> {
        let length = ((self.block_s / free_run.speed.sample_time_s).round() as usize).max(1);
        let mean = |block: usize, _| {
            let seen = (block * length..(block + 1) * length).filter(|k| !free_run.dropped[*k]);
            let (count, sum) = seen.fold((0.0, 0.0), |(count, sum), k| (count + 1.0, sum + column[k]));
            if count > 0.0 { sum / count } else { f64::NAN }
        };
        Mat::from_fn(column.len() / length, 1, mean)
    }

    /// Columns that make up the speed along a free run, from its first sample on.
    fn columns(&self, free_run: &FreeRun, terms: &[Term], drive: Drive) -> Columns {
        let step = free_run.speed.sample_time_s;
        let speed = &free_run.speed.samples;
        let first = speed.first().copied().unwrap_or(0.0);
        let mut target: Vec<f64> = speed.iter().map(|w| w - first).collect();
        let mut regressors = Vec::new();
        if let (Some(torque), Some(done)) = (free_run.torque_at(self.delay_s), free_run.torque_integral(self.delay_s)) {
            match drive {
                Drive::Known { inertia_kg_m2 } => {
                    target.iter_mut().zip(&done).for_each(|(w, done)| *w += done / inertia_kg_m2);
                }
                // T_d read later by dδ is −∫T_d less dδ·T_d, but for a constant.
                Drive::Free => {
                    regressors.push(done.iter().map(|done| -done).collect());
                    regressors.push(torque.iter().map(|t| torque[0] - t).collect());
                }
            }
        }
        let part = |term: &Term| {
            let values: Vec<f64> = speed.iter().map(|w| -term.at(*w)).collect();
            integral(&values, step)
        };
        regressors.extend(terms.iter().map(part));
        Columns { target, regressors }
    }

    /// The delay at an estimate.
    pub(super) fn delay(&self, fit: &Fitted) -> Parameter {
        let (p, c) = (&fit.linear.parameters, &fit.covariance);
        let shift = p[1] / p[0];
        let variance = (c[(1, 1)] - 2.0 * shift * c[(0, 1)] + shift * shift * c[(0, 0)]) / (p[0] * p[0]);
        let step_s = self.free_runs.first().map_or(0.0, |free_run| free_run.speed.sample_time_s);
        let dated_s = self.free_runs.iter().map(|free_run| free_run.dated_s).fold(0.0, f64::max);
        let error = variance.max(0.0).sqrt().hypot(dated_s).hypot(timing_floor_s(step_s));
        Parameter::new(Quantity::TorqueLateness, self.delay_s + shift, error, fit.freedom)
    }
}

struct Columns {
    target: Vec<f64>,
    regressors: Vec<Vec<f64>>,
}

/// The robust covariance where few batches hold what determines a parameter, such as the few steps of the speed: the
/// scatter of n batches of which e matter is known with e − 1 degrees of freedom. e is (Σs)²/Σs², s being a batch's
/// part in the variance of the parameter that is worst off.
fn with_few_events(fit: &Minimum) -> Result<(Mat<f64>, f64), IdentError> {
    let (covariance, _) = at_least_white(fit, BATCHES)?;
    let (rows, count) = fit.jacobian.shape();
    let length = rows.div_ceil(BATCHES);
    let events = |j: usize| {
        let influence =
            |i: usize| (0..count).map(|k| fit.jacobian[(i, k)] * fit.unscaled_covariance[(k, j)]).sum::<f64>();
        let mut parts = [0.0; BATCHES];
        (0..rows).for_each(|i| parts[i / length] += influence(i).powi(2));
        let (sum, squares) = parts.iter().fold((0.0, 0.0), |(sum, squares), s| (sum + s, squares + s * s));
        sum * sum / squares
    };
    let fewest = (0..count).map(events).fold(BATCHES as f64, f64::min).max(FEWEST_EVENTS);
    let all = BATCHES as f64;
    let factor = fewest / (fewest - 1.0) * (all - 1.0) / all;
    Ok((faer::Scale(factor) * covariance, fewest - 1.0))
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v * v));
    if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
}

/// A random walk whose steps have this (ln) variance, under white noise of variance one.
fn walk(log_variance: f64) -> Result<(NoisySystem, Belief), IdentError> {
    let system = StateSpace::discrete(mat![[1.0]], Mat::zeros(1, 0), mat![[1.0]], Mat::zeros(1, 0), 1.0)?;
    let noisy = NoisySystem::new(system, mat![[log_variance.exp()]], vec![1.0])?;
    Ok((noisy, Belief { mean: vec![0.0], covariance: mat![[START_VARIANCE]] }))
}
