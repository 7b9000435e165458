//! The delay beside dynamics, from the error of a simulated output.

mod model;
mod pure;
mod ripple;
mod structure;

use std::rc::Rc;

use super::signals;
use crate::continuous::ContinuousChannel;
use crate::data::check_range;
use crate::data::excited_lines::Lines;
use crate::distributions::{f_quantile, normal_quantile};
use crate::{Dataset, Experiment, IdentError, Intersample};
use fitting::StructureError;
pub use model::{DelayFault, DelayModel, ModelledDelay};
use model::{LEAD, ROUNDING};
use structure::Structure;

/// Zeros and poles of what is tried, the simplest first: with and without zeros, since zeros make up for a part of a
/// delay.
const LADDER: [(usize, usize); 10] = [(0, 0), (0, 1), (0, 2), (0, 3), (1, 2), (0, 4), (1, 3), (1, 4), (2, 3), (2, 4)];

/// Confidence with which a richer model has to be better.
const RICHER: f64 = 0.99;

/// Confidence from which on a model with as many zeros and poles is out of the question.
const LESS_LIKELY: f64 = 0.95;

/// Confidence from which on a richer model is possible: about that at which Akaike's criterion takes one more
/// parameter.
const SUSPECTED: f64 = 0.84;

/// Confidence from which on a simpler model is out of the question.
const REFUTED: f64 = 0.9999;

/// Least confidence of an interval: one of none has no width, and says nothing.
const LEAST_LEVEL: f64 = 1e-3;

/// An interval that takes more than this share of the searched range means nothing.
const UNDETERMINED: f64 = 0.8;

/// Energy, over the variance of the errors, from which an input's part of the output counts as seen beside its
/// strongest lines.
const SEEN: f64 = 20.0;

/// Dead times by models of rising order.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayModels {
    /// The models that could be fitted, the simplest first; never empty.
    pub models: Vec<DelayModel>,
    /// Index of the best of them.
    pub best: usize,
}

impl DelayModels {
    /// The best model.
    #[must_use]
    pub fn best(&self) -> &DelayModel {
        &self.models[self.best]
    }

    /// The model whose intervals can be relied on, where there is one.
    #[must_use]
    pub fn claimed(&self) -> Option<&DelayModel> {
        Some(self.best()).filter(|model| model.faults.is_empty())
    }
}

impl ModelledDelay {
    /// The dead times for data of one output and inputs without gaps.
    ///
    /// # Errors
    /// Those of [`ContinuousTransferFunction::fit`](crate::ContinuousTransferFunction::fit) where no model could be
    /// fitted; [`signal::SignalError::Parameter`] for options out of range.
    pub fn estimate(&self, data: &Dataset) -> Result<DelayModels, IdentError> {
        signals(data)?;
        check_range("longest", self.longest as f64, 1.0, 1e5)?;
        check_range("dating", self.dating, 0.0, 1e5)?;
        check_range("level", self.level, LEAST_LEVEL, 1.0 - 1e-12)?;
        let late = made_late(data)?;
        let beginning = Structure::beginning(self, &late)?;
        let (mut models, mut failure): (Vec<DelayModel>, _) = (Vec::new(), None);
        // The data without ripple that each model is of.
        let mut cleans: Vec<Rc<Dataset>> = Vec::new();
        let is_held = data.intersample() == Intersample::ZeroOrderHold;
        // The error of a gain under a held input jumps from sample to sample: no search finds its least, see [`pure`].
        let ladder = &LADDER[usize::from(is_held)..];
        // Of an input that is one sine nothing can be claimed, however rich the model.
        let tried = if (0..data.inputs()).any(|input| single_line(data, input).is_some()) { 1 } else { ladder.len() };
        let mut beaten = None;
        for (zeros, poles) in ladder[..tried].iter().copied() {
            // Richer models than those that were no better are not tried.
            if beaten.is_some_and(|size| zeros + poles > size) {
                break;
            }
            let structure = Structure { options: self, beginning, zeros, poles };
            // Whether a richer model is better shows without its own ripple and tests.
            let mut start = None;
            if let Some(best) = choice(&models) {
                let clean = Rc::clone(&cleans[best]);
                let Ok((model, found)) = structure.glance(&clean) else { continue };
                let is_rival = zeros + poles == models[best].size();
                let is_better = model.loss <= models[best].loss && models[best].is_worse_than(&model, RICHER);
                if !is_better && !is_rival {
                    models.push(model);
                    cleans.push(clean);
                    beaten = Some(zeros + poles);
                    continue;
                }
                (beaten, start) = (None, Some(found));
            }
            match structure.fit(&late, start.as_ref()) {
                Ok((model, without_ripple)) => {
                    if models.is_empty() && data.inputs() == 1 && is_held {
                        models.extend(pure::fit(self, beginning.first, &without_ripple, &model));
                    }
                    models.push(model);
                    cleans.resize(models.len(), Rc::new(without_ripple));
                }
                Err(error) => failure = failure.or(Some(error)),
            }
        }
        if models.is_empty() {
            return Err(failure.unwrap_or(StructureError::NoModel.into()));
        }
        let outdone = outdone(&models);
        let simplest = choice(&models).unwrap_or_else(|| outdone.iter().position(|is| !is).unwrap_or(models.len() - 1));
        let best = likeliest(&models, &outdone, simplest);
        for (model, is_outdone) in models.iter_mut().zip(outdone) {
            if is_outdone {
                model.faults.insert(0, DelayFault::Outdone);
            }
        }
        let beside = [rivals(&models, best), suspected(&models, best)].concat();
        for index in beside.iter().copied().chain([best]) {
            let model = &mut models[index];
            let structure = Structure { options: self, beginning, zeros: model.zeros, poles: model.poles };
            // A gain under a held input has an interval of its own kind, and a model with other faults than those of
            // its search is not claimed, whatever its interval.
            let is_profiled = !model.channels.is_empty() && model.faults.iter().all(DelayFault::is_of_search);
            // One that cannot be estimated again keeps the interval of its covariance.
            if is_profiled && let Ok(renewed) = structure.profiled(&cleans[index], model) {
                *model = renewed;
            }
        }
        let simpler = (0..best).filter(|simpler| models[*simpler].is_simpler_than(&models[best]));
        let simpler = simpler.filter(|simpler| models[*simpler].may_be(&models[best]));
        let possible: Vec<&DelayModel> = simpler.chain(beside).map(|index| &models[index]).collect();
        let (intervals, late_intervals) = (widened(&models[best], &possible), widened_late(&models[best], &possible));
        let best_model = &mut models[best];
        (best_model.intervals, best_model.late_intervals) = (intervals, late_intervals);
        let (undetermined, at_longest) = (self.undetermined(best_model), self.at_longest(best_model));
        best_model.faults.extend(undetermined);
        best_model.faults.splice(..0, at_longest);
        let few = best_model.few_lines(data);
        best_model.faults.splice(..0, few);
        Ok(DelayModels { models, best })
    }

    /// The inputs that explain nothing, or whose delay could be nearly any that was looked for.
    fn undetermined(&self, best: &DelayModel) -> Vec<DelayFault> {
        let explains = best.explains();
        let is_wide = |(low, high): &(f64, f64)| high - low > UNDETERMINED * self.longest as f64;
        let all = best.intervals.iter().enumerate().filter(|(_, interval)| !explains || is_wide(interval));
        all.map(|(input, _)| DelayFault::Undetermined { input }).collect()
    }

    /// The inputs whose interval ends where the search did: the true dead time may lie beyond, and dynamics make up for
    /// it.
    fn at_longest(&self, best: &DelayModel) -> Vec<DelayFault> {
        let tried = self.longest;
        let is_known = |input: usize| best.faults.contains(&DelayFault::AtLongest { input, tried });
        let touching = (0..best.intervals.len()).filter(|input| best.intervals[*input].1 >= tried as f64);
        touching.filter(|input| !is_known(*input)).map(|input| DelayFault::AtLongest { input, tried }).collect()
    }

    /// The error of an estimate together with that of the instants.
    fn dated(&self, standard_error: f64) -> f64 {
        standard_error.hypot(self.dating)
    }

    fn reach(&self) -> f64 {
        normal_quantile(0.5 + 0.5 * self.level)
    }
}

/// Of the models with as many zeros and poles as the simplest that will do, that with the least errors.
fn likeliest(models: &[DelayModel], outdone: &[bool], simplest: usize) -> usize {
    let is_as_good = |index: usize| models[index].faults.is_empty() && !outdone[index];
    let same = (0..models.len()).filter(|index| models[*index].has_size_of(&models[simplest]) && is_as_good(*index));
    same.min_by(|a, b| models[*a].loss.total_cmp(&models[*b].loss)).unwrap_or(simplest)
}

/// The other models with as many zeros and poles as the best that chance may have made look worse.
fn rivals(models: &[DelayModel], best: usize) -> Vec<usize> {
    let may_be = |index: &usize| {
        let model = &models[*index];
        *index != best
            && model.has_size_of(&models[best])
            && model.faults.is_empty()
            && !model.is_worse_than(&models[best], LESS_LIKELY)
    };
    (0..models.len()).filter(may_be).collect()
}

/// The models with a zero or a pole more than the best that lower the errors, but not by so much that they are better
/// beyond doubt. What the best one lacks, its dead time makes up for.
fn suspected(models: &[DelayModel], best: usize) -> Vec<usize> {
    let may_be = |index: &usize| {
        let richer = &models[*index];
        // A gain under a held input has an interval of its own kind.
        !models[best].channels.is_empty()
            && richer.size() == models[best].size() + 1
            && richer.loss <= models[best].loss
            && richer.faults.iter().all(DelayFault::is_of_search)
            && models[best].is_worse_than(richer, SUSPECTED)
    };
    (0..models.len()).filter(may_be).collect()
}

/// The intervals of the best model and of others that are possible: simpler ones that are not refuted beyond doubt,
/// since where a further pole is barely seen its time constant is barely known, and the interval with it; rivals,
/// since zeros and poles make up for a part of a delay; and richer ones that are suspected.
fn widened(best: &DelayModel, possible: &[&DelayModel]) -> Vec<(f64, f64)> {
    let mut intervals = best.intervals.clone();
    for other in possible {
        for ((low, high), (from, to)) in intervals.iter_mut().zip(&other.intervals) {
            (*low, *high) = (low.min(*from), high.max(*to));
        }
    }
    intervals
}

/// As [`widened`], of what slow changes are late by; a gain says nothing of that.
fn widened_late(best: &DelayModel, possible: &[&DelayModel]) -> Vec<Option<(f64, f64)>> {
    let mut intervals = best.late_intervals.clone();
    for possible in possible {
        for (own, other) in intervals.iter_mut().zip(&possible.late_intervals) {
            *own = own.map(|(low, high)| other.map_or((low, high), |(from, to)| (low.min(from), high.max(to))));
        }
    }
    intervals
}

/// The simplest model without fault that none richer outdoes.
fn choice(models: &[DelayModel]) -> Option<usize> {
    outdone(models).iter().zip(models).position(|(is_outdone, model)| !is_outdone && model.faults.is_empty())
}

/// Which models a richer one outdoes.
fn outdone(models: &[DelayModel]) -> Vec<bool> {
    let by_any = |index: usize| models[index + 1..].iter().any(|richer| models[index].is_outdone_by(richer));
    (0..models.len()).map(by_any).collect()
}

impl DelayModel {
    fn size(&self) -> usize {
        self.zeros + self.poles
    }

    fn has_size_of(&self, other: &DelayModel) -> bool {
        self.size() == other.size() && self.channels.is_empty() == other.channels.is_empty()
    }

    fn is_simpler_than(&self, other: &DelayModel) -> bool {
        self.size() < other.size()
    }

    /// Returns true if chance may have made this model look worse than a richer one.
    fn may_be(&self, richer: &DelayModel) -> bool {
        let is_weak = |fault: &DelayFault| match fault {
            DelayFault::Outdone => true,
            DelayFault::DynamicsMissing { p_value } | DelayFault::Feedback { p_value } => *p_value > 1.0 - REFUTED,
            _ => false,
        };
        self.faults.iter().all(is_weak) && !self.is_worse_than(richer, REFUTED)
    }

    /// Returns true if a richer model lowers the loss by more than chance would.
    fn is_worse_than(&self, richer: &DelayModel, level: f64) -> bool {
        let inflation = richer.inflation.max(self.inflation);
        (self.loss / richer.loss).ln() > inflation * richer.by_chance(level, richer.free.saturating_sub(self.free))
    }

    /// Returns true if it lowers the loss by more than chance would, beside no effect of any input.
    fn explains(&self) -> bool {
        let gained = -2.0 * (1.0 - self.fit_percent / 100.0).ln();
        gained > self.inflation * self.by_chance(REFUTED, self.free)
    }

    /// By how much the logarithm of the loss falls by chance, at most, where so many of the free values are
    /// superfluous. They may be many: in data with gaps every stretch has initial states of its own, so the test is
    /// that of F.
    fn by_chance(&self, level: f64, superfluous: usize) -> f64 {
        let (more, left) = (superfluous.max(1) as f64, self.samples.saturating_sub(self.free).max(1) as f64);
        (more / left * f_quantile(level, more, left)).ln_1p()
    }

    /// The inputs whose lines are too few for this structure: it takes a gain, a delay, zeros and poles, and one value
    /// more has to be there to refute it.
    fn few_lines(&self, data: &Dataset) -> Vec<DelayFault> {
        let needed = (self.zeros + self.poles + 2) / 2 + 1;
        let error = (1.0 - self.fit_percent / 100.0).powi(2).max(ROUNDING);
        let share = SEEN * self.inflation * error / ((1.0 - error).max(ROUNDING) * self.samples as f64);
        let of = |input: usize| {
            let system = self.channels.get(input).and_then(|channel| channel.transfer_function().ok());
            let found = Lines::of(data, input, system.as_ref(), share.min(0.5)).all_hz;
            let strongest_hz = found.first().copied().unwrap_or(0.0);
            (found.len() < needed).then_some(DelayFault::FewLines { input, lines: found.len(), needed, strongest_hz })
        };
        (0..data.inputs()).filter_map(of).collect()
    }

    /// A search that does not end is often one for a pole and a zero that cancel: it outdoes only what is refuted.
    fn is_outdone_by(&self, richer: &DelayModel) -> bool {
        let level = if richer.faults.contains(&DelayFault::NotConverged) { REFUTED } else { RICHER };
        richer.loss <= self.loss && self.is_worse_than(richer, level)
    }
}

/// The frequency, in hertz, of an input that is one sine, all but 1 % of its amplitude: with it, a delay is only a
/// phase shift.
#[must_use]
pub fn single_line(data: &Dataset, input: usize) -> Option<f64> {
    let found = (input < data.inputs()).then(|| Lines::of(data, input, None, 0.0).all_hz)?;
    if let [only] = found[..] { Some(only) } else { None }
}

/// The same data with every output [`LEAD`] samples later.
fn made_late(data: &Dataset) -> Result<Dataset, IdentError> {
    data.map_experiments(|e| {
        let outputs = faer::Mat::from_fn(e.len(), e.outputs.ncols(), |t, i| match t.checked_sub(LEAD) {
            Some(t) => e.outputs[(t, i)],
            None => f64::NAN,
        });
        Ok(Experiment { outputs, ..e.clone() })
    })
}
