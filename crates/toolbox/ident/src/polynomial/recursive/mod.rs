//! Recursive estimation: models that follow the data sample by sample.
//!
//! `θ̂(t) = θ̂(t−1) + L(t) ε(t)`, `ε(t) = y(t) − ŷ(t | t−1)`, with a gain `L` that depends on how the parameters are
//! thought to change ([`Adaptation`]) and on the structure ([`RecursiveStructure`]).

mod adaptation;
mod diffuse;
mod regressor;
mod stability;
mod ud;
mod weights;

pub use adaptation::Adaptation;
pub use regressor::RecursiveStructure;

use adaptation::Gain;
use faer::Mat;
use lti::PolynomialModel;
use regressor::Regressor;

use crate::{Dataset, IdentError};
use fitting::{Count, StructureError};

/// How often a step that would leave an unstable predictor is halved before it is given up.
const HALVINGS: usize = 12;

/// Recursive estimator: the structure whose parameters it follows, and how it adapts them.
///
/// The start needs no guess: the first samples are gathered as least squares for an ARX model until they determine it
/// (for ARMAX and output error that model is where the search starts). With ARX and [`Adaptation::Forgetting`] the
/// parameters are, at every sample, those of weighted least squares over all samples before, with weights `λ^(age)`.
///
/// # Example
/// ```
/// use ident::recursive::{Adaptation, Recursive, RecursiveStructure};
/// # let mut random = signal::excitation::Random::new(6);
/// let structure = RecursiveStructure::Arx { na: 1, nb: vec![1], nk: vec![1] };
/// let mut recursive = Recursive::new(structure, Adaptation::Forgetting(1.0))?;
/// let (mut u, mut y) = (0.0, 0.0);
/// for _ in 0..50 {
///     y = 0.9 * y + 0.5 * u;
///     u = random.normal();
///     recursive.step(&[u], y)?;
/// }
/// assert!((recursive.parameters()[0] + 0.9).abs() < 1e-9 && (recursive.parameters()[1] - 0.5).abs() < 1e-9);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, ch. 11; Ljung & Söderström, *Theory and Practice of Recursive Identification*, 1983.
#[derive(Debug, Clone)]
pub struct Recursive {
    regressor: Regressor,
    gain: Gain,
    parameters: Vec<f64>,
    /// Regressor and gradient, kept to be written anew.
    phi: Vec<f64>,
    psi: Vec<f64>,
    before: Vec<f64>,
}

/// Prediction and error of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Update {
    /// `ŷ(t | t−1)`, by the parameters before the sample; NaN where what it needs of the past is missing, as at the
    /// start.
    pub prediction: f64,
    /// `y(t) − ŷ(t | t−1)`; NaN where either is missing.
    pub error: f64,
}

/// The parameters over the samples of data.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Names of the parameters.
    pub names: Vec<String>,
    /// Parameters after each sample: rows are samples, over all experiments; columns parameters.
    pub parameters: Mat<f64>,
    /// Standard errors after each sample, of the same shape; NaN as long as there are none.
    pub standard_errors: Mat<f64>,
    /// Prediction and error of each sample.
    pub updates: Vec<Update>,
}

impl Recursive {
    /// An estimator that has seen nothing.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for a structure without parameters or with lists of different lengths;
    /// [`signal::SignalError::Parameter`] for an adaptation outside its range; [`IdentError::Length`] where the drift
    /// does not have one value a parameter.
    pub fn new(structure: RecursiveStructure, adaptation: Adaptation) -> Result<Self, IdentError> {
        let regressor = Regressor::new(structure)?;
        let count = regressor.parameter_count();
        let gain = Gain::new(adaptation, count, regressor.starting_count(), regressor.poles())?;
        let zeros = || vec![0.0; count];
        Ok(Recursive { regressor, gain, parameters: zeros(), phi: zeros(), psi: zeros(), before: zeros() })
    }

    /// Takes one sample: the inputs of this instant, and the output they and the past have led to. NaN is a missing
    /// sample: the parameters stay, a missing output is replaced by its prediction in what follows, a missing input by
    /// the one before it.
    ///
    /// # Errors
    /// [`IdentError::Length`] for a wrong number of inputs; [`IdentError::NotFinite`] for an infinite value.
    pub fn step(&mut self, inputs: &[f64], output: f64) -> Result<Update, IdentError> {
        self.regressor.check(inputs, output)?;
        let starting = !self.gain.has_started();
        let known = self.regressor.read_inputs(inputs, &self.parameters, starting);
        self.regressor.write(starting, &mut self.phi, &mut self.psi);
        let value: f64 = self.phi.iter().zip(&self.parameters).map(|(x, p)| x * p).sum();
        let error = output - value;
        if known && !error.is_nan() {
            self.adapt(error, output);
        }
        let after: f64 = self.phi.iter().zip(&self.parameters).map(|(x, p)| x * p).sum();
        self.regressor.advance(&self.parameters, output, after, starting);
        let prediction = if known { value } else { f64::NAN };
        Ok(Update { prediction, error: output - prediction })
    }

    fn adapt(&mut self, error: f64, output: f64) {
        self.before.copy_from_slice(&self.parameters);
        let starting = !self.gain.has_started();
        self.gain.update(&mut self.parameters, &self.psi, error, output);
        if starting && self.gain.has_started() {
            self.regressor.share_poles(&mut self.parameters);
        }
        // A step to an unstable predictor is shortened; where it started, zero or the last estimate, it was stable.
        for _ in 0..HALVINGS {
            if self.regressor.is_stable(&self.parameters) {
                return;
            }
            self.parameters.iter_mut().zip(&self.before).for_each(|(p, b)| *p = 0.5 * (*p + b));
        }
        self.parameters.copy_from_slice(&self.before);
    }

    /// Follows data from where it stands. Past samples are forgotten between experiments, parameters are not; the first
    /// rows of each experiment, whose past is not known, teach nothing.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for several outputs; [`IdentError::Length`] for a wrong number of inputs.
    pub fn run(&mut self, data: &Dataset) -> Result<Trajectory, IdentError> {
        if data.outputs() != 1 {
            return Err(StructureError::outputs("a recursive estimate", Count::Exactly(1), data.outputs()).into());
        }
        let (count, rows) = (self.parameters.len(), data.samples());
        let mut trajectory = Trajectory {
            names: self.model(data.sample_time_s())?.coefficient_names(),
            parameters: Mat::zeros(rows, count),
            standard_errors: Mat::zeros(rows, count),
            updates: Vec::with_capacity(rows),
        };
        let (mut inputs, mut row) = (vec![0.0; data.inputs()], 0);
        for e in data.experiments() {
            self.regressor.forget_past();
            for (t, y) in work::checked(e.output(0)).enumerate() {
                (0..data.inputs()).for_each(|k| inputs[k] = e.input(k)[t]);
                trajectory.updates.push(self.step(&inputs, *y)?);
                let standard_errors = self.gain.standard_errors();
                for j in 0..count {
                    trajectory.parameters[(row, j)] = self.parameters[j];
                    trajectory.standard_errors[(row, j)] = standard_errors[j];
                }
                row += 1;
            }
        }
        Ok(trajectory)
    }

    /// θ, in the order of [`lti::PolynomialEquation::coefficients`]; zero until the first samples determine them.
    #[must_use]
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Covariance of θ under white noise; `None` during the start and for [`Adaptation::NormalisedGradient`]. With
    /// forgetting it is that of the errors of parameters that stay: how far parameters that move have gone from the
    /// estimate is not in it.
    #[must_use]
    pub fn covariance(&self) -> Option<Mat<f64>> {
        self.gain.covariance()
    }

    /// Variance of the prediction errors: of all for a random walk or gradient, over the memory for forgetting.
    #[must_use]
    pub fn noise_variance(&self) -> f64 {
        self.gain.noise_variance()
    }

    /// The model at the present parameters.
    ///
    /// # Errors
    /// [`IdentError::SampleTime`] by way of [`lti::LtiError`].
    pub fn model(&self, sample_time_s: f64) -> Result<PolynomialModel, IdentError> {
        let noise = self.gain.noise_variance();
        let noise = if noise.is_finite() { noise } else { 0.0 };
        let shape = self.regressor.shape();
        let model = PolynomialModel::new(sample_time_s, vec![shape], Mat::full(1, 1, noise))?;
        Ok(model.with_coefficients(&self.parameters)?)
    }
}
