//! [`ContinuousModel`]: continuous channels from every input to every output, with white noise on the outputs.

use faer::Mat;
use lti::{Innovations, LtiError, ProcessModel, StateSpace, TransferFunction, from_rows, to_rows};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::channel::{ContinuousChannel, Degrees};
use super::companion::Companion;
use crate::{BandLimitedForm, Intersample, LinearModel, Parametric};

/// Time constants are closer than this part where they count as equal.
const APART: f64 = 0.02;

/// A continuous transfer function by its coefficients:
///
/// `G(s) = (b_m s^m + … + b₀) / (s^n + a_{n−1} s^{n−1} + … + a₀) · e^{−s·delay}`.
///
/// Parameters are `b_m … b₀`, `a_{n−1} … a₀` and the delay in seconds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "RationalParts"))]
#[serde(try_from = "RationalParts")]
pub struct RationalChannel {
    num: Vec<f64>,
    den: Vec<f64>,
    delay_s: f64,
}

/// Fields of a channel as read, before they are checked.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct RationalParts {
    num: Vec<f64>,
    den: Vec<f64>,
    delay_s: f64,
}

impl TryFrom<RationalParts> for RationalChannel {
    type Error = LtiError;

    fn try_from(parts: RationalParts) -> Result<Self, LtiError> {
        RationalChannel::new(parts.num, parts.den, parts.delay_s)
    }
}

impl RationalChannel {
    /// The delay, s.
    pub(super) fn delay_s(&self) -> f64 {
        self.delay_s
    }

    /// From `b_m … b₀`, `a_{n−1} … a₀` (the leading one is not given) and a delay.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`], [`LtiError::Delay`]; [`LtiError::ZeroPolynomial`] without a numerator.
    pub fn new(num: Vec<f64>, den: Vec<f64>, delay_s: f64) -> Result<Self, LtiError> {
        if num.is_empty() {
            return Err(LtiError::ZeroPolynomial { what: "numerator" });
        }
        let channel = RationalChannel { num, den, delay_s };
        channel.transfer_function().map(|_| channel)
    }

    /// The transfer function in z where there is a sample time, of the same coefficients.
    pub(crate) fn on_clock(&self, sample_time_s: Option<f64>) -> Result<TransferFunction, LtiError> {
        let den = std::iter::once(1.0).chain(self.den.iter().copied()).collect();
        TransferFunction::new(self.num.clone(), den, sample_time_s)?.with_delay(self.delay_s)
    }
}

impl Parametric for RationalChannel {
    fn parameters(&self) -> Vec<f64> {
        self.num.iter().chain(&self.den).copied().chain([self.delay_s]).collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        let b = (0..self.num.len()).rev().map(|power| format!("b{power}"));
        let a = (0..self.den.len()).rev().map(|power| format!("a{power}"));
        b.chain(a).chain(["delay".to_owned()]).collect()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        let (m, n) = (self.num.len(), self.den.len());
        check_count(m + n + 1, parameters.len())?;
        Self::new(parameters[..m].to_vec(), parameters[m..m + n].to_vec(), parameters[m + n])
    }
}

impl ContinuousChannel for RationalChannel {
    fn degrees(&self) -> Degrees {
        Degrees { numerator: self.num.len() - 1, poles: self.den.len() }
    }

    fn delay_parameter(&self) -> Option<usize> {
        Some(self.num.len() + self.den.len())
    }

    fn transfer_function(&self) -> Result<TransferFunction, LtiError> {
        self.on_clock(None)
    }
}

impl Parametric for ProcessModel {
    fn parameters(&self) -> Vec<f64> {
        ProcessModel::parameters(self)
    }

    fn parameter_names(&self) -> Vec<String> {
        ProcessModel::parameter_names(self)
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        ProcessModel::with_parameters(self, parameters)
    }
}

impl ContinuousChannel for ProcessModel {
    fn degrees(&self) -> Degrees {
        let poles = self.order() + usize::from(self.integrates());
        Degrees { numerator: usize::from(self.zero_s().is_some()), poles }
    }

    fn delay_parameter(&self) -> Option<usize> {
        self.delay_s().map(|_| ProcessModel::parameters(self).len() - 1)
    }

    fn profiled_parameters(&self) -> Vec<usize> {
        (0..ProcessModel::parameters(self).len()).collect()
    }

    fn apart(&self) -> Option<Self> {
        let lags = self.lags_s();
        let mut order: Vec<usize> = (0..lags.len()).collect();
        order.sort_by(|i, j| lags[*j].total_cmp(&lags[*i]));
        let is_close = |pair: &[usize]| lags[pair[0]] < lags[pair[1]] * (1.0 + APART);
        if !order.windows(2).any(is_close) {
            return None;
        }
        let mut spread = lags.to_vec();
        for (place, i) in order.iter().enumerate() {
            spread[*i] *= 1.0 + APART * (0.5 * (lags.len() - 1) as f64 - place as f64);
        }
        let first = 1 + 2 * usize::from(self.pair().is_some());
        let mut parameters = ProcessModel::parameters(self);
        parameters[first..first + lags.len()].copy_from_slice(&spread);
        self.with_parameters(&parameters).ok()
    }

    fn transfer_function(&self) -> Result<TransferFunction, LtiError> {
        self.to_transfer_function()
    }
}

/// Outputs that are sums of continuous channels and of white noise:
///
/// `y_i(t_k) = Σ_j [G_ij u_j](t_k) + e_i(t_k)`, `Cov e = Λ`.
///
/// Parameters are those of the channels, output by output, and in each from the first input on. Under inputs that are
/// [`Intersample::BandLimited`] the outputs are those of the inputs' band-limited courses between the samples: right to
/// 1e-5 of the amplitude up to 0.4 of the sample rate, to some 1e-4 up to 0.45 of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(with = "ModelParts<C>", rename = "ContinuousModelOf{C}")
)]
#[serde(
    try_from = "ModelParts<C>",
    into = "ModelParts<C>",
    bound = "C: ContinuousChannel + Serialize + DeserializeOwned"
)]
pub struct ContinuousModel<C> {
    channels: Vec<C>,
    inputs: usize,
    noise_covariance: Mat<f64>,
}

/// How a model is written down.
#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ModelParts<C> {
    inputs: usize,
    channels: Vec<C>,
    noise_covariance: Vec<Vec<f64>>,
}

impl<C> From<ContinuousModel<C>> for ModelParts<C> {
    fn from(model: ContinuousModel<C>) -> Self {
        let noise_covariance = to_rows(model.noise_covariance.as_ref());
        ModelParts { inputs: model.inputs, channels: model.channels, noise_covariance }
    }
}

impl<C: ContinuousChannel> TryFrom<ModelParts<C>> for ContinuousModel<C> {
    type Error = LtiError;

    fn try_from(parts: ModelParts<C>) -> Result<Self, LtiError> {
        let outputs = parts.noise_covariance.len();
        let noise_covariance = from_rows("noise covariance", &parts.noise_covariance, outputs, outputs)?;
        Self::new(parts.channels, parts.inputs, noise_covariance)
    }
}

/// Continuous transfer functions given by coefficients.
pub type TransferFunctionModel = ContinuousModel<RationalChannel>;

/// Process models.
pub type ProcessSystem = ContinuousModel<ProcessModel>;

impl<C: ContinuousChannel> ContinuousModel<C> {
    /// From the channels of each output in turn, one an input, and the covariance of the noise, outputs × outputs.
    ///
    /// # Errors
    /// [`LtiError::Shape`] where there is not one channel for every input and output.
    pub fn new(channels: Vec<C>, inputs: usize, noise_covariance: Mat<f64>) -> Result<Self, LtiError> {
        let outputs = noise_covariance.nrows();
        let shape = (outputs, inputs);
        if channels.len() != outputs * inputs || noise_covariance.ncols() != outputs {
            return Err(LtiError::shape("channels", shape, (channels.len(), 1)));
        }
        Ok(ContinuousModel { channels, inputs, noise_covariance })
    }

    /// The channel from an input to an output.
    ///
    /// # Errors
    /// [`LtiError::Index`].
    pub fn channel(&self, output: usize, input: usize) -> Result<&C, LtiError> {
        let outputs = self.noise_covariance.nrows();
        for (what, index, count) in [("output", output, outputs), ("input", input, self.inputs)] {
            if index >= count {
                return Err(LtiError::Index { what, index, count });
            }
        }
        Ok(&self.channels[output * self.inputs + input])
    }

    /// The transfer function from an input to an output, delay included.
    ///
    /// # Errors
    /// [`LtiError::Index`], or parameters at which there is none.
    pub fn transfer_function(&self, output: usize, input: usize) -> Result<TransferFunction, LtiError> {
        self.channel(output, input)?.transfer_function()
    }

    /// `Λ`, outputs × outputs.
    pub fn noise_covariance(&self) -> faer::MatRef<'_, f64> {
        self.noise_covariance.as_ref()
    }

    /// The continuous system of all channels, their delays left out.
    ///
    /// # Errors
    /// A channel whose numerator has the higher degree, or parameters at which there is none.
    pub fn without_delays(&self) -> Result<StateSpace, LtiError> {
        let channel = |c: &C| c.transfer_function()?.with_delay(0.0)?.to_state_space();
        let parts: Vec<StateSpace> = self.channels.iter().map(channel).collect::<Result<_, LtiError>>()?;
        assemble(&parts, self.inputs, |index| index % self.inputs, self.noise_covariance.nrows(), None)
    }

    /// One channel after another, and where the parameters of each begin.
    pub(crate) fn offsets(&self) -> Vec<usize> {
        let mut next = 0;
        let mut begin = |c: &C| {
            next += c.parameters().len();
            next - c.parameters().len()
        };
        self.channels.iter().map(&mut begin).collect()
    }

    pub(crate) fn channels(&self) -> &[C] {
        &self.channels
    }
}

impl<C: ContinuousChannel> Parametric for ContinuousModel<C> {
    fn parameters(&self) -> Vec<f64> {
        self.channels.iter().flat_map(C::parameters).collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        let outputs = self.noise_covariance.nrows();
        let label = |i: usize| match (outputs > 1, self.inputs > 1) {
            (true, _) => format!("[{},{}]", i / self.inputs + 1, i % self.inputs + 1),
            (false, true) => format!("[{}]", i + 1),
            (false, false) => String::new(),
        };
        let named = |(i, c): (usize, &C)| c.parameter_names().into_iter().map(move |n| n + &label(i));
        self.channels.iter().enumerate().flat_map(named).collect()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        check_count(self.parameters().len(), parameters.len())?;
        let mut rest = parameters;
        let mut channels = Vec::with_capacity(self.channels.len());
        for channel in &self.channels {
            let (own, others) = rest.split_at(channel.parameters().len());
            channels.push(channel.with_parameters(own)?);
            rest = others;
        }
        Ok(ContinuousModel { channels, ..self.clone() })
    }
}

impl<C: ContinuousChannel> LinearModel for ContinuousModel<C> {
    fn inputs(&self) -> usize {
        self.inputs
    }

    fn outputs(&self) -> usize {
        self.noise_covariance.nrows()
    }

    fn innovations(&self, sample_time_s: f64, intersample: Intersample) -> Result<Innovations, LtiError> {
        let sampled: Vec<StateSpace> = self
            .channels
            .iter()
            .map(|c| Companion::new(c, sample_time_s)?.to_state_space(sample_time_s, intersample))
            .collect::<Result<_, LtiError>>()?;
        let system = assemble(&sampled, self.inputs, |index| index % self.inputs, self.outputs(), Some(sample_time_s))?;
        Innovations::output_error(system, self.noise_covariance.clone())
    }

    /// One course a channel.
    fn band_limited(&self, sample_time_s: f64) -> Result<Option<BandLimitedForm>, LtiError> {
        if self.channels.is_empty() {
            return Ok(None);
        }
        let companions: Vec<Companion> =
            self.channels.iter().map(|c| Companion::new(c, sample_time_s)).collect::<Result<_, LtiError>>()?;
        let sampled: Vec<StateSpace> =
            companions.iter().map(|c| c.band_limited(sample_time_s)).collect::<Result<_, LtiError>>()?;
        let columns = sampled.iter().map(StateSpace::inputs).sum();
        let first_column = |index| index * columns / sampled.len();
        let system = assemble(&sampled, columns, first_column, self.outputs(), Some(sample_time_s))?;
        let innovations = Innovations::output_error(system, self.noise_covariance.clone())?;
        let courses = companions.iter().enumerate().map(|(i, c)| (i % self.inputs, c.delay())).collect();
        Ok(Some(BandLimitedForm { innovations, courses }))
    }
}

/// One system of all channels, output by output, their states one after the other. Each finds its inputs from the
/// column on that `first_column` gives for it.
fn assemble(
    parts: &[StateSpace],
    inputs: usize,
    first_column: impl Fn(usize) -> usize,
    outputs: usize,
    sample_time_s: Option<f64>,
) -> Result<StateSpace, LtiError> {
    let n = parts.iter().map(StateSpace::states).sum();
    let (mut a, mut b) = (Mat::zeros(n, n), Mat::zeros(n, inputs));
    let (mut c, mut d) = (Mat::zeros(outputs, n), Mat::zeros(outputs, inputs));
    let mut first = 0;
    for (index, part) in parts.iter().enumerate() {
        let (output, column, states) = (index * outputs / parts.len(), first_column(index), part.states());
        a.submatrix_mut(first, first, states, states).copy_from(part.a());
        b.submatrix_mut(first, column, states, part.inputs()).copy_from(part.b());
        c.submatrix_mut(output, first, 1, states).copy_from(part.c());
        d.submatrix_mut(output, column, 1, part.inputs()).copy_from(part.d());
        first += states;
    }
    StateSpace::new(a, b, c, d, sample_time_s)
}

fn check_count(expected: usize, found: usize) -> Result<(), LtiError> {
    if expected == found {
        return Ok(());
    }
    Err(LtiError::shape("parameters", (expected, 1), (found, 1)))
}
