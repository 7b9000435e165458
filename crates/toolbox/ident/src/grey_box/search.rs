//! The parameters of a grey-box model as the search sees them.

use std::f64::consts::PI;

use faer::Mat;
use lti::{Innovations, LtiError};
use signal::excitation::Random;

use super::{GreyBoxModel, GreyNoise, GreyParameter, Structure};
use crate::state_space::{Free, Searchable, entries};
use crate::{Dataset, IdentError, LinearModel, Parametric};
use fitting::StructureError;

/// Steps of central differences, as a part of the parameter: the cube root of the rounding.
const STEP: f64 = 6e-6;
/// A parameter this near to a bound, as a part of itself or its start, rests on it.
const NEAR: f64 = 1e-7;
/// Part by which a parameter is moved to see whether a pole depends on it, and by which the pole moves then, at least.
const NUDGE: f64 = 1e-4;
const MOVES: f64 = 1e-9;

/// A model and which of its parameters are searched.
#[derive(Debug, Clone)]
pub(super) struct Parameters<S> {
    pub(super) model: GreyBoxModel<S>,
    about: Vec<GreyParameter>,
    free: Vec<usize>,
    /// True if the data have the courses of band-limited inputs.
    courses: bool,
}

impl<S: Structure> Parameters<S> {
    /// For data with the courses of band-limited inputs, or with samples.
    pub(super) fn new(model: GreyBoxModel<S>, courses: bool) -> Self {
        let about = model.structure().parameters();
        let free = (0..about.len()).filter(|j| !about[*j].fixed && about[*j].bounds.lower < about[*j].bounds.upper);
        let free = free.collect();
        Parameters { model, about, free, courses }
    }

    /// Which parameter each direction is.
    pub(super) fn free_indices(&self) -> &[usize] {
        &self.free
    }

    /// Which directions end at a bound, or so near to it that the search had no use for the rest of the way.
    pub(super) fn resting(&self) -> Vec<bool> {
        let values = self.model.parameters();
        let at = |j: &usize| {
            let GreyParameter { value: start, bounds, .. } = &self.about[*j];
            let near = NEAR * values[*j].abs().max(start.abs());
            values[*j] - bounds.lower <= near || bounds.upper - values[*j] <= near
        };
        self.free.iter().map(at).collect()
    }

    /// The fastest mode of a continuous structure that turns by more than half a turn a sample and depends on a free
    /// parameter, in hertz: the samples see it as a slower one, and a search may take it for that.
    pub(super) fn above_nyquist(&self, sample_time_s: f64) -> Result<Option<f64>, IdentError> {
        let system = self.model.system()?;
        if system.sample_time_s().is_some() {
            return Ok(None);
        }
        let mut fast = system.poles()?;
        fast.retain(|pole| pole.im * sample_time_s > PI);
        if fast.is_empty() {
            return Ok(None);
        }
        let mut moved = vec![false; fast.len()];
        let values = self.model.parameters();
        for j in &self.free {
            let (mut other, bounds) = (values.clone(), self.about[*j].bounds);
            let step = NUDGE * self.size(*j, values[*j]);
            other[*j] += if values[*j] + step <= bounds.upper { step } else { -step };
            let poles = self.model.with_parameters(&other)?.system()?.poles()?;
            for (pole, moved) in fast.iter().zip(&mut moved) {
                let by = poles.iter().map(|other| (other - pole).norm()).fold(f64::INFINITY, f64::min);
                *moved |= by > MOVES * pole.norm();
            }
        }
        let all = fast.iter().zip(moved).filter(|(_, moved)| *moved).map(|(pole, _)| pole.im / (2.0 * PI));
        Ok(all.reduce(f64::max))
    }

    /// The reciprocal standard deviation that is known beforehand; zero where none is.
    pub(super) fn prior_weight(&self, direction: usize) -> f64 {
        self.about[self.free[direction]].prior.map_or(0.0, |(_, deviation)| 1.0 / deviation)
    }

    fn form(&self, model: &GreyBoxModel<S>, data: &Dataset) -> Result<Innovations, LtiError> {
        let band_limited = if self.courses { model.band_limited(data.sample_time_s())? } else { None };
        match band_limited {
            Some(form) => Ok(form.innovations),
            None => model.innovations(data.sample_time_s(), data.intersample()),
        }
    }

    /// A size that a parameter's steps are measured by.
    fn size(&self, j: usize, value: f64) -> f64 {
        let GreyParameter { value: start, bounds, prior, .. } = &self.about[j];
        let width = bounds.upper - bounds.lower;
        let candidates = [value.abs(), start.abs(), prior.map_or(0.0, |(_, deviation)| deviation), width];
        candidates.into_iter().find(|c| *c > 0.0 && c.is_finite()).unwrap_or(1.0)
    }

    /// The same with other values of the free parameters, drawn at random.
    pub(super) fn drawn(&self, random: &mut Random) -> Result<Self, IdentError> {
        let mut values = self.model.parameters();
        for j in &self.free {
            let GreyParameter { value, bounds, .. } = &self.about[*j];
            let part = random.uniform();
            let drawn = match (bounds.lower, bounds.upper) {
                (lower, upper) if lower > 0.0 && upper.is_finite() => lower * (upper / lower).powf(part),
                (lower, upper) if lower.is_finite() && upper.is_finite() => lower + part * (upper - lower),
                _ => self.size(*j, *value).copysign(*value) * 10.0_f64.powf(2.0 * part - 1.0),
            };
            values[*j] = drawn.max(bounds.lower).min(bounds.upper);
        }
        Ok(Parameters { model: self.model.with_parameters(&values)?, ..self.clone() })
    }
}

impl<S: Structure> Searchable for Parameters<S> {
    fn innovations(&self, data: &Dataset) -> Result<Innovations, IdentError> {
        Ok(self.form(&self.model, data)?)
    }

    fn free(&self) -> Free {
        let noise = self.model.structure().noise(&self.model.parameters()) != GreyNoise::OutputError;
        Free { dynamics: true, feedthrough: true, noise }
    }

    fn directions(&self, _: &Innovations, data: &Dataset, _: &[Vec<f64>]) -> Result<Mat<f64>, IdentError> {
        let values = self.model.parameters();
        let at = |j: usize, value: f64| -> Result<Vec<f64>, IdentError> {
            let mut moved = values.clone();
            moved[j] = value;
            let model = self.model.with_parameters(&moved)?;
            Ok(entries(&self.form(&model, data)?, self.free()))
        };
        let mut columns = Vec::with_capacity(self.free.len());
        for j in &self.free {
            let (bounds, step) = (self.about[*j].bounds, STEP * self.size(*j, values[*j]));
            let (above, below) = ((values[*j] + step).min(bounds.upper), (values[*j] - step).max(bounds.lower));
            let (high, low) = (at(*j, above)?, at(*j, below)?);
            if high.len() != low.len() {
                return Err(StructureError::WholeDelay.into());
            }
            columns.push(high.iter().zip(&low).map(|(h, l)| (h - l) / (above - below)).collect::<Vec<f64>>());
        }
        let rows = columns.first().map_or(0, Vec::len);
        Ok(Mat::from_fn(rows, columns.len(), |i, j| columns[j][i]))
    }

    fn moved(&self, _: &Mat<f64>, step: &[f64]) -> Option<Self> {
        let mut values = self.model.parameters();
        for (j, by) in self.free.iter().zip(step) {
            let bounds = self.about[*j].bounds;
            values[*j] = (values[*j] + by).max(bounds.lower).min(bounds.upper);
        }
        Some(Parameters { model: self.model.with_parameters(&values).ok()?, ..self.clone() })
    }

    fn blocked(&self, direction: usize, towards: f64) -> bool {
        let j = self.free[direction];
        let (value, bounds) = (self.model.parameters()[j], self.about[j].bounds);
        (value <= bounds.lower && towards < 0.0) || (value >= bounds.upper && towards > 0.0)
    }

    fn prior(&self) -> Vec<(f64, f64)> {
        let values = self.model.parameters();
        let row = |j: &usize| match self.about[*j].prior {
            Some((mean, deviation)) => (1.0 / deviation, (mean - values[*j]) / deviation),
            None => (0.0, 0.0),
        };
        self.free.iter().map(row).collect()
    }

    /// Inputs are taken to have been before an experiment what they are at its start.
    fn all_states(&self, x0: &[Vec<f64>], data: &Dataset) -> Vec<Vec<f64>> {
        let delayed = if self.courses { Vec::new() } else { self.model.delayed_inputs(data.sample_time_s()) };
        let extended = |(states, experiment): (&Vec<f64>, &crate::Experiment)| {
            let past = delayed
                .iter()
                .enumerate()
                .flat_map(|(j, back)| std::iter::repeat_n(experiment.input(j).first().copied().unwrap_or(0.0), *back));
            states.iter().copied().chain(past).collect()
        };
        x0.iter().zip(data.experiments()).map(extended).collect()
    }
}
