//! Grey-box models: state space whose entries follow from parameters that mean something.

mod formula;
mod formula_structure;
mod model;
mod search;
mod structure;

use faer::Mat;
use lti::LtiError;
use signal::excitation::Random;

use crate::data::band_limited::{REACH, with_courses};
use crate::data::check_missing;
use crate::prediction::{InitialState, residuals};
use crate::state_space::{Information, Known, Search, Searchable, gather};
use crate::{Dataset, Doubt, Experiment, Fit, IdentError, Intersample, Parametric, Termination};
use fitting::StructureError;

pub use formula::Formula;
pub use formula_structure::{FormulaParts, FormulaStructure};
pub use model::GreyBoxModel;
use search::Parameters;
pub use structure::{Entry, GreyNoise, GreyParameter, Structure, StructuredMatrices};

/// Beyond this condition the data cannot separate the parameters: only the errors of the derivatives by differences are
/// left of a direction.
const UNDETERMINED: f64 = 1e9;

/// Grey-box estimation: the parameters of a [`Structure`] by minimising the prediction error.
///
/// Minimises `det Σ ε(t) ε(t)ᵀ`, with a prior the posterior density, over the free parameters and the initial states. A
/// continuous structure is sampled exactly under what the data say of their inputs between samples: held, straight, or
/// band-limited (without input delays; up to 0.45 of the sample rate, rows within 32 samples of an end left out). With
/// [`GreyNoise::OutputError`] the errors are those of a simulation, otherwise those one step ahead. Derivatives of the
/// sampled matrices are central differences with steps of 6e-6 of the parameter (relative error about 1e-10); the
/// derivatives of the errors with respect to the matrices are exact.
///
/// # Source
/// Ljung 1999, §4.3 and (7.89); Bohlin, *Practical Grey-box Process Identification*, 2006.
#[derive(Debug, Clone, PartialEq)]
pub struct GreyBox<S> {
    /// The structure.
    pub structure: S,
    /// Knowledge of the state at the first sample of each experiment.
    pub initial_state: InitialState,
    /// Further starting points against local minima: drawn within the bounds of each free parameter where both are
    /// finite, otherwise from a tenth to ten times its start. A search that ends at a mode which turns faster than the
    /// samples can show has 40 of them at least.
    pub further_starts: usize,
    /// Seed of the further starting points.
    pub seed: u64,
    /// Most iterations.
    pub iteration_limit: usize,
}

/// Iterations from each starting point before the best is followed to its end.
const TRIAL_ITERATIONS: usize = 12;

/// Further starting points where a search has ended at a mode that turns faster than the samples can show.
const AGAIN: usize = 40;

/// Name of the method.
const METHOD: &str = "prediction error";

impl<S: Structure> GreyBox<S> {
    /// One search from the structure's own starting values, initial states estimated.
    #[must_use]
    pub fn new(structure: S) -> Self {
        GreyBox { structure, initial_state: InitialState::Estimated, further_starts: 0, seed: 1, iteration_limit: 100 }
    }

    /// With this initial state, of the innovations form (`x − B₁u` under straight inputs) without delayed inputs.
    #[must_use]
    pub fn with_initial_state(self, initial_state: InitialState) -> Self {
        GreyBox { initial_state, ..self }
    }

    /// With so many further starting points.
    #[must_use]
    pub fn with_further_starts(self, further_starts: usize) -> Self {
        GreyBox { further_starts, ..self }
    }

    /// Estimates the parameters. Instants at which an output is missing are no part of the criterion; with a noise
    /// model the predictor makes a time update alone there, as in [`StateSpacePem`](crate::StateSpacePem).
    ///
    /// # Errors
    /// [`IdentError::Structure`] for a structure without a free parameter, a prior without spread, or a start at which
    /// the predictor is unstable; [`IdentError::StartOutsideBounds`]; [`IdentError::Length`] for other channels than
    /// the data's or initial states of another number; [`IdentError::MissingInput`]; [`IdentError::TooFewSamples`];
    /// [`IdentError::RankDeficient`] if the data cannot separate the parameters; errors of the structure itself.
    pub fn fit(&self, data: &Dataset) -> Result<Fit<GreyBoxModel<S>>, IdentError> {
        let start = GreyBoxModel::new(self.structure.clone())?;
        self.check(&start, data)?;
        let continuous = start.system()?.sample_time_s().is_none();
        if !continuous || data.intersample() != Intersample::BandLimited || data.inputs() == 0 {
            return Ok(self.fit_driven_by(data, start, false)?.made_by(METHOD, data));
        }
        let mut fit = self.fit_driven_by(&self.courses(&start, data)?, start, true)?;
        if self.initial_state == InitialState::Estimated {
            // The search began where the inputs are known; the model starts with the record.
            fit.initial_states = residuals(&fit.model, data, &InitialState::Estimated)?.initial_states;
        }
        if fit.samples < data.samples() {
            fit.doubts.retain(|doubt| !matches!(doubt, Doubt::RowsLeftOut { .. }));
            fit.doubts.push(Doubt::RowsLeftOut { rows: data.samples() - fit.samples, of: data.samples() });
        }
        Ok(fit.made_by(METHOD, data))
    }

    /// The data with the courses of their band-limited inputs, without the rows near the ends where these rest on a
    /// guess; an initial state that is known keeps the first ones.
    fn courses(&self, start: &GreyBoxModel<S>, data: &Dataset) -> Result<Dataset, IdentError> {
        let delays_s = self.structure.input_delays_s(&start.parameters());
        if let Some(delay_s) = delays_s.into_iter().find(|d| *d != 0.0) {
            return Err(LtiError::DelayPresent { delay_s }.into());
        }
        check_missing(data)?;
        let first = if self.initial_state == InitialState::Estimated { REACH } else { 0 };
        if let Some(short) = data.experiments().iter().find(|e| e.len() <= first + REACH) {
            return Err(IdentError::TooFewSamples { samples: short.len(), parameters: first + REACH });
        }
        let inputs: Vec<(usize, f64)> = (0..data.inputs()).map(|k| (k, 0.0)).collect();
        with_courses(data, &inputs, self.initial_state == InitialState::Zero)?.map_experiments(|e| {
            let rows = e.len() - first - REACH;
            let cut = |m: &Mat<f64>| m.subrows(first, rows).to_owned();
            Ok(Experiment { inputs: cut(&e.inputs), outputs: cut(&e.outputs), ..e.clone() })
        })
    }

    fn fit_driven_by(
        &self,
        data: &Dataset,
        start: GreyBoxModel<S>,
        courses: bool,
    ) -> Result<Fit<GreyBoxModel<S>>, IdentError> {
        let parameters = Parameters::new(start, courses);
        let missing = check_missing(data)?;
        let estimated = if self.initial_state == InitialState::Estimated { parameters.model.own_states()? } else { 0 };
        let first = || Search::new(data, parameters.clone(), self.states(data, &parameters)?, estimated);
        let mut search = self.best_start(data, &parameters, first()?, estimated, self.further_starts)?;
        let mut termination = search.run(self.iteration_limit)?;
        if search.model().above_nyquist(data.sample_time_s())?.is_some() && self.further_starts < AGAIN {
            let mut other = self.best_start(data, &parameters, first()?, estimated, AGAIN)?;
            let ended = other.run(self.iteration_limit)?;
            if other.criterion() < search.criterion() {
                (search, termination) = (other, ended);
            }
        }
        self.finish(data, search, termination, estimated, missing)
    }

    /// States at the start of the search: the given ones or zero.
    fn states(&self, data: &Dataset, parameters: &Parameters<S>) -> Result<Vec<Vec<f64>>, IdentError> {
        let own = parameters.model.own_states()?;
        Ok(match &self.initial_state {
            InitialState::Given(states) => states.clone(),
            _ => vec![vec![0.0; own]; data.experiments().len()],
        })
    }

    fn check(&self, start: &GreyBoxModel<S>, data: &Dataset) -> Result<(), IdentError> {
        crate::fit::check_channels(start, data)?;
        let parameters = self.structure.parameters();
        if parameters.iter().all(|p| p.fixed) {
            return Err(StructureError::NoParameters.into());
        }
        for (index, p) in parameters.iter().enumerate() {
            let (lower, upper) = (p.bounds.lower, p.bounds.upper);
            if !(p.value.is_finite() && lower <= p.value && p.value <= upper) {
                return Err(IdentError::StartOutsideBounds { index, start: p.value, lower, upper });
            }
            if let Some((mean, deviation)) = p.prior
                && !(mean.is_finite() && deviation > 0.0)
            {
                return Err(StructureError::Prior { index, mean, deviation }.into());
            }
        }
        let InitialState::Given(states) = &self.initial_state else { return Ok(()) };
        let own = start.own_states()?;
        let experiments = data.experiments().len();
        let length = |expected, found| IdentError::Length { what: "initial states", expected, found };
        if states.len() != experiments {
            return Err(length(experiments, states.len()));
        }
        states.iter().find(|s| s.len() != own).map_or(Ok(()), |s| Err(length(own, s.len())))
    }

    /// The search that is ahead after some iterations from every starting point.
    fn best_start<'a>(
        &self,
        data: &'a Dataset,
        parameters: &Parameters<S>,
        first: Search<'a, Parameters<S>>,
        estimated: usize,
        further_starts: usize,
    ) -> Result<Search<'a, Parameters<S>>, IdentError> {
        if further_starts == 0 {
            return Ok(first);
        }
        let mut best = first;
        best.run(TRIAL_ITERATIONS)?;
        let mut random = Random::new(self.seed);
        for _ in 0..further_starts {
            let Ok(other) = parameters.drawn(&mut random) else { continue };
            let Ok(mut search) = Search::new(data, other, self.states(data, parameters)?, estimated) else { continue };
            if search.run(TRIAL_ITERATIONS).is_ok() && search.criterion() < best.criterion() {
                best = search;
            }
        }
        Ok(best)
    }

    fn finish(
        &self,
        data: &Dataset,
        search: Search<'_, Parameters<S>>,
        termination: Termination,
        estimated: usize,
        missing: usize,
    ) -> Result<Fit<GreyBoxModel<S>>, IdentError> {
        let (iterations, initial_states, found) = search.into_parts();
        let innovations = found.innovations(data)?;
        let all_states = found.all_states(&initial_states, data);
        let basis = found.directions(&innovations, data, &all_states)?;
        let blocked = found.resting();
        let kept: Vec<usize> = (0..basis.ncols()).filter(|j| !blocked[*j]).collect();
        let basis = Mat::from_fn(basis.nrows(), kept.len(), |i, j| basis[(i, kept[j])]);
        let prior: Vec<f64> = kept.iter().map(|j| found.prior_weight(*j)).collect();
        let known = Known { free: found.free(), basis: basis.as_ref(), prior: &prior };
        let gathered = gather(data, &innovations, &known, &all_states, estimated, Information::All)?;
        if gathered.condition > UNDETERMINED {
            let (parameters, condition) = (kept.len(), gathered.condition);
            return Err(IdentError::RankDeficient { rank: parameters - 1, parameters, condition });
        }
        let places: Vec<usize> = kept.iter().map(|j| found.free_indices()[*j]).collect();
        let count = found.model.parameters().len();
        let mut covariance = Mat::zeros(count, count);
        for (a, i) in places.iter().enumerate() {
            for (b, j) in places.iter().enumerate() {
                covariance[(*i, *j)] = gathered.covariance[(a, b)];
            }
        }
        let mut doubts = Vec::new();
        if !termination.converged() {
            doubts.push(Doubt::NotConverged);
        }
        let bounded = (0..blocked.len()).filter(|j| blocked[*j]);
        doubts.extend(bounded.map(|j| Doubt::AtBound { parameter: found.free_indices()[j] }));
        if gathered.condition > 1e8 {
            doubts.push(Doubt::IllConditioned { condition: gathered.condition });
        }
        if missing > 0 {
            doubts.push(Doubt::RowsLeftOut { rows: missing, of: data.samples() });
        }
        // An integrator is as its structure has it.
        if innovations.system().growing_mode()?.is_some() {
            doubts.push(Doubt::Unstable);
        }
        let image = found.above_nyquist(data.sample_time_s())?;
        doubts.extend(image.map(|frequency_hz| Doubt::AboveNyquist { frequency_hz }));
        let has_noise_model = innovations.k().norm_max() > 0.0;
        let fit = Fit {
            model: found.model.with_noise_covariance(gathered.noise_covariance.clone())?,
            covariance,
            degrees_of_freedom: gathered.degrees_of_freedom,
            noise_covariance: gathered.noise_covariance,
            loss: gathered.loss,
            samples: gathered.samples,
            free_parameters: gathered.free_parameters,
            initial_states: all_states,
            levels: Vec::new(),
            termination,
            iterations,
            condition: gathered.condition,
            doubts,
            origin: None,
        }
        .doubting_errors();
        Ok(if has_noise_model { fit } else { fit.doubting_feedback(data) })
    }
}
