//! Results as JSON documents of their own, each with a format and a version.

use std::marker::PhantomData;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::format_of;
use super::json::{JsonFault, from_json};

/// The form of a result as a document: `{"format": …, "format_version": …, "result": {…}}`.
///
/// A number that is NaN or infinite is `null` in it. It is read as NaN, or as infinite where the field's own
/// documentation says that it may be; a result without such numbers is read as it was written.
///
/// # Example
/// ```
/// use bench_model::document::ResultFormat;
///
/// const LENGTHS: ResultFormat<Vec<f64>> = ResultFormat::new("lengths", 1);
/// let text = LENGTHS.json(&vec![1.0, 2.5])?;
/// assert_eq!(LENGTHS.read(&text)?, [1.0, 2.5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct ResultFormat<T> {
    format: &'static str,
    version: u32,
    of: PhantomData<fn(T) -> T>,
}

#[derive(Serialize)]
struct Written<'a, T> {
    format: &'static str,
    format_version: u32,
    result: &'a T,
}

#[derive(Deserialize)]
struct Read<T> {
    result: T,
}

/// Statements of a document on itself; looked at first, since another version may have another shape.
#[derive(Deserialize)]
struct Header {
    #[serde(default)]
    format_version: u64,
}

/// Why a text is no result of a format.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ResultError {
    /// The text has another `format`, or none.
    #[error("this is no {wanted}: its `format` is {}", found.as_ref().map_or("missing".to_owned(), |text| format!("“{text}”")))]
    OtherFormat {
        /// The format that is wanted.
        wanted: &'static str,
        /// Its own.
        found: Option<String>,
    },
    /// A result of another version.
    #[error("this {format} is of version {found}, where {wanted} is read; make it again with this dynoid")]
    OtherVersion {
        /// Its format.
        format: &'static str,
        /// Its version.
        found: u64,
        /// The version that is read.
        wanted: u32,
    },
    /// A result that is damaged.
    #[error("{fault}; copy the file again, or make it again")]
    Damaged {
        /// Where, and what is wrong.
        fault: JsonFault,
    },
}

impl<T> ResultFormat<T> {
    /// Results with this text in their `format` field. The version grows by one when a field changes its meaning or
    /// disappears.
    #[must_use]
    pub const fn new(format: &'static str, version: u32) -> Self {
        ResultFormat { format, version, of: PhantomData }
    }

    /// The text of the `format` field.
    #[must_use]
    pub const fn format(&self) -> &'static str {
        self.format
    }

    /// The number of the `format_version` field.
    #[must_use]
    pub const fn version(&self) -> u32 {
        self.version
    }
}

impl<T: Serialize> ResultFormat<T> {
    /// A result as compact JSON.
    ///
    /// # Errors
    /// Those of the serialiser.
    pub fn json(&self, result: &T) -> Result<String, serde_json::Error> {
        serde_json::to_string(&Written { format: self.format, format_version: self.version, result })
    }
}

impl<T: DeserializeOwned> ResultFormat<T> {
    /// Reads what [`ResultFormat::json`] wrote.
    ///
    /// # Errors
    /// [`ResultError`] with the place in the text, and what to do.
    pub fn read(&self, text: &str) -> Result<T, ResultError> {
        let damaged = |fault| ResultError::Damaged { fault };
        let found = format_of(text);
        if found.as_deref() != Some(self.format) {
            return Err(ResultError::OtherFormat { wanted: self.format, found });
        }
        let header: Header = from_json(text).map_err(damaged)?;
        if header.format_version != u64::from(self.version) {
            let (format, found, wanted) = (self.format, header.format_version, self.version);
            return Err(ResultError::OtherVersion { format, found, wanted });
        }
        from_json::<Read<T>>(text).map(|read| read.result).map_err(damaged)
    }
}
