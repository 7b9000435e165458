//! Numbers of a document, which has null where a number is NaN or infinite.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer};

/// A number of a document.
#[derive(Deserialize)]
#[serde(transparent)]
pub struct Number(Option<f64>);

/// Numbers that a document may hold as null.
pub trait Numbers {
    /// The form in the document.
    type Written: DeserializeOwned;

    /// The numbers; null is read as NaN.
    fn from_written(written: Self::Written) -> Self;
}

impl Numbers for f64 {
    type Written = Number;

    fn from_written(written: Number) -> Self {
        written.0.unwrap_or(f64::NAN)
    }
}

impl Numbers for (f64, f64) {
    type Written = (Number, Number);

    fn from_written(written: (Number, Number)) -> Self {
        (f64::from_written(written.0), f64::from_written(written.1))
    }
}

impl Numbers for (Vec<f64>, Vec<f64>) {
    type Written = (Vec<Number>, Vec<Number>);

    fn from_written(written: Self::Written) -> Self {
        (Vec::from_written(written.0), Vec::from_written(written.1))
    }
}

impl<T: Numbers> Numbers for Vec<T> {
    type Written = Vec<T::Written>;

    fn from_written(written: Self::Written) -> Self {
        written.into_iter().map(T::from_written).collect()
    }
}

/// Reads numbers; null is read as NaN.
///
/// # Errors
/// Those of the deserialiser.
pub fn nan_if_null<'de, T: Numbers, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::Written::deserialize(deserializer).map(T::from_written)
}

/// Reads degrees of freedom; null is read as infinite.
///
/// # Errors
/// Those of the deserialiser.
pub fn infinite_if_null<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

/// Units in the last place by which a number that was scaled and scaled back may be away.
const ROUNDED: usize = 8;

/// The number that a scaling made into this one. Of those that give the same after rounding, it is one near the
/// quotient, so that a document that is read and written again has the same digits.
pub(crate) fn unscaled(written: f64, scales: &[f64]) -> f64 {
    let scaled = |si: f64| scales.iter().fold(si, |value, scale| value * scale);
    let near = scales.iter().fold(written, |value, scale| value / scale);
    let upwards = std::iter::successors(Some(near), |value| Some(value.next_up())).take(ROUNDED);
    let downwards = std::iter::successors(Some(near), |value| Some(value.next_down())).take(ROUNDED);
    upwards.chain(downwards).find(|si| scaled(*si) == written).unwrap_or(near)
}
