//! [`ProcessModel`]: gain, lags, zero and delay, the models of process control.

use serde::{Deserialize, Serialize};

use crate::error::{LtiError, check_delay, check_finite, check_shape};
use crate::polynomial::multiply;
use crate::transfer_function::TransferFunction;

/// Most lags, a complex pair counting as two.
const MOST_LAGS: usize = 3;

/// A continuous model of low order, written by its time constants:
///
/// `G(s) = K (1 + T_z s) / ((1 + T_p1 s)(1 + T_p2 s)(1 + T_p3 s)) · e^(−T_d s)`
///
/// with up to three lags; `1/s` in it where it integrates; and `1 + 2ζ T_w s + (T_w s)²` in place of two of the lags
/// for a pair of poles that may be complex, of natural frequency `1/T_w`. Times are in seconds. A negative time
/// constant or damping is an unstable pole; zero, no pole at all.
///
/// # Example
/// ```
/// let model = lti::ProcessModel::new(2.0)?.with_lags(vec![3.0])?.with_delay(0.5)?;
/// assert_eq!(model.parameter_names(), ["K", "Tp1", "Td"]);
/// assert_eq!(model.parameters(), [2.0, 3.0, 0.5]);
/// let g = model.with_parameters(&[4.0, 3.0, 0.0])?.to_transfer_function()?;
/// assert_eq!((g.num(), g.den(), g.delay_s()), (&[4.0][..], &[3.0, 1.0][..], 0.0));
/// # Ok::<(), lti::LtiError>(())
/// ```
///
/// # Source
/// Åström, K. J. and Hägglund, T. (2006), *Advanced PID Control*, ch. 2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Parts"))]
#[serde(try_from = "Parts", into = "Parts")]
pub struct ProcessModel(Parts);

/// The numbers, and what is read before it is checked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Parts {
    gain: f64,
    pair: Option<ProcessPair>,
    lags_s: Vec<f64>,
    zero_s: Option<f64>,
    delay_s: Option<f64>,
    integrates: bool,
}

/// Two poles as `1 + 2ζ T_w s + (T_w s)²`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProcessPair {
    /// `T_w`, one over the natural frequency, in seconds.
    pub time_constant_s: f64,
    /// `ζ`: below one in magnitude the poles are complex.
    pub damping: f64,
}

impl From<ProcessModel> for Parts {
    fn from(model: ProcessModel) -> Self {
        model.0
    }
}

impl TryFrom<Parts> for ProcessModel {
    type Error = LtiError;

    fn try_from(parts: Parts) -> Result<Self, LtiError> {
        let model = Self(parts);
        check_finite("process model", model.parameters().into_iter())?;
        model.0.delay_s.map_or(Ok(()), check_delay)?;
        match model.order() {
            order if order <= MOST_LAGS => Ok(model),
            order => Err(LtiError::Order { order, most: MOST_LAGS }),
        }
    }
}

impl ProcessModel {
    /// A mere gain, to which lags, a zero, a delay and an integrator are added.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`].
    pub fn new(gain: f64) -> Result<Self, LtiError> {
        Self::try_from(Parts { gain, pair: None, lags_s: Vec::new(), zero_s: None, delay_s: None, integrates: false })
    }

    /// The model with these lags, `T_p1` and on, in place of its own.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`]; [`LtiError::Order`] where there are more than three, a pair counting as two.
    pub fn with_lags(self, lags_s: Vec<f64>) -> Result<Self, LtiError> {
        Self::try_from(Parts { lags_s, ..self.0 })
    }

    /// The model with a pair of poles of time constant `T_w` and damping `ζ`.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`]; [`LtiError::Order`] where there is more than one lag beside it.
    pub fn with_pair(self, time_constant_s: f64, damping: f64) -> Result<Self, LtiError> {
        Self::try_from(Parts { pair: Some(ProcessPair { time_constant_s, damping }), ..self.0 })
    }

    /// The model with the zero `1 + T_z s`; a negative `T_z` puts it in the right half-plane.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`].
    pub fn with_zero(self, zero_s: f64) -> Result<Self, LtiError> {
        Self::try_from(Parts { zero_s: Some(zero_s), ..self.0 })
    }

    /// The model with a delay `T_d`; a delay of zero is a parameter too.
    ///
    /// # Errors
    /// [`LtiError::Delay`] for a negative one, [`LtiError::NonFinite`].
    pub fn with_delay(self, delay_s: f64) -> Result<Self, LtiError> {
        Self::try_from(Parts { delay_s: Some(delay_s), ..self.0 })
    }

    /// The model with `1/s` in it.
    #[must_use]
    pub fn with_integrator(self) -> Self {
        Self(Parts { integrates: true, ..self.0 })
    }

    /// `K`: the gain at rest, or for a model that integrates the output's rise a second.
    #[must_use]
    pub fn gain(&self) -> f64 {
        self.0.gain
    }

    /// The pair of poles, where the model has one.
    #[must_use]
    pub fn pair(&self) -> Option<ProcessPair> {
        self.0.pair
    }

    /// The lags `T_p`, in seconds.
    #[must_use]
    pub fn lags_s(&self) -> &[f64] {
        &self.0.lags_s
    }

    /// `T_z` in seconds, where the model has a zero.
    #[must_use]
    pub fn zero_s(&self) -> Option<f64> {
        self.0.zero_s
    }

    /// `T_d` in seconds, where the model has a delay.
    #[must_use]
    pub fn delay_s(&self) -> Option<f64> {
        self.0.delay_s
    }

    /// Returns true if `1/s` is in the model.
    #[must_use]
    pub fn integrates(&self) -> bool {
        self.0.integrates
    }

    /// Number of poles beside the integrator's.
    #[must_use]
    pub fn order(&self) -> usize {
        self.0.lags_s.len() + 2 * usize::from(self.0.pair.is_some())
    }

    /// The numbers that the structure leaves free: `K`, `T_w` and `ζ`, the lags, `T_z`, `T_d`, as far as it has them.
    #[must_use]
    pub fn parameters(&self) -> Vec<f64> {
        let parts = &self.0;
        let pair = parts.pair.into_iter().flat_map(|pair| [pair.time_constant_s, pair.damping]);
        let last = parts.zero_s.into_iter().chain(parts.delay_s);
        std::iter::once(parts.gain).chain(pair).chain(parts.lags_s.iter().copied()).chain(last).collect()
    }

    /// Names of the [`parameters`](Self::parameters): `K`, `Tw`, `zeta`, `Tp1` …, `Tz`, `Td`. Beside a pair, the lag is
    /// `Tp3`.
    #[must_use]
    pub fn parameter_names(&self) -> Vec<String> {
        let parts = &self.0;
        let before = 2 * usize::from(parts.pair.is_some());
        let mut names = vec!["K".to_owned()];
        if parts.pair.is_some() {
            names.extend(["Tw".to_owned(), "zeta".to_owned()]);
        }
        names.extend((0..parts.lags_s.len()).map(|i| format!("Tp{}", before + i + 1)));
        names.extend(parts.zero_s.map(|_| "Tz".to_owned()));
        names.extend(parts.delay_s.map(|_| "Td".to_owned()));
        names
    }

    /// The same structure with other numbers, in the order of [`parameters`](Self::parameters).
    ///
    /// # Errors
    /// [`LtiError::Shape`] for a wrong count, [`LtiError::NonFinite`], [`LtiError::Delay`] for a negative delay.
    pub fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        check_shape("parameters", (self.parameters().len(), 1), (parameters.len(), 1))?;
        let mut parts = self.0.clone();
        let pair = parts.pair.iter_mut().flat_map(|pair| [&mut pair.time_constant_s, &mut pair.damping]);
        let last = parts.zero_s.iter_mut().chain(&mut parts.delay_s);
        let slots = std::iter::once(&mut parts.gain).chain(pair).chain(&mut parts.lags_s).chain(last);
        for (slot, value) in slots.zip(parameters) {
            *slot = *value;
        }
        Self::try_from(parts)
    }

    /// The model as a continuous ratio of polynomials with its delay; the zero may make it improper.
    ///
    /// # Errors
    /// [`LtiError::NonFinite`] where a product of time constants overflows.
    pub fn to_transfer_function(&self) -> Result<TransferFunction, LtiError> {
        let parts = &self.0;
        let mut den = parts
            .pair
            .map_or(vec![1.0], |ProcessPair { time_constant_s: t, damping }| vec![t * t, 2.0 * damping * t, 1.0]);
        for lag in &parts.lags_s {
            den = multiply(&den, &[*lag, 1.0]);
        }
        if parts.integrates {
            den.push(0.0);
        }
        let num = vec![parts.gain * parts.zero_s.unwrap_or(0.0), parts.gain];
        TransferFunction::continuous(num, den)?.with_delay(parts.delay_s.unwrap_or(0.0))
    }
}
