//! Files and streams of Arrow: the batches that they describe, column by column.

use super::batch::{Batch, Dictionaries, learn};
use super::messages::{Messages, Place};
use super::plan::Plan;
use super::reader::Reader;
use super::table::{Flaw, Table, start_of};
use crate::{Catalogue, Finding, Format, Recording, RecordingError, StartTime};

/// Rows that are read at once where they are not compressed; a multiple of 8, for values of one bit.
const ROWS: usize = 1 << 16;

/// An opened file or stream.
pub(super) struct Ipc<'r> {
    reader: &'r Reader<'r>,
    messages: Messages,
    plan: Plan,
}

impl<'r> Ipc<'r> {
    pub(super) fn open(reader: &'r Reader<'r>, is_stream: bool) -> Result<Self, RecordingError> {
        let open = if is_stream { Messages::of_stream } else { Messages::of_file };
        let messages = open(&**reader.source).map_err(|detail| reader.damaged(detail))?;
        let plan = reader.plan(&messages.schema)?;
        Ok(Self { reader, messages, plan })
    }

    pub(super) fn read(self) -> Result<Recording, RecordingError> {
        let Self { reader, messages, plan } = self;
        let columns = plan.columns.clone();
        let counts = counts(reader, &messages, &plan)?;
        let most = usize::try_from(reader.size.saturating_mul(8)).unwrap_or(usize::MAX);
        let expected: Vec<usize> = counts.iter().map(|count| *count.min(&most)).collect();
        let all = expected.iter().fold(0_u64, |all, count| all.saturating_add(*count as u64));
        reader.check_size(all, 1)?;
        let mut table = Table::new(plan, reader.row_distance_s, &expected);
        let mut work =
            Work { reader, messages: &messages, columns: &columns, dictionaries: Dictionaries::new(), rows: 0 };
        for place in &messages.places {
            work.message(*place, &mut table)?;
        }
        let mut recording = table.finish();
        if !messages.is_ended {
            recording.findings.push(Finding::NotFinalised);
        }
        Ok(recording)
    }

    pub(super) fn list(self) -> Result<Catalogue, RecordingError> {
        let Self { reader, messages, plan } = self;
        let counts = counts(reader, &messages, &plan)?;
        let samples: Vec<Option<usize>> = counts.into_iter().map(Some).collect();
        let start_time = started(reader, &messages, &plan)?;
        let mut catalogue = plan.into_catalogue(Format::Arrow, &samples, start_time);
        if !messages.is_ended {
            catalogue.findings.push(Finding::NotFinalised);
        }
        Ok(catalogue)
    }
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
    rows: u64,
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
        self.rows = self.rows.saturating_add(batch.rows as u64);
        self.reader.check_size(self.rows, self.columns.len())?;
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
