//! Parquet: row groups of columns in pages, of which those of selected columns are read.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use arrow_array::{ArrayRef, RecordBatch};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ArrowReaderMetadata, ParquetRecordBatchReaderBuilder};
use parquet::basic::Compression;
use parquet::file::metadata::ParquetMetaData;

use super::pages::Pages;
use super::plan::Plan;
use super::reader::Reader;
use super::table::{Flaw, Table, start_of};
use crate::{Catalogue, Format, RecordingError, SkipReason, StartTime};

/// Rows that are read at once.
const ROWS: usize = 1 << 16;

/// Reads what a file says of its columns and row groups.
pub(super) fn load(reader: &Reader<'_>) -> Result<ArrowReaderMetadata, RecordingError> {
    let metadata = ArrowReaderMetadata::load(&Pages::of(reader), Default::default());
    metadata.map_err(|e| reader.damaged(e.to_string()))
}

/// How many rows a file has.
pub(super) fn rows(metadata: &ArrowReaderMetadata) -> u64 {
    u64::try_from(metadata.metadata().file_metadata().num_rows()).unwrap_or(u64::MAX)
}

/// Columns of a file.
pub(super) struct Parquet<'r> {
    pub(super) reader: &'r Reader<'r>,
    pub(super) metadata: &'r ArrowReaderMetadata,
    pub(super) plan: Plan,
}

impl Parquet<'_> {
    /// Reads all rows.
    pub(super) fn table(self) -> Result<Table, RecordingError> {
        let Self { reader, .. } = self;
        let (all, width) = (rows(self.metadata), self.plan.columns.len());
        reader.check_size(all, width)?;
        let most = usize::try_from(all.min(reader.size.saturating_mul(8))).unwrap_or(usize::MAX);
        let expected: Vec<usize> = self.samples().into_iter().map(|count| count.unwrap_or(most).min(most)).collect();
        let (columns, reads) = (self.plan.columns.clone(), self.plan.reads());
        let mut table = Table::new(self.plan, reader.row_distance_s, &expected);
        let columns = Columns::new(reader, self.metadata, &columns, None);
        columns.append(reads, &mut table)?;
        Ok(table)
    }

    pub(super) fn list(self) -> Result<Catalogue, RecordingError> {
        self.reader.check_size(rows(self.metadata), self.plan.columns.len())?;
        let samples = self.samples();
        let start_time = started(self.reader, self.metadata, &self.plan)?;
        Ok(self.plan.into_catalogue(Format::Parquet, &samples, start_time))
    }

    /// The samples of each group, where the file counts the values that are missing.
    fn samples(&self) -> Vec<Option<usize>> {
        let metadata = self.metadata.metadata();
        let rows = usize::try_from(rows(self.metadata)).ok();
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

/// The columns that are read. Of each that is being read there are pages in memory, so long ones are read one after the
/// other; a reader goes through the schema of all, so short ones are read in blocks.
pub(super) struct Columns<'a> {
    reader: &'a Reader<'a>,
    metadata: &'a ArrowReaderMetadata,
    columns: &'a [usize],
    /// The rows that are read, where these are not all.
    range: Option<Range<usize>>,
    rows: usize,
    /// The places of the columns that were read last, and their batches; none where they could not be read together.
    block: RefCell<(Range<usize>, Vec<RecordBatch>)>,
}

impl<'a> Columns<'a> {
    pub(super) fn new(
        reader: &'a Reader<'a>,
        metadata: &'a ArrowReaderMetadata,
        columns: &'a [usize],
        range: Option<Range<usize>>,
    ) -> Self {
        let all = || usize::try_from(rows(metadata)).unwrap_or(usize::MAX);
        let rows = range.as_ref().map_or_else(all, ExactSizeIterator::len);
        Self { reader, metadata, columns, range, rows, block: RefCell::default() }
    }

    /// Appends the rows to a table, which reads so many columns.
    pub(super) fn append(&self, reads: usize, table: &mut Table) -> Result<(), RecordingError> {
        let (done, total) = (Cell::new(0), (self.rows as u64).saturating_mul(reads as u64));
        let read = |column: usize| {
            let arrays = self.arrays(column)?;
            Ok(arrays.inspect(|array| {
                done.set(done.get() + array.as_ref().map_or(0, |array| array.len() as u64));
                match self.range {
                    None => self.reader.context.reach(done.get(), total),
                    Some(_) => work::checkpoint(),
                }
            }))
        };
        table.append(self.rows, read).map_err(|fault| fault.error(self.reader.file))
    }

    /// The arrays of the column at a place.
    fn arrays(&self, place: usize) -> Result<Box<dyn Iterator<Item = Result<ArrayRef, String>> + '_>, Flaw> {
        let width = (ROWS / self.rows.max(1)).max(1);
        if width > 1 {
            let first = place / width * width;
            let mut block = self.block.borrow_mut();
            if !block.0.contains(&place) {
                let places = first..self.columns.len().min(first + width);
                *block = (places.clone(), self.together(places));
            }
            if !block.1.is_empty() {
                let arrays: Vec<_> = block.1.iter().map(|batch| Ok(batch.column(place - first).clone())).collect();
                return Ok(Box::new(arrays.into_iter()));
            }
        }
        let column = self.columns[place];
        if let Some(reason) = unreadable(self.metadata.metadata(), column) {
            return Err(Flaw::Unusable(reason));
        }
        let batches = batches(self.reader, self.metadata, &[column], self.range.as_ref())?;
        Ok(Box::new(batches.map(|batch| batch.map(|batch| batch.column(0).clone()))))
    }

    /// The batches of several columns; none where one cannot be read, which has to be found. No more are read than it
    /// takes to see that there are too many rows.
    fn together(&self, places: Range<usize>) -> Vec<RecordBatch> {
        let mut before = 0;
        let is_due = |batch: &Result<RecordBatch, String>| {
            let is_due = before <= self.rows;
            before += batch.as_ref().map_or(0, RecordBatch::num_rows);
            is_due
        };
        let batches = batches(self.reader, self.metadata, &self.columns[places], self.range.as_ref());
        batches.and_then(|batches| batches.take_while(is_due).collect()).unwrap_or_default()
    }
}

/// The batches of columns, whose arrays are in the order of the file: of all rows, or of a range the row groups with
/// it.
fn batches(
    reader: &Reader<'_>,
    metadata: &ArrowReaderMetadata,
    columns: &[usize],
    range: Option<&Range<usize>>,
) -> Result<impl Iterator<Item = Result<RecordBatch, String>> + use<>, String> {
    let builder = ParquetRecordBatchReaderBuilder::new_with_metadata(Pages::of(reader), metadata.clone());
    let mask = ProjectionMask::roots(builder.parquet_schema(), columns.iter().copied());
    let rows = usize::try_from(rows(metadata)).unwrap_or(ROWS);
    let rows = range.map_or(rows, ExactSizeIterator::len).clamp(1, ROWS);
    let mut builder = builder.with_projection(mask).with_batch_size(rows);
    if let Some(range) = range {
        let (groups, skipped) = groups(metadata.metadata(), range);
        builder = builder.with_row_groups(groups).with_offset(skipped).with_limit(range.len());
    }
    let batches = builder.build().map_err(|e| e.to_string())?;
    Ok(batches.map(|batch| batch.map_err(|e| e.to_string())))
}

/// The row groups with rows of a range, and how many rows stand before the range in them.
fn groups(metadata: &ParquetMetaData, range: &Range<usize>) -> (Vec<usize>, usize) {
    let (mut begin, mut skipped, mut found) = (0_usize, 0, Vec::new());
    for (index, group) in metadata.row_groups().iter().enumerate() {
        let end = begin.saturating_add(usize::try_from(group.num_rows()).unwrap_or(0));
        if begin < range.end && end > range.start {
            skipped = if found.is_empty() { range.start.saturating_sub(begin) } else { skipped };
            found.push(index);
        }
        begin = end;
    }
    (found, skipped)
}

/// Why a sound column cannot be read: how it is compressed.
fn unreadable(metadata: &ParquetMetaData, root: usize) -> Option<SkipReason> {
    let schema = metadata.file_metadata().schema_descr();
    let leaves = (0..schema.num_columns()).filter(|&leaf| schema.get_column_root_idx(leaf) == root);
    let compression = |leaf: usize| metadata.row_groups().first()?.columns().get(leaf).map(|chunk| chunk.compression());
    let name = leaves.filter_map(compression).find_map(|compression| match compression {
        Compression::BROTLI(_) => Some("brotli"),
        Compression::LZO => Some("LZO"),
        _ => None,
    })?;
    let detail = format!("compressed with {name}; save the file with snappy, gzip, lz4 or zstd");
    Some(SkipReason::Unsupported { detail })
}

/// When the recording started, as its first date says.
fn started(
    reader: &Reader<'_>,
    metadata: &ArrowReaderMetadata,
    plan: &Plan,
) -> Result<Option<StartTime>, RecordingError> {
    let Some((column, clock)) = plan.dates() else { return Ok(None) };
    let damaged = |detail| reader.damaged(detail);
    for batch in batches(reader, metadata, &[plan.columns[*column]], None).map_err(damaged)? {
        if let Some(start) = start_of(batch.map_err(damaged)?.column(0), clock) {
            return Ok(Some(start));
        }
    }
    Ok(None)
}
