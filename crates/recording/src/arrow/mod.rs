//! Parquet and Arrow: tables of columns with types and metadata.
//!
//! [`plan`] finds clocks and channels in the schema, [`values`] turns arrays into numbers, [`table`] gathers them batch
//! by batch. [`row_groups`] (Parquet) and [`ipc`] (Arrow) read the two formats, the latter through [`messages`] and their [`batch`]es; [`write`]
//! writes them.

mod batch;
mod ipc;
mod kind;
mod messages;
mod pages;
mod plan;
mod row_groups;
mod table;
mod values;
mod write;

use arrow_schema::Schema;

use crate::error::guarded;
use crate::source::{self, Shared};
use crate::{Catalogue, Recording, RecordingError, Selection};
use ipc::Ipc;
pub(crate) use kind::Kind;
use plan::Plan;
use row_groups::Parquet;
pub use write::{encode_arrow, encode_parquet, write_arrow, write_parquet};

/// The most numbers of a file, and of each byte of a larger file.
const MAX_NUMBERS: u64 = 1 << 26;
const MAX_PER_BYTE: u64 = 129;

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
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Recording, RecordingError> {
    let size = source::size(name, &**source)?;
    let reader = Reader { file: name, source, size, selection, row_distance_s, progress };
    guarded(name, || match kind {
        Kind::Parquet => Parquet::open(&reader)?.read(),
        Kind::File | Kind::Stream => Ipc::open(&reader, kind == Kind::Stream)?.read(),
    })
}

/// Lists the channels: of the samples nothing is read but the first date, where it says when the recording started.
pub(crate) fn catalogue(name: &str, source: &Shared, kind: Kind) -> Result<Catalogue, RecordingError> {
    let size = source::size(name, &**source)?;
    let (selection, progress) = (&Selection::All, &|_, _| {});
    let reader = Reader { file: name, source, size, selection, row_distance_s: None, progress };
    guarded(name, || match kind {
        Kind::Parquet => Parquet::open(&reader)?.list(),
        Kind::File | Kind::Stream => Ipc::open(&reader, kind == Kind::Stream)?.list(),
    })
}

struct Reader<'a> {
    file: &'a str,
    source: &'a Shared,
    size: u64,
    selection: &'a Selection,
    row_distance_s: Option<f64>,
    progress: &'a (dyn Fn(u64, u64) + Sync),
}

impl Reader<'_> {
    fn plan(&self, schema: &Schema) -> Result<Plan, RecordingError> {
        Plan::new(self.file, schema, self.selection, self.row_distance_s)
    }

    /// The most bytes that a compressed buffer may become.
    fn most_bytes(&self) -> i64 {
        let most = MAX_NUMBERS.max(self.size.saturating_mul(MAX_PER_BYTE)).saturating_mul(8);
        i64::try_from(most).unwrap_or(i64::MAX)
    }

    fn check_size(&self, rows: u64, columns: usize) -> Result<(), RecordingError> {
        let most = MAX_NUMBERS.max(self.size.saturating_mul(MAX_PER_BYTE));
        // Rows that nothing is kept of are gone through all the same.
        if rows.saturating_mul(columns.max(1) as u64) <= most {
            return Ok(());
        }
        Err(self.damaged(format!("{columns} columns of {rows} rows in {} bytes", self.size)))
    }

    fn damaged(&self, detail: String) -> RecordingError {
        RecordingError::Damaged { file: self.file.into(), offset: None, detail }
    }
}
