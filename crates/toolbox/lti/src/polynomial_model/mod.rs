//! [`PolynomialModel`]: ARX, ARMAX, output error, Box–Jenkins and everything between.

mod realise;

use faer::{Mat, MatRef};
use serde::{Deserialize, Serialize};

use crate::error::{LtiError, check_finite, check_sample_time, check_shape};
use crate::matrix::{from_rows, to_rows};

/// The equation of one output `i`:
///
/// `Σ_j A_j(q) y_j(t) = Σ_k B_k(q)/F_k(q) u_k(t) + C(q)/D(q) e(t)`
///
/// with polynomials in the backward shift `q⁻¹`, lowest power first. The leading ones of `A_i`, `C`, `D`, `F_k` and the
/// leading zeros of `B_k` (its delay `nk`) are not stored, so every number stored is a parameter:
///
/// | field | polynomial |
/// | --- | --- |
/// | `a[i]` = a₁ … | 1 + a₁ q⁻¹ + … for the output itself; a₁ q⁻¹ + … for another output |
/// | `b[k]` = b₀ …, `nk[k]` | q^(−nk) (b₀ + b₁ q⁻¹ + …) |
/// | `c` = c₁ …, `d`, `f[k]` | 1 + c₁ q⁻¹ + … |
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PolynomialEquation {
    /// One list an output.
    pub a: Vec<Vec<f64>>,
    /// One list an input.
    pub b: Vec<Vec<f64>>,
    /// Delay from each input, in samples.
    pub nk: Vec<usize>,
    /// Numerator of the noise model.
    pub c: Vec<f64>,
    /// Denominator of the noise model.
    pub d: Vec<f64>,
    /// One list an input.
    pub f: Vec<Vec<f64>>,
}

impl PolynomialEquation {
    /// Every coefficient, in the order a, b, c, d, f, each from its first output or input on.
    pub fn coefficients(&self) -> impl Iterator<Item = f64> + '_ {
        let (a, b, f) = (self.a.iter().flatten(), self.b.iter().flatten(), self.f.iter().flatten());
        a.chain(b).chain(&self.c).chain(&self.d).chain(f).copied()
    }

    /// The coefficients again, to be changed, in the same order.
    pub fn coefficients_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        let (a, b, f) = (self.a.iter_mut().flatten(), self.b.iter_mut().flatten(), self.f.iter_mut().flatten());
        a.chain(b).chain(&mut self.c).chain(&mut self.d).chain(f)
    }
}

/// A discrete model of polynomials in `q⁻¹`, one [`PolynomialEquation`] an output.
///
/// # Example
/// ```
/// // y(t) − 0.5 y(t−1) = 2 u(t−1) + e(t)
/// let model = lti::PolynomialModel::siso(0.1, 1, lti::PolynomialEquation {
///     a: vec![vec![-0.5]], b: vec![vec![2.0]], ..Default::default()
/// })?;
/// let h = model.transfer_function(0, 0)?;
/// assert_eq!(h.dc_gain(), 4.0);
/// # Ok::<(), lti::LtiError>(())
/// ```
///
/// # Source
/// Ljung, *System Identification*, 2nd ed., 1999, (4.33).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Parts"))]
#[serde(try_from = "Parts", into = "Parts")]
pub struct PolynomialModel {
    equations: Vec<PolynomialEquation>,
    noise_covariance: Mat<f64>,
    sample_time_s: f64,
}

#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Parts {
    equations: Vec<PolynomialEquation>,
    noise_covariance: Vec<Vec<f64>>,
    sample_time_s: f64,
}

impl From<PolynomialModel> for Parts {
    fn from(whole: PolynomialModel) -> Self {
        let noise_covariance = to_rows(whole.noise_covariance.as_ref());
        Self { equations: whole.equations, noise_covariance, sample_time_s: whole.sample_time_s }
    }
}

impl TryFrom<Parts> for PolynomialModel {
    type Error = LtiError;

    fn try_from(parts: Parts) -> Result<Self, LtiError> {
        let outputs = parts.equations.len();
        let noise_covariance = from_rows("noise covariance", &parts.noise_covariance, outputs, outputs)?;
        Self::new(parts.sample_time_s, parts.equations, noise_covariance)
    }
}

impl PolynomialModel {
    /// A model from one equation an output and the covariance of the noise `e`, outputs × outputs.
    ///
    /// # Errors
    /// [`LtiError::Shape`] where an equation does not have one `a` an output, or one `b`, `nk` and `f` an input;
    /// [`LtiError::NonFinite`], [`LtiError::SampleTime`].
    pub fn new(
        sample_time_s: f64,
        equations: Vec<PolynomialEquation>,
        noise_covariance: Mat<f64>,
    ) -> Result<Self, LtiError> {
        check_sample_time(sample_time_s)?;
        let outputs = equations.len();
        let inputs = equations.first().map_or(0, |e| e.b.len());
        check_shape("noise covariance", (outputs, outputs), noise_covariance.shape())?;
        for e in &equations {
            check_shape("A of an equation", (outputs, 1), (e.a.len(), 1))?;
            check_shape("B of an equation", (inputs, 1), (e.b.len(), 1))?;
            check_shape("F of an equation", (inputs, 1), (e.f.len(), 1))?;
            check_shape("nk of an equation", (inputs, 1), (e.nk.len(), 1))?;
            check_finite("equation", e.coefficients())?;
        }
        Ok(Self { equations, noise_covariance, sample_time_s })
    }

    /// A model of one input and one output with noise of variance one; empty lists stand for absent polynomials.
    ///
    /// # Errors
    /// Those of [`PolynomialModel::new`].
    pub fn siso(sample_time_s: f64, nk: usize, equation: PolynomialEquation) -> Result<Self, LtiError> {
        let or_empty = |lists: Vec<Vec<f64>>| if lists.is_empty() { vec![Vec::new()] } else { lists };
        let PolynomialEquation { a, b, c, d, f, .. } = equation;
        let equation = PolynomialEquation { a: or_empty(a), b: or_empty(b), nk: vec![nk], c, d, f: or_empty(f) };
        Self::new(sample_time_s, vec![equation], Mat::full(1, 1, 1.0))
    }

    /// The same model with this noise covariance, outputs × outputs.
    ///
    /// # Errors
    /// [`LtiError::Shape`].
    pub fn with_noise_covariance(self, noise_covariance: Mat<f64>) -> Result<Self, LtiError> {
        Self::new(self.sample_time_s, self.equations, noise_covariance)
    }

    /// The same structure with other coefficients, in the order of [`PolynomialEquation::coefficients`], equation by
    /// equation.
    ///
    /// # Errors
    /// [`LtiError::Shape`], [`LtiError::NonFinite`].
    pub fn with_coefficients(&self, coefficients: &[f64]) -> Result<Self, LtiError> {
        let count = self.coefficients().len();
        check_shape("coefficients", (count, 1), (coefficients.len(), 1))?;
        let mut model = self.clone();
        let slots = model.equations.iter_mut().flat_map(PolynomialEquation::coefficients_mut);
        for (slot, value) in slots.zip(coefficients) {
            *slot = *value;
        }
        check_finite("coefficients", coefficients.iter().copied())?;
        Ok(model)
    }

    /// Every coefficient, equation by equation.
    #[must_use]
    pub fn coefficients(&self) -> Vec<f64> {
        self.equations.iter().flat_map(PolynomialEquation::coefficients).collect()
    }

    /// Names of the coefficients: `a1`, `b0`, `c1`, `d1`, `f1`, with the channel behind it where there are several
    /// (`b0[2]`: input 2; `a1[1,2]`: equation 1, output 2). The digit is the power of `q⁻¹`, so `b` starts at its
    /// delay.
    #[must_use]
    pub fn coefficient_names(&self) -> Vec<String> {
        let several_outputs = self.equations.len() > 1;
        let mut names = Vec::new();
        for (i, e) in self.equations.iter().enumerate() {
            let label = |channel: Option<(usize, usize)>| match (several_outputs, channel) {
                (false, Some((k, count))) if count > 1 => format!("[{}]", k + 1),
                (true, Some((k, _))) => format!("[{},{}]", i + 1, k + 1),
                (true, None) => format!("[{}]", i + 1),
                (false, _) => String::new(),
            };
            let mut push = |letter: char, first: usize, count: usize, channel| {
                names.extend((first..first + count).map(|power| format!("{letter}{power}{}", label(channel))));
            };
            e.a.iter().enumerate().for_each(|(j, a)| push('a', 1, a.len(), Some((j, e.a.len()))));
            e.b.iter().enumerate().for_each(|(k, b)| push('b', e.nk[k], b.len(), Some((k, e.b.len()))));
            push('c', 1, e.c.len(), None);
            push('d', 1, e.d.len(), None);
            e.f.iter().enumerate().for_each(|(k, f)| push('f', 1, f.len(), Some((k, e.f.len()))));
        }
        names
    }

    /// The equations, one an output.
    #[must_use]
    pub fn equations(&self) -> &[PolynomialEquation] {
        &self.equations
    }

    /// The covariance of `e`, outputs × outputs.
    #[must_use]
    pub fn noise_covariance(&self) -> MatRef<'_, f64> {
        self.noise_covariance.as_ref()
    }

    /// The sample time, in seconds.
    #[must_use]
    pub fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.equations.len()
    }

    /// Number of inputs.
    #[must_use]
    pub fn inputs(&self) -> usize {
        self.equations.first().map_or(0, |e| e.b.len())
    }
}
