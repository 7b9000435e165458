//! How an iteration ended.

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
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
