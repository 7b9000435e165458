//! How an iteration ended.

use std::fmt;

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Termination {
    /// Solved at once, without a search.
    Direct,
    /// The step became negligible.
    SmallStep,
    /// The cost can no longer fall noticeably.
    SmallDecrease,
    /// No damping makes the cost fall: as good as the arithmetic allows.
    NoDescent,
    /// The cost would fall further where there is no model, such as beyond the edge of stability.
    Edge,
    /// The iteration limit was reached first.
    IterationLimit,
}

impl Termination {
    /// Returns true if the iteration reached a minimum.
    pub fn converged(self) -> bool {
        !matches!(self, Termination::Edge | Termination::IterationLimit)
    }
}

impl fmt::Display for Termination {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Termination::Direct => "solved directly",
            Termination::SmallStep => "converged, the steps became negligible",
            Termination::SmallDecrease => "converged, the errors no longer fall",
            Termination::NoDescent => "converged as far as the arithmetic allows",
            Termination::Edge => "stopped at the edge of the models that exist",
            Termination::IterationLimit => "stopped at the limit of iterations",
        })
    }
}
