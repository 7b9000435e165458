//! Numbers of JSON documents, which have null where a number is NaN or infinite.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer};

/// A number of a document.
#[derive(Deserialize)]
#[serde(transparent)]
pub struct Number(Option<f64>);

/// Numbers that a document may hold as null, and texts beside them.
pub trait Numbers {
    /// The form in the document.
    type Written: DeserializeOwned;

    /// The numbers, with `null` where the document has null.
    fn from_written(written: Self::Written, null: f64) -> Self;
}

impl Numbers for f64 {
    type Written = Number;

    fn from_written(written: Number, null: f64) -> Self {
        written.0.unwrap_or(null)
    }
}

impl Numbers for String {
    type Written = String;

    fn from_written(written: String, _: f64) -> Self {
        written
    }
}

impl<A: Numbers, B: Numbers> Numbers for (A, B) {
    type Written = (A::Written, B::Written);

    fn from_written((a, b): Self::Written, null: f64) -> Self {
        (A::from_written(a, null), B::from_written(b, null))
    }
}

impl<A: Numbers, B: Numbers, C: Numbers> Numbers for (A, B, C) {
    type Written = (A::Written, B::Written, C::Written);

    fn from_written((a, b, c): Self::Written, null: f64) -> Self {
        (A::from_written(a, null), B::from_written(b, null), C::from_written(c, null))
    }
}

impl<T: Numbers, const N: usize> Numbers for [T; N]
where
    [T::Written; N]: DeserializeOwned,
{
    type Written = [T::Written; N];

    fn from_written(written: Self::Written, null: f64) -> Self {
        written.map(|one| T::from_written(one, null))
    }
}

impl<T: Numbers> Numbers for Vec<T> {
    type Written = Vec<T::Written>;

    fn from_written(written: Self::Written, null: f64) -> Self {
        written.into_iter().map(|one| T::from_written(one, null)).collect()
    }
}

/// A value that may be missing is none where the document has null.
impl<T: Numbers> Numbers for Option<T> {
    type Written = Option<T::Written>;

    fn from_written(written: Self::Written, null: f64) -> Self {
        written.map(|one| T::from_written(one, null))
    }
}

/// Reads numbers that may not be known; null is read as NaN.
///
/// # Errors
/// Those of the deserialiser.
pub fn nan_if_null<'de, T: Numbers, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::Written::deserialize(deserializer).map(|written| T::from_written(written, f64::NAN))
}

/// Reads numbers that may be infinite, such as degrees of freedom; null is read as infinite.
///
/// # Errors
/// Those of the deserialiser.
pub fn infinite_if_null<'de, T: Numbers, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::Written::deserialize(deserializer).map(|written| T::from_written(written, f64::INFINITY))
}
