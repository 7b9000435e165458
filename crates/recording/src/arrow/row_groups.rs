//! Parquet: row groups of columns in pages, of which those of selected columns are read.

use arrow_schema::ArrowError;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use parquet::file::metadata::ParquetMetaData;

use super::Reader;
use super::pages::Pages;
use super::plan::Plan;
use super::table::{Table, start_of};
use crate::{Catalogue, Format, Recording, RecordingError, StartTime};

/// An opened file.
pub(super) struct Parquet<'r> {
    reader: &'r Reader<'r>,
    builder: ParquetRecordBatchReaderBuilder<Pages>,
    plan: Plan,
}

impl<'r> Parquet<'r> {
    pub(super) fn open(reader: &'r Reader<'r>) -> Result<Self, RecordingError> {
        let pages = Pages { source: reader.source.clone(), size: reader.size };
        let builder = ParquetRecordBatchReaderBuilder::try_new(pages).map_err(|e| reader.damaged(e.to_string()))?;
        let plan = reader.plan(builder.schema())?;
        Ok(Self { reader, builder, plan })
    }

    fn rows(&self) -> u64 {
        u64::try_from(self.builder.metadata().file_metadata().num_rows()).unwrap_or(u64::MAX)
    }

    pub(super) fn read(self) -> Result<Recording, RecordingError> {
        let Self { reader, .. } = self;
        let (all, width) = (self.rows(), self.plan.columns.len());
        reader.check_size(all, width)?;
        let most = usize::try_from(all.min(reader.size.saturating_mul(8))).unwrap_or(usize::MAX);
        let expected: Vec<usize> = self.samples().into_iter().map(|count| count.unwrap_or(most).min(most)).collect();
        let columns = self.plan.columns.clone();
        let batches = batches(reader, self.builder, &columns)?;
        let mut table = Table::new(self.plan, reader.row_distance_s, &expected);
        let mut rows = 0_u64;
        for batch in batches {
            let batch = batch.map_err(|error: ArrowError| reader.damaged(error.to_string()))?;
            rows = rows.saturating_add(batch.num_rows() as u64);
            reader.check_size(rows, width)?;
            let read = |column: usize| Ok(batch.column(column).clone());
            table.append(batch.num_rows(), read).map_err(|fault| fault.error(reader.file))?;
            (reader.progress)(rows, all);
        }
        let mut recording = table.finish();
        recording.format = Format::Parquet;
        Ok(recording)
    }

    pub(super) fn list(self) -> Result<Catalogue, RecordingError> {
        self.reader.check_size(self.rows(), self.plan.columns.len())?;
        let samples = self.samples();
        let start_time = started(self.reader, self.builder, &self.plan)?;
        Ok(self.plan.into_catalogue(Format::Parquet, &samples, start_time))
    }

    /// The samples of each group, where the file counts the values that are missing.
    fn samples(&self) -> Vec<Option<usize>> {
        let metadata = self.builder.metadata();
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

fn batches(
    reader: &Reader<'_>,
    builder: ParquetRecordBatchReaderBuilder<Pages>,
    columns: &[usize],
) -> Result<ParquetRecordBatchReader, RecordingError> {
    let mask = ProjectionMask::roots(builder.parquet_schema(), columns.iter().copied());
    builder.with_projection(mask).build().map_err(|e| reader.damaged(e.to_string()))
}

/// When the recording started, as its first date says.
fn started(
    reader: &Reader<'_>,
    builder: ParquetRecordBatchReaderBuilder<Pages>,
    plan: &Plan,
) -> Result<Option<StartTime>, RecordingError> {
    let Some((column, clock)) = plan.dates() else { return Ok(None) };
    for batch in batches(reader, builder, &[plan.columns[*column]])? {
        let batch = batch.map_err(|error: ArrowError| reader.damaged(error.to_string()))?;
        if let Some(start) = start_of(batch.column(0), clock) {
            return Ok(Some(start));
        }
    }
    Ok(None)
}
