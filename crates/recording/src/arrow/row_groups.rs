//! Parquet: row groups of columns in pages, of which those of selected columns are read.

use std::cell::Cell;

use arrow_array::ArrayRef;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ArrowReaderMetadata, ParquetRecordBatchReaderBuilder};
use parquet::file::metadata::ParquetMetaData;

use super::Reader;
use super::pages::Pages;
use super::plan::Plan;
use super::table::{Table, start_of};
use crate::{Catalogue, Format, Recording, RecordingError, StartTime};

/// Rows that are read at once.
const ROWS: usize = 1 << 16;

/// An opened file.
pub(super) struct Parquet<'r> {
    reader: &'r Reader<'r>,
    metadata: ArrowReaderMetadata,
    plan: Plan,
}

impl<'r> Parquet<'r> {
    pub(super) fn open(reader: &'r Reader<'r>) -> Result<Self, RecordingError> {
        let metadata = ArrowReaderMetadata::load(&Pages::of(reader), Default::default());
        let metadata = metadata.map_err(|e| reader.damaged(e.to_string()))?;
        let plan = reader.plan(metadata.schema())?;
        Ok(Self { reader, metadata, plan })
    }

    fn rows(&self) -> u64 {
        u64::try_from(self.metadata.metadata().file_metadata().num_rows()).unwrap_or(u64::MAX)
    }

    pub(super) fn read(self) -> Result<Recording, RecordingError> {
        let Self { reader, .. } = self;
        let (all, width) = (self.rows(), self.plan.columns.len());
        reader.check_size(all, width)?;
        let rows = usize::try_from(all).unwrap_or(usize::MAX);
        let most = usize::try_from(all.min(reader.size.saturating_mul(8))).unwrap_or(usize::MAX);
        let expected: Vec<usize> = self.samples().into_iter().map(|count| count.unwrap_or(most).min(most)).collect();
        let (done, total) = (Cell::new(0), all.saturating_mul(self.plan.reads() as u64));
        let columns = self.plan.columns.clone();
        // One column after the other: of each that is being read there are pages in memory.
        let read = |column: usize| {
            let arrays = arrays(reader, &self.metadata, columns[column])?;
            Ok(arrays.inspect(|array| {
                done.set(done.get() + array.as_ref().map_or(0, |array| array.len() as u64));
                (reader.progress)(done.get(), total);
            }))
        };
        let mut table = Table::new(self.plan, reader.row_distance_s, &expected);
        table.append(rows, read).map_err(|fault| fault.error(reader.file))?;
        let mut recording = table.finish();
        recording.format = Format::Parquet;
        Ok(recording)
    }

    pub(super) fn list(self) -> Result<Catalogue, RecordingError> {
        self.reader.check_size(self.rows(), self.plan.columns.len())?;
        let samples = self.samples();
        let start_time = started(self.reader, &self.metadata, &self.plan)?;
        Ok(self.plan.into_catalogue(Format::Parquet, &samples, start_time))
    }

    /// The samples of each group, where the file counts the values that are missing.
    fn samples(&self) -> Vec<Option<usize>> {
        let metadata = self.metadata.metadata();
        let rows = usize::try_from(self.rows()).ok();
        let present = |mark: Option<usize>| match mark {
            None => rows,
            Some(mark) => rows?.checked_sub(nulls(metadata, self.plan.columns[mark])?),
        };
        self.plan.marks().map(present).collect()
    }
}

/// How many values of a column are missing, if the file says so.
fn nulls(metadata: &ParquetMetaData, root: usize) -> Option<usize> {
    let schema = metadata.file_metadata().schema_descr();
    let leaf = (0..schema.num_columns()).find(|&leaf| schema.get_column_root_idx(leaf) == root)?;
    if schema.column(leaf).max_def_level() == 0 {
        return Some(0);
    }
    let nulls = |group: &parquet::file::metadata::RowGroupMetaData| {
        group.columns().get(leaf)?.statistics()?.null_count_opt().and_then(|count| usize::try_from(count).ok())
    };
    metadata.row_groups().iter().try_fold(0_usize, |sum, group| sum.checked_add(nulls(group)?))
}

/// The arrays of a column.
fn arrays(
    reader: &Reader<'_>,
    metadata: &ArrowReaderMetadata,
    column: usize,
) -> Result<impl Iterator<Item = Result<ArrayRef, String>> + use<>, String> {
    let builder = ParquetRecordBatchReaderBuilder::new_with_metadata(Pages::of(reader), metadata.clone());
    let mask = ProjectionMask::roots(builder.parquet_schema(), [column]);
    let batches = builder.with_projection(mask).with_batch_size(ROWS).build().map_err(|e| e.to_string())?;
    Ok(batches.map(|batch| batch.map(|batch| batch.column(0).clone()).map_err(|e| e.to_string())))
}

/// When the recording started, as its first date says.
fn started(
    reader: &Reader<'_>,
    metadata: &ArrowReaderMetadata,
    plan: &Plan,
) -> Result<Option<StartTime>, RecordingError> {
    let Some((column, clock)) = plan.dates() else { return Ok(None) };
    let damaged = |detail| reader.damaged(detail);
    for array in arrays(reader, metadata, plan.columns[*column]).map_err(damaged)? {
        if let Some(start) = start_of(&array.map_err(damaged)?, clock) {
            return Ok(Some(start));
        }
    }
    Ok(None)
}
