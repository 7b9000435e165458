//! [`Fit`]: what every estimator returns, and what a model has to be able to do to be judged.

pub(crate) mod criteria;
pub(crate) mod degenerate;
pub(crate) mod focus;
pub(crate) mod on_data;

use faer::Mat;
use lti::{Innovations, LtiError, PolynomialModel};

use crate::data::band_limited::BandLimitedForm;
use crate::data::check_clock;
use crate::{Dataset, Experiment, IdentError, Intersample, Origin, Termination};

/// A model with parameters θ that can be read and replaced. Everything derived from an estimate — intervals, bands,
/// ellipses, sampled models — goes through it.
pub trait Parametric: Clone {
    /// θ, in a fixed order.
    fn parameters(&self) -> Vec<f64>;

    /// Names of the parameters, in the same order.
    fn parameter_names(&self) -> Vec<String>;

    /// The same structure with other parameters.
    ///
    /// # Errors
    /// A wrong number of parameters, or values at which there is no model.
    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError>;
}

/// A model that says how sampled outputs come from sampled inputs and noise.
pub trait LinearModel: Sync {
    /// Number of inputs.
    fn inputs(&self) -> usize;

    /// Number of outputs.
    fn outputs(&self) -> usize;

    /// The model in innovations form on a sample time. Models in continuous time are discretised exactly under inputs
    /// that are held or straight. Under band-limited ones no form in the samples is exact: theirs is that of straight
    /// inputs, whose gain at ω is lower by the part (ωT)²/12, while estimates, [`prediction`](crate::prediction) and
    /// [`validate`](crate::validate) go by [`LinearModel::band_limited`].
    ///
    /// # Errors
    /// A discrete model of another sample time, or a continuous one that cannot be discretised.
    fn innovations(&self, sample_time_s: f64, intersample: Intersample) -> Result<Innovations, LtiError>;

    /// A model in continuous time under band-limited inputs; none for a discrete one, which only knows samples.
    ///
    /// # Errors
    /// Those of [`LinearModel::innovations`].
    fn band_limited(&self, _sample_time_s: f64) -> Result<Option<BandLimitedForm>, LtiError> {
        Ok(None)
    }
}

/// An estimate: the model, how certain it is, and how it came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit<M> {
    /// The model at the estimate.
    pub model: M,
    /// Covariance of the model's parameters, in their order.
    pub covariance: Mat<f64>,
    /// Degrees of freedom of Student's t for intervals of the parameters.
    pub degrees_of_freedom: f64,
    /// Covariance of the one-step prediction errors, outputs × outputs, degrees of freedom taken off.
    pub noise_covariance: Mat<f64>,
    /// The determinant of the mean of `ε(t) ε(t)ᵀ`; the mean squared prediction error for one output. Criteria build on
    /// it.
    pub loss: f64,
    /// Rows of prediction errors that the estimate rests on.
    pub samples: usize,
    /// Free parameters, those of initial states not counted.
    pub free_parameters: usize,
    /// The initial state of the innovations form, for each experiment; empty where the method needs none.
    pub initial_states: Vec<Vec<f64>>,
    /// The constants that were estimated beside the model: for each experiment one an output. Empty where none were;
    /// then the outputs are those of the model alone.
    pub levels: Vec<Vec<f64>>,
    /// How the search ended.
    pub termination: Termination,
    /// Iterations taken, zero for a method without any.
    pub iterations: usize,
    /// Condition number of the scaled regressor or Jacobian.
    pub condition: f64,
    /// Doubts about the estimate.
    pub doubts: Vec<Doubt>,
    /// How it was made; none for an estimate that was read from a model file.
    pub origin: Option<Origin>,
}

/// A reason to doubt an estimate that was made all the same.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Doubt {
    /// The search stopped before a minimum: at its limit of iterations, or at an edge such as that of stability.
    NotConverged,
    /// The data can hardly separate the parameters.
    IllConditioned {
        /// Condition number of the scaled regressor or Jacobian.
        #[cfg_attr(feature = "schema", schemars(with = "f64"))]
        #[serde(with = "maybe_infinite")]
        condition: f64,
    },
    /// Rows were left out because of missing samples, or since inputs are not known well enough near the ends.
    RowsLeftOut {
        /// How many.
        rows: usize,
        /// Of how many.
        of: usize,
    },
    /// Inputs are taken to have been, before each record, what they are at its first sample.
    HeldBefore,
    /// The outputs refute that inputs were, before each record, what they are at its first sample; the estimate assumes
    /// it all the same, since the rows that do without are too few.
    HeldBeforeRefuted,
    /// The profile of a parameter shows smaller errors of an output with other parameters, where no estimate was
    /// possible: the intervals are those of the covariance, and too narrow.
    NotTheLeast {
        /// Index of the output.
        output: usize,
    },
    /// A parameter is at a bound: it has no interval, and the covariance of the others holds with it there.
    AtBound {
        /// Its index.
        parameter: usize,
    },
    /// The model is not stable.
    Unstable,
    /// The residuals are larger than the measured noise, on which alone the covariance rests: true errors are larger.
    LargerThanNoise {
        /// The sum of squares over its expected value.
        #[cfg_attr(feature = "schema", schemars(with = "f64"))]
        #[serde(with = "maybe_infinite")]
        ratio: f64,
    },
    /// The covariance is the least that any estimate could have; this one may scatter more.
    CovarianceIsLowerBound,
    /// An input is a linear combination of those before it, but for a constant: the data cannot separate their effects.
    DependentInputs {
        /// Index of the input.
        input: usize,
    },
    /// The errors of an output are a linear combination of those of the outputs before it: their joint covariance is
    /// singular, the loss is zero, and no criterion is defined.
    DependentOutputs {
        /// Index of the output.
        output: usize,
    },
    /// The errors of an output vanish to the arithmetic, or their squares do: no interval or criterion means anything.
    NothingLeft {
        /// Index of the output.
        output: usize,
    },
    /// The search stopped where a root of a polynomial would cross the unit circle, as one polynomial too long makes
    /// it: the numbers hold, short of a minimum that does not exist.
    RootAtEdge {
        /// Index of the output.
        output: usize,
        /// The polynomial, `C` or `F`.
        polynomial: char,
        /// Of which input, for `F`.
        input: Option<usize>,
        /// Magnitude of the root, within a few percent of one.
        magnitude: f64,
        /// Its frequency, rad a sample.
        angle: f64,
        /// The polynomial that nearly cancels it.
        cancelled_by: Option<char>,
    },
    /// The model, simulated or predicted one step ahead, leaves nearly all of an output of the estimation data
    /// unexplained.
    ExplainsLittle {
        /// Index of the output.
        output: usize,
        /// True if only the simulation leaves so much; otherwise the prediction does too.
        simulated: bool,
    },
    /// A mode's part of an output is below the noise: other poles may do as well, far beyond its intervals.
    UnseenMode {
        /// Index of the output.
        output: usize,
        /// Index of the input.
        input: usize,
        /// The pole in z, its real and imaginary part; the imaginary one is not negative.
        pole: (f64, f64),
        /// The energy of its part over the variance of the errors.
        energy: f64,
    },
    /// The search ended at a mode that turns faster than the samples can show, and parameters that are estimated decide
    /// where: it may be the image of a slower one.
    AboveNyquist {
        /// Its frequency.
        frequency_hz: f64,
    },
    /// The samples are few for a noise model, or a root of it may be on the unit circle: its intervals are too narrow.
    UncertainNoiseModel {
        /// Index of the output.
        output: usize,
    },
    /// An input follows what the model leaves of an output, as under feedback, and the method takes inputs for
    /// independent of the noise: the estimate is biased.
    Feedback {
        /// Index of the output.
        output: usize,
        /// Index of the input.
        input: usize,
    },
    /// An input goes with what the model leaves of an output in the same sample, and the model has no way for that: the
    /// input acts at once, or follows the output within the sample, as a controller's output does. Then the estimate is
    /// biased.
    WithinSample {
        /// Index of the output.
        output: usize,
        /// Index of the input.
        input: usize,
    },
    /// An input has so few lines of frequency, each of which gives a gain and a phase, that it does not separate delay
    /// and dynamics of this structure.
    FewLines {
        /// Index of the input.
        input: usize,
        /// Lines there are.
        lines: usize,
        /// Lines that the structure needs.
        needed: usize,
        /// The strongest of them.
        strongest_hz: f64,
    },
    /// The residuals of an output still follow the inputs: the structure is too simple, or the search ended in a local
    /// minimum. Intervals and covariance contain nothing of this error.
    FollowsInputs {
        /// Index of the output.
        output: usize,
        /// The part of the residual's sum of squares that a further model of the same structure explains.
        share: f64,
    },
}

/// Numbers that may be infinite, which JSON has no word for but null.
mod maybe_infinite {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        value.is_finite().then_some(*value).serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
    }
}

impl<M> Fit<M> {
    /// The same estimate of a model in another guise, whose parameters are the same in the same order.
    pub fn map<N>(self, change: impl FnOnce(M) -> N) -> Fit<N> {
        Fit {
            model: change(self.model),
            covariance: self.covariance,
            degrees_of_freedom: self.degrees_of_freedom,
            noise_covariance: self.noise_covariance,
            loss: self.loss,
            samples: self.samples,
            free_parameters: self.free_parameters,
            initial_states: self.initial_states,
            levels: self.levels,
            termination: self.termination,
            iterations: self.iterations,
            condition: self.condition,
            doubts: self.doubts,
            origin: self.origin,
        }
    }
}

impl<M: Parametric> Fit<M> {
    /// The parameters, in the model's order.
    pub fn parameters(&self) -> Vec<f64> {
        self.model.parameters()
    }

    /// Standard error of each parameter: zero for one that is fixed, NaN for one [at its bound](Fit::is_at_bound).
    pub fn standard_errors(&self) -> Vec<f64> {
        let error = |i: usize| if self.is_at_bound(i) { f64::NAN } else { self.covariance[(i, i)].max(0.0).sqrt() };
        (0..self.covariance.nrows()).map(error).collect()
    }

    /// Returns true if a parameter ended at a bound that the errors would fall beyond. The data then do not show how
    /// far from the truth it is. Its row of the covariance is zero: the covariance of the others holds with it at that
    /// value.
    pub fn is_at_bound(&self, parameter: usize) -> bool {
        self.doubts.contains(&Doubt::AtBound { parameter })
    }

    /// The interval that holds each parameter with this probability, by Student's t; NaN for one at its bound.
    pub fn intervals(&self, level: f64) -> Vec<(f64, f64)> {
        let interval = |(value, error)| crate::distributions::interval(value, error, self.degrees_of_freedom, level);
        self.parameters().into_iter().zip(self.standard_errors()).map(interval).collect()
    }
}

impl Parametric for PolynomialModel {
    fn parameters(&self) -> Vec<f64> {
        self.coefficients()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.coefficient_names()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        self.with_coefficients(parameters)
    }
}

impl LinearModel for PolynomialModel {
    fn inputs(&self) -> usize {
        PolynomialModel::inputs(self)
    }

    fn outputs(&self) -> usize {
        PolynomialModel::outputs(self)
    }

    fn innovations(&self, sample_time_s: f64, _: Intersample) -> Result<Innovations, LtiError> {
        check_clock(self.sample_time_s(), sample_time_s)?;
        PolynomialModel::innovations(self)
    }
}

/// A fit can stand wherever its model can.
impl<M: LinearModel> LinearModel for Fit<M> {
    fn inputs(&self) -> usize {
        self.model.inputs()
    }

    fn outputs(&self) -> usize {
        self.model.outputs()
    }

    fn innovations(&self, sample_time_s: f64, intersample: Intersample) -> Result<Innovations, LtiError> {
        self.model.innovations(sample_time_s, intersample)
    }

    fn band_limited(&self, sample_time_s: f64) -> Result<Option<BandLimitedForm>, LtiError> {
        self.model.band_limited(sample_time_s)
    }
}

impl LinearModel for Innovations {
    fn inputs(&self) -> usize {
        self.system().inputs()
    }

    fn outputs(&self) -> usize {
        self.system().outputs()
    }

    fn innovations(&self, sample_time_s: f64, _: Intersample) -> Result<Innovations, LtiError> {
        check_clock(self.system().sample_time_s().unwrap_or(f64::NAN), sample_time_s)?;
        Ok(self.clone())
    }
}

/// Refuses data whose channels are not those of a model.
///
/// # Errors
/// [`IdentError::Length`].
pub(crate) fn check_channels<M: LinearModel + ?Sized>(model: &M, data: &crate::Dataset) -> Result<(), IdentError> {
    for (what, expected, found) in [
        ("inputs of the data", model.inputs(), data.inputs()),
        ("outputs of the data", model.outputs(), data.outputs()),
    ] {
        if expected != found {
            return Err(IdentError::Length { what, expected, found });
        }
    }
    Ok(())
}

impl<M> Fit<M> {
    /// Data of the estimate, or others with as many experiments, less the [levels](Fit::levels): what the model alone
    /// describes.
    ///
    /// # Errors
    /// [`IdentError::Length`] for another number of experiments or outputs.
    pub fn without_levels(&self, data: &Dataset) -> Result<Dataset, IdentError> {
        if self.levels.is_empty() {
            return Ok(data.clone());
        }
        crate::data::check_count("experiments of the levels", self.levels.len(), data.experiments().len())?;
        let mut levels = self.levels.iter();
        data.map_experiments(|e| {
            let of = levels.next().map_or(&[][..], Vec::as_slice);
            crate::data::check_count("outputs of the levels", of.len(), e.outputs.ncols())?;
            let outputs = Mat::from_fn(e.len(), of.len(), |t, i| e.outputs[(t, i)] - of[i]);
            Ok(Experiment { outputs, ..e.clone() })
        })
    }

    /// The same estimate, made by this method from these data.
    pub(crate) fn made_by(self, method: &'static str, data: &Dataset) -> Self {
        Fit { origin: Some(Origin::new(method, data)), ..self }
    }
}
