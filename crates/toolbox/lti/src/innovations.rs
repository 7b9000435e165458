//! [`Innovations`]: a system together with the noise that moves it.

use faer::{Mat, MatRef};
use serde::{Deserialize, Serialize};

use crate::error::{LtiError, check_shape};
use crate::matrix::check_matrix;
use crate::matrix::from_rows;
use crate::state_space::StateSpace;

/// A discrete system with its disturbance, in innovations form:
///
/// `x(t+1) = A x(t) + B u(t) + K e(t)`, `y(t) = C x(t) + D u(t) + e(t)`, `Cov e = Λ`.
///
/// `K` is states × outputs, `Λ` outputs × outputs. `K = 0` makes it an output-error model. Every linear model that is
/// estimated from sampled data has this form; prediction and simulation are written for it alone.
///
/// # Source
/// Ljung, *System Identification*, 2nd ed., 1999, (4.91).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "Parts"))]
#[serde(try_from = "Parts", into = "Parts")]
pub struct Innovations {
    system: StateSpace,
    k: Mat<f64>,
    noise_covariance: Mat<f64>,
}

#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Parts {
    system: StateSpace,
    k: Vec<Vec<f64>>,
    noise_covariance: Vec<Vec<f64>>,
}

impl From<Innovations> for Parts {
    fn from(whole: Innovations) -> Self {
        let Innovations { system, k, noise_covariance } = whole;
        Self {
            system,
            k: crate::matrix::to_rows(k.as_ref()),
            noise_covariance: crate::matrix::to_rows(noise_covariance.as_ref()),
        }
    }
}

impl TryFrom<Parts> for Innovations {
    type Error = LtiError;

    fn try_from(parts: Parts) -> Result<Self, LtiError> {
        let (n, outputs) = (parts.system.states(), parts.system.outputs());
        let k = from_rows("K", &parts.k, n, outputs)?;
        let noise_covariance = from_rows("noise covariance", &parts.noise_covariance, outputs, outputs)?;
        Self::new(parts.system, k, noise_covariance)
    }
}

impl Innovations {
    /// A discrete `system` with the noise gain `k` (states × outputs) and the covariance of its innovations.
    ///
    /// # Errors
    /// [`LtiError::NotDiscrete`], [`LtiError::Shape`], [`LtiError::NonFinite`].
    pub fn new(system: StateSpace, k: Mat<f64>, noise_covariance: Mat<f64>) -> Result<Self, LtiError> {
        if system.sample_time_s().is_none() {
            return Err(LtiError::NotDiscrete);
        }
        let outputs = system.outputs();
        check_shape("K", (system.states(), outputs), k.shape())?;
        check_shape("noise covariance", (outputs, outputs), noise_covariance.shape())?;
        check_matrix("K", k.as_ref())?;
        check_matrix("noise covariance", noise_covariance.as_ref())?;
        Ok(Self { system, k, noise_covariance })
    }

    /// An output-error model: white noise of this covariance on the outputs, none in the states.
    ///
    /// # Errors
    /// Those of [`Innovations::new`].
    pub fn output_error(system: StateSpace, noise_covariance: Mat<f64>) -> Result<Self, LtiError> {
        let k = Mat::zeros(system.states(), system.outputs());
        Self::new(system, k, noise_covariance)
    }

    /// The way from `u` to `y`: `A`, `B`, `C`, `D`.
    #[must_use]
    pub fn system(&self) -> &StateSpace {
        &self.system
    }

    /// The noise gain `K`, states × outputs.
    #[must_use]
    pub fn k(&self) -> MatRef<'_, f64> {
        self.k.as_ref()
    }

    /// `Λ`, the covariance of `e(t)`, outputs × outputs.
    #[must_use]
    pub fn noise_covariance(&self) -> MatRef<'_, f64> {
        self.noise_covariance.as_ref()
    }

    /// The way from `e` to `y`: `A`, `K`, `C`, `I`.
    ///
    /// # Errors
    /// None for a system that was checked; the type is that of [`StateSpace::new`].
    pub fn noise_system(&self) -> Result<StateSpace, LtiError> {
        let outputs = self.system.outputs();
        StateSpace::new(
            self.system.a().to_owned(),
            self.k.clone(),
            self.system.c().to_owned(),
            Mat::identity(outputs, outputs),
            self.system.sample_time_s(),
        )
    }

    /// The one-step predictor, from `[u; y]` to `ŷ(t | t−1)`: `A − K C`, `[B − K D, K]`, `C`, `[D, 0]`.
    ///
    /// # Errors
    /// None for a system that was checked; the type is that of [`StateSpace::new`].
    pub fn predictor(&self) -> Result<StateSpace, LtiError> {
        let (n, inputs, outputs) = (self.system.states(), self.system.inputs(), self.system.outputs());
        let a = self.system.a() - &self.k * self.system.c();
        let from_input = self.system.b() - &self.k * self.system.d();
        let b =
            Mat::from_fn(
                n,
                inputs + outputs,
                |i, j| {
                    if j < inputs { from_input[(i, j)] } else { self.k[(i, j - inputs)] }
                },
            );
        let d = Mat::from_fn(outputs, inputs + outputs, |i, j| if j < inputs { self.system.d()[(i, j)] } else { 0.0 });
        StateSpace::new(a, b, self.system.c().to_owned(), d, self.system.sample_time_s())
    }
}
