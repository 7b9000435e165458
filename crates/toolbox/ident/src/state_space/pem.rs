//! State-space models by minimising the prediction error.

use lti::Innovations;

use crate::data::check_missing;
use crate::state_space::subspace::Subspace;
use crate::state_space::{Information, Search, StateSpaceModel, estimate};
use crate::{Arx, Dataset, Doubt, Fit, Focus, IdentError, LinearModel, Termination};

/// Data of so many samples are searched in part first: the steps that are left from there are few ...
const LONG: usize = 100_000;
/// ... in one of so many of them.
const PART: usize = 10;
/// Steps that show whether a search from an ARX model leads lower.
const GLANCE: usize = 5;

/// Prediction-error estimation of a state-space model in innovations form.
///
/// `x(t+1) = A x(t) + B u(t) + K e(t)`, `y(t) = C x(t) + D u(t) + e(t)`.
///
/// Minimises `det Σ ε(t) ε(t)ᵀ` over all of `A`, `B`, `C`, `D`, `K` and the initial state of each experiment by damped
/// Gauss–Newton steps. At each step only those directions are searched that change the behaviour, not the basis of the
/// states, so no canonical form limits the models or spoils the conditioning. Starts at the model given; or at a
/// subspace estimate, and of one output at the ARX model of the same order where that leads lower; of 100 000 samples
/// or more, at the model of a tenth of them, where that is better. Steps that shrink slowly are extrapolated. Data are
/// taken as they are: remove offsets first.
///
/// Outputs may miss samples. At a missing one the predictor makes a time update alone, and goes on with the gain of the
/// time-varying Kalman filter until the state is known again. Errors after it weigh less, by their variance.
///
/// # Example
/// ```
/// // y(t) = 0.8 y(t−1) + u(t−1)
/// let mut noise = signal::excitation::Random::new(1);
/// let u: Vec<f64> = (0..200).map(|_| noise.uniform() - 0.5).collect();
/// let mut y = vec![0.0; 200];
/// for t in 1..200 {
///     y[t] = 0.8 * y[t - 1] + u[t - 1];
/// }
/// let fit = ident::StateSpacePem::new(1).fit(&ident::Dataset::siso(0.1, &u, &y)?)?;
/// assert!((fit.model.system().poles()?[0].re - 0.8).abs() < 1e-9);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// McKelvey, Helmersson & Ribarits, *Data driven local coordinates for multivariable linear systems and their
/// application to system identification*, Automatica 40(9), 2004; Ljung 1999, (7.89) for the criterion; Walker & Ni,
/// *Anderson acceleration for fixed-point iterations*, SIAM J. Numer. Anal. 49(4), 2011.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpacePem {
    /// Which errors are made small: `K` is free for those of the prediction, zero for those of the simulation.
    pub focus: Focus,
    /// True if `D` is estimated; otherwise it is zero.
    pub feedthrough: bool,
    /// True if every experiment starts from rest; otherwise initial states are estimated.
    pub from_rest: bool,
    /// Where the search starts.
    pub start: SearchStart,
    /// Most iterations, on all data.
    pub iteration_limit: usize,
}

/// Where the search for a state-space model starts.
#[derive(Debug, Clone, PartialEq)]
pub enum SearchStart {
    /// At the subspace estimate of these options, or the ARX model of its order. The focus of the search and its
    /// feed-through replace theirs.
    Subspace(Subspace),
    /// At a model that is given.
    Model(Box<StateSpaceModel>),
}

impl StateSpacePem {
    /// Of `order` states, with a noise model and no feed-through, initial states estimated.
    #[must_use]
    pub fn new(order: usize) -> Self {
        Self::from_subspace(Subspace::new(order))
    }

    /// From a subspace estimate of these options, whose feed-through and noise model decide what is free.
    #[must_use]
    pub fn from_subspace(subspace: Subspace) -> Self {
        StateSpacePem {
            focus: if subspace.noise_model { Focus::Prediction } else { Focus::Simulation },
            feedthrough: subspace.feedthrough,
            from_rest: false,
            start: SearchStart::Subspace(subspace),
            iteration_limit: 100,
        }
    }

    /// From this model, whose feed-through and noise model decide what is free; a `D` that is not free stays.
    #[must_use]
    pub fn from_model(start: StateSpaceModel) -> Self {
        let focus = if start.has_noise_model() { Focus::Prediction } else { Focus::Simulation };
        let feedthrough = start.has_feedthrough();
        StateSpacePem { focus, feedthrough, start: SearchStart::Model(Box::new(start)), ..Self::new(1) }
    }

    /// With this focus.
    #[must_use]
    pub fn with_focus(self, focus: Focus) -> Self {
        StateSpacePem { focus, ..self }
    }

    /// Every experiment taken as starting from rest.
    #[must_use]
    pub fn from_rest(self) -> Self {
        StateSpacePem { from_rest: true, ..self }
    }

    /// With `D` estimated.
    #[must_use]
    pub fn with_feedthrough(self) -> Self {
        StateSpacePem { feedthrough: true, ..self }
    }

    /// Estimates the model. Instants at which an output is missing are no part of the criterion.
    ///
    /// # Errors
    /// Those of [`Subspace::fit`] where no start is given; [`IdentError::MissingInput`];
    /// [`IdentError::Length`] for a start with other channels;
    /// [`IdentError::TooFewSamples`]; [`IdentError::Structure`] for a start whose predictor is unstable.
    pub fn fit(&self, data: &Dataset) -> Result<Fit<StateSpaceModel>, IdentError> {
        let missing = check_missing(data)?;
        let start = self.starting_point(data)?;
        let n = start.system().states();
        let (estimated, zero) = (if self.from_rest { 0 } else { n }, vec![vec![0.0; n]; data.experiments().len()]);
        let mut search = Search::new(data, start, zero.clone(), estimated)?;
        if let Some(nearer) = self.found_in_part(data, search.model())
            && let Ok(from_there) = Search::new(data, nearer, zero, estimated)
            && from_there.criterion() < search.criterion()
        {
            search = from_there.near_the_end();
        }
        let mut termination = search.run(self.iteration_limit)?;
        // A start that was given is meant.
        if matches!(self.start, SearchStart::Subspace(_))
            && let Some(other) = self.again_from_equation_error(data, &search, estimated)
        {
            (search, termination) = other;
        }
        let (iterations, initial_states, model) = search.into_parts();
        let mut fit = estimate(data, &model, initial_states, estimated, Information::All)?;
        (fit.termination, fit.iterations) = (termination, iterations);
        if !termination.converged() {
            fit.doubts.push(Doubt::NotConverged);
        }
        if missing > 0 {
            fit.doubts.push(Doubt::RowsLeftOut { rows: missing, of: data.samples() });
        }
        let fit = if self.focus == Focus::Simulation { fit.doubting_feedback(data) } else { fit };
        Ok(fit.made_by(self.focus.method(), data))
    }

    /// The search from the ARX model of the same order, which least squares find whatever the data, where it leads
    /// lower: that model is one of those that are searched, so that a search which ends above it went astray.
    fn again_from_equation_error<'a>(
        &self,
        data: &'a Dataset,
        found: &Search<'a, StateSpaceModel>,
        estimated: usize,
    ) -> Option<(Search<'a, StateSpaceModel>, Termination)> {
        let n = found.model().system().states();
        let start = equation_error(data, n, self.feedthrough, self.focus == Focus::Prediction)?;
        let zero = vec![vec![0.0; n]; data.experiments().len()];
        let mut other = Search::new(data, start, zero, estimated).ok()?;
        let glanced = other.run(GLANCE.min(self.iteration_limit)).ok()?;
        if other.criterion() >= found.criterion() {
            return None;
        }
        let termination = if glanced.converged() { glanced } else { other.run(self.iteration_limit).ok()? };
        Some((other, termination))
    }

    /// The model of a part of long data; none where it cannot be found.
    fn found_in_part(&self, data: &Dataset, start: &StateSpaceModel) -> Option<StateSpaceModel> {
        if data.samples() < LONG {
            return None;
        }
        let (part, n) = (data.excerpts(data.samples() / PART), start.system().states());
        let mut search = Search::new(&part, start.clone(), vec![vec![0.0; n]; part.experiments().len()], n).ok()?;
        search.run(self.iteration_limit).ok()?;
        Some(search.into_parts().2)
    }

    fn starting_point(&self, data: &Dataset) -> Result<StateSpaceModel, IdentError> {
        let (feedthrough, noise_model) = (self.feedthrough, self.focus == Focus::Prediction);
        match &self.start {
            SearchStart::Model(start) => {
                crate::fit::check_channels(start.as_ref(), data)?;
                let given = LinearModel::innovations(start.as_ref(), data.sample_time_s(), data.intersample())?;
                let (system, covariance) = (given.system().clone(), given.noise_covariance().to_owned());
                let innovations = if noise_model { given } else { Innovations::output_error(system, covariance)? };
                Ok(StateSpaceModel::new(innovations, feedthrough, noise_model))
            }
            SearchStart::Subspace(options) => {
                let options = Subspace { feedthrough, noise_model, stable: !noise_model, ..*options };
                options.start(data)
            }
        }
    }
}

/// The ARX model of one output with so many states; none of several outputs, of short data or of long ones, whose
/// searches are dear.
fn equation_error(data: &Dataset, states: usize, feedthrough: bool, noise_model: bool) -> Option<StateSpaceModel> {
    if data.outputs() != 1 || data.samples() >= LONG {
        return None;
    }
    let (nb, nk) = if feedthrough { (states + 1, 0) } else { (states, 1) };
    let found = Arx::new(states, nb, nk).fit(data).ok()?.model.innovations().ok()?;
    let (system, covariance) = (found.system().clone(), found.noise_covariance().to_owned());
    let found = if noise_model { found } else { Innovations::output_error(system, covariance).ok()? };
    (found.system().states() == states).then(|| StateSpaceModel::new(found, feedthrough, noise_model))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn exact_long_data_alone_are_begun_with_a_part() {
        let mut random = signal::excitation::Random::new(1);
        let u: Vec<f64> = (0..LONG).map(|_| random.normal()).collect();
        let mut y = vec![0.0; LONG];
        for t in 1..LONG {
            y[t] = 0.8 * y[t - 1] + u[t - 1];
        }
        let pole = |samples: usize| {
            let (options, data) = (StateSpacePem::new(1), Dataset::siso(0.1, &u[..samples], &y[..samples]).unwrap());
            let start = options.starting_point(&data).unwrap();
            options.found_in_part(&data, &start).map(|model| model.system().poles().unwrap()[0].re)
        };
        assert!(pole(LONG - 1).is_none() && (pole(LONG).unwrap() - 0.8).abs() < 1e-6);
    }
}
