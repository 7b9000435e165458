//! The delay with which an ARX model fits best.

use faer::Mat;

use super::{past_outputs, signals};
use crate::data::check_range;
use crate::data::regression::{Lagged, Regression, Signals};
use crate::{Dataset, IdentError};
use fitting::StructureError;
use fitting::equation::factor_of;

/// Most combinations of delays that are compared jointly.
const JOINT: usize = 2000;

/// Rounds of the search input by input.
const ROUNDS: usize = 20;

/// Losses below this part of the output's power are rounding.
const ROUNDING: f64 = 1e-26;

/// Compares `A(q^s) y(t) = Σ_k B_k(q) u_k(t − nk_k) + e(t)` over the delays `lowest..=highest` of every input, on the
/// same rows, with the `spacing` s of one unless the output is slower than the inputs; then `nb` has to be larger by s
/// − 1 for the same dynamics.
///
/// The data are read once: the widest regressor is factored, and each model is solved from the factor. Up to 2000
/// combinations of delays are compared jointly; beyond that inputs take turns, starting with all lags of the others in
/// the model, until no single change is better.
///
/// # Example
/// ```
/// # let mut random = signal::excitation::Random::new(1);
/// # let u: Vec<f64> = (0..400).map(|_| random.normal()).collect();
/// let mut y = vec![0.0; 400];
/// for t in 3..400 {
///     y[t] = 0.7 * y[t - 1] + u[t - 3];
/// }
/// let found = ident::delay::ArxDelay { na: 1, nb: 1, ..Default::default() }.estimate(&ident::Dataset::siso(0.1, &u, &y)?)?;
/// assert_eq!(found.delays, [3]);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, §16.5 and §17.3; the factor of a subset of columns: Golub & Van Loan, *Matrix Computations*, §6.5.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArxDelay {
    /// Coefficients of `A`; zero for finite impulse responses.
    pub na: usize,
    /// Samples from one past output to the next: one, or more for an output that is known only so often.
    pub spacing: usize,
    /// Coefficients of each `B`.
    pub nb: usize,
    /// Shortest delay.
    pub lowest: usize,
    /// Longest delay.
    pub highest: usize,
}

impl Default for ArxDelay {
    /// Two coefficients each, delays from 0 to 20.
    fn default() -> Self {
        ArxDelay { na: 2, spacing: 1, nb: 2, lowest: 0, highest: 20 }
    }
}

/// Delays in the order of how well they fit.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayRanking {
    /// The best delay of each input.
    pub delays: Vec<usize>,
    /// Root of the weighted mean of squared distances from the best delay; below a tenth where there is no rival.
    pub standard_errors: Vec<f64>,
    /// Delays that were compared, the best first.
    pub candidates: Vec<DelayCandidate>,
    /// Rows every model was fitted on.
    pub samples: usize,
}

/// One combination of delays.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayCandidate {
    /// The delay of each input.
    pub delays: Vec<usize>,
    /// Mean squared prediction error.
    pub loss: f64,
    /// Its likelihood under white normal errors as a part of the sum over all candidates.
    pub weight: f64,
}

impl ArxDelay {
    /// The ranking for data of one output and any number of inputs. Rows with missing samples are left out.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for several outputs, no input or `nb = 0`; [`IdentError::TooFewSamples`];
    /// [`signal::SignalError::Parameter`] for a range that is none; [`IdentError::Constant`] for an output of zeros.
    pub fn estimate(&self, data: &Dataset) -> Result<DelayRanking, IdentError> {
        let signals = signals(data)?;
        check_range("highest", self.highest as f64, self.lowest as f64, 1e5)?;
        if self.nb == 0 {
            return Err(StructureError::NoNumerator.into());
        }
        let comparison = Comparison::new(self, &signals, data.inputs())?;
        let mut candidates = comparison.search(data.inputs());
        let best = candidates[0].loss;
        let half = 0.5 * comparison.samples as f64;
        let weight = |c: &DelayCandidate| (-half * (c.loss / best).ln()).exp();
        let total: f64 = candidates.iter().map(weight).sum();
        candidates.iter_mut().for_each(|c| c.weight = weight(c) / total);
        let delays = candidates[0].delays.clone();
        let spread = |k: usize| {
            let apart = |c: &DelayCandidate| (c.delays[k] as f64 - delays[k] as f64).powi(2) * c.weight;
            candidates.iter().map(apart).sum::<f64>().sqrt()
        };
        let standard_errors = (0..data.inputs()).map(spread).collect();
        Ok(DelayRanking { delays, standard_errors, candidates, samples: comparison.samples })
    }
}

/// The factor of the widest regressor, to be asked for the loss of models within it.
struct Comparison<'a> {
    options: &'a ArxDelay,
    factor: Mat<f64>,
    samples: usize,
    /// Lags of each input in the factor.
    width: usize,
}

impl<'a> Comparison<'a> {
    fn new(options: &'a ArxDelay, signals: &Signals<'_>, inputs: usize) -> Result<Self, IdentError> {
        let past = past_outputs(options.na, options.spacing);
        let lags = options.lowest as isize..(options.highest + options.nb) as isize;
        let width = lags.len();
        let fed = (1..=inputs).flat_map(|k| Lagged::each(k, lags.clone()));
        let columns: Vec<Lagged> = past.chain(fed).chain([Lagged::new(0, 0)]).collect();
        let parameters = columns.len() - 1;
        let regression = Regression::new(signals, columns);
        let samples = regression.rows;
        if samples <= parameters {
            return Err(IdentError::TooFewSamples { samples, parameters });
        }
        let factor = regression.factor();
        if factor.col(parameters).norm_l2() == 0.0 {
            return Err(IdentError::Constant { what: "the output" });
        }
        Ok(Comparison { options, factor, samples, width })
    }

    /// Mean squared error with these numerator columns of each input beside all of `A`.
    fn loss(&self, lags: impl Iterator<Item = std::ops::Range<usize>>) -> f64 {
        let na = self.options.na;
        let last = self.factor.ncols() - 1;
        let fed = lags.enumerate().flat_map(|(k, lags)| lags.map(move |l| na + k * self.width + l));
        let chosen: Vec<usize> = (0..na).chain(fed).chain([last]).collect();
        let own = factor_of(&self.factor, &chosen);
        let cost = own[(chosen.len() - 1, chosen.len() - 1)].powi(2);
        cost.max(ROUNDING * self.factor.col(last).squared_norm_l2()) / self.samples as f64
    }

    fn candidate(&self, offsets: &[usize]) -> DelayCandidate {
        let loss = self.loss(offsets.iter().map(|o| *o..o + self.options.nb));
        DelayCandidate { delays: offsets.iter().map(|o| o + self.options.lowest).collect(), loss, weight: 0.0 }
    }

    /// Candidates, the best first.
    fn search(&self, inputs: usize) -> Vec<DelayCandidate> {
        let count = self.options.highest - self.options.lowest + 1;
        let joint = u32::try_from(inputs).ok().and_then(|n| count.checked_pow(n)).filter(|all| *all <= JOINT);
        let mut found: Vec<DelayCandidate> = match joint {
            Some(all) => {
                let digits = |mut index: usize| -> Vec<usize> {
                    let digit = |_| {
                        let digit = index % count;
                        index /= count;
                        digit
                    };
                    (0..inputs).map(digit).collect()
                };
                (0..all).map(|index| self.candidate(&digits(index))).collect()
            }
            None => self.search_in_turns(inputs, count),
        };
        found.sort_by(|a, b| a.loss.total_cmp(&b.loss));
        found.dedup_by(|a, b| a.delays == b.delays);
        found
    }

    fn search_in_turns(&self, inputs: usize, count: usize) -> Vec<DelayCandidate> {
        // Each input by itself first, beside every lag of the others.
        let alone = |k: usize| {
            let lags = |offset: usize| {
                (0..inputs).map(move |j| if j == k { offset..offset + self.options.nb } else { 0..self.width })
            };
            let loss = |offset: &usize| self.loss(lags(*offset));
            (0..count).min_by(|a, b| loss(a).total_cmp(&loss(b))).unwrap_or(0)
        };
        let mut best: Vec<usize> = (0..inputs).map(alone).collect();
        let mut found = vec![self.candidate(&best)];
        let mut lowest = found[0].loss;
        for _ in 0..ROUNDS {
            let before = best.clone();
            for k in 0..inputs {
                for offset in 0..count {
                    let mut trial = best.clone();
                    trial[k] = offset;
                    let candidate = self.candidate(&trial);
                    if candidate.loss < lowest {
                        (lowest, best) = (candidate.loss, trial);
                    }
                    found.push(candidate);
                }
            }
            if best == before {
                break;
            }
        }
        found
    }
}
