//! [`AnyModel`]: every kind of model behind one type.

use lti::text::Written;
use lti::{FrequencyResponse, Innovations, LtiError, PolynomialModel, StateSpace};
use serde::{Deserialize, Serialize};

use crate::uncertainty::{Dynamics, Ratio};
use crate::{BandLimitedForm, FormulaStructure, GreyBoxModel, Intersample, LinearModel, Parametric};
use crate::{ProcessSystem, StateSpaceModel, TransferFunctionModel};

/// A model of any kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", content = "value", rename_all = "snake_case")]
#[expect(clippy::large_enum_variant, reason = "models are held one by one, never in bulk")]
pub enum AnyModel {
    /// ARX, ARMAX, output error, Box–Jenkins and everything between.
    Polynomial(PolynomialModel),
    /// State space in innovations form, with every entry a parameter.
    StateSpace(StateSpaceModel),
    /// Continuous transfer functions.
    TransferFunction(TransferFunctionModel),
    /// Process models.
    Process(ProcessSystem),
    /// State space whose entries are formulas of physical parameters.
    GreyBox(GreyBoxModel<FormulaStructure>),
}

/// Does the same with whatever model there is.
macro_rules! each {
    ($model:expr, $inner:ident => $body:expr) => {
        match $model {
            AnyModel::Polynomial($inner) => $body,
            AnyModel::StateSpace($inner) => $body,
            AnyModel::TransferFunction($inner) => $body,
            AnyModel::Process($inner) => $body,
            AnyModel::GreyBox($inner) => $body,
        }
    };
}

impl Parametric for AnyModel {
    fn parameters(&self) -> Vec<f64> {
        each!(self, m => Parametric::parameters(m))
    }

    fn parameter_names(&self) -> Vec<String> {
        each!(self, m => Parametric::parameter_names(m))
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        each!(self, m => Parametric::with_parameters(m, parameters).map(Into::into))
    }
}

impl Written for AnyModel {
    fn written(&self, standard_errors: Option<&[f64]>) -> String {
        each!(self, m => Written::written(m, standard_errors))
    }
}

impl LinearModel for AnyModel {
    fn inputs(&self) -> usize {
        each!(self, m => LinearModel::inputs(m))
    }

    fn outputs(&self) -> usize {
        each!(self, m => LinearModel::outputs(m))
    }

    fn innovations(&self, sample_time_s: f64, intersample: Intersample) -> Result<Innovations, LtiError> {
        each!(self, m => LinearModel::innovations(m, sample_time_s, intersample))
    }

    fn band_limited(&self, sample_time_s: f64) -> Result<Option<BandLimitedForm>, LtiError> {
        each!(self, m => LinearModel::band_limited(m, sample_time_s))
    }
}

impl Dynamics for AnyModel {
    fn system(&self) -> Result<StateSpace, LtiError> {
        each!(self, m => Dynamics::system(m))
    }

    fn delay_s(&self, output: usize, input: usize) -> Result<f64, LtiError> {
        each!(self, m => Dynamics::delay_s(m, output, input))
    }

    fn polynomials(&self, output: usize, input: usize) -> Result<Option<Ratio>, LtiError> {
        each!(self, m => Dynamics::polynomials(m, output, input))
    }

    fn frequency_response(
        &self,
        output: usize,
        input: usize,
        omega_rad_s: &[f64],
    ) -> Result<FrequencyResponse, LtiError> {
        each!(self, m => Dynamics::frequency_response(m, output, input, omega_rad_s))
    }
}

impl From<PolynomialModel> for AnyModel {
    fn from(model: PolynomialModel) -> Self {
        AnyModel::Polynomial(model)
    }
}

impl From<StateSpaceModel> for AnyModel {
    fn from(model: StateSpaceModel) -> Self {
        AnyModel::StateSpace(model)
    }
}

impl From<TransferFunctionModel> for AnyModel {
    fn from(model: TransferFunctionModel) -> Self {
        AnyModel::TransferFunction(model)
    }
}

impl From<ProcessSystem> for AnyModel {
    fn from(model: ProcessSystem) -> Self {
        AnyModel::Process(model)
    }
}

impl From<GreyBoxModel<FormulaStructure>> for AnyModel {
    fn from(model: GreyBoxModel<FormulaStructure>) -> Self {
        AnyModel::GreyBox(model)
    }
}
