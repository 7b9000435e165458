//! Parquet and Arrow: tables of columns with types and metadata.
//!
//! [`plan`] finds clocks and channels in the schema, [`values`] turns arrays into numbers, [`table`] gathers them batch
//! by batch. [`row_groups`] (Parquet) and [`ipc`] (Arrow) read the two formats, the latter through [`messages`] and
//! their [`batch`]es, and [`part`] reads both in part; [`write`] writes them.

mod batch;
mod ipc;
mod kind;
mod messages;
mod pages;
mod part;
mod plan;
mod reader;
mod row_groups;
mod table;
mod values;
mod write;

use std::sync::Arc;

use crate::RecordingError;
use crate::part::Opened;
use crate::source::Shared;
pub(crate) use kind::Kind;
pub use write::{encode_arrow, encode_parquet, write_arrow, write_parquet};

/// Names of metadata: of a field and of the file, as they are written, and read if they are there.
mod key {
    pub(super) const NAME: &str = "name";
    pub(super) const UNIT: &str = "unit";
    pub(super) const COMMENT: &str = "comment";
    pub(super) const RASTER: &str = "raster";
    pub(super) const START_TIME: &str = "start_time";
}

/// Opens a file; rows without a time column are `row_distance_s` apart, if that is known.
pub(crate) fn open(
    name: &str,
    source: Shared,
    kind: Kind,
    row_distance_s: Option<f64>,
) -> Result<Arc<dyn Opened>, RecordingError> {
    Ok(Arc::new(part::Opened::new(name, source, kind, row_distance_s)?))
}
