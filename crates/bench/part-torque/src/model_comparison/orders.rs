//! The orders that black boxes are tried with.

use serde::{Deserialize, Serialize};

/// Which orders are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OrdersTried {
    /// Poles and coefficients of B: from one to this many.
    pub highest: usize,
    /// Delays: from none to this many samples.
    pub longest_delay: usize,
}

impl Default for OrdersTried {
    fn default() -> Self {
        OrdersTried { highest: 6, longest_delay: 4 }
    }
}

/// Input of a black box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Input {
    /// T_d*, as in (6.8).
    Demand,
    /// T_d* − T_d, as in (6.3): judged with its loop closed.
    Error,
}
