//! What a check of an experiment gives.

use numerics::order;
use serde::Serialize;

use super::quantity::Quantity;
use super::verdict::Proportion;
use super::verdict::Safety;

/// One quantity over all benches drawn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Checked {
    /// What it is.
    pub of: Quantity,
    /// The limit stated, SI.
    pub limit: Option<f64>,
    /// Its value on every bench, SI, growing; infinite where a bench is not stable.
    pub values: Vec<f64>,
    /// How often the limit is reached; `None` without one.
    pub reached: Option<Proportion>,
    /// The value on the worst bench, SI.
    pub worst: f64,
    /// Resonance of that bench in torque control, Hz; `None` without a shaft.
    pub worst_resonance_hz: Option<f64>,
}

impl Checked {
    /// The value that a share of the benches stays below, SI (linear between them).
    pub fn quantile(&self, probability: f64) -> f64 {
        order::quantile_of_sorted(&self.values, probability).unwrap_or(f64::NAN)
    }

    /// Verdict of its limit alone.
    pub fn safety(&self) -> Safety {
        self.reached.map_or(Safety::NotChecked, |reached| reached.safety())
    }
}

/// The worst of all verdicts; benches that are not stable count as a limit reached.
pub(crate) fn overall(checked: &[Checked], unstable: Proportion) -> Safety {
    let mut stated: Vec<Safety> =
        checked.iter().map(Checked::safety).filter(|safety| *safety != Safety::NotChecked).collect();
    if stated.is_empty() && unstable.count == 0 {
        return Safety::NotChecked;
    }
    stated.push(unstable.safety());
    let has = |safety: Safety| stated.contains(&safety);
    match (has(Safety::Unsafe), has(Safety::Risky)) {
        (true, _) => Safety::Unsafe,
        (false, true) => Safety::Risky,
        (false, false) => Safety::Safe,
    }
}
