//! Parts of a grey-box model: its structure and its parameters.

use faer::Mat;
use lti::{LtiError, StateSpace};

use crate::Bounds;

/// One parameter of a grey-box model.
#[derive(Debug, Clone, PartialEq)]
pub struct GreyParameter {
    /// Its name.
    pub name: String,
    /// Its value: where the search starts, and what a fixed one stays at.
    pub value: f64,
    /// True if it is not estimated.
    pub fixed: bool,
    /// Bounds it is kept within.
    pub bounds: Bounds,
    /// Mean and standard deviation of what is known of it beforehand, a normal distribution.
    pub prior: Option<(f64, f64)>,
}

impl GreyParameter {
    /// A free parameter without bounds.
    #[must_use]
    pub fn new(name: impl Into<String>, value: f64) -> Self {
        GreyParameter { name: name.into(), value, fixed: false, bounds: Bounds::NONE, prior: None }
    }

    /// Not estimated.
    #[must_use]
    pub fn fixed(self) -> Self {
        GreyParameter { fixed: true, ..self }
    }

    /// Kept from `lower` to `upper`.
    #[must_use]
    pub fn within(self, lower: f64, upper: f64) -> Self {
        GreyParameter { bounds: Bounds::new(lower, upper), ..self }
    }

    /// Known beforehand to be about `mean`, give or take `standard_deviation`.
    #[must_use]
    pub fn with_prior(self, mean: f64, standard_deviation: f64) -> Self {
        GreyParameter { prior: Some((mean, standard_deviation)), ..self }
    }
}

/// Noise of a grey-box model.
#[derive(Debug, Clone, PartialEq)]
pub enum GreyNoise {
    /// White noise on the outputs alone: `K = 0`.
    OutputError,
    /// The gain `K` of the sampled predictor, states × outputs.
    Gain(Mat<f64>),
    /// White process and measurement noise; `K` is that of the stationary Kalman filter.
    Covariances {
        /// States × states: covariance a sample of a discrete model, spectral density (covariance a second) of a
        /// continuous one.
        process: Mat<f64>,
        /// Outputs × outputs: covariance of a sample's noise, up to a factor that `process` shares.
        measurement: Mat<f64>,
    },
}

/// A family of state-space models with parameters that mean something.
///
/// # Example
/// ```
/// # use faer::mat;
/// /// J ω̇ = −b ω + T
/// #[derive(Clone)]
/// struct Rotor;
///
/// impl ident::Structure for Rotor {
///     fn parameters(&self) -> Vec<ident::GreyParameter> {
///         vec![ident::GreyParameter::new("J", 0.1), ident::GreyParameter::new("b", 0.1)]
///     }
///     fn system(&self, p: &[f64]) -> Result<lti::StateSpace, lti::LtiError> {
///         lti::StateSpace::continuous(mat![[-p[1] / p[0]]], mat![[1.0 / p[0]]], mat![[1.0]], mat![[0.0]])
///     }
/// }
/// # let truth = ident::Structure::system(&Rotor, &[0.2, 0.5])?.to_discrete_zoh(0.05)?;
/// # let u: Vec<f64> = (0..200).map(|t| if t / 20 % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// # let y = truth.simulate(faer::Mat::from_fn(200, 1, |t, _| u[t]).as_ref(), &[0.3])?;
/// # let y: Vec<f64> = (0..200).map(|t| y[(t, 0)]).collect();
/// let fit = ident::GreyBox::new(Rotor).fit(&ident::Dataset::siso(0.05, &u, &y)?)?;
/// assert!((fit.parameters()[0] - 0.2).abs() < 1e-8 && (fit.parameters()[1] - 0.5).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Structure: Clone + Sync {
    /// The parameters, in a fixed order, with starting values.
    fn parameters(&self) -> Vec<GreyParameter>;

    /// The system at these parameters: continuous, or discrete on the data's sample time.
    ///
    /// # Errors
    /// Parameters at which there is no system; the search then steps less far.
    fn system(&self, parameters: &[f64]) -> Result<StateSpace, LtiError>;

    /// The disturbance at these parameters; none but white noise on the outputs unless said otherwise.
    fn noise(&self, _parameters: &[f64]) -> GreyNoise {
        GreyNoise::OutputError
    }

    /// The delay of each input in seconds at these parameters, for a continuous system under held inputs; none where
    /// empty.
    fn input_delays_s(&self, _parameters: &[f64]) -> Vec<f64> {
        Vec::new()
    }
}

/// An entry of a structured matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Entry {
    /// This number.
    Fixed(f64),
    /// Estimated, from this start.
    Free(f64),
    /// Estimated from `start` within bounds.
    Bounded {
        /// Where the search starts.
        start: f64,
        /// Bounds of the value.
        bounds: Bounds,
    },
}

impl Entry {
    fn value(self) -> f64 {
        match self {
            Entry::Fixed(value) | Entry::Free(value) | Entry::Bounded { start: value, .. } => value,
        }
    }
}

/// A structure whose parameters are entries of its matrices.
///
/// `ẋ = A x + B u`, or `x(t+1) = A x(t) + B u(t) + K e(t)` with a sample time; `y = C x + D u + e`.
#[derive(Debug, Clone, PartialEq)]
pub struct StructuredMatrices {
    /// States × states.
    pub a: Vec<Vec<Entry>>,
    /// States × inputs.
    pub b: Vec<Vec<Entry>>,
    /// Outputs × states.
    pub c: Vec<Vec<Entry>>,
    /// Outputs × inputs.
    pub d: Vec<Vec<Entry>>,
    /// The sampled predictor's gain, states × outputs; empty for an output-error model.
    pub k: Vec<Vec<Entry>>,
    /// The sample time; `None` for a continuous model.
    pub sample_time_s: Option<f64>,
}

impl StructuredMatrices {
    fn named(&self) -> [(char, &[Vec<Entry>]); 5] {
        [('A', &self.a), ('B', &self.b), ('C', &self.c), ('D', &self.d), ('K', &self.k)]
    }

    /// The matrix of this letter with the free entries' values put in.
    fn filled(&self, letter: char, parameters: &[f64]) -> Result<Mat<f64>, LtiError> {
        let mut values = parameters.iter().copied();
        let mut found = Mat::new();
        for (name, rows) in self.named() {
            let columns = rows.first().map_or(0, Vec::len);
            let mut m = Mat::zeros(rows.len(), columns);
            for (i, row) in rows.iter().enumerate() {
                if row.len() != columns {
                    let (expected, got) = ((rows.len(), columns), (rows.len(), row.len()));
                    return Err(LtiError::shape("structured matrix", expected, got));
                }
                for (j, entry) in row.iter().enumerate() {
                    m[(i, j)] = match entry {
                        Entry::Fixed(value) => *value,
                        _ => values.next().unwrap_or(f64::NAN),
                    };
                }
            }
            if name == letter {
                found = m;
            }
        }
        Ok(found)
    }
}

impl Structure for StructuredMatrices {
    fn parameters(&self) -> Vec<GreyParameter> {
        let mut parameters = Vec::new();
        for (letter, rows) in self.named() {
            for (i, row) in rows.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    let bounds = match entry {
                        Entry::Fixed(_) => continue,
                        Entry::Free(_) => Bounds::NONE,
                        Entry::Bounded { bounds, .. } => *bounds,
                    };
                    let name = format!("{letter}[{},{}]", i + 1, j + 1);
                    parameters.push(GreyParameter { bounds, ..GreyParameter::new(name, entry.value()) });
                }
            }
        }
        parameters
    }

    fn system(&self, parameters: &[f64]) -> Result<StateSpace, LtiError> {
        let [a, b, c, d] = ['A', 'B', 'C', 'D'].map(|letter| self.filled(letter, parameters));
        StateSpace::new(a?, b?, c?, d?, self.sample_time_s)
    }

    fn noise(&self, parameters: &[f64]) -> GreyNoise {
        if self.k.is_empty() {
            return GreyNoise::OutputError;
        }
        self.filled('K', parameters).map_or(GreyNoise::OutputError, GreyNoise::Gain)
    }
}
