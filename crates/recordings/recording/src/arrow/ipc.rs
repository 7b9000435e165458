//! Files and streams of Arrow: the batches that they describe, column by column.

use std::ops::Range;

use arrow_array::{Array, ArrayRef};
use arrow_schema::DataType;

use super::batch::{Batch, Dictionaries, learn};
use super::messages::{Messages, Place};
use super::plan::Plan;
use super::reader::Reader;
use super::table::{Flaw, Table, start_of};
use crate::error;
use crate::{Catalogue, Finding, Format, RecordingError, StartTime};

/// Rows that are read at once where they are not compressed; a multiple of 8, for values of one bit.
const ROWS: usize = 1 << 16;

/// Times that a column of a batch is in memory while it is unpacked: as bytes, as an array, and as numbers.
const UNPACKED: usize = 3;

/// Reads where the batches of a file or stream are.
pub(super) fn load(reader: &Reader<'_>, is_stream: bool) -> Result<Messages, RecordingError> {
    let open = if is_stream { Messages::of_stream } else { Messages::of_file };
    open(&**reader.source).map_err(|detail| reader.damaged(detail))
}

/// Columns of a file or stream.
pub(super) struct Ipc<'r> {
    pub(super) reader: &'r Reader<'r>,
    pub(super) messages: &'r Messages,
    pub(super) plan: Plan,
}

impl Ipc<'_> {
    /// Reads all rows.
    pub(super) fn table(self) -> Result<Table, RecordingError> {
        let Self { reader, messages, plan } = self;
        let columns = plan.columns.clone();
        let counts = counts(reader, messages, &plan)?;
        let most = usize::try_from(reader.size.saturating_mul(8)).unwrap_or(usize::MAX);
        let expected: Vec<usize> = counts.iter().map(|count| *count.min(&most)).collect();
        let all = expected.iter().fold(0_u64, |all, count| all.saturating_add(*count as u64));
        reader.check_size(all, 1)?;
        check_room(reader, messages, columns.len())?;
        let mut table = Table::new(plan, reader.row_distance_s, &expected);
        let mut work = Work { reader, messages, columns: &columns, dictionaries: Dictionaries::new() };
        for place in &messages.places {
            work.message(*place, &mut table)?;
        }
        Ok(table)
    }

    pub(super) fn list(self) -> Result<Catalogue, RecordingError> {
        let Self { reader, messages, plan } = self;
        let counts = counts(reader, messages, &plan)?;
        let samples: Vec<Option<usize>> = counts.into_iter().map(Some).collect();
        let start_time = started(reader, messages, &plan)?;
        let mut catalogue = plan.into_catalogue(Format::Arrow, &samples, start_time);
        if !messages.is_ended {
            catalogue.findings.push(Finding::NotFinalised);
        }
        Ok(catalogue)
    }
}

/// Fails for more rows than are plausible, and where the memory has no room for their numbers and for those of a batch
/// while it is unpacked.
fn check_room(reader: &Reader<'_>, messages: &Messages, columns: usize) -> Result<(), RecordingError> {
    let rows = messages.rows(&**reader.source).map_err(|detail| reader.damaged(detail))?;
    let all = rows.last().map_or(0, |last| last.end);
    reader.check_size(all as u64, columns)?;
    let largest = rows.iter().map(ExactSizeIterator::len).max().unwrap_or(0);
    let numbers = all.saturating_mul(columns).saturating_add(largest.saturating_mul(UNPACKED));
    error::check_room(numbers.saturating_mul(size_of::<f64>())).map_err(|detail| reader.damaged(detail))
}

/// Appends a range of rows to a table: of each column the bytes of these rows, or of compressed batches all that have
/// some.
pub(super) fn append(
    reader: &Reader<'_>,
    messages: &Messages,
    columns: &[usize],
    range: &Range<usize>,
    table: &mut Table,
) -> Result<(), RecordingError> {
    let read = |place: usize| -> Result<_, Flaw> {
        let column = columns.get(place).copied().unwrap_or(usize::MAX);
        Ok(arrays(reader, messages, column, range)?.into_iter().map(Ok))
    };
    table.append(range.len(), read).map_err(|fault| fault.error(reader.file))
}

/// The arrays of a column with a range of rows.
fn arrays(
    reader: &Reader<'_>,
    messages: &Messages,
    column: usize,
    range: &Range<usize>,
) -> Result<Vec<ArrayRef>, String> {
    let (source, schema, most) = (&**reader.source, &messages.schema, reader.most_bytes());
    let has_codes = schema.fields().get(column).is_some_and(|f| matches!(f.data_type(), DataType::Dictionary(..)));
    let (mut dictionaries, mut found) = (Dictionaries::new(), Vec::new());
    for (place, rows) in messages.places.iter().zip(messages.rows(source)?) {
        work::checkpoint();
        let own = rows.start.max(range.start)..rows.end.min(range.end);
        match place.is_dictionary {
            true if has_codes => learn(source, schema, *place, most, &mut dictionaries)?,
            false if own.start < own.end => {
                let block = place.block(source)?;
                let batch = Batch::new(source, schema, *place, &block)?;
                let first = own.start - rows.start;
                // Values of one bit begin with a byte.
                let read = if batch.is_packed() { 0..batch.rows } else { first / 8 * 8..own.end - rows.start };
                let array = batch.array(column, read.clone(), &dictionaries, most)?;
                found.push(array.slice(first - read.start, own.len()));
            }
            _ => {}
        }
    }
    Ok(found)
}

/// Does something with each batch; stops where it yields something.
fn each<T>(
    reader: &Reader<'_>,
    messages: &Messages,
    mut with: impl FnMut(&Batch<'_>) -> Result<Option<T>, String>,
) -> Result<Option<T>, RecordingError> {
    let damaged = |detail| reader.damaged(detail);
    for place in messages.places.iter().filter(|place| !place.is_dictionary) {
        let block = place.block(&**reader.source).map_err(damaged)?;
        let batch = Batch::new(&**reader.source, &messages.schema, *place, &block).map_err(damaged)?;
        if let Some(found) = with(&batch).map_err(damaged)? {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

/// The samples of each group.
fn counts(reader: &Reader<'_>, messages: &Messages, plan: &Plan) -> Result<Vec<usize>, RecordingError> {
    let mut counts = vec![0_usize; plan.groups.len()];
    each(reader, messages, |batch| {
        for (count, mark) in counts.iter_mut().zip(plan.marks()) {
            let nulls = mark.map_or(Ok(0), |mark| batch.nulls(plan.columns[mark]))?;
            *count = count.saturating_add(batch.rows.saturating_sub(nulls));
        }
        Ok(None::<()>)
    })?;
    Ok(counts)
}

/// When the recording started, as its first date says.
fn started(reader: &Reader<'_>, messages: &Messages, plan: &Plan) -> Result<Option<StartTime>, RecordingError> {
    let Some((column, clock)) = plan.dates() else { return Ok(None) };
    each(reader, messages, |batch| {
        let rows = if batch.is_packed() { batch.rows } else { batch.rows.min(ROWS) };
        let array = batch.array(plan.columns[*column], 0..rows, &Dictionaries::new(), reader.most_bytes())?;
        Ok(start_of(&array, clock))
    })
}

/// State of the passage through the messages.
struct Work<'w> {
    reader: &'w Reader<'w>,
    messages: &'w Messages,
    /// The columns that are read.
    columns: &'w [usize],
    dictionaries: Dictionaries,
}

impl Work<'_> {
    fn message(&mut self, place: Place, table: &mut Table) -> Result<(), RecordingError> {
        let (source, schema, most) = (&**self.reader.source, &self.messages.schema, self.reader.most_bytes());
        let damaged = |detail| self.reader.damaged(detail);
        if place.is_dictionary {
            return learn(source, schema, place, most, &mut self.dictionaries).map_err(damaged);
        }
        let block = place.block(source).map_err(damaged)?;
        let batch = Batch::new(source, schema, place, &block).map_err(damaged)?;
        let step = if batch.is_packed() { batch.rows.max(1) } else { ROWS };
        for first in (0..batch.rows).step_by(step) {
            let rows = first..batch.rows.min(first + step);
            let array = |column: usize| batch.array(self.columns[column], rows.clone(), &self.dictionaries, most);
            let read = |column: usize| -> Result<_, Flaw> { Ok(std::iter::once(array(column))) };
            table.append(rows.len(), read).map_err(|fault| fault.error(self.reader.file))?;
        }
        self.reader.context.reach(place.end(), self.reader.size);
        Ok(())
    }
}
