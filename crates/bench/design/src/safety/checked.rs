//! Result of a check of an experiment.

use numerics::null::infinite_if_null;
use numerics::order;
use serde::{Deserialize, Serialize};
use signal::proportion::Proportion;

use super::quantity::Quantity;
use super::verdict::Safety;

/// One quantity over all benches drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Checked {
    /// The quantity.
    pub of: Quantity,
    /// The limit stated, SI.
    pub limit: Option<f64>,
    /// Its value on every bench, SI, growing; infinite where a bench is not stable.
    #[serde(deserialize_with = "infinite_if_null")]
    pub values: Vec<f64>,
    /// How often the limit is reached; `None` without one.
    pub reached: Option<Proportion>,
    /// The value on the worst bench, SI.
    #[serde(deserialize_with = "infinite_if_null")]
    pub worst: f64,
    /// Resonance of that bench in torque control, Hz; `None` without a shaft.
    pub worst_resonance_hz: Option<f64>,
}

impl Checked {
    /// The value that a bench stays below with a probability, SI.
    pub fn quantile(&self, probability: f64) -> f64 {
        order::quantile_of_sorted(&self.values, probability).unwrap_or(f64::NAN)
    }

    /// Verdict of its limit alone.
    pub fn safety(&self) -> Safety {
        self.reached.map_or(Safety::NotChecked, Safety::against)
    }
}

/// The verdict of all limits together, by how many benches reach any of them or are not stable.
pub(crate) fn overall(checked: &[Checked], any: Proportion) -> Safety {
    let is_stated = checked.iter().any(|one| one.reached.is_some());
    if !is_stated && any.count == 0 { Safety::NotChecked } else { Safety::against(any) }
}
