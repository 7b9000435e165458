//! Values that are written as their words.

use std::fmt::Display;

use serde::Serializer;

/// Serialises a value, such as an error, as what it displays.
///
/// # Errors
/// Those of the serialiser.
pub fn write_words<T: Display, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

/// The same of a value that may be missing.
///
/// # Errors
/// Those of the serialiser.
#[allow(clippy::ref_option, reason = "serde passes fields by reference")]
pub fn write_words_if_any<T: Display, S: Serializer>(value: &Option<T>, serializer: S) -> Result<S::Ok, S::Error> {
    match value {
        Some(value) => serializer.serialize_some(&value.to_string()),
        None => serializer.serialize_none(),
    }
}
