//! By how many samples N_d* is late in the speed error and in the feed-forward, and what that says of the controller's
//! delay.
//!
//! T_d*(k) = K_p [n(kT − τ) − r(k − l)] + I(k) + k r(k − f) + k_a (r(k − f) − r(k − f − 1))/T, r = N_d*.
//!
//! With K_p, K_i and τ of a recording with constant N_d*, each pair (l, f) of whole samples leaves a linear
//! least-squares problem in k and k_a. All pairs share one triangular factor.
//!
//! Two pairs always describe the same sequence: (f + 1, f), and (f, f) with k greater by K_i T and k_a by (K_p − K_i T)
//! T. Which of them a controller has, no recording can show; where its delay acts can often show it.

use ident::{IdentError, Triangle};
use rig::results::{DelayPlace, DemandLags};

use super::data::Data;
use super::inverse::{self, InverseController, recursion};
use super::lag::shifted;

/// Samples that the search takes at most; more cost memory and decide nothing.
const MOST_SAMPLES: usize = 300_000;
/// Samples by which N_d* may be recorded after the controller has it.
const EARLIEST: i32 = -2;
/// Samples beyond the controller's delay by which N_d* may be late.
const BEYOND_DELAY: i32 = 1;

/// A pair of lags, and by how much more it leaves than the best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    pub(super) lags: DemandLags,
    /// N (cost/least cost − 1): χ² with one degree of freedom where errors are white.
    pub(super) excess: f64,
}

/// All pairs of lags, the best first.
pub(super) fn scan(data: &Data, theta: &[f64], delay: i32) -> Result<Vec<Candidate>, IdentError> {
    let data = data.middle(MOST_SAMPLES);
    let latest = delay.max(0) + BEYOND_DELAY;
    let columns = Columns::new(&data, theta, EARLIEST, latest + 1)?;
    let factor = columns.factor();
    let pairs = (EARLIEST..=latest).flat_map(|feed| {
        let of = move |error| DemandLags { speed_error: error, feed_forward: feed };
        (EARLIEST + 1..=latest).map(of)
    });
    let mut candidates: Vec<Candidate> =
        pairs.map(|lags| Candidate { lags, excess: columns.cost(&factor, lags) }).collect();
    candidates.sort_by(|a, b| a.excess.total_cmp(&b.excess));
    let least = candidates.first().map_or(0.0, |best| best.excess).max(f64::MIN_POSITIVE);
    let samples = columns.target.len() as f64;
    candidates.iter_mut().for_each(|one| one.excess = samples * (one.excess / least - 1.0));
    Ok(candidates)
}

/// Columns that make up the measured speed, for all lags, at the samples of N_d.
struct Columns {
    earliest: i32,
    /// The inverted controller's answer to N_d* late by each lag.
    answers: Vec<Vec<f64>>,
    /// N_d* late by each lag.
    demands: Vec<Vec<f64>>,
    /// The decay of the first error, and the encoder's once-a-turn error.
    others: Vec<Vec<f64>>,
    /// N_d less the inverted controller's answer to T_d*.
    target: Vec<f64>,
}

impl Columns {
    fn new(data: &Data, theta: &[f64], earliest: i32, latest: i32) -> Result<Self, IdentError> {
        let model = data.model(DemandLags::default(), &|_| false);
        let n = data.demand.len().min(data.reference.len());
        // Constants only change the first error.
        let first = data.reference.samples.first().copied().unwrap_or(0.0);
        let reference: Vec<f64> = data.reference.samples[..n].iter().map(|r| r - first).collect();
        let answer = |series: &[f64]| {
            let step = |k: usize| if k == 0 { 0.0 } else { theta[inverse::P] * (series[k] - series[k - 1]) };
            let forcing: Vec<f64> = (0..n).map(step).collect();
            model.at_speed_samples(theta, recursion(theta, 0.0, &forcing))
        };
        let late: Vec<Vec<f64>> = (earliest..=latest).map(|lag| shifted(&reference, lag)).collect();
        let answers = late.iter().map(|series| answer(series)).collect::<Result<_, _>>()?;
        let demands =
            late.iter().map(|series| model.at_speed_samples(theta, series.clone())).collect::<Result<_, _>>()?;
        let decay = model.at_speed_samples(theta, recursion(theta, 1.0, &vec![0.0; n]))?;
        let of_demand = answer(&data.demand.samples[..n])?;
        let speed = model.kept().map(|i| data.speed.samples[i] - first);
        let [cosine, sine] = model.once_a_turn();
        Ok(Columns {
            earliest,
            answers,
            demands,
            others: vec![decay, cosine, sine],
            target: speed.zip(of_demand).map(|(speed, answer)| speed - answer).collect(),
        })
    }

    fn factor(&self) -> faer::Mat<f64> {
        let all: Vec<&Vec<f64>> =
            self.answers.iter().chain(&self.demands).chain(&self.others).chain([&self.target]).collect();
        let mut triangle = Triangle::new(all.len());
        let mut row = vec![0.0; all.len()];
        for i in 0..self.target.len() {
            row.iter_mut().zip(&all).for_each(|(value, column)| *value = column[i]);
            triangle.push_row(&row);
        }
        triangle.finish()
    }

    /// The sum of squares that a pair leaves.
    fn cost(&self, factor: &faer::Mat<f64>, lags: DemandLags) -> f64 {
        let place = |lag: i32| (lag - self.earliest) as usize;
        let (answers, demands) = (self.answers.len(), self.demands.len());
        let others = answers + demands..answers + demands + self.others.len();
        let free: Vec<usize> =
            [place(lags.feed_forward), place(lags.feed_forward + 1)].into_iter().chain(others).collect();
        let (fixed, target) = (answers + place(lags.speed_error), factor.ncols() - 1);
        let mut triangle = Triangle::new(free.len() + 1);
        for i in 0..factor.nrows() {
            let left = factor[(i, target)] - factor[(i, fixed)];
            let row: Vec<f64> = free.iter().map(|j| factor[(i, *j)]).chain([left]).collect();
            triangle.push_row(&row);
        }
        triangle.finish()[(free.len(), free.len())].powi(2)
    }
}

/// One way to read a sequence of T_d*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reading {
    pub(super) place: DelayPlace,
    pub(super) lags: DemandLags,
    /// True where dN_d*/dt is the change to the next sample, as where the demand comes with its slope; else it is that
    /// from the last.
    pub(super) is_forward: bool,
}

impl Reading {
    /// The controllers with a delay of so many samples whose sequence is that of some lags, the likeliest first.
    pub(super) fn of(lags: DemandLags, delay: i32) -> Vec<Reading> {
        let at = |place, error, feed, is_forward| {
            let lags = DemandLags { speed_error: error, feed_forward: feed };
            Reading { place, lags, is_forward }
        };
        let known = [
            at(DelayPlace::SpeedError, delay, 0, false),
            at(DelayPlace::WholeOutput, delay, delay - 1, true),
            at(DelayPlace::MeasuredSpeed, 0, -1, true),
            at(DelayPlace::WholeOutput, delay, delay, false),
            at(DelayPlace::MeasuredSpeed, 0, 0, false),
            at(DelayPlace::SpeedError, delay, -1, true),
        ];
        let mut same: Vec<Reading> = known.into_iter().filter(|one| is_same(one.lags, lags)).collect();
        // Without a delay all places are one.
        same.dedup_by_key(|one| (delay > 0).then_some(one.place));
        same
    }
}

/// Tells whether two pairs describe the same sequence.
pub(super) fn is_same(a: DemandLags, b: DemandLags) -> bool {
    let is_next = |lags: DemandLags| (0..=1).contains(&(lags.speed_error - lags.feed_forward));
    a == b || (a.feed_forward == b.feed_forward && is_next(a) && is_next(b))
}

impl InverseController {
    /// A series on the controller's clock as an encoder with the fit's gate reads it at the samples of N_d that are
    /// predicted.
    fn at_speed_samples(&self, theta: &[f64], series: Vec<f64>) -> Result<Vec<f64>, IdentError> {
        let spline = inverse::spline_of(series)?;
        let read = |i: usize| {
            let at = self.position(i) + theta[inverse::LEAD];
            spline.value(at) + theta[inverse::GATE_SQUARED] / 24.0 * spline.curvature(at)
        };
        Ok(self.kept().map(read).collect())
    }
}
