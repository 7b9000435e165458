//! [`GreyBoxModel`]: a structure with values for its parameters.

use std::collections::BTreeMap;

use faer::Mat;
use lti::{Innovations, LtiError, StateSpace, from_rows, to_rows};
use serde::{Deserialize, Serialize};

use super::{GreyNoise, Structure};
use crate::continuous::response_to_powers;
use crate::data::band_limited::{BandLimitedForm, COEFFICIENTS};
use crate::data::check_clock;
use crate::dense::kalman;
use crate::{IdentError, Intersample, LinearModel, Parametric};

/// A grey-box model: its structure, the value of every parameter (fixed ones too), and the covariance of the
/// innovations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Written<S>"))]
#[serde(
    try_from = "Written<S>",
    into = "Written<S>",
    bound(serialize = "S: Structure + Serialize", deserialize = "S: Structure + Deserialize<'de>")
)]
pub struct GreyBoxModel<S> {
    structure: S,
    parameters: Vec<f64>,
    noise_covariance: Mat<f64>,
}

/// How a model is written down: parameters by name, the covariance by rows.
#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Written<S> {
    structure: S,
    parameters: BTreeMap<String, f64>,
    noise_covariance: Vec<Vec<f64>>,
}

impl<S: Structure> From<GreyBoxModel<S>> for Written<S> {
    fn from(model: GreyBoxModel<S>) -> Self {
        let parameters = model.parameter_names().into_iter().zip(model.parameters()).collect();
        Written { parameters, noise_covariance: to_rows(model.noise_covariance.as_ref()), structure: model.structure }
    }
}

impl<S: Structure> TryFrom<Written<S>> for GreyBoxModel<S> {
    type Error = IdentError;

    fn try_from(written: Written<S>) -> Result<Self, IdentError> {
        let start = GreyBoxModel::new(written.structure)?;
        let names = start.parameter_names();
        let values: Vec<f64> = names.iter().filter_map(|name| written.parameters.get(name).copied()).collect();
        let (expected, found) = (names.len(), written.parameters.len());
        if values.len() != expected || found != expected {
            return Err(IdentError::Length { what: "values of the structure's parameters", expected, found });
        }
        let outputs = written.noise_covariance.len();
        let noise_covariance = from_rows("noise covariance", &written.noise_covariance, outputs, outputs)?;
        Ok(start.with_parameters(&values)?.with_noise_covariance(noise_covariance)?)
    }
}

impl<S: Structure> GreyBoxModel<S> {
    /// The structure at the starting values of its parameters, with white noise of variance one.
    ///
    /// # Errors
    /// Those of [`Structure::system`].
    pub fn new(structure: S) -> Result<Self, LtiError> {
        let parameters: Vec<f64> = structure.parameters().iter().map(|p| p.value).collect();
        let p = structure.system(&parameters)?.outputs();
        Ok(GreyBoxModel { structure, parameters, noise_covariance: Mat::identity(p, p) })
    }

    /// The structure.
    #[must_use]
    pub fn structure(&self) -> &S {
        &self.structure
    }

    /// The system at the parameters: continuous or discrete, as the structure has it, without input delays.
    ///
    /// # Errors
    /// Those of [`Structure::system`].
    pub fn system(&self) -> Result<StateSpace, LtiError> {
        self.structure.system(&self.parameters)
    }

    /// The delay of an input at the parameters; zero where the structure has none.
    #[must_use]
    pub fn input_delay_s(&self, input: usize) -> f64 {
        self.structure.input_delays_s(&self.parameters).get(input).copied().unwrap_or(0.0)
    }

    /// The same model with this covariance of the innovations, outputs × outputs.
    ///
    /// # Errors
    /// [`LtiError::Shape`].
    pub fn with_noise_covariance(self, noise_covariance: Mat<f64>) -> Result<Self, LtiError> {
        check("noise covariance", &noise_covariance, self.noise_covariance.shape())?;
        Ok(GreyBoxModel { noise_covariance, ..self })
    }

    /// The structure's own states, without those that remember delayed inputs.
    pub(super) fn own_states(&self) -> Result<usize, LtiError> {
        Ok(self.system()?.states())
    }

    /// How many past values of each input the sampled system remembers.
    pub(super) fn delayed_inputs(&self, sample_time_s: f64) -> Vec<usize> {
        let delays_s = self.structure.input_delays_s(&self.parameters);
        if delays_s.iter().all(|d| *d == 0.0) {
            return Vec::new();
        }
        // A delay within a billionth of a sample of a whole number is whole, as it is when it is sampled.
        delays_s.iter().map(|d| (d / sample_time_s - 1e-9).ceil().max(0.0) as usize).collect()
    }

    /// The sampled system, whose states begin with the structure's `own`, with the structure's noise.
    fn with_noise(&self, own: &StateSpace, system: StateSpace, sample_time_s: f64) -> Result<Innovations, LtiError> {
        let (n, p) = (own.states(), system.outputs());
        let gain = match self.structure.noise(&self.parameters) {
            GreyNoise::OutputError => Mat::zeros(n, p),
            GreyNoise::Gain(k) => k,
            GreyNoise::Covariances { process, measurement } => {
                check("process noise covariance", &process, (n, n))?;
                check("measurement noise covariance", &measurement, (p, p))?;
                let continuous = own.sample_time_s().is_none();
                let q = if continuous { sampled_noise(own.a(), &process, sample_time_s)? } else { process };
                let (a, c) = (system.a().submatrix(0, 0, n, n), system.c().subcols(0, n));
                let cross = Mat::zeros(n, p);
                let filter = kalman(a, c, q.as_ref(), cross.as_ref(), measurement.as_ref());
                filter.ok_or(LtiError::Singular { what: "the Riccati equation of the noise covariances" })?.0
            }
        };
        check("K", &gain, (n, p))?;
        let k = Mat::from_fn(system.states(), p, |i, j| if i < n { gain[(i, j)] } else { 0.0 });
        Innovations::new(system, k, self.noise_covariance.clone())
    }

    /// The continuous system sampled; states that remember delayed inputs come last.
    fn sampled(&self, system: &StateSpace, sample_time_s: f64, held: bool) -> Result<StateSpace, LtiError> {
        let delays_s = self.structure.input_delays_s(&self.parameters);
        match (delays_s.iter().any(|d| *d != 0.0), held) {
            (true, true) => system.to_discrete_delayed(&delays_s, sample_time_s)?.to_state_space(),
            (true, false) => Err(LtiError::DelayPresent { delay_s: delays_s.iter().copied().fold(0.0, f64::max) }),
            (false, true) => system.to_discrete_zoh(sample_time_s),
            (false, false) => system.to_discrete_foh(sample_time_s)?.to_state_space(),
        }
    }
}

/// The continuous system sampled, with the coefficients of every input's course as inputs.
fn sampled_with_courses(system: &StateSpace, sample_time_s: f64) -> Result<StateSpace, LtiError> {
    let (n, inputs, outputs) = (system.states(), system.inputs(), system.outputs());
    let mut b = Mat::zeros(n, COEFFICIENTS * inputs);
    let mut a = Mat::identity(n, n);
    for input in 0..inputs {
        let (phi, powers) = response_to_powers(system, input, sample_time_s)?;
        b.subcols_mut(COEFFICIENTS * input, COEFFICIENTS).copy_from(&powers);
        a = phi;
    }
    let now = |i: usize, j: usize| if j.is_multiple_of(COEFFICIENTS) { system.d()[(i, j / COEFFICIENTS)] } else { 0.0 };
    let d = Mat::from_fn(outputs, COEFFICIENTS * inputs, now);
    StateSpace::discrete(a, b, system.c().to_owned(), d, sample_time_s)
}

/// Covariance of the state's noise over a sample: `∫₀ᵀ e^{As} Q e^{Aᵀs} ds`.
///
/// # Source
/// Van Loan, C. F. (1978), IEEE Trans. Autom. Control 23(3), 395–404.
fn sampled_noise(a: faer::MatRef<'_, f64>, q: &Mat<f64>, time_s: f64) -> Result<Mat<f64>, LtiError> {
    let n = a.nrows();
    let generator = Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) => -a[(i, j)] * time_s,
        (true, false) => q[(i, j - n)] * time_s,
        (false, false) => a[(j - n, i - n)] * time_s,
        (false, true) => 0.0,
    });
    let e = lti::expm(generator.as_ref())?;
    let (upper, lower) = (e.submatrix(0, n, n, n), e.submatrix(n, n, n, n));
    let covariance = lower.transpose() * upper;
    Ok(Mat::from_fn(n, n, |i, j| 0.5 * (covariance[(i, j)] + covariance[(j, i)])))
}

fn check(what: &'static str, m: &Mat<f64>, expected: (usize, usize)) -> Result<(), LtiError> {
    if m.shape() == expected { Ok(()) } else { Err(LtiError::shape(what, expected, m.shape())) }
}

impl<S: Structure> Parametric for GreyBoxModel<S> {
    fn parameters(&self) -> Vec<f64> {
        self.parameters.clone()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.structure.parameters().into_iter().map(|p| p.name).collect()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        if parameters.len() != self.parameters.len() {
            let (expected, got) = ((self.parameters.len(), 1), (parameters.len(), 1));
            return Err(LtiError::shape("parameters", expected, got));
        }
        self.structure.system(parameters)?;
        Ok(GreyBoxModel { parameters: parameters.to_vec(), ..self.clone() })
    }
}

impl<S: Structure> LinearModel for GreyBoxModel<S> {
    fn inputs(&self) -> usize {
        self.system().map_or(0, |s| s.inputs())
    }

    fn outputs(&self) -> usize {
        self.noise_covariance.nrows()
    }

    fn innovations(&self, sample_time_s: f64, intersample: Intersample) -> Result<Innovations, LtiError> {
        let own = self.system()?;
        match own.sample_time_s() {
            Some(model_s) => {
                check_clock(model_s, sample_time_s)?;
                self.with_noise(&own, own.clone(), sample_time_s)
            }
            None => {
                let held = intersample == Intersample::ZeroOrderHold;
                self.with_noise(&own, self.sampled(&own, sample_time_s, held)?, sample_time_s)
            }
        }
    }

    /// The noise enters at the samples, or between them as it does under any input.
    fn band_limited(&self, sample_time_s: f64) -> Result<Option<BandLimitedForm>, LtiError> {
        let own = self.system()?;
        if own.sample_time_s().is_some() || own.inputs() == 0 {
            return Ok(None);
        }
        let delays_s = self.structure.input_delays_s(&self.parameters);
        let system = sampled_with_courses(&own, sample_time_s)?;
        let innovations = self.with_noise(&own, system, sample_time_s)?;
        let delay = |j: usize| delays_s.get(j).map_or(0.0, |delay_s| delay_s / sample_time_s);
        Ok(Some(BandLimitedForm { innovations, courses: (0..own.inputs()).map(|j| (j, delay(j))).collect() }))
    }
}
