//! The estimate of one equation: start, search, covariance, residuals.

use std::borrow::Cow;

use faer::Mat;
use signal::Sos;

use super::evaluate::Evaluator;
use super::excerpt::{excerpt, interpolated};
use super::high_order_arx::HighOrderArx;
use super::joint::{Errors, Stage};
use super::options::Polynomial;
use super::orders::Orders;
use super::quadratic_region::QuadraticRegion;
use super::reduced::{lowered, raised};
use super::segment::{Segment, segments};
use super::signals::Aim;
use super::slower::{quickened, slow_orders, slowed};
use super::start::{self, Long, candidates};
use crate::{Bounds, Dataset, Focus, IdentError, NonlinearOptions};
use fitting::nonlinear::{Lowest, SumOfSquares, descend, descend_unless};
use fitting::{StructureError, UnstablePart};

/// Rows that starting values are sought on.
const START_ROWS: usize = 16_384;
/// Rows that the shortest way starts on, and fewest rows on which it is tried.
const DIRECT_ROWS: usize = 4096;
const LEAST_ROWS: usize = 2000;
/// Iterations spent on each starting value.
const START_ITERATIONS: usize = 30;
/// Factors by which the data are slowed for further starting values, while this many rows a coefficient are left.
const SLOWER: [usize; 2] = [8, 64];
const SLOW_ROWS: usize = 20;
/// By how many poles the order is raised for further starting values.
const RAISED: [usize; 2] = [1, 2];
/// Stretches for a covariance under residuals that a filter colours, where none are given.
const BATCHES: usize = 30;

/// One equation at its estimate.
pub(super) struct Equation<'a> {
    pub(super) theta: Vec<f64>,
    /// Searches that its covariance rests on.
    pub(super) stages: Vec<Stage<'a>>,
    pub(super) lowest: Lowest,
    /// Prediction errors of every experiment, NaN where there are none.
    pub(super) errors: Vec<Vec<f64>>,
    /// The initial state of every experiment.
    pub(super) states: Vec<Vec<f64>>,
    /// Numbers estimated for initial states.
    pub(super) state_parameters: usize,
    /// True if `C`, `F`, and the poles that `A` and `D` give are all in the unit circle.
    pub(super) stable: bool,
}

/// Settings that all searches of one equation share.
struct Task<'a> {
    orders: &'a Orders,
    estimate_states: bool,
    bounds: Vec<Bounds>,
    search: NonlinearOptions,
    /// Where the search is to start; none where starting values are sought.
    starts: &'a [Vec<f64>],
}

pub(super) fn estimate<'a>(
    options: &Polynomial,
    orders: &Orders,
    data: &'a Dataset,
    output: usize,
    held: &[(usize, f64)],
) -> Result<Equation<'a>, IdentError> {
    let skip = orders.is_output_error();
    let mut all = segments(data, output, skip);
    let estimate_states = !options.from_rest;
    let states = if estimate_states { orders.states() } else { 0 };
    all.retain(|s| s.known() > states);
    let rows: usize = all.iter().map(Segment::known).sum();
    if rows <= orders.count() + states * all.len() {
        return Err(IdentError::TooFewSamples { samples: rows, parameters: orders.count() + states });
    }
    let of_output = output * orders.count()..(output + 1) * orders.count();
    let starts: Vec<Vec<f64>> = options.starts.iter().map(|start| start[of_output.clone()].to_vec()).collect();
    let task = Task { orders, estimate_states, bounds: bounds(orders, held), search: options.search, starts: &starts };
    let (lowest, stages) = task.estimate(&all, options)?;
    let mut evaluator = Evaluator::new(orders, &all, Aim::Prediction, estimate_states);
    let errors = evaluator.residuals(&lowest.parameters)?;
    Ok(Equation {
        errors: by_experiment(data, &all, &errors),
        states: first_states(data, &all, evaluator.states(), orders),
        state_parameters: states * all.len(),
        stable: is_stable(orders, &lowest.parameters),
        theta: lowest.parameters.clone(),
        stages,
        lowest,
    })
}

fn bounds(orders: &Orders, held: &[(usize, f64)]) -> Vec<Bounds> {
    let mut bounds = vec![Bounds::NONE; orders.count()];
    held.iter().for_each(|(index, value)| bounds[*index] = Bounds::new(*value, *value));
    bounds
}

fn is_stable(orders: &Orders, theta: &[f64]) -> bool {
    let inputs = (0..orders.inputs()).map(|k| orders.f(k));
    inputs.chain([orders.a(), orders.c(), orders.d()]).all(|range| super::line::is_stable(&theta[range], 1.0))
}

type Estimate<'a> = (Lowest, Vec<Stage<'a>>);

impl Task<'_> {
    fn estimate<'a>(&self, all: &[Segment<'a>], options: &Polynomial) -> Result<Estimate<'a>, IdentError> {
        let passed: Option<Vec<Segment<'a>>> =
            options.prefilter.as_ref().map(|f| all.iter().map(|s| filtered(s, f, options.from_rest)).collect());
        let batches = options.batches;
        match (options.focus, &passed) {
            (Focus::Prediction, None) => self.predicting(all, batches),
            (Focus::Prediction, Some(passed)) if self.orders.is_output_error() => self.predicting(passed, batches),
            (Focus::Prediction, Some(passed)) if self.orders.na == 0 => {
                let (found, mut stages) = self.predicting(passed, batches.or(Some(BATCHES)))?;
                let (_, place) = self.orders.without_noise();
                let parameters = place.iter().map(|j| found.parameters[*j]).collect();
                let taken = |i: usize, j: usize| f64::from(u8::from(place[i] == j));
                let taken = Mat::from_fn(place.len(), self.orders.count(), taken);
                stages.iter_mut().for_each(|s| s.share = &taken * &s.share);
                self.with_noise(all, &place, (Lowest { parameters, ..found }, stages), batches)
            }
            // Where noise and inputs share their poles, the noise that the filter colours would take part in A.
            (_, passed) => self.simulating(passed.as_deref().unwrap_or(all), all, batches),
        }
    }

    fn predicting<'a>(&self, all: &[Segment<'a>], batches: Option<usize>) -> Result<Estimate<'a>, IdentError> {
        let direct = if self.starts.is_empty() { self.direct(all) } else { None };
        let lowest = match direct {
            Some((lowest, true)) => lowest,
            Some((lowest, false)) => self.contested(all, lowest)?,
            None => {
                let start = if !self.starts.is_empty() {
                    self.best_of(all, Aim::Prediction, self.starts)?
                } else if self.orders.is_output_error() {
                    self.simulating_start(all, |few| self.guesses(few))?
                } else {
                    self.start(all, Aim::Prediction, |few| self.guesses(few))?
                };
                self.descended(all, Aim::Prediction, &start, self.search)?
            }
        };
        Ok(self.judged(all, Aim::Prediction, lowest, batches))
    }

    /// The minimum that the shortest way leads to, and whether a long ARX model says that no other lies lower. Only for
    /// structures whose noise and inputs share their poles: others have shallow minima that no such model separates.
    fn direct(&self, all: &[Segment<'_>]) -> Option<(Lowest, bool)> {
        if self.orders.na == 0 || self.orders.nd + self.orders.nf.iter().sum::<usize>() > 0 {
            return None;
        }
        let rows: usize = all.iter().map(Segment::known).sum();
        let high_order = (rows >= LEAST_ROWS).then(|| HighOrderArx::new(self.orders, all)).flatten()?;
        if !high_order.is_settled() {
            return None;
        }
        let few = excerpt(all, DIRECT_ROWS);
        let long = Long::of(self.orders, &few, high_order.order, high_order.theta.clone());
        let mut theta = self.held(start::by_noise(self.orders, &few, &long)?);
        if few.iter().map(Segment::len).sum::<usize>() < rows
            && let Ok(lowest) = self.descended(&few, Aim::Prediction, &theta, self.some_way())
        {
            theta = lowest.parameters;
        }
        let lowest = self.descended(all, Aim::Prediction, &theta, self.search).ok()?;
        let free = lowest.at_bound.iter().filter(|b| !**b).count();
        let residuals = Evaluator::new(self.orders, all, Aim::Prediction, self.estimate_states).residual_count();
        let met = lowest.termination.converged() && high_order.is_met(lowest.cost, residuals, free);
        Some((lowest, met))
    }

    /// The lower of this minimum and of that which all starting values lead to.
    fn contested(&self, all: &[Segment<'_>], lowest: Lowest) -> Result<Lowest, IdentError> {
        let guesses = |few: &[Segment<'_>]| -> Result<Vec<Vec<f64>>, IdentError> {
            let mut guesses = self.guesses(few)?;
            guesses.push(lowest.parameters.clone());
            Ok(guesses)
        };
        let start = self.start(all, Aim::Prediction, guesses)?;
        let mut evaluator = Evaluator::new(self.orders, all, Aim::Prediction, self.estimate_states);
        if evaluator.cost(&start).is_ok_and(|cost| QuadraticRegion(&lowest).holds(&start, cost)) {
            return Ok(lowest);
        }
        let other = self.descended(all, Aim::Prediction, &start, self.search);
        Ok(other.ok().filter(|other| other.cost < lowest.cost).unwrap_or(lowest))
    }

    /// `A`, `B`, `F` from the simulated output, filtered or not, then `C` and `D` from all there is with those held.
    fn simulating<'a>(
        &self,
        passed: &[Segment<'a>],
        all: &[Segment<'a>],
        batches: Option<usize>,
    ) -> Result<Estimate<'a>, IdentError> {
        let (plain, place) = self.orders.without_noise();
        let bounds = place.iter().map(|j| self.bounds[*j]).collect();
        let dynamics = Task { orders: &plain, bounds, ..*self };
        let start = if self.starts.is_empty() {
            dynamics.simulating_start(passed, |few| dynamics.guesses(few))?
        } else {
            let of_dynamics = |start: &Vec<f64>| place.iter().map(|j| start[*j]).collect();
            dynamics.best_of(passed, Aim::Simulation, &self.starts.iter().map(of_dynamics).collect::<Vec<_>>())?
        };
        let found = dynamics.descended(passed, Aim::Simulation, &start, self.search)?;
        let found = dynamics.judged(passed, Aim::Simulation, found, batches);
        self.with_noise(all, &place, found, batches)
    }

    /// `C` and `D` from all there is, with the dynamics held that were found to stand at these places.
    ///
    /// The errors of the dynamics carry over to `C` and `D` by `−(JᵀJ)⁻¹ Jᵀ J_d`, with `J` and `J_d` the columns of `C`
    /// and `D`, and of the dynamics. Apart from that both are independent: the former come of the noise times inputs,
    /// the latter of the noise times itself.
    fn with_noise<'a>(
        &self,
        all: &[Segment<'a>],
        place: &[usize],
        (found, mut stages): Estimate<'a>,
        batches: Option<usize>,
    ) -> Result<Estimate<'a>, IdentError> {
        if place.len() == self.orders.count() {
            return Ok((found, stages));
        }
        let theta = placed(place, &found.parameters, self.orders.count());
        let mut noise = Task { orders: self.orders, bounds: self.bounds.clone(), ..*self };
        place.iter().for_each(|j| noise.bounds[*j] = Bounds::new(theta[*j], theta[*j]));
        let begin = noise.start(all, Aim::Prediction, |few| Ok(vec![start::with_noise(self.orders, few, &theta)]))?;
        let lowest = noise.descended(all, Aim::Prediction, &begin, self.search)?;
        let (lowest, mut own) = noise.judged(all, Aim::Prediction, lowest, batches);
        // What the dynamics took of the residuals is gone too.
        let taken = place.iter().filter(|j| self.bounds[**j].lower < self.bounds[**j].upper).count();
        own.iter_mut().for_each(|stage| stage.freedom = (stage.freedom - taken as f64).max(1.0));
        let influence = influence(&lowest, place);
        stages.iter_mut().for_each(|s| s.share = &influence * &s.share);
        stages.extend(own);
        let at_bound = self.bounds.iter().map(|b| b.lower == b.upper).collect();
        let ended = if found.termination.converged() { lowest.termination } else { found.termination };
        let iterations = found.iterations.max(lowest.iterations);
        let condition = found.condition.max(lowest.condition);
        let lowest = Lowest { at_bound, termination: ended, iterations, condition, ..lowest };
        Ok((lowest, stages))
    }

    /// The minimum that a start leads to.
    fn descended(
        &self,
        all: &[Segment<'_>],
        aim: Aim,
        start: &[f64],
        search: NonlinearOptions,
    ) -> Result<Lowest, IdentError> {
        let mut evaluator = Evaluator::new(self.orders, all, aim, self.estimate_states);
        let start = self.held(evaluator.within_the_edge(start));
        descend(&mut evaluator, &start, &self.bounds, search)
    }

    /// Some way down, to compare starting values.
    fn some_way(&self) -> NonlinearOptions {
        NonlinearOptions { iteration_limit: START_ITERATIONS, cost_tolerance: 1e-7, ..self.search }
    }

    /// θ with the coefficients that are held at their values.
    fn held(&self, mut theta: Vec<f64>) -> Vec<f64> {
        let values = theta.iter_mut().zip(&self.bounds);
        values.for_each(|(v, b)| *v = if b.lower == b.upper { b.lower } else { *v });
        theta
    }

    /// A minimum, or a lower one across the edge of stability, with what its covariance rests on.
    fn judged<'a>(&self, all: &[Segment<'a>], aim: Aim, lowest: Lowest, batches: Option<usize>) -> Estimate<'a> {
        let evaluator = Evaluator::new(self.orders, all, aim, self.estimate_states);
        let lowest = self.beyond_the_edge(all, aim, &evaluator, &lowest).unwrap_or(lowest);
        let free = lowest.at_bound.iter().filter(|b| !**b).count();
        // Nothing else speaks for white errors of a model of the dynamics alone.
        let unexplained = aim == Aim::Simulation || self.orders.is_output_error();
        let white = if unexplained { Errors::Coloured } else { Errors::White };
        let stage = Stage {
            orders: self.orders.clone(),
            segments: all.to_vec(),
            aim,
            estimate_states: self.estimate_states,
            theta: lowest.parameters.clone(),
            unscaled: lowest.unscaled_covariance.clone(),
            cost: lowest.cost,
            freedom: evaluator.residual_count() as f64 - free as f64,
            errors: batches.map_or(white, Errors::Stretches),
            share: Mat::identity(self.orders.count(), self.orders.count()),
        };
        (lowest, vec![stage])
    }

    /// A lower minimum inside the edge of stability that is reached across it, where a search was stopped at the edge.
    fn beyond_the_edge(
        &self,
        all: &[Segment<'_>],
        aim: Aim,
        inside: &Evaluator<'_>,
        stopped: &Lowest,
    ) -> Option<Lowest> {
        if !inside.is_at_the_edge(&stopped.parameters) {
            return None;
        }
        let mut wide = Evaluator::new(self.orders, all, aim, self.estimate_states).with_wider_edge();
        let other = descend(&mut wide, &stopped.parameters, &self.bounds, self.search).ok()?;
        (other.cost < stopped.cost && inside.is_stable(&other.parameters)).then_some(other)
    }

    /// Starting values: those of linear regressions, and where there is noise to be modelled the dynamics that simulate
    /// best, followed by a noise model for what they leave.
    fn guesses(&self, few: &[Segment<'_>]) -> Result<Vec<Vec<f64>>, IdentError> {
        if self.orders.inputs() == 0 || self.orders.na + self.orders.nf.iter().sum::<usize>() == 0 {
            return candidates(self.orders, few);
        }
        let (plain, place) = self.orders.without_noise();
        let long = Long::new(&plain, few)?;
        let mut shorter = vec![self.orders.memory(), plain.memory()];
        shorter.dedup();
        let mut dynamics = start::dynamics(&plain, few, &long, &shorter)?;
        let with_noise =
            |theta: &Vec<f64>| start::with_noise(self.orders, few, &placed(&place, theta, self.orders.count()));
        let mut all: Vec<Vec<f64>> = dynamics.iter().map(with_noise).collect();
        all.extend(start::by_noise(self.orders, few, &long));
        let task = Task { orders: &plain, bounds: bounds(&plain, &[]), ..*self };
        let slower = task.slower_guesses(few);
        if plain.count() == self.orders.count() {
            all.extend(slower);
            return Ok(all);
        }
        dynamics.extend(start::by_noise(&plain, few, &long));
        dynamics.extend(slower);
        // Where noise and inputs share their poles, what simulates best is one start among several.
        let found = if self.orders.na > 0 {
            task.start(few, Aim::Simulation, |_| Ok(dynamics))
        } else {
            task.simulating_start(few, |_| Ok(dynamics))
        };
        if let Ok(found) = found {
            all.push(with_noise(&found));
        }
        Ok(all)
    }

    /// Starting values from slower data.
    fn slower_guesses(&self, few: &[Segment<'_>]) -> Vec<Vec<f64>> {
        let mut all = Vec::new();
        for factor in SLOWER {
            let (orders, slow) = (slow_orders(self.orders, factor), slowed(few, factor));
            let rows: usize = slow.iter().map(Segment::len).sum();
            if rows < SLOW_ROWS * orders.count() {
                break;
            }
            let task = Task { orders: &orders, bounds: bounds(&orders, &[]), ..*self };
            let Ok(found) = task.start(&slow, Aim::Simulation, |few| candidates(&orders, few)) else { continue };
            let theta = quickened(self.orders, &orders, &found, factor);
            let refitted = start::with_numerators(self.orders, few, &theta, self.estimate_states);
            all.extend(refitted.map(|(_, theta)| theta));
        }
        all
    }

    /// [`Task::start`] for the dynamics alone. Where the inputs explain more of what the best leaves, also by way of
    /// models of higher order: their searches are not caught as easily where one pole has to do the work of two.
    fn simulating_start(
        &self,
        all: &[Segment<'_>],
        guesses: impl FnOnce(&[Segment<'_>]) -> Result<Vec<Vec<f64>>, IdentError>,
    ) -> Result<Vec<f64>, IdentError> {
        let theta = self.start(all, Aim::Simulation, guesses)?;
        let few = excerpt(all, START_ROWS);
        let mut evaluator = Evaluator::new(self.orders, &few, Aim::Simulation, self.estimate_states);
        let left = evaluator.residuals(&theta)?;
        if !start::inputs_tell_more(self.orders, &few, &left) {
            return Ok(theta);
        }
        let mut others = vec![theta];
        for by in RAISED {
            let orders = raised(self.orders, by);
            let task = Task { orders: &orders, bounds: bounds(&orders, &[]), ..*self };
            let Ok(found) = task.start(&few, Aim::Simulation, |few| task.guesses(few)) else { continue };
            others.extend(lowered(self.orders, &orders, &few, &found, self.estimate_states));
        }
        self.start(&few, Aim::Simulation, |_| Ok(others))
    }

    /// Of given starting values that which suits all data best, where the numerators that suit its denominators may
    /// replace its own.
    fn best_of(&self, all: &[Segment<'_>], aim: Aim, starts: &[Vec<f64>]) -> Result<Vec<f64>, IdentError> {
        let mut evaluator = Evaluator::new(self.orders, all, aim, self.estimate_states);
        let mut best: Option<(f64, Vec<f64>)> = None;
        for start in starts {
            let inside = evaluator.within_the_edge(start);
            let refitted = (self.orders.is_output_error() || aim == Aim::Simulation)
                .then(|| start::with_numerators(self.orders, all, &inside, self.estimate_states))
                .flatten();
            for theta in refitted.map(|(_, theta)| theta).into_iter().chain([inside]).map(|theta| self.held(theta)) {
                let Ok(cost) = evaluator.cost(&theta) else { continue };
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, theta));
                }
            }
        }
        let (_, theta) = best.ok_or(StructureError::Unstable(UnstablePart::StartingPredictor))?;
        Ok(theta)
    }

    /// The best of several starting values, each followed some way down on a part of the data, the most promising
    /// first, unless it comes to where another has been.
    fn start(
        &self,
        all: &[Segment<'_>],
        aim: Aim,
        guesses: impl FnOnce(&[Segment<'_>]) -> Result<Vec<Vec<f64>>, IdentError>,
    ) -> Result<Vec<f64>, IdentError> {
        let few = excerpt(all, START_ROWS);
        let whole: Vec<Segment<'_>> = few.iter().map(interpolated).collect();
        let mut evaluator = Evaluator::new(self.orders, &few, aim, self.estimate_states);
        let mut rank = |tried: Vec<Vec<f64>>| {
            let tried = tried.into_iter().map(|theta| self.held(theta));
            let mut ranked: Vec<_> = tried.filter_map(|t| evaluator.cost(&t).ok().map(|cost| (cost, t))).collect();
            ranked.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            ranked
        };
        let mut ranked = rank(guesses(&whole)?);
        if ranked.is_empty() {
            ranked = rank(vec![vec![0.0; self.orders.count()]]);
        }
        let mut minima: Vec<Lowest> = Vec::new();
        let mut ends = Vec::new();
        for (cost, theta) in ranked {
            let known = |theta: &[f64], cost: f64| minima.iter().any(|m| QuadraticRegion(m).holds(theta, cost));
            match descend_unless(&mut evaluator, &theta, &self.bounds, self.some_way(), known) {
                Ok(Some(lowest)) => minima.push(lowest),
                Ok(None) => {}
                Err(_) => ends.push((cost, theta)),
            }
        }
        ends.extend(minima.into_iter().map(|m| (m.cost, m.parameters)));
        let best = ends.into_iter().min_by(|(a, _), (b, _)| a.total_cmp(b));
        let (_, theta) = best.ok_or(StructureError::HeldUnstable)?;
        Ok(theta)
    }
}

/// Effect of one unit of each coefficient held, at these places, on all.
fn influence(lowest: &Lowest, place: &[usize]) -> Mat<f64> {
    let n = lowest.parameters.len();
    let jacobian = lowest.factor.get(.., ..n);
    let carried = &lowest.unscaled_covariance * (jacobian.transpose() * jacobian);
    Mat::from_fn(n, place.len(), |i, j| f64::from(u8::from(i == place[j])) - carried[(i, place[j])])
}

/// The values at their places among zeros.
fn placed(place: &[usize], values: &[f64], count: usize) -> Vec<f64> {
    let mut theta = vec![0.0; count];
    place.iter().zip(values).for_each(|(j, v)| theta[*j] = *v);
    theta
}

/// A segment through a filter that starts at rest at its first row. What the system did before then acts as an initial
/// state whose impulse goes through the filter too, so that nothing of the start is laid to the dynamics. Unless the
/// system starts from rest the means are taken off before, so that an offset does not start with a step.
fn filtered(segment: &Segment<'_>, filter: &Sos, from_rest: bool) -> Segment<'static> {
    let pass = |x: &[f64]| {
        let level = if from_rest { 0.0 } else { x.iter().sum::<f64>() / x.len().max(1) as f64 };
        let centred: Vec<f64> = x.iter().map(|x| x - level).collect();
        Cow::Owned(filter.filter(&centred, &mut filter.state_at_rest()))
    };
    let whole = interpolated(segment);
    let mut impulse = vec![0.0; segment.len()];
    impulse.iter_mut().take(1).for_each(|v| *v = 1.0);
    Segment {
        inputs: whole.inputs.iter().map(|u| pass(u)).collect(),
        output: pass(&whole.output),
        missing: segment.missing.clone(),
        impulse: Some(Cow::Owned(filter.filter(&impulse, &mut filter.state_at_rest()))),
        experiment: segment.experiment,
        first: segment.first,
    }
}

/// Errors of the segments put where they belong in the experiments.
fn by_experiment(data: &Dataset, all: &[Segment<'_>], errors: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut placed: Vec<Vec<f64>> = data.experiments().iter().map(|e| vec![f64::NAN; e.len()]).collect();
    for (segment, values) in all.iter().zip(errors) {
        let slot = &mut placed[segment.experiment][segment.first..segment.first + segment.len()];
        slot.copy_from_slice(values);
        segment.missing.iter().for_each(|t| slot[*t] = f64::NAN);
    }
    placed
}

fn first_states(data: &Dataset, all: &[Segment<'_>], states: &[Vec<f64>], orders: &Orders) -> Vec<Vec<f64>> {
    let mut placed = vec![vec![0.0; orders.states()]; data.experiments().len()];
    for (segment, state) in all.iter().zip(states).filter(|(s, _)| s.first == 0) {
        placed[segment.experiment].clone_from(state);
    }
    placed
}
