//! Parquet and Arrow: tables of columns with types and metadata.
//!
//! [`plan`] finds clocks and channels in the schema, [`values`] turns arrays into numbers, [`table`] gathers them batch
//! by batch; [`write`] writes them.

mod kind;
mod packed;
mod pages;
mod plan;
mod table;
mod values;
mod write;

use std::io::BufReader;

use arrow_array::RecordBatch;
use arrow_ipc::reader::{FileReader, StreamReader};
use arrow_schema::{ArrowError, Schema, SchemaRef};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

use crate::error::guarded;
use crate::source::{self, Shared, Stretch};
use crate::{Finding, Format, Recording, RecordingError, Selection};
pub(crate) use kind::Kind;
use pages::Pages;
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
///
/// Of Parquet only the pages of selected columns are read. Of Arrow the batches are, one at a time: its decoder reads
/// them whole.
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
    source: &'a Shared,
    size: u64,
    selection: &'a Selection,
    row_distance_s: Option<f64>,
    progress: &'a (dyn Fn(u64, u64) + Sync),
}

impl Reader<'_> {
    fn parquet(&self) -> Result<Recording, RecordingError> {
        let pages = Pages { source: self.source.clone(), size: self.size };
        let builder = ParquetRecordBatchReaderBuilder::try_new(pages).map_err(|e| self.damaged(e.to_string()))?;
        let plan = self.plan(builder.schema())?;
        let rows = u64::try_from(builder.metadata().file_metadata().num_rows()).unwrap_or(u64::MAX);
        self.check_size(rows, plan.columns.len())?;
        let mask = ProjectionMask::roots(builder.parquet_schema(), plan.columns.iter().copied());
        let batches = builder.with_projection(mask).build().map_err(|e| self.damaged(e.to_string()))?;
        self.gather(plan, batches, Some(rows))
    }

    fn file(&self) -> Result<Recording, RecordingError> {
        self.check_packed(packed::is_plausible_file(&**self.source, self.most_bytes()))?;
        let open = |columns| FileReader::try_new(self.reader(), columns).map_err(|e| self.damaged(e.to_string()));
        let plan = self.plan(&open(None)?.schema())?;
        let batches = open(Some(plan.columns.clone()))?;
        self.gather(plan, batches, None)
    }

    fn stream(&self) -> Result<Recording, RecordingError> {
        self.check_packed(packed::is_plausible_stream(&**self.source, self.most_bytes()))?;
        let open = |columns| StreamReader::try_new(self.reader(), columns).map_err(|e| self.damaged(e.to_string()));
        let plan = self.plan(&open(None)?.schema())?;
        let batches = open(Some(plan.columns.clone()))?;
        let mut recording = self.gather(plan, batches, None)?;
        // The end may be left out; but then a cut between two batches does not show.
        let end = source::bytes(self.file, &**self.source, self.size.saturating_sub(8), 8)?;
        if end != [0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0] {
            recording.findings.push(Finding::NotFinalised);
        }
        Ok(recording)
    }

    fn reader(&self) -> BufReader<Stretch> {
        BufReader::new(Stretch::new(self.source, 0, self.size))
    }

    fn plan(&self, schema: &Schema) -> Result<Plan, RecordingError> {
        Plan::new(self.file, schema, self.selection, self.row_distance_s)
    }

    fn gather(
        &self,
        plan: Plan,
        batches: impl Iterator<Item = Result<RecordBatch, ArrowError>>,
        all: Option<u64>,
    ) -> Result<Recording, RecordingError> {
        let (width, mut rows) = (plan.columns.len(), 0_u64);
        let mut table = Table::new(plan, self.row_distance_s);
        for batch in batches {
            let batch = batch.map_err(|error| self.damaged(error.to_string()))?;
            rows = rows.saturating_add(batch.num_rows() as u64);
            self.check_size(rows, width)?;
            table.append(&batch).map_err(|fault| fault.error(self.file))?;
            if let Some(all) = all {
                (self.progress)(rows, all);
            }
        }
        Ok(table.finish())
    }

    /// The most bytes that a compressed buffer may become.
    fn most_bytes(&self) -> i64 {
        let most = MAX_NUMBERS.max(self.size.saturating_mul(MAX_PER_BYTE)).saturating_mul(8);
        i64::try_from(most).unwrap_or(i64::MAX)
    }

    fn check_packed(&self, is_plausible: bool) -> Result<(), RecordingError> {
        let detail = || String::from("it announces more numbers than the file's size makes plausible");
        if is_plausible { Ok(()) } else { Err(self.damaged(detail())) }
    }

    fn check_size(&self, rows: u64, columns: usize) -> Result<(), RecordingError> {
        let most = MAX_NUMBERS.max(self.size.saturating_mul(MAX_PER_BYTE));
        if rows.saturating_mul(columns as u64) <= most {
            return Ok(());
        }
        Err(self.damaged(format!("{columns} columns of {rows} rows in {} bytes", self.size)))
    }

    fn damaged(&self, detail: String) -> RecordingError {
        RecordingError::Damaged { file: self.file.into(), offset: None, detail }
    }
}

/// The schema and the one batch that a recording becomes.
type Written = (SchemaRef, RecordBatch);
