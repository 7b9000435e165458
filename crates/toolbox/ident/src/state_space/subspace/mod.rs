//! Subspace identification: state-space models from projections, without a search.

mod hankel;
mod predictor;
mod realise;
mod weighting;

use lti::Innovations;
use numerics::linalg;

use crate::data::{Experiment, check_missing};
use crate::state_space::{Information, StateSpaceModel, estimate, regress_inputs};
use crate::{Dataset, Doubt, Fit, IdentError};
use fitting::StructureError;
use hankel::{Hankel, HankelFactor, Horizons};
use predictor::PredictorStates;
use realise::{Projection, Realised};
pub use weighting::Weighting;

/// Samples of a gap that a straight line fills for a start.
const FILLED: usize = 10;

/// A canonical correlation this close to one is one.
const CERTAIN: f64 = 1e-9;

/// The number of states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateOrder {
    /// So many.
    Fixed(usize),
    /// The number of canonical correlations between past and future that stand above what independent data of this
    /// length would show, but no more than `largest` and at least one.
    Auto {
        /// Most states.
        largest: usize,
    },
}

/// Subspace estimation of a state-space model in innovations form.
///
/// `x(t+1) = A x(t) + B u(t) + K e(t)`, `y(t) = C x(t) + D u(t) + e(t)`.
///
/// `A` and `C` come from the shift structure of the extended observability matrix, `K` and `Λ` from the residuals of
/// the state sequence by a Riccati equation, `B`, `D` and the initial states from a linear least squares on the
/// one-step prediction errors over all of the data. Data are taken as they are: remove offsets first.
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
/// let fit = ident::Subspace::new(1).fit(&ident::Dataset::siso(0.1, &u, &y)?)?;
/// assert!((fit.model.system().poles()?[0].re - 0.8).abs() < 1e-9);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Van Overschee & De Moor, *Subspace Identification for Linear Systems*, 1996, chapters 4 and 5; Ljung 1999, §10.6.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subspace {
    /// Number of states.
    pub order: StateOrder,
    /// Weighting of the projection.
    pub weighting: Weighting,
    /// Block rows of the past; chosen from the order and the length of the data where `None`.
    pub past: Option<usize>,
    /// Block rows of the future; as the past where `None`.
    pub future: Option<usize>,
    /// True if `D` is estimated; otherwise it is zero.
    pub feedthrough: bool,
    /// True if a noise model is estimated; otherwise `K = 0`.
    pub noise_model: bool,
    /// True if `A` is made stable where the data alone would not make it so.
    pub stable: bool,
}

impl Subspace {
    /// Of `order` states, canonical variates (SSARX under feedback), no feed-through, with a noise model.
    #[must_use]
    pub fn new(order: usize) -> Self {
        Self::of(StateOrder::Fixed(order))
    }

    /// The order chosen from the data, at most `largest`.
    #[must_use]
    pub fn auto(largest: usize) -> Self {
        Self::of(StateOrder::Auto { largest })
    }

    fn of(order: StateOrder) -> Self {
        Subspace {
            order,
            weighting: Weighting::default(),
            past: None,
            future: None,
            feedthrough: false,
            noise_model: true,
            stable: false,
        }
    }

    /// With another weighting.
    #[must_use]
    pub fn with_weighting(self, weighting: Weighting) -> Self {
        Subspace { weighting, ..self }
    }

    /// With these block rows of past and future.
    #[must_use]
    pub fn with_horizons(self, past: usize, future: usize) -> Self {
        Subspace { past: Some(past), future: Some(future), ..self }
    }

    /// With `D` estimated.
    #[must_use]
    pub fn with_feedthrough(self) -> Self {
        Subspace { feedthrough: true, ..self }
    }

    /// With `K = 0`.
    #[must_use]
    pub fn without_noise_model(self) -> Self {
        Subspace { noise_model: false, ..self }
    }

    /// With a stable `A` whatever the data say.
    #[must_use]
    pub fn with_stability(self) -> Self {
        Subspace { stable: true, ..self }
    }

    /// Estimates the model.
    ///
    /// The covariance is the one that a prediction-error estimate would have (gathered from stretches spread over long
    /// data); a subspace estimate comes close to it with canonical variates and scatters more with the other
    /// weightings, so [`Doubt::CovarianceIsLowerBound`] is added as a doubt. Refine the estimate by
    /// [`crate::StateSpacePem`] where intervals matter. Under feedback the estimate is biased with any weighting but
    /// [`Weighting::Ssarx`]; where the residuals show it, [`Doubt::Feedback`] is added.
    ///
    /// # Errors
    /// [`IdentError::Missing`] for a missing sample, [`IdentError::TooFewSamples`], [`IdentError::Constant`] for a
    /// channel that is zero throughout, [`IdentError::RankDeficient`] for inputs that do not excite the order, and
    /// [`IdentError::Structure`] for an order that the horizons cannot hold.
    pub fn fit(&self, data: &Dataset) -> Result<Fit<StateSpaceModel>, IdentError> {
        if self.weighting != Weighting::Automatic {
            return self.fit_weighted(data);
        }
        let fit = self.with_weighting(Weighting::Cva).fit_weighted(data)?;
        let is_fed_back = fit.doubts.iter().any(|d| matches!(d, Doubt::Feedback { .. }));
        if is_fed_back { self.with_weighting(Weighting::Ssarx).fit_weighted(data) } else { Ok(fit) }
    }

    fn fit_weighted(&self, data: &Dataset) -> Result<Fit<StateSpaceModel>, IdentError> {
        let weights = channel_weights(data)?;
        let horizons = self.horizons(data)?;
        let hankel = Hankel::new(data, horizons, &weights);
        let factor = hankel.factor();
        let scaled = self.realise(&hankel, &factor)?.unscaled(&weights, data)?;
        self.finish(data, scaled)
    }

    /// A model for a search to start from, also where outputs miss samples: short gaps are filled by straight lines,
    /// and the data are split at the others where what is left is enough.
    ///
    /// # Errors
    /// Those of [`Subspace::fit`].
    pub fn start(&self, data: &Dataset) -> Result<StateSpaceModel, IdentError> {
        if !data.experiments().iter().any(Experiment::has_missing) {
            return Ok(self.fit(data)?.model);
        }
        check_missing(data)?;
        let filled = |longest: usize| data.fill_gaps(longest)?.without_gaps(1);
        let start = filled(FILLED).and_then(|part| self.fit(&part));
        Ok(start.or_else(|_| self.fit(&filled(data.samples())?))?.model)
    }

    /// `A`, `C` and the noise in scaled channels.
    fn realise(&self, hankel: &Hankel<'_>, factor: &HankelFactor) -> Result<Realised, IdentError> {
        // Canonical correlations beyond the order that are one, as of data without noise, rank nothing; sizes do.
        let rank_nothing = |correlations: &[f64], order: usize| {
            correlations.get(order).is_some_and(|correlation| *correlation > 1.0 - CERTAIN)
        };
        if self.weighting == Weighting::Ssarx {
            let states = PredictorStates::new(hankel, factor, self.feedthrough)?;
            let order = self.choose(hankel, factor, states.correlations())?;
            if !rank_nothing(states.correlations(), order) {
                return states.realise(order, self.stable, self.noise_model);
            }
            let projection = Projection::new(hankel, factor, Weighting::N4sid)?;
            return projection.realise(order, self.stable, self.noise_model);
        }
        let mut projection = Projection::new(hankel, factor, self.weighting)?;
        let order = match self.weighting {
            Weighting::Cva => self.choose(hankel, factor, projection.singular_values())?,
            _ => self.choose(hankel, factor, Projection::new(hankel, factor, Weighting::Cva)?.singular_values())?,
        };
        if self.weighting == Weighting::Cva && rank_nothing(projection.singular_values(), order) {
            projection = Projection::new(hankel, factor, Weighting::N4sid)?;
        }
        projection.realise(order, self.stable, self.noise_model)
    }

    /// The singular values of the weighted projection, largest first: a drop shows the order. Canonical correlations
    /// with [`Weighting::Cva`] and [`Weighting::Ssarx`], those of the former for [`Weighting::Automatic`]; otherwise in
    /// units of scaled outputs per window.
    ///
    /// # Errors
    /// Those of [`Subspace::fit`].
    pub fn singular_values(&self, data: &Dataset) -> Result<Vec<f64>, IdentError> {
        let weights = channel_weights(data)?;
        let hankel = Hankel::new(data, self.horizons(data)?, &weights);
        let factor = hankel.factor();
        if self.weighting == Weighting::Ssarx {
            return Ok(PredictorStates::new(&hankel, &factor, self.feedthrough)?.correlations().to_vec());
        }
        Ok(Projection::new(&hankel, &factor, self.weighting)?.singular_values().to_vec())
    }

    /// Block rows: as asked for, or enough for the order and what the data can fill ten times over. Where the order is
    /// to be chosen, short data make it smaller.
    fn horizons(&self, data: &Dataset) -> Result<Horizons, IdentError> {
        let largest = match self.order {
            StateOrder::Fixed(order) => return self.horizons_of(order, data),
            StateOrder::Auto { largest } => largest,
        };
        let first = self.horizons_of(largest, data);
        match first {
            Err(IdentError::TooFewSamples { .. }) => {
                (1..largest).rev().find_map(|order| self.horizons_of(order, data).ok()).map_or(first, Ok)
            }
            other => other,
        }
    }

    fn horizons_of(&self, order: usize, data: &Dataset) -> Result<Horizons, IdentError> {
        let p = data.outputs();
        if order == 0 {
            return Err(StructureError::TooFew { what: "states", found: 0, least: 1 }.into());
        }
        let least = order.div_ceil(p) + 1;
        let longest = data.experiments().iter().map(Experiment::len).max().unwrap_or(0);
        let affordable = (longest / (2 + 4 * (data.inputs() + p))).max(least);
        let chosen = (order + 6).max(2 * order.div_ceil(p)).max(10).min(affordable);
        let past = self.past.unwrap_or(chosen);
        let horizons = Horizons { past, future: self.future.unwrap_or(past) };
        if horizons.past == 0 || horizons.past * (data.inputs() + p) < order || (horizons.future.max(1) - 1) * p < order
        {
            let Horizons { past, future } = horizons;
            let channels = data.inputs() + p;
            return Err(StructureError::Horizons { past, future, order, outputs: p, channels }.into());
        }
        let columns = horizons.total() * (data.inputs() + p);
        let windows: usize = data.experiments().iter().map(|e| (e.len() + 1).saturating_sub(horizons.total())).sum();
        if windows < columns + order {
            return Err(IdentError::TooFewSamples { samples: data.samples(), parameters: columns + order });
        }
        Ok(horizons)
    }

    fn choose(&self, hankel: &Hankel<'_>, factor: &HankelFactor, correlations: &[f64]) -> Result<usize, IdentError> {
        let order = match self.order {
            StateOrder::Fixed(order) => order,
            StateOrder::Auto { largest } => {
                let held = (hankel.horizons.future.max(2) - 1) * hankel.outputs;
                significant(correlations, hankel, factor.windows).clamp(1, largest.min(held))
            }
        };
        check_excitation(hankel, factor, order)?;
        Ok(order)
    }

    /// `B`, `D`, initial states and the covariances.
    fn finish(&self, data: &Dataset, start: Innovations) -> Result<Fit<StateSpaceModel>, IdentError> {
        let regressed = regress_inputs(data, start, self.feedthrough)?;
        let model = StateSpaceModel::new(regressed.model, self.feedthrough, self.noise_model);
        let states = model.system().states();
        let mut fit = estimate(data, &model, regressed.initial_states, states, Information::Sampled)?;
        fit.doubts.push(Doubt::CovarianceIsLowerBound);
        // Without a noise model nothing holds under feedback.
        if self.weighting != Weighting::Ssarx || !self.noise_model {
            fit = fit.doubting_feedback(data);
        }
        let method = match self.weighting {
            Weighting::Ssarx => "subspace, SSARX",
            Weighting::Cva | Weighting::Automatic => "subspace, canonical variates (CVA)",
            Weighting::Moesp => "subspace, MOESP",
            Weighting::N4sid => "subspace, N4SID",
        };
        Ok(fit.made_by(method, data))
    }
}

/// The reciprocal root mean square of each channel, inputs first.
fn channel_weights(data: &Dataset) -> Result<Vec<f64>, IdentError> {
    let size = |pick: &dyn Fn(&Experiment) -> &[f64], what: &'static str| -> Result<f64, IdentError> {
        let (mut largest, mut offset) = (0.0_f64, 0);
        for experiment in data.experiments() {
            let values = pick(experiment);
            if let Some(index) = values.iter().position(|v| v.is_nan()) {
                return Err(IdentError::Missing { what, index: offset + index });
            }
            largest = values.iter().fold(largest, |l, v| l.max(v.abs()));
            offset += values.len();
        }
        if largest == 0.0 {
            return Err(if offset == 0 {
                IdentError::TooFewSamples { samples: 0, parameters: 1 }
            } else {
                IdentError::Constant { what }
            });
        }
        let sum: f64 =
            data.experiments().iter().flat_map(|e| pick(e).iter()).map(|v| (v / largest) * (v / largest)).sum();
        Ok(1.0 / (largest * (sum / offset as f64).sqrt()))
    };
    let inputs = (0..data.inputs()).map(|k| size(&|e| e.input(k), "an input"));
    let outputs = (0..data.outputs()).map(|k| size(&|e| e.output(k), "an output"));
    inputs.chain(outputs).collect()
}

/// Canonical correlations above the largest that independent past and future show: about `(√a + √b)/√N` for spaces of
/// `a` and `b` dimensions, with a margin for the windows' overlap.
///
/// # Source
/// Johnstone, *Multivariate analysis and Jacobi ensembles*, Ann. Statist. 36(6), 2008, for the edge.
fn significant(correlations: &[f64], hankel: &Hankel<'_>, windows: usize) -> usize {
    const MARGIN: f64 = 1.25;
    let future = (hankel.horizons.future * hankel.outputs) as f64;
    let past = (hankel.horizons.past * hankel.channels()) as f64;
    let edge = MARGIN * (future.sqrt() + past.sqrt()) / (windows as f64).sqrt();
    correlations.iter().filter(|c| **c > edge.min(0.999)).count()
}

/// Refuses inputs whose Hankel matrix does not have the rank that the order needs.
fn check_excitation(hankel: &Hankel<'_>, factor: &HankelFactor, order: usize) -> Result<(), IdentError> {
    const TOLERANCE: f64 = 1e-10;
    let columns = hankel.inputs * hankel.horizons.future;
    if columns == 0 {
        return Ok(());
    }
    let block = factor.r.submatrix(0, 0, columns, columns);
    let values = linalg::singular_values(block)?;
    let rank = values.iter().filter(|v| **v > TOLERANCE * values[0]).count();
    let needed = columns.min(hankel.inputs * (order + 1));
    if rank < needed {
        let condition = values[0] / values[needed - 1];
        return Err(IdentError::RankDeficient { rank, parameters: needed, condition });
    }
    Ok(())
}
