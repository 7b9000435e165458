//! Values that are written as their words.

use std::fmt::{self, Display};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// An error of the program, or the words that a document keeps of one. Two that say the same are equal.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "String", bound = ""))]
pub enum InWords<E> {
    /// The error itself.
    Known(E),
    /// Its words, as a document has them.
    Read(String),
}

impl<E> From<E> for InWords<E> {
    fn from(error: E) -> Self {
        InWords::Known(error)
    }
}

impl<E: Display> Display for InWords<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InWords::Known(error) => error.fmt(f),
            InWords::Read(words) => f.write_str(words),
        }
    }
}

impl<E: Display> PartialEq for InWords<E> {
    fn eq(&self, other: &Self) -> bool {
        self.to_string() == other.to_string()
    }
}

impl<E: Display> Serialize for InWords<E> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de, E> Deserialize<'de> for InWords<E> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(InWords::Read)
    }
}
