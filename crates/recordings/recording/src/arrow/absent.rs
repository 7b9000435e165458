//! Takes the place of [`super::arrow`] in a build without the feature `parquet`.

#[path = "kind.rs"]
mod kind;

use std::sync::Arc;

use crate::RecordingError;
use crate::part::Opened;
use crate::source::Shared;
pub(crate) use kind::Kind;

pub(crate) fn open(name: &str, _: Shared, kind: Kind, _: Option<f64>) -> Result<Arc<dyn Opened>, RecordingError> {
    let format = if kind == Kind::Parquet { "Parquet" } else { "Arrow" };
    Err(RecordingError::LeftOut { file: name.into(), format: format.into(), feature: "parquet" })
}
