//! A result, or why there is none.

use serde::Serialize;

use crate::role::Role;

/// A part of the study, estimated or not.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum Part<T> {
    /// The estimate.
    Estimated(T),
    /// What is needed before it can be estimated.
    NotEstimated {
        /// Each need; any one of the alternatives inside fulfils it.
        needs: Vec<Need>,
    },
}

impl<T> Part<T> {
    /// The estimate, if there is one.
    pub fn estimated(&self) -> Option<&T> {
        match self {
            Part::Estimated(value) => Some(value),
            Part::NotEstimated { .. } => None,
        }
    }
}

/// Something a part needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Need {
    /// A recording of one of these experiments, e.g. `BS_T_NT`.
    Recording {
        /// Labels, any one of which will do.
        any_of: Vec<String>,
    },
    /// A channel in the recording that is there.
    Channel {
        /// File.
        file: String,
        /// Role.
        role: Role,
    },
    /// Another part of the study.
    Part {
        /// Its name.
        name: String,
    },
    /// Data on which the estimate converges to something usable.
    UsableData {
        /// File.
        file: String,
        /// The estimator's own words.
        reason: String,
    },
}

/// A result, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Told<T> {
    /// The result.
    Found(T),
    /// Why there is none.
    Untold(Untold),
}

/// Why a recording does not show a quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Untold {
    /// A signal was not recorded.
    Missing {
        /// Its role.
        role: Role,
    },
    /// T_d* does not move T_d by itself in this experiment, or hardly.
    NotExcited,
    /// No filter explains T_d,shaft,calc.
    NotExplained,
    /// A torque brakes with a negative sign, against what it does to the speed.
    WrongSign {
        /// Its role.
        role: Role,
    },
    /// The estimator's own words.
    Failed {
        /// They.
        reason: String,
    },
}

impl<T> Told<T> {
    /// The result by reference, or why there is none.
    ///
    /// # Errors
    /// That there is none.
    pub fn as_ref(&self) -> Result<&T, &Untold> {
        match self {
            Told::Found(value) => Ok(value),
            Told::Untold(why) => Err(why),
        }
    }

    /// The result, where there is one.
    pub fn found(&self) -> Option<&T> {
        match self {
            Told::Found(value) => Some(value),
            Told::Untold(_) => None,
        }
    }
}
