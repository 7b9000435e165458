//! Parquet and Arrow: tables of columns with types and metadata.
//!
//! [`plan`] finds clocks and channels in the schema, [`values`] turns arrays into numbers, [`table`] gathers them batch
//! by batch. [`row_groups`] (Parquet) and [`ipc`] (Arrow) read the two formats, the latter through [`messages`] and
//! their [`batch`]es; [`write`] writes them.

mod batch;
mod ipc;
mod kind;
mod messages;
mod pages;
mod plan;
mod reader;
mod row_groups;
mod table;
mod values;
mod write;

use crate::error::guarded;
use crate::source::{self, Shared};
use crate::{Catalogue, Recording, RecordingError, Selection};
use ipc::Ipc;
pub(crate) use kind::Kind;
use reader::Reader;
use row_groups::Parquet;
use work::Context;
pub use write::{encode_arrow, encode_parquet, write_arrow, write_parquet};

/// Names of metadata: of a field and of the file, as they are written, and read if they are there.
mod key {
    pub(super) const NAME: &str = "name";
    pub(super) const UNIT: &str = "unit";
    pub(super) const COMMENT: &str = "comment";
    pub(super) const RASTER: &str = "raster";
    pub(super) const START_TIME: &str = "start_time";
}

/// Decodes the selected channels; rows without a time column are `row_distance_s` apart, if that is known.
///
/// Of Parquet only the pages of selected columns are read, of Arrow only their buffers.
pub(crate) fn decode(
    name: &str,
    source: &Shared,
    kind: Kind,
    selection: &Selection,
    row_distance_s: Option<f64>,
    context: &Context,
) -> Result<Recording, RecordingError> {
    let size = source::size(name, &**source)?;
    let reader = Reader { file: name, source, size, selection, row_distance_s, context };
    guarded(name, || match kind {
        Kind::Parquet => Parquet::open(&reader)?.read(),
        Kind::File | Kind::Stream => Ipc::open(&reader, kind == Kind::Stream)?.read(),
    })
}

/// Lists the channels: of the samples nothing is read but the first date, where it says when the recording started.
pub(crate) fn catalogue(name: &str, source: &Shared, kind: Kind) -> Result<Catalogue, RecordingError> {
    let size = source::size(name, &**source)?;
    let (selection, context) = (&Selection::All, &Context::new());
    let reader = Reader { file: name, source, size, selection, row_distance_s: None, context };
    guarded(name, || match kind {
        Kind::Parquet => Parquet::open(&reader)?.list(),
        Kind::File | Kind::Stream => Ipc::open(&reader, kind == Kind::Stream)?.list(),
    })
}
