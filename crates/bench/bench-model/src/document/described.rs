//! The numbers of a model for people: symbol, name, unit, standard error.

use serde::{Deserialize, Serialize};

use crate::model::{BenchModel, ModelParameter, ModelUncertainty};

/// One number of the model, in SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DescribedParameter {
    /// Which number.
    pub parameter: ModelParameter,
    /// Symbol of the thesis; the two delays have one of their own each.
    pub symbol: String,
    /// Name of the parameter.
    pub name: String,
    /// Its value, in this unit.
    pub value: f64,
    /// SI unit.
    pub unit: String,
    /// Standard error; null for a number that is taken as exact.
    pub standard_error: Option<f64>,
    /// Degrees of freedom behind the standard error; null where they are infinite, or there is none.
    pub degrees_of_freedom: Option<f64>,
    /// 95 % interval of the study. It may be wider than the standard error says, by what the recordings leave open:
    /// where a delay acts, or estimates that contradict each other. Null where the study has none.
    #[serde(default)]
    pub interval_95: Option<(f64, f64)>,
}

/// All numbers that the model has.
pub(super) fn all(model: &BenchModel, uncertainty: &ModelUncertainty) -> Vec<DescribedParameter> {
    let described = |parameter: ModelParameter| {
        let notation = parameter.quantity().notation();
        let known = uncertainty.standard_error(parameter);
        Some(DescribedParameter {
            parameter,
            symbol: parameter.distinct_symbol().to_owned(),
            name: notation.name.to_owned(),
            value: model.value(parameter)?,
            unit: notation.si_unit.to_owned(),
            standard_error: known.map(|(error, _)| error),
            degrees_of_freedom: known.map(|(_, degrees)| degrees).filter(|degrees| degrees.is_finite()),
            interval_95: None,
        })
    };
    ModelParameter::ALL.into_iter().filter_map(described).collect()
}
