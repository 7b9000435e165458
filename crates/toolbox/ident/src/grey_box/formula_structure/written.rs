//! How a structure of formulas is written down.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{FormulaParts, FormulaStructure};
use crate::grey_box::{Formula, GreyParameter};
use crate::{Bounds, IdentError};

#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Written {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sample_time_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    input_delays_s: Vec<Formula>,
    #[cfg_attr(feature = "schema", schemars(with = "std::collections::BTreeMap<String, Parameter>"))]
    #[serde(with = "in_order")]
    parameters: Vec<(String, Parameter)>,
    matrices: Matrices,
    #[cfg_attr(feature = "schema", schemars(with = "std::collections::BTreeMap<String, Formula>"))]
    #[serde(default, with = "in_order", skip_serializing_if = "Vec::is_empty")]
    derived: Vec<(String, Formula)>,
}

#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Parameter {
    value: f64,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    fixed: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    min: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    max: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    prior: Option<Prior>,
}

#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Prior {
    mean: f64,
    sd: f64,
}

#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
struct Matrices {
    #[serde(rename = "A")]
    a: Vec<Vec<Formula>>,
    #[serde(rename = "B")]
    b: Vec<Vec<Formula>>,
    #[serde(rename = "C")]
    c: Vec<Vec<Formula>>,
    #[serde(rename = "D", default, skip_serializing_if = "Vec::is_empty")]
    d: Vec<Vec<Formula>>,
    #[serde(rename = "K", default, skip_serializing_if = "Vec::is_empty")]
    k: Vec<Vec<Formula>>,
}

impl From<(String, Parameter)> for GreyParameter {
    fn from((name, written): (String, Parameter)) -> Self {
        let Parameter { value, fixed, min, max, prior } = written;
        let bounds = Bounds::new(min.unwrap_or(f64::NEG_INFINITY), max.unwrap_or(f64::INFINITY));
        GreyParameter { name, value, fixed, bounds, prior: prior.map(|Prior { mean, sd }| (mean, sd)) }
    }
}

impl From<GreyParameter> for (String, Parameter) {
    fn from(parameter: GreyParameter) -> Self {
        let GreyParameter { name, value, fixed, bounds, prior } = parameter;
        let finite = |bound: f64| bound.is_finite().then_some(bound);
        let prior = prior.map(|(mean, sd)| Prior { mean, sd });
        (name, Parameter { value, fixed, min: finite(bounds.lower), max: finite(bounds.upper), prior })
    }
}

impl Serialize for FormulaStructure {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Written::from(self.clone()).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for FormulaStructure {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::try_from(Written::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

impl TryFrom<Written> for FormulaStructure {
    type Error = IdentError;

    fn try_from(written: Written) -> Result<Self, IdentError> {
        let Written { sample_time_s, input_delays_s, parameters, matrices, derived } = written;
        let Matrices { a, b, c, d, k } = matrices;
        let parameters = parameters.into_iter().map(Into::into).collect();
        FormulaStructure::new(FormulaParts { parameters, a, b, c, d, k, sample_time_s, input_delays_s, derived })
    }
}

impl From<FormulaStructure> for Written {
    fn from(structure: FormulaStructure) -> Self {
        let FormulaParts { parameters, a, b, c, d, k, sample_time_s, input_delays_s, derived } = structure.parts();
        let parameters = parameters.into_iter().map(Into::into).collect();
        Written { sample_time_s, input_delays_s, parameters, matrices: Matrices { a, b, c, d, k }, derived }
    }
}

/// A table whose entries keep the order in which they are written.
mod in_order {
    use std::fmt;
    use std::marker::PhantomData;

    use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
    use serde::{Serialize, Serializer};

    pub(super) fn serialize<S: Serializer, V: Serialize>(pairs: &[(String, V)], to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(pairs.iter().map(|(name, value)| (name, value)))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>, V: Deserialize<'de>>(
        from: D,
    ) -> Result<Vec<(String, V)>, D::Error> {
        from.deserialize_map(Pairs(PhantomData))
    }

    struct Pairs<V>(PhantomData<V>);

    impl<'de, V: Deserialize<'de>> Visitor<'de> for Pairs<V> {
        type Value = Vec<(String, V)>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a table")
        }

        fn visit_map<M: MapAccess<'de>>(self, mut map: M) -> Result<Self::Value, M::Error> {
            let mut pairs = Vec::new();
            while let Some(pair) = map.next_entry()? {
                pairs.push(pair);
            }
            Ok(pairs)
        }
    }
}
