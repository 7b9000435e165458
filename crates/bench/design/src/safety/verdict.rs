//! From counts to verdicts.

use serde::{Deserialize, Serialize};
use signal::proportion::Proportion;

/// The probability of reaching a limit that is allowed.
pub const ALLOWED: f64 = 0.05;

/// A verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Safety {
    /// Every limit stated is reached with a probability below 5 %, and so is the upper end of its 95 % interval.
    Safe,
    /// A probability is at most 5 %, but its interval reaches beyond.
    Risky,
    /// A limit is reached with a probability above 5 %, or that many benches are not stable.
    Unsafe,
    /// No limit is stated.
    NotChecked,
}

impl Safety {
    /// Safety against something that must not happen.
    pub(super) fn against(happened: Proportion) -> Self {
        match (happened.estimate > ALLOWED, happened.upper > ALLOWED) {
            (true, _) => Safety::Unsafe,
            (false, true) => Safety::Risky,
            (false, false) => Safety::Safe,
        }
    }
}
