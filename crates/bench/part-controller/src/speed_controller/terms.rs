//! Search for more in a speed controller than PI, delay and straight feed-forward. One term at a time is added to the
//! inverted controller, and its estimate tested against zero.
//!
//! A test is Wald's, with a covariance that is robust to coloured residuals: t, or for several coefficients F, on the
//! degrees of freedom of the stretches that show the term. A step of N_d* shows a feed-forward for a second, so these
//! are few. Several terms on the same data are corrected by Holm, so that the level is that of finding anything where
//! there is nothing.
//!
//! # Source
//! Holm, *A simple sequentially rejective multiple test procedure*, 1979.

use faer::Mat;
use ident::Minimum;
use ident::covariance::at_least_white;
use ident::distributions::{f_tail, holm, interval, student_t_quantile};
use numerics::linalg;
use numerics::null::nan_if_null;
use rig::Experiment;
use rig::estimation::{EstimateError, INTERVAL_LEVEL, ReadOut, timing_floor_s, transformed};
use rig::results::{DemandLags, Estimate, Parameter, Quantity, Stretch};
use serde::{Deserialize, Serialize};
use signal::Signal;

use super::data::{Data, ident_error};
use super::feed_forward::check_moves;
use super::fit::{BATCHES, SpeedControllerFit, run};
use super::inverse::{self, COUNT};
use super::variance::variance_towards;

/// Probability of finding any term where there is none.
pub const LEVEL: f64 = 0.01;
/// Share of the variance left of the speed that a term explains at least, to count as found: where data are long and
/// nearly free of noise, what is estimated differs from zero by what is only almost right in the description of an
/// encoder, too.
pub const MATTERS: f64 = 0.01;
/// A term is not estimated where its 95 % interval would let it move the speed by more than this part of its standard
/// deviation.
const SHORT: f64 = 0.1;
/// Terms that are added to PI and delay at most.
const MOST_TERMS: usize = 2;
/// Speeds at which the static map is estimated.
const KNOTS: usize = 7;

/// A term that may be added to PI and delay.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Term {
    /// A first-order filter on the measured speed.
    Filter,
    /// A derivative term.
    Derivative,
    /// A second integrator.
    SecondIntegrator,
    /// An offset in the speed error.
    SpeedOffset,
    /// A feed-forward that is no straight line over N_d*.
    StaticMap,
    /// A feed-forward that depends on whence N_d* came to its level.
    Hysteresis,
    /// A feed-forward with the sign of dN_d*/dt, as for Coulomb friction.
    Friction,
}

/// Verdict of the data on a term.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It is there.
    Found,
    /// It differs from zero, but explains less than [`MATTERS`] of the variance that is left without it.
    Negligible,
    /// The data show none.
    NotFound,
    /// The data do not decide.
    Undecided,
}

/// A term against zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TermTest {
    /// The term.
    pub term: Term,
    /// Its size; `None` for a static map, which has many, and where the data do not determine it.
    pub estimate: Option<Parameter>,
    /// Probability of as large an estimate where there is no such term.
    #[serde(deserialize_with = "nan_if_null")]
    pub p_value: f64,
    /// The same, corrected for the number of terms tested together.
    #[serde(deserialize_with = "nan_if_null")]
    pub adjusted_p_value: f64,
    /// Part of the speed that it explains, root mean square, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub explains_rad_s: f64,
    /// Verdict that follows.
    pub verdict: Verdict,
}

/// PI and delay, and what was found beside them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Structure {
    /// Probability of finding anything where there is nothing.
    #[serde(deserialize_with = "nan_if_null")]
    pub level: f64,
    /// Each round tests the terms that are left beside those that were found in earlier rounds.
    pub rounds: Vec<Round>,
    /// K_p, K_i and τ beside what was found; `None` where nothing was.
    pub with_terms: Option<Estimate>,
    /// Speed that PI and delay leave unexplained, root mean square, rad/s, and the rest beside the terms found.
    #[serde(deserialize_with = "nan_if_null")]
    pub left_rad_s: (f64, f64),
    /// The data.
    pub stretch: Stretch,
}

/// One round of tests.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Round {
    /// Terms already taken in.
    pub beside: Vec<Term>,
    /// The tests.
    pub tests: Vec<TermTest>,
    /// The term that explains most of those found, which the next round takes in.
    pub takes_in: Option<Term>,
}

/// The feed-forward beyond a straight line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FeedForwardTerms {
    /// Probability of finding anything where there is nothing.
    #[serde(deserialize_with = "nan_if_null")]
    pub level: f64,
    /// Static map, hysteresis, friction compensation beside k and k_a, and beside what was found in earlier rounds.
    pub rounds: Vec<Round>,
    /// The static map, piecewise straight; empty where the data do not determine it.
    pub map: Vec<MapPoint>,
    /// The data.
    pub stretch: Stretch,
}

/// The static feed-forward at one speed, less that at the lowest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapPoint {
    /// N_d*, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: f64,
    /// Torque, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_nm: f64,
    /// Its 95 % interval, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub interval_nm: (f64, f64),
    /// Torque beyond the straight line between the map's ends, Nm; zero at the ends.
    #[serde(deserialize_with = "nan_if_null")]
    pub bend_nm: f64,
    /// Its 95 % interval, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub bend_interval_nm: (f64, f64),
}

impl FeedForwardTerms {
    /// The first test of a term.
    #[must_use]
    pub fn test(&self, term: Term) -> Option<&TermTest> {
        self.rounds.first()?.tests.iter().find(|test| test.term == term)
    }

    /// Terms that were found.
    #[must_use]
    pub fn found(&self) -> Vec<Term> {
        self.rounds.iter().filter_map(|round| round.takes_in).collect()
    }
}

impl Structure {
    /// Terms that were taken in.
    #[must_use]
    pub fn found(&self) -> Vec<Term> {
        self.rounds.iter().filter_map(|round| round.takes_in).collect()
    }
}

/// Tests what may be added to PI and delay in a recording with constant N_d* (BS_T_NT).
///
/// Terms that are found enter one after another, the one that explains most first, and the others are tested beside it:
/// a filter that is left out looks like a derivative, and the reverse.
///
/// # Errors
/// Those of [`super::estimate`].
pub fn structure(
    experiment: &Experiment,
    controller: &SpeedControllerFit,
    torque_limit_nm: Option<f64>,
) -> Result<Structure, EstimateError> {
    let data = Data::of(experiment, torque_limit_nm)?.smoothed()?;
    let has_gate = controller.coarse_demand_nm.is_none();
    let mut start = controller.theta.clone();
    start[inverse::FIRST_ERROR] = data.speed.samples[0] - data.reference.samples[0];
    let fit = |terms: &[Term], start: &[f64]| {
        let is_own = |j: usize| j < inverse::K && (j != inverse::GATE_SQUARED || has_gate);
        let free = |j: usize| is_own(j) || terms.iter().any(|term| positions(*term).contains(&j));
        Ok((data.clone(), run(&data, controller.lags, start, free)?))
    };
    let all = [Term::Filter, Term::Derivative, Term::SecondIntegrator, Term::SpeedOffset];
    let Searched { rounds, data, base, last } = search(&all, &fit, &start)?;
    let found: Vec<Term> = rounds.iter().filter_map(|round| round.takes_in).collect();
    Ok(Structure {
        level: LEVEL,
        with_terms: if found.is_empty() { None } else { Some(with_terms(&data, &last, &found)?) },
        rounds,
        left_rad_s: (root_mean_square(&base), root_mean_square(&last)),
        stretch: data.stretch,
    })
}

/// Tests the feed-forward in a recording in which N_d* moves (Levels_N_NT, Ramp_N_NT), with the lags of its straight
/// form.
///
/// # Errors
/// Those of [`super::estimate_feed_forward`].
pub fn feed_forward_terms(
    experiment: &Experiment,
    controller: &SpeedControllerFit,
    lags: DemandLags,
    torque_limit_nm: Option<f64>,
) -> Result<FeedForwardTerms, EstimateError> {
    let data = Data::of(experiment, torque_limit_nm)?;
    check_moves(experiment, &data.reference)?;
    let free = |j: usize| (j <= inverse::K_A && j != inverse::GATE_SQUARED) || j >= COUNT;
    let mut start = controller.theta.clone();
    start[inverse::FIRST_ERROR] = data.speed.samples[0] - data.reference.samples[0];
    (start[inverse::COSINE], start[inverse::SINE]) = (0.0, 0.0);
    let (knots, tents) = tents(&data.reference);
    let (last, moving) = directions(&data.reference);
    let further = |term: &Term| match term {
        Term::StaticMap => tents.clone(),
        Term::Hysteresis => vec![last.clone()],
        _ => vec![moving.clone()],
    };
    let fit = |terms: &[Term], start: &[f64]| {
        let smooth = Data { further: terms.iter().flat_map(further).collect(), ..data.clone() }.smoothed()?;
        let fit = run(&smooth, lags, start, free)?;
        Ok((smooth, fit))
    };
    let Searched { rounds, base, .. } = search(&[Term::StaticMap, Term::Hysteresis, Term::Friction], &fit, &start)?;
    let is_decided = |test: &TermTest| test.term == Term::StaticMap && test.verdict != Verdict::Undecided;
    let map = match rounds.first().is_some_and(|round| round.tests.iter().any(is_decided)) {
        true => {
            let (data, fit) = fit(&[Term::StaticMap], &base.parameters)?;
            map_points(&data, &knots, &fit)?
        }
        false => Vec::new(),
    };
    Ok(FeedForwardTerms { level: LEVEL, rounds, map, stretch: data.stretch })
}

/// Outcome of a search for terms.
struct Searched {
    rounds: Vec<Round>,
    data: Data,
    /// The fit without terms, and that with all that were taken in.
    base: Minimum,
    last: Minimum,
}

/// Data with terms, and the fit that has them, from where it starts.
type Fitting<'a> = &'a dyn Fn(&[Term], &[f64]) -> Result<(Data, Minimum), EstimateError>;

/// Tests all terms, takes in the one that explains most of those found, tests the others beside it, and so on.
fn search(all: &[Term], fit: Fitting<'_>, start: &[f64]) -> Result<Searched, EstimateError> {
    let (data, base) = fit(&[], start)?;
    let mut searched = Searched { rounds: Vec::new(), data, last: base.clone(), base };
    let mut found: Vec<Term> = Vec::new();
    while found.len() < MOST_TERMS {
        let start = &searched.last.parameters;
        let with = |term: &Term| [found.as_slice(), &[*term]].concat();
        let left = all.iter().filter(|term| !found.iter().any(|taken| has(*taken, **term)));
        let fits: Vec<(Term, Option<(Data, Minimum)>)> =
            left.map(|term| (*term, fit(&with(term), start).ok())).collect();
        let tested = fits.iter().map(|(term, fit)| test(*term, &searched.last, fit.as_ref())).collect();
        let tests = corrected(tested, root_mean_square(&searched.last));
        let is_found = |test: &&TermTest| test.verdict == Verdict::Found;
        let most = tests.iter().filter(is_found).max_by(|a, b| a.explains_rad_s.total_cmp(&b.explains_rad_s));
        let takes_in = most.map(|test| test.term);
        searched.rounds.push(Round { beside: found.clone(), tests, takes_in });
        let Some((term, Some((_, fit)))) = fits.into_iter().find(|(term, _)| Some(*term) == takes_in) else { break };
        found.push(term);
        searched.last = fit;
    }
    Ok(searched)
}

/// Tells whether a term that was taken in leaves nothing of another to test.
fn has(taken: Term, other: Term) -> bool {
    taken == other || (taken, other) == (Term::SecondIntegrator, Term::SpeedOffset)
}

fn root_mean_square(fit: &Minimum) -> f64 {
    (fit.cost / fit.residuals.len() as f64).sqrt()
}

/// Parameters that a term of the controller adds; the first is the one that is tested. The initial state of a second
/// integrator is an offset.
fn positions(term: Term) -> &'static [usize] {
    match term {
        Term::Filter => &[inverse::FILTER],
        Term::Derivative => &[inverse::DERIVATIVE],
        Term::SecondIntegrator => &[inverse::SECOND_INTEGRATOR, inverse::OFFSET],
        Term::SpeedOffset => &[inverse::OFFSET],
        Term::StaticMap | Term::Hysteresis | Term::Friction => &[],
    }
}

/// Parameters that are tested for a term, the last that came into a fit.
fn tested(term: Term, fit: &Minimum) -> Vec<usize> {
    let count = fit.parameters.len();
    match term {
        Term::StaticMap => (count - (KNOTS - 2)..count).collect(),
        Term::Hysteresis | Term::Friction => vec![count - 1],
        _ => positions(term).iter().take(1).copied().collect(),
    }
}

/// Tests a term in the fit that has it against the one that has not; not yet corrected for the number of terms.
fn test(term: Term, base: &Minimum, fit: Option<&(Data, Minimum)>) -> TermTest {
    let undecided = TermTest {
        term,
        estimate: None,
        p_value: 1.0,
        adjusted_p_value: 1.0,
        explains_rad_s: 0.0,
        verdict: Verdict::Undecided,
    };
    let Some((data, fit)) = fit else { return undecided };
    let tested = tested(term, fit);
    let Ok((variance, freedom)) = variance_towards(fit, BATCHES, &tested) else { return undecided };
    let covariance = faer::Scale(variance) * &fit.unscaled_covariance;
    let p_value = one_sided(term, &fit.parameters, joint_p_value(fit, &covariance, freedom, &tested));
    let all_short = tested.iter().all(|j| is_short(data, fit, &covariance, freedom, *j));
    if tested.iter().any(|j| fit.at_bound[*j]) || !(all_short || p_value < LEVEL) {
        return undecided;
    }
    let estimate = quantity(term).map(|quantity| {
        let (t, index) = (data.demand.sample_time_s, tested[0]);
        let outputs: [ReadOut<'_>; 1] = [(quantity, &|g| read_out(term, g, index, t))];
        transformed(&outputs, fit, &covariance, freedom, &data.stretch).parameters.swap_remove(0)
    });
    TermTest {
        estimate,
        p_value,
        adjusted_p_value: p_value,
        explains_rad_s: ((base.cost - fit.cost).max(0.0) / fit.residuals.len() as f64).sqrt(),
        verdict: Verdict::NotFound,
        ..undecided
    }
}

/// The time constant of a filter is positive: a negative one is no sign of a filter, but of how the gate is described.
fn one_sided(term: Term, theta: &[f64], p_value: f64) -> f64 {
    match term {
        Term::Filter if theta[inverse::FILTER] > 0.0 => 0.5 * p_value,
        Term::Filter => 1.0 - 0.5 * p_value,
        _ => p_value,
    }
}

/// Probability of estimates as far from zero where all of `tested` are zero: θᵀ P⁻¹ θ/m is F with m degrees of freedom
/// and those of the variance.
fn joint_p_value(fit: &Minimum, covariance: &Mat<f64>, freedom: f64, tested: &[usize]) -> f64 {
    let m = tested.len();
    let block = Mat::from_fn(m, m, |a, b| covariance[(tested[a], tested[b])]);
    let theta = Mat::from_fn(m, 1, |a, _| fit.parameters[tested[a]]);
    let statistic = (theta.transpose() * linalg::solve(block.as_ref(), theta.as_ref()))[(0, 0)];
    let p_value = f_tail(statistic / m as f64, m as f64, freedom);
    if p_value.is_finite() { p_value } else { 1.0 }
}

/// Tells whether the interval of a coefficient is short: what it lets the term move is small beside how the speed
/// moves.
fn is_short(data: &Data, fit: &Minimum, covariance: &Mat<f64>, freedom: f64, j: usize) -> bool {
    let half_width = student_t_quantile(0.5 + INTERVAL_LEVEL / 2.0, freedom) * covariance[(j, j)].sqrt();
    let rows = fit.residuals.len() as f64;
    let moves = half_width * fit.jacobian.col(j).norm_l2() / rows.sqrt();
    let mean = data.speed.mean().unwrap_or(0.0);
    let spread = (data.speed.samples.iter().map(|w| (w - mean).powi(2)).sum::<f64>() / data.speed.len() as f64).sqrt();
    moves < SHORT * spread
}

/// Holm's correction, and with it the verdict; `left_rad_s` is what is left of the speed without the terms.
fn corrected(mut tests: Vec<TermTest>, left_rad_s: f64) -> Vec<TermTest> {
    let p_values: Vec<f64> = tests.iter().map(|test| test.p_value).collect();
    for (test, adjusted) in tests.iter_mut().zip(holm(&p_values)) {
        test.adjusted_p_value = adjusted;
        if adjusted < LEVEL {
            let matters = test.explains_rad_s.powi(2) >= MATTERS * left_rad_s.powi(2);
            test.verdict = if matters { Verdict::Found } else { Verdict::Negligible };
        }
    }
    tests
}

fn quantity(term: Term) -> Option<Quantity> {
    match term {
        Term::Filter => Some(Quantity::FilterTime),
        Term::Derivative => Some(Quantity::DerivativeGain),
        Term::SecondIntegrator => Some(Quantity::SecondIntegralGain),
        Term::SpeedOffset => Some(Quantity::SpeedErrorOffset),
        Term::StaticMap => None,
        Term::Hysteresis => Some(Quantity::FeedForwardHysteresis),
        Term::Friction => Some(Quantity::FrictionCompensation),
    }
}

/// A term in SI, its parameter at `index`; T is the controller's sample time.
fn read_out(term: Term, g: &[f64], index: usize, t: f64) -> f64 {
    let k_p = 1.0 / g[inverse::P];
    match term {
        Term::Filter => g[index] * t,
        Term::Derivative => g[index] * k_p * t,
        Term::SecondIntegrator => g[index] * k_p / (t * t),
        Term::SpeedOffset | Term::StaticMap | Term::Hysteresis | Term::Friction => g[index],
    }
}

fn with_terms(data: &Data, fit: &Minimum, found: &[Term]) -> Result<Estimate, EstimateError> {
    let (covariance, freedom) = at_least_white(fit, BATCHES).map_err(|e| ident_error(data, e))?;
    let t = data.demand.sample_time_s;
    let gains: [ReadOut<'_>; 3] = [
        (Quantity::ProportionalGain, &|g| 1.0 / g[inverse::P]),
        (Quantity::IntegralGain, &|g| g[inverse::Q] / (g[inverse::P] * t)),
        (Quantity::ControllerDelay, &|g| (g[inverse::LEAD] + g[inverse::GATE_SQUARED].max(0.0).sqrt() / 2.0) * t),
    ];
    let read = |term: &Term| {
        let (term, index) = (*term, *positions(*term).first()?);
        let read = move |g: &[f64]| read_out(term, g, index, t);
        Some((quantity(term)?, Box::new(read) as Box<dyn Fn(&[f64]) -> f64>))
    };
    let read: Vec<_> = found.iter().filter_map(read).collect();
    let terms = read.iter().map(|(quantity, read)| (*quantity, read.as_ref()));
    let outputs: Vec<ReadOut<'_>> = gains.into_iter().chain(terms).collect();
    let mut estimate = transformed(&outputs, fit, &covariance, freedom, &data.stretch);
    estimate.add_systematic(&[Quantity::ControllerDelay], timing_floor_s(t));
    Ok(estimate)
}

/// Speeds from the lowest to the highest N_d*, and for each between the ends the function that is one there, zero at
/// the next ones on either side, and straight in between: what a static map has beyond a straight line.
fn tents(reference: &Signal) -> (Vec<f64>, Vec<Signal>) {
    let fold = |f: fn(f64, f64) -> f64, from: f64| reference.samples.iter().copied().fold(from, f);
    let (low, high) = (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY));
    let width = (high - low) / (KNOTS - 1) as f64;
    let knots: Vec<f64> = (0..KNOTS).map(|i| low + i as f64 * width).collect();
    let tent = |knot: &f64| reference.map(|speed| (1.0 - (speed - knot).abs() / width).max(0.0));
    let tents = knots[1..KNOTS - 1].iter().map(tent).collect();
    (knots, tents)
}

/// The sign of the last change of N_d*, zero before the first; and the same while N_d* moves, zero while it rests. N_d*
/// that is given in steps moves as long as they follow each other as they usually do.
fn directions(reference: &Signal) -> (Signal, Signal) {
    let changes: Vec<usize> =
        (1..reference.len()).filter(|i| reference.samples[*i] != reference.samples[i - 1]).collect();
    let mut gaps: Vec<usize> = changes.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_unstable();
    let usual = gaps.get(gaps.len() / 2).copied().unwrap_or(1);
    let (mut last, mut since) = (0.0, usize::MAX);
    let mut both = (Vec::with_capacity(reference.len()), Vec::with_capacity(reference.len()));
    for (i, speed) in reference.samples.iter().enumerate() {
        let change = if i == 0 { 0.0 } else { speed - reference.samples[i - 1] };
        if change != 0.0 {
            (last, since) = (change.signum(), 0);
        } else {
            since = since.saturating_add(1);
        }
        both.0.push(last);
        both.1.push(if since < usual { last } else { 0.0 });
    }
    (reference.with_samples(both.0), reference.with_samples(both.1))
}

/// The map at its knots, less that at the first: k (N_j − N_1) + c_j.
fn map_points(data: &Data, knots: &[f64], fit: &Minimum) -> Result<Vec<MapPoint>, EstimateError> {
    let (covariance, freedom) = at_least_white(fit, BATCHES).map_err(|e| ident_error(data, e))?;
    let within = |value: f64, variance: f64| interval(value, variance.max(0.0).sqrt(), freedom, INTERVAL_LEVEL);
    let point = |(i, speed): (usize, &f64)| {
        let rise = speed - knots[0];
        let tent = (i > 0 && i + 1 < knots.len()).then(|| COUNT + i - 1);
        let bend_nm = tent.map_or(0.0, |j| fit.parameters[j]);
        let of_bend = tent.map_or(0.0, |j| covariance[(j, j)]);
        let with_line = tent.map_or(0.0, |j| 2.0 * rise * covariance[(inverse::K, j)]);
        let torque_nm = fit.parameters[inverse::K] * rise + bend_nm;
        let variance = rise * rise * covariance[(inverse::K, inverse::K)] + with_line + of_bend;
        MapPoint {
            speed_rad_s: *speed,
            torque_nm,
            interval_nm: within(torque_nm, variance),
            bend_nm,
            bend_interval_nm: within(bend_nm, of_bend),
        }
    };
    Ok(knots.iter().enumerate().map(point).collect())
}
