//! A result, or why there is none.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Error, IgnoredAny, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::part::Part;
use crate::error::EstimateError;
use crate::experiment::ExperimentLabel;
use crate::role::Role;
use crate::words::InWords;

/// Outcome of an estimate.
///
/// It has two forms in JSON: [`write_status`] is that of a study, [`Found`] that of single analyses.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "FoundForm<T>", inline))]
pub enum Outcome<T> {
    /// The estimate.
    Estimated(T),
    /// There is none.
    NotEstimated {
        /// Why: what is needed before there can be one.
        needs: Vec<Reason>,
    },
}

impl<T> Outcome<T> {
    /// There is none, because of this.
    pub fn because(reason: Reason) -> Self {
        Outcome::NotEstimated { needs: vec![reason] }
    }

    /// The estimate, if there is one.
    pub fn estimated(&self) -> Option<&T> {
        self.as_ref().ok()
    }

    /// The estimate by reference, or why there is none.
    ///
    /// # Errors
    /// That there is none.
    pub fn as_ref(&self) -> Result<&T, &[Reason]> {
        match self {
            Outcome::Estimated(value) => Ok(value),
            Outcome::NotEstimated { needs } => Err(needs),
        }
    }

    /// The form of single analyses.
    pub fn written(&self) -> Found<'_, &T> {
        self.written_as(|value| value)
    }

    /// The form of single analyses, with what `written` makes of the estimate.
    pub fn written_as<'a, U>(&'a self, written: impl FnOnce(&'a T) -> U) -> Found<'a, U> {
        self.as_ref().map_or_else(|needs| Found::NotEstimated(needs), |value| Found::Found(written(value)))
    }

    /// Why there is no estimate; empty if there is one.
    pub fn needs(&self) -> &[Reason] {
        self.as_ref().err().unwrap_or_default()
    }
}

impl<T> From<Result<T, Vec<Reason>>> for Outcome<T> {
    fn from(result: Result<T, Vec<Reason>>) -> Self {
        result.map_or_else(|needs| Outcome::NotEstimated { needs }, Outcome::Estimated)
    }
}

impl<T> From<Result<T, Reason>> for Outcome<T> {
    fn from(result: Result<T, Reason>) -> Self {
        result.map_or_else(Outcome::because, Outcome::Estimated)
    }
}

impl<T> From<Result<T, EstimateError>> for Outcome<T> {
    fn from(result: Result<T, EstimateError>) -> Self {
        result.map_err(Reason::from).into()
    }
}

/// Why there is no estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Reason {
    /// There is no recording of any of these experiments.
    Recording {
        /// Labels, any one of which will do.
        any_of: Vec<ExperimentLabel>,
    },
    /// A channel is missing in the recording that is there.
    Channel {
        /// File.
        file: String,
        /// Role.
        role: Role,
    },
    /// Another part of the bench is not estimated.
    Part {
        /// Which.
        #[serde(rename = "name")]
        part: Part,
    },
    /// A finding is an error: it was estimated, and its numbers are struck.
    Error {
        /// The file that has the error; none where the bench file has it.
        file: Option<String>,
    },
    /// A signal hardly varies, or another one does not follow it.
    NotExcited {
        /// File.
        file: String,
        /// The signal that should move.
        role: Role,
    },
    /// A torque brakes with a negative sign, against what it does to the speed.
    WrongSign {
        /// File.
        file: String,
        /// Its role.
        role: Role,
    },
    /// No filter explains T_d,shaft,calc.
    NotExplained {
        /// File.
        file: String,
    },
    /// T_d is known by its samples alone, and what folds in them cannot be separated from the shaft.
    FoldedTorque {
        /// File.
        file: String,
        /// Time between the samples, s.
        apart_s: f64,
    },
    /// The engine fires too fast for the rate of N_d.
    FiringsTooFast {
        /// Time between firings, s.
        firing_s: f64,
        /// The lowest rate that would do, Hz.
        needed_hz: f64,
        /// The rate of N_d, Hz.
        rate_hz: f64,
    },
    /// The recording holds too few cycles of the engine.
    TooFewCycles {
        /// Whole cycles.
        found: usize,
        /// Cycles that are needed.
        needed: usize,
        /// The length that has them, s.
        needed_s: f64,
    },
    /// The estimator failed.
    #[serde(rename = "usable_data")]
    Failed {
        /// File.
        file: String,
        /// The estimator's error; it serialises as its words.
        #[serde(rename = "reason")]
        error: InWords<EstimateError>,
    },
    /// An analysis fails, for a reason of its own.
    Analysis {
        /// The reason, in words.
        #[serde(rename = "reason")]
        words: String,
    },
}

impl Reason {
    /// The reason of an analysis that fails.
    pub fn of_analysis(error: impl fmt::Display) -> Self {
        Reason::Analysis { words: error.to_string() }
    }
}

impl From<EstimateError> for Reason {
    fn from(error: EstimateError) -> Self {
        match error {
            EstimateError::MissingSignal { file, role } => Reason::Channel { file, role },
            EstimateError::WrongSign { file, role } => Reason::WrongSign { file, role },
            EstimateError::WeakExcitation { file, role, .. } => Reason::NotExcited { file, role },
            error => Reason::Failed { file: error.file().to_owned(), error: error.into() },
        }
    }
}

/// The form of an outcome in a study: the estimate's own fields beside a `status`.
#[derive(Serialize)]
#[serde(tag = "status", rename_all = "snake_case")]
enum Status<'a, T> {
    Estimated(&'a T),
    NotEstimated { needs: &'a [Reason] },
}

/// Serialises an outcome as the fields of the estimate with a `status`, or as `needs` with one.
///
/// # Errors
/// Those of the serialiser.
pub fn write_status<T: Serialize, S: Serializer>(outcome: &Outcome<T>, serializer: S) -> Result<S::Ok, S::Error> {
    let status = match outcome.as_ref() {
        Ok(value) => Status::Estimated(value),
        Err(needs) => Status::NotEstimated { needs },
    };
    status.serialize(serializer)
}

/// The same form as it is read.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(inline))]
#[serde(tag = "status", rename_all = "snake_case")]
pub enum ReadStatus<T> {
    /// The fields of the estimate.
    Estimated(T),
    /// There is none.
    NotEstimated {
        /// Why: what is needed before there can be one.
        needs: Vec<Reason>,
    },
}

/// Reads what [`write_status`] wrote.
///
/// # Errors
/// Those of the deserialiser.
pub fn read_status<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Outcome<T>, D::Error> {
    Ok(match ReadStatus::deserialize(deserializer)? {
        ReadStatus::Estimated(value) => Outcome::Estimated(value),
        ReadStatus::NotEstimated { needs } => Outcome::NotEstimated { needs },
    })
}

/// The form of an outcome in single analyses: `{"found": …}`, or `{"not_estimated": …}` with the first reason and,
/// where there are several, all of them as `needs`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "FoundForm<T>", inline))]
pub enum Found<'a, T> {
    /// The estimate, or what is written of it.
    Found(T),
    /// Why there is none.
    NotEstimated(&'a [Reason]),
}

/// The form of [`Found`], for its schema.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[schemars(untagged, inline)]
#[expect(dead_code, reason = "the schema is all that is made of it")]
enum FoundForm<T> {
    /// The estimate.
    Found { found: T },
    /// There is none.
    NotEstimated {
        /// The first reason why.
        not_estimated: Option<Reason>,
        /// All reasons, where there are several.
        #[schemars(default, skip_serializing_if = "Vec::is_empty")]
        needs: Vec<Reason>,
    },
}

impl<T: Serialize> Serialize for Found<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_map(None)?;
        match self {
            Found::Found(value) => fields.serialize_entry("found", value)?,
            Found::NotEstimated(needs) => {
                fields.serialize_entry("not_estimated", &needs.first())?;
                if needs.len() > 1 {
                    fields.serialize_entry("needs", needs)?;
                }
            }
        }
        fields.end()
    }
}

/// Reads that form field by field, so that an error keeps its place in the document.
struct FoundVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for FoundVisitor<T> {
    type Value = Outcome<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with `found` or `not_estimated`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Self::Value, A::Error> {
        let (mut found, mut first, mut needs) = (None, None::<Option<Reason>>, None::<Vec<Reason>>);
        while let Some(name) = fields.next_key::<String>()? {
            match name.as_str() {
                "found" => found = Some(fields.next_value()?),
                "not_estimated" => first = Some(fields.next_value()?),
                "needs" => needs = Some(fields.next_value()?),
                _ => drop(fields.next_value::<IgnoredAny>()?),
            }
        }
        match (found, first) {
            (Some(value), _) => Ok(Outcome::Estimated(value)),
            (None, Some(first)) => {
                Ok(Outcome::NotEstimated { needs: needs.unwrap_or_else(|| first.into_iter().collect()) })
            }
            (None, None) => Err(A::Error::missing_field("found")),
        }
    }
}

/// Serialises an outcome as [`Found`].
///
/// # Errors
/// Those of the serialiser.
pub fn write_found<T: Serialize, S: Serializer>(outcome: &Outcome<T>, serializer: S) -> Result<S::Ok, S::Error> {
    outcome.written().serialize(serializer)
}

/// The same of an outcome that is not sought everywhere.
///
/// # Errors
/// Those of the serialiser.
pub fn write_if_sought<T: Serialize, S: Serializer>(
    outcome: &Option<Outcome<T>>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    outcome.as_ref().map(Outcome::written).serialize(serializer)
}

/// Reads what [`write_found`] wrote.
///
/// # Errors
/// Those of the deserialiser.
pub fn read_found<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Outcome<T>, D::Error> {
    deserializer.deserialize_map(FoundVisitor(PhantomData))
}

/// An outcome in the form of single analyses.
#[derive(Deserialize)]
#[serde(transparent, bound = "T: Deserialize<'de>")]
struct Sought<T>(#[serde(deserialize_with = "read_found")] Outcome<T>);

/// Reads what [`write_if_sought`] wrote.
///
/// # Errors
/// Those of the deserialiser.
pub fn read_if_sought<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Outcome<T>>, D::Error> {
    Ok(Option::<Sought<T>>::deserialize(deserializer)?.map(|sought| sought.0))
}
