//! Parquet and Arrow: tables of columns with types and metadata.
//!
//! [`plan`] finds clocks and channels in the schema, [`values`] turns arrays into numbers, [`table`] gathers them batch
//! by batch; [`write`] writes them.

mod kind;
mod packed;
mod plan;
mod table;
mod values;
mod write;

use std::io::Cursor;

use arrow_array::RecordBatch;
use arrow_ipc::reader::{FileReader, StreamReader};
use arrow_schema::{ArrowError, Schema, SchemaRef};
use bytes::Bytes;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

use crate::error::guarded;
use crate::{Finding, Format, Recording, RecordingError, Selection};
pub(crate) use kind::Kind;
use plan::Plan;
use table::Table;
pub use write::{encode_arrow, encode_parquet};

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
pub(crate) fn decode(
    name: &str,
    bytes: &[u8],
    kind: Kind,
    selection: &Selection,
    row_distance_s: Option<f64>,
) -> Result<Recording, RecordingError> {
    let reader = Reader { file: name, bytes, selection, row_distance_s };
    guarded(name, || match kind {
        Kind::Parquet => reader.parquet(),
        Kind::File => reader.file(),
        Kind::Stream => reader.stream(),
    })
    .map(|mut recording| {
        recording.format = if kind == Kind::Parquet { Format::Parquet } else { Format::Arrow };
        recording
    })
}

struct Reader<'a> {
    file: &'a str,
    bytes: &'a [u8],
    selection: &'a Selection,
    row_distance_s: Option<f64>,
}

impl Reader<'_> {
    fn parquet(&self) -> Result<Recording, RecordingError> {
        let bytes = Bytes::copy_from_slice(self.bytes);
        let builder = ParquetRecordBatchReaderBuilder::try_new(bytes).map_err(|e| self.damaged(e.to_string()))?;
        let plan = self.plan(builder.schema())?;
        let rows = builder.metadata().file_metadata().num_rows();
        self.check_size(u64::try_from(rows).unwrap_or(u64::MAX), plan.columns.len())?;
        let mask = ProjectionMask::roots(builder.parquet_schema(), plan.columns.iter().copied());
        let batches = builder.with_projection(mask).build().map_err(|e| self.damaged(e.to_string()))?;
        self.gather(plan, batches)
    }

    fn file(&self) -> Result<Recording, RecordingError> {
        self.check_packed(packed::is_plausible_file(self.bytes, self.most_bytes()))?;
        let open =
            |columns| FileReader::try_new(Cursor::new(self.bytes), columns).map_err(|e| self.damaged(e.to_string()));
        let plan = self.plan(&open(None)?.schema())?;
        let batches = open(Some(plan.columns.clone()))?;
        self.gather(plan, batches)
    }

    fn stream(&self) -> Result<Recording, RecordingError> {
        self.check_packed(packed::is_plausible_stream(self.bytes, self.most_bytes()))?;
        let open = |columns| StreamReader::try_new(self.bytes, columns).map_err(|e| self.damaged(e.to_string()));
        let plan = self.plan(&open(None)?.schema())?;
        let batches = open(Some(plan.columns.clone()))?;
        let mut recording = self.gather(plan, batches)?;
        // The end may be left out; but then a cut between two batches does not show.
        if !self.bytes.ends_with(&[0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0]) {
            recording.findings.push(Finding::NotFinalised);
        }
        Ok(recording)
    }

    fn plan(&self, schema: &Schema) -> Result<Plan, RecordingError> {
        Plan::new(self.file, schema, self.selection, self.row_distance_s)
    }

    fn gather(
        &self,
        plan: Plan,
        batches: impl Iterator<Item = Result<RecordBatch, ArrowError>>,
    ) -> Result<Recording, RecordingError> {
        let (width, mut rows) = (plan.columns.len(), 0_u64);
        let mut table = Table::new(plan, self.row_distance_s);
        for batch in batches {
            let batch = batch.map_err(|error| self.damaged(error.to_string()))?;
            rows = rows.saturating_add(batch.num_rows() as u64);
            self.check_size(rows, width)?;
            table.append(&batch).map_err(|fault| fault.error(self.file))?;
        }
        Ok(table.finish())
    }

    /// The most bytes that a compressed buffer may become.
    fn most_bytes(&self) -> i64 {
        let most = MAX_NUMBERS.max((self.bytes.len() as u64).saturating_mul(MAX_PER_BYTE)).saturating_mul(8);
        i64::try_from(most).unwrap_or(i64::MAX)
    }

    fn check_packed(&self, is_plausible: bool) -> Result<(), RecordingError> {
        let detail = || String::from("it announces more numbers than the file's size makes plausible");
        if is_plausible { Ok(()) } else { Err(self.damaged(detail())) }
    }

    fn check_size(&self, rows: u64, columns: usize) -> Result<(), RecordingError> {
        let most = MAX_NUMBERS.max((self.bytes.len() as u64).saturating_mul(MAX_PER_BYTE));
        if rows.saturating_mul(columns as u64) <= most {
            return Ok(());
        }
        Err(self.damaged(format!("{columns} columns of {rows} rows in {} bytes", self.bytes.len())))
    }

    fn damaged(&self, detail: String) -> RecordingError {
        RecordingError::Damaged { file: self.file.into(), offset: None, detail }
    }
}

/// The schema and the one batch that a recording becomes.
type Written = (SchemaRef, RecordBatch);
