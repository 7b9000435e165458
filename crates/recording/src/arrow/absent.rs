//! What stands in for [`super::arrow`] in a build without the feature `parquet`.

#[path = "kind.rs"]
mod kind;

use crate::source::Shared;
use crate::{Recording, RecordingError, Selection};
pub(crate) use kind::Kind;

pub(crate) fn decode(
    name: &str,
    _: &Shared,
    kind: Kind,
    _: &Selection,
    _: Option<f64>,
    _: &(dyn Fn(u64, u64) + Sync),
) -> Result<Recording, RecordingError> {
    let format = if kind == Kind::Parquet { "Parquet" } else { "Arrow" };
    let feature = format!("{format}, which this build of the program leaves out,");
    Err(RecordingError::Unsupported { file: name.into(), feature })
}
