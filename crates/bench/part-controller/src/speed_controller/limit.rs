//! The limit of T_d*, and what becomes of the integrator while T_d* rests there.
//!
//! While T_d* is not limited, the integrator's state can be read from it: I = T_d* − FF − K_p e. How much it changes
//! over an episode at the limit depends on the anti-windup; each law predicts a change, and is rejected where the
//! changes seen over all episodes are farther from it than the same readings scatter where nothing is limited.
//!
//! # Source
//! Åström & Hägglund, *Advanced PID Control*, 2006, §3.5 (integrator windup).

use std::ops::Range;
use std::ops::RangeInclusive;

use faer::Mat;
use ident::distributions::f_tail;
use numerics::linalg;
use numerics::null::nan_if_null;
use rig::estimation::{EstimateError, need};
use rig::results::{FeedForward, Quantity};
use rig::{Experiment, Role};
use serde::{Deserialize, Serialize};
use signal::spline::UniformSpline;

use super::data::{at_updates, held_on_the_clock_of, signal_error};
use super::fit::SpeedControllerFit;
use super::inverse;
use super::lag::{lagged, shifted};
use super::terms::LEVEL;

/// Within this part of the highest |T_d*| a sample counts as being at the limit.
const AT_LIMIT: f64 = 1e-6;
/// T_d* that rests at its highest magnitude for so many samples, or comes back to it so often, is limited there.
const RESTS: usize = 10;
const COMES_BACK: usize = 5;
/// Samples before and after an episode in which the integrator is read, and samples left out right after it.
const WINDOW: usize = 40;
const SKIPPED: usize = 3;
/// Fewest readings without a limit by which their scatter is judged.
const FEWEST_QUIET: usize = 10;
/// Laws that differ by less than so many standard deviations of a reading are not separated, however many readings
/// there are.
const AT_STAKE: f64 = 5.0;
/// Laws that are tested together.
const LAWS: f64 = 3.0;
/// Tracking times tried, s, in equal ratios.
const TRACKING_S: RangeInclusive<f64> = 1e-3..=10.0;
/// So many are tried.
const TRACKING_TIMES: usize = 121;

/// Behaviour of the integrator while T_d* is limited.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum AntiWindup {
    /// It runs on.
    None,
    /// It rests while T_d* would exceed the limit.
    Clamping,
    /// It rests while T_d* would exceed the limit and the speed error would drive it further.
    ConditionalIntegration,
    /// It is drawn back by what exceeds the limit over a tracking time.
    BackCalculation {
        /// The tracking time that fits best, s.
        #[serde(deserialize_with = "nan_if_null")]
        tracking_s: f64,
    },
}

/// A law against the data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LawTest {
    /// The law.
    pub law: AntiWindup,
    /// Root mean square of what the integrator's changes miss it by, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub misses_nm: f64,
    /// Probability of missing it by as much where it is right.
    #[serde(deserialize_with = "nan_if_null")]
    pub p_value: f64,
    /// The same, times the number of laws.
    #[serde(deserialize_with = "nan_if_null")]
    pub adjusted_p_value: f64,
}

/// Findings of a recording on the limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Limit {
    /// T_d* never rests at its highest magnitude.
    NotReached {
        /// Highest |T_d*|, Nm.
        #[serde(deserialize_with = "nan_if_null")]
        highest_nm: f64,
    },
    /// It does.
    Reached(LimitReached),
}

/// Episodes at the limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LimitReached {
    /// The limit, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub limit_nm: f64,
    /// Share of the samples at it.
    #[serde(deserialize_with = "nan_if_null")]
    pub share: f64,
    /// Episodes that could be used, and the longest of all, s.
    pub episodes: usize,
    /// The longest of all, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub longest_s: f64,
    /// By how much the laws differ in the integrator over an episode at most, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub at_stake_nm: f64,
    /// Standard deviation of a reading of the integrator's change, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub reading_nm: f64,
    /// The laws; empty where readings are too few, or too inexact beside what is at stake.
    pub laws: Vec<LawTest>,
}

impl LimitReached {
    /// Laws that the data do not reject.
    pub fn possible(&self) -> impl Iterator<Item = &LawTest> {
        self.laws.iter().filter(|law| law.adjusted_p_value >= LEVEL)
    }
}

/// Looks for the limit of T_d* in a recording in speed control, and compares laws of anti-windup.
///
/// # Errors
/// A missing signal.
pub fn limit(
    experiment: &Experiment,
    controller: &SpeedControllerFit,
    feed_forward: Option<&FeedForward>,
) -> Result<Limit, EstimateError> {
    let demand = &need(experiment, Role::DynoTorqueDemand)?.samples;
    let highest_nm = demand.iter().fold(0.0, |highest: f64, torque| highest.max(torque.abs()));
    let limited: Vec<bool> = demand.iter().map(|torque| torque.abs() >= (1.0 - AT_LIMIT) * highest_nm).collect();
    let runs: Vec<Range<usize>> = signal::runs(demand.len(), |k| limited[k]).collect();
    let longest = runs.iter().map(Range::len).max().unwrap_or(0);
    if longest < RESTS && runs.len() < COMES_BACK {
        return Ok(Limit::NotReached { highest_nm });
    }
    let signals = ControllerSignals::new(experiment, controller, feed_forward, highest_nm)?;
    let episodes = signals.usable(&merged(&runs));
    let typical = episodes.get(episodes.len() / 2).map_or(1, Range::len);
    let quiet = signals.quiet(&limited, typical);
    let of_law = |law| signals.misses(&episodes, law);
    let doubts = doubtful(controller, feed_forward).into_iter().map(|(fit, feed)| {
        let moved =
            ControllerSignals::new(experiment, &fit, feed.as_ref(), highest_nm)?.misses(&episodes, AntiWindup::None);
        Ok(moved.iter().zip(of_law(AntiWindup::None)).map(|(moved, miss)| moved - miss).collect())
    });
    let doubts: Vec<Vec<f64>> = doubts.collect::<Result<_, EstimateError>>()?;
    let reading_nm = root_mean_square(&quiet);
    let apart = of_law(AntiWindup::None).iter().zip(of_law(AntiWindup::Clamping)).map(|(a, b)| (a - b).abs()).collect();
    let at_stake_nm = largest(apart);
    let is_decided = episodes.len() > 1 && quiet.len() >= FEWEST_QUIET && at_stake_nm >= AT_STAKE * reading_nm;
    let judge = Judge { reading_nm, count: quiet.len(), doubts };
    let laws = if is_decided { judge.laws(&of_law) } else { Vec::new() };
    Ok(Limit::Reached(LimitReached {
        limit_nm: highest_nm,
        share: limited.iter().filter(|is| **is).count() as f64 / limited.len().max(1) as f64,
        episodes: episodes.len(),
        longest_s: longest as f64 * signals.sample_time_s,
        at_stake_nm,
        reading_nm,
        laws,
    }))
}

/// The controller and its feed-forward, one of K_p, K_i, τ and k after the other moved by its standard error.
fn doubtful(
    controller: &SpeedControllerFit,
    feed_forward: Option<&FeedForward>,
) -> Vec<(SpeedControllerFit, Option<FeedForward>)> {
    let estimate = &controller.result.estimate;
    let moved = |quantity: Quantity, move_by: &dyn Fn(&mut [f64], f64, f64)| {
        let parameter = estimate.parameter(quantity)?;
        let mut fit = controller.clone();
        move_by(&mut fit.theta, parameter.value, parameter.standard_error);
        Some((fit, feed_forward.cloned()))
    };
    let t = controller.result.sample_time_s;
    let gains = moved(Quantity::ProportionalGain, &|theta, value, error| {
        theta[inverse::P] *= value / (value + error);
        theta[inverse::Q] *= value / (value + error);
    });
    let integral = moved(Quantity::IntegralGain, &|theta, value, error| theta[inverse::Q] *= (value + error) / value);
    let delay = moved(Quantity::ControllerDelay, &|theta, _, error| theta[inverse::LEAD] += error / t);
    let feed = feed_forward.map(|feed_forward| {
        let mut feed = feed_forward.clone();
        let k = feed.estimate.parameters.iter_mut().find(|p| p.quantity == Quantity::SpeedFeedForward);
        k.into_iter().for_each(|k| k.value += k.standard_error);
        (controller.clone(), Some(feed))
    });
    [gains, integral, delay, feed].into_iter().flatten().collect()
}

/// Scale against which the misses of a law are judged.
struct Judge {
    /// Scatter of a reading, known from so many of them.
    reading_nm: f64,
    count: usize,
    /// By how much the readings move with each parameter that is not known exactly.
    doubts: Vec<Vec<f64>>,
}

impl Judge {
    /// Each law against the readings. Back-calculation has a parameter of its own, and the laws without one as its
    /// limits; it is tried where none of those is possible.
    fn laws(&self, of_law: &impl Fn(AntiWindup) -> Vec<f64>) -> Vec<LawTest> {
        let simple = [AntiWindup::None, AntiWindup::Clamping, AntiWindup::ConditionalIntegration];
        let mut tests: Vec<LawTest> = simple.iter().map(|law| self.test(*law, &of_law(*law), 0)).collect();
        if tests.iter().all(|test| test.adjusted_p_value < LEVEL) {
            let (from, to) = TRACKING_S.into_inner();
            let tracking = |i: usize| from * (to / from).powf(i as f64 / (TRACKING_TIMES - 1) as f64);
            let best = (0..TRACKING_TIMES)
                .map(|i| AntiWindup::BackCalculation { tracking_s: tracking(i) })
                .map(|law| (law, of_law(law)))
                .min_by(|a, b| root_mean_square(&a.1).total_cmp(&root_mean_square(&b.1)));
            tests.extend(best.map(|(law, misses)| self.test(law, &misses, 1)));
        }
        tests
    }

    /// mᵀ V⁻¹ m of the misses m, V = σ² I + Σ d dᵀ with the doubts d, over its degrees of freedom.
    fn test(&self, law: AntiWindup, misses: &[f64], parameters: usize) -> LawTest {
        let n = misses.len();
        let freedom = n.saturating_sub(parameters) as f64;
        let own = |a: usize, b: usize| if a == b { self.reading_nm.powi(2) } else { 0.0 };
        let spread = Mat::from_fn(n, n, |a, b| own(a, b) + self.doubts.iter().map(|d| d[a] * d[b]).sum::<f64>());
        let misses_column = Mat::from_fn(n, 1, |a, _| misses[a]);
        let squares = (misses_column.transpose() * linalg::solve(spread.as_ref(), misses_column.as_ref()))[(0, 0)];
        let p_value = f_tail(squares / freedom, freedom, self.count as f64);
        let adjusted_p_value = (p_value * LAWS).min(1.0);
        LawTest { law, misses_nm: root_mean_square(misses), p_value, adjusted_p_value }
    }
}

/// Runs so close that the integrator cannot be read in between, taken together.
fn merged(runs: &[Range<usize>]) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = Vec::new();
    for run in runs {
        match all.last_mut() {
            Some(last) if run.start < last.end + 2 * WINDOW + SKIPPED => last.end = run.end,
            _ => all.push(run.clone()),
        }
    }
    all
}

/// Signals that the controller computed from, sample by sample of T_d*.
struct ControllerSignals {
    sample_time_s: f64,
    limit_nm: f64,
    /// K_i T, Nm s/rad.
    gain: f64,
    /// The speed error that T_d* shows at each sample, rad/s.
    error: Vec<f64>,
    /// K_p e, Nm.
    proportional_nm: Vec<f64>,
    /// Feed-forward when that error was measured, Nm.
    feed_nm: Vec<f64>,
    /// T_d* less K_p e and the feed-forward of its sample, Nm: the integrator, where T_d* is not limited.
    integrator_nm: Vec<f64>,
}

impl ControllerSignals {
    fn new(
        experiment: &Experiment,
        controller: &SpeedControllerFit,
        feed_forward: Option<&FeedForward>,
        limit_nm: f64,
    ) -> Result<Self, EstimateError> {
        let demand = &at_updates(need(experiment, Role::DynoTorqueDemand)?);
        let reference = &held_on_the_clock_of(demand, need(experiment, Role::DynoSpeedDemand)?);
        let speed = need(experiment, Role::DynoSpeed)?;
        let file = experiment.file.as_str();
        let spline = UniformSpline::new(speed.samples.clone()).map_err(|e| signal_error(file, e))?;
        let (theta, t) = (&controller.theta, demand.sample_time_s);
        let lags = feed_forward.map_or(controller.lags, |f| f.lags);
        let coefficient = |quantity| feed_forward.and_then(|f| f.estimate.parameter(quantity)).map_or(0.0, |p| p.value);
        let k = coefficient(Quantity::SpeedFeedForward);
        let k_a = coefficient(Quantity::AccelerationFeedForward) / t;
        let n = demand.len().min(reference.len());
        let set = |i: usize, lag: i32| lagged(&reference.samples[..n], i, lag);
        let fed = |i: usize| {
            let now = set(i, lags.feed_forward);
            k * now + k_a * (now - set(i, lags.feed_forward + 1))
        };
        let feed: Vec<f64> = (0..n).map(fed).collect();
        let error = |i: usize| {
            let at = (demand.time_s(i) - theta[inverse::LEAD] * t - speed.start_s) / speed.sample_time_s;
            spline.value(at.clamp(0.0, speed.len() as f64 - 1.0)) - set(i, lags.speed_error)
        };
        let error: Vec<f64> = (0..n).map(error).collect();
        let proportional_nm: Vec<f64> = error.iter().map(|e| e / theta[inverse::P]).collect();
        Ok(ControllerSignals {
            sample_time_s: t,
            limit_nm,
            gain: theta[inverse::Q] / theta[inverse::P],
            integrator_nm: (0..n).map(|i| demand.samples[i] - proportional_nm[i] - feed[i]).collect(),
            feed_nm: shifted(&feed, lags.speed_error - lags.feed_forward),
            error,
            proportional_nm,
        })
    }

    /// Episodes with room to read the integrator before and after.
    fn usable(&self, episodes: &[Range<usize>]) -> Vec<Range<usize>> {
        let has_room = |e: &&Range<usize>| e.start > WINDOW && e.end + SKIPPED + WINDOW <= self.error.len();
        episodes.iter().filter(has_room).cloned().collect()
    }

    /// By how much the integrator misses a law after each episode.
    fn misses(&self, episodes: &[Range<usize>], law: AntiWindup) -> Vec<f64> {
        episodes.iter().map(|episode| self.miss(episode, law)).collect()
    }

    /// The same reading of the integrator's change where T_d* is not limited, of episodes of `length`.
    fn quiet(&self, limited: &[bool], length: usize) -> Vec<f64> {
        let span = 1 + WINDOW + length + SKIPPED + WINDOW;
        let starts = (0..self.error.len().saturating_sub(span)).step_by(span);
        let is_quiet = |start: &usize| limited[*start..start + span].iter().all(|is| !is);
        let episode = |start: usize| start + WINDOW + 1..start + WINDOW + 1 + length;
        starts.filter(is_quiet).map(|start| self.miss(&episode(start), AntiWindup::None)).collect()
    }

    fn miss(&self, episode: &Range<usize>, law: AntiWindup) -> f64 {
        let (before, after) = (episode.start - 1 - WINDOW, episode.end + SKIPPED);
        // Where nothing is limited the integrator runs by itself; its level is that at which it does so best.
        let mut integral = 0.0;
        let mut level = 0.0;
        for i in before..episode.start - 1 {
            level += (self.integrator_nm[i] - integral) / WINDOW as f64;
            integral += self.gain * self.error[i];
        }
        let mut state = level + integral;
        let mut miss = 0.0;
        for i in episode.start - 1..after + WINDOW {
            if i >= after {
                miss += (self.integrator_nm[i] - state) / WINDOW as f64;
            }
            state = self.next(state, i, law);
        }
        miss
    }

    /// The integrator's next state under a law.
    fn next(&self, state_nm: f64, i: usize, law: AntiWindup) -> f64 {
        let change = self.gain * self.error[i];
        let wanted = state_nm + self.proportional_nm[i] + self.feed_nm[i];
        let exceeds = wanted.abs() > self.limit_nm;
        match law {
            AntiWindup::Clamping if exceeds => state_nm,
            AntiWindup::ConditionalIntegration if exceeds && change * wanted > 0.0 => state_nm,
            AntiWindup::BackCalculation { tracking_s } => {
                let excess = wanted.clamp(-self.limit_nm, self.limit_nm) - wanted;
                state_nm + change + excess * (self.sample_time_s / tracking_s).min(1.0)
            }
            _ => state_nm + change,
        }
    }
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

fn largest(values: Vec<f64>) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}
