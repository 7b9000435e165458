//! Takes the place of [`super::arrow`] in a build without the feature `parquet`.

#[path = "kind.rs"]
mod kind;

use crate::source::Shared;
use crate::{Catalogue, Recording, RecordingError, Selection};
pub(crate) use kind::Kind;

pub(crate) fn decode(
    name: &str,
    _: &Shared,
    kind: Kind,
    _: &Selection,
    _: Option<f64>,
    _: &(dyn Fn(u64, u64) + Sync),
) -> Result<Recording, RecordingError> {
    Err(left_out(name, kind))
}

pub(crate) fn catalogue(name: &str, _: &Shared, kind: Kind) -> Result<Catalogue, RecordingError> {
    Err(left_out(name, kind))
}

fn left_out(name: &str, kind: Kind) -> RecordingError {
    let format = if kind == Kind::Parquet { "Parquet" } else { "Arrow" };
    let feature = format!("{format}, which this build of the program leaves out,");
    RecordingError::Unsupported { file: name.into(), feature }
}
