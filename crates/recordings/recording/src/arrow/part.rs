//! Tables read in part: clocks whole, once, and of channels the rows that are wanted.

use std::ops::Range;
use std::sync::Arc;

use parquet::arrow::arrow_reader::ArrowReaderMetadata;
use work::Context;

use super::ipc::{self, Ipc};
use super::kind::Kind;
use super::messages::Messages;
use super::plan::{Heading, Plan};
use super::reader::Reader;
use super::row_groups::{self, Columns, Parquet};
use super::table::{Places, Table};
use crate::error::guarded;
use crate::kept::Kept;
use crate::part::{self, ClockShape, Each, STEP, Series, concerns};
use crate::source::{self, Shared};
use crate::{Catalogue, Channel, Finding, Format, Raster, Recording, RecordingError, Selection, epoch};

/// Numbers that are read at once, of all channels of a group.
const MOST_NUMBERS: usize = 1 << 19;

/// A file whose structure is read.
pub(super) struct Opened {
    name: String,
    source: Shared,
    size: u64,
    row_distance_s: Option<f64>,
    content: Content,
    clocks: Kept<Key, Clocks>,
}

/// Structure of a file.
enum Content {
    Parquet(ArrowReaderMetadata),
    Arrow(Messages),
}

/// The columns of the clock and of the mark of each group.
type Key = Vec<(Option<usize>, Option<usize>)>;

/// Clocks that were read.
struct Clocks {
    /// The recording without its channels.
    recording: Recording,
    /// The rows of the table that have the stamps of each clock.
    places: Vec<Places>,
    /// Rows of the table.
    rows: usize,
    /// For each clock, true where its stamps do not decrease.
    are_sorted: Vec<bool>,
}

impl Opened {
    pub(super) fn new(
        name: &str,
        source: Shared,
        kind: Kind,
        row_distance_s: Option<f64>,
    ) -> Result<Self, RecordingError> {
        let size = source::size(name, &*source)?;
        let (selection, context) = (&Selection::All, &Context::new());
        let reader = Reader { file: name, source: &source, size, selection, row_distance_s, context };
        let content = guarded(name, || match kind {
            Kind::Parquet => row_groups::load(&reader).map(Content::Parquet),
            Kind::File | Kind::Stream => ipc::load(&reader, kind == Kind::Stream).map(Content::Arrow),
        })?;
        Ok(Self { name: name.to_owned(), source, size, row_distance_s, content, clocks: Kept::default() })
    }

    fn reader<'s>(&'s self, selection: &'s Selection, context: &'s Context) -> Reader<'s> {
        let Self { name, source, size, row_distance_s, .. } = self;
        Reader { file: name, source, size: *size, selection, row_distance_s: *row_distance_s, context }
    }

    fn plan(&self, reader: &Reader<'_>) -> Result<Plan, RecordingError> {
        match &self.content {
            Content::Parquet(metadata) => reader.plan(metadata.schema()),
            Content::Arrow(messages) => reader.plan(&messages.schema),
        }
    }

    /// Reads all rows of the columns in a plan.
    fn table(&self, reader: &Reader<'_>, plan: Plan) -> Result<Table, RecordingError> {
        match &self.content {
            Content::Parquet(metadata) => Parquet { reader, metadata, plan }.table(),
            Content::Arrow(messages) => Ipc { reader, messages, plan }.table(),
        }
    }

    /// Appends a range of rows to a table, which has these columns.
    fn append(
        &self,
        reader: &Reader<'_>,
        columns: &[usize],
        range: Range<usize>,
        table: &mut Table,
    ) -> Result<(), RecordingError> {
        match &self.content {
            Content::Parquet(metadata) => Columns::new(reader, metadata, columns, Some(range)).append(0, table),
            Content::Arrow(messages) => ipc::append(reader, messages, columns, &range, table),
        }
    }

    /// The recording that a table has become.
    fn finished(&self, table: Table) -> Recording {
        let mut recording = table.finish();
        match &self.content {
            Content::Parquet(_) => recording.format = Format::Parquet,
            Content::Arrow(messages) if !messages.is_ended => recording.findings.push(Finding::NotFinalised),
            Content::Arrow(_) => {}
        }
        epoch::counted_from_first(recording)
    }

    fn clocks(&self, plan: &Plan, context: &Context) -> Result<Arc<Clocks>, RecordingError> {
        let column = |place: usize| plan.columns.get(place).copied();
        let clock = |group: &super::plan::Group| group.clock.as_ref().and_then(|(place, _)| column(*place));
        let key: Key = plan.groups.iter().map(clock).zip(plan.marks().map(|mark| mark.and_then(column))).collect();
        if let Some(clocks) = self.clocks.get(&key) {
            return Ok(clocks);
        }
        let reader = self.reader(&Selection::All, context);
        let mut table = guarded(&self.name, || self.table(&reader, plan.of_clocks()))?;
        let (places, rows) = (table.take_places(), table.rows());
        let recording = self.finished(table);
        let are_sorted = recording.rasters.iter().map(|raster| raster.time_s.is_sorted()).collect();
        let numbers: usize = recording.rasters.iter().map(|raster| raster.time_s.len()).sum();
        let clocks = Clocks { recording, places, rows, are_sorted };
        Ok(self.clocks.keep(key, clocks, numbers * size_of::<f64>()))
    }
}

impl part::Opened for Opened {
    fn catalogue(&self) -> Result<Catalogue, RecordingError> {
        let (selection, context) = (&Selection::All, &Context::new());
        let reader = &self.reader(selection, context);
        guarded(&self.name, || {
            let plan = self.plan(reader)?;
            match &self.content {
                Content::Parquet(metadata) => Parquet { reader, metadata, plan }.list(),
                Content::Arrow(messages) => Ipc { reader, messages, plan }.list(),
            }
        })
    }

    /// Of Parquet only the pages of selected columns are read, of Arrow only their buffers.
    fn decode(&self, selection: &Selection, context: &Context) -> Result<Recording, RecordingError> {
        let reader = self.reader(selection, context);
        guarded(&self.name, || Ok(self.finished(self.table(&reader, self.plan(&reader)?)?)))
    }

    fn part<'s>(
        &'s self,
        selection: &'s Selection,
        context: &Context,
    ) -> Result<Box<dyn part::Part + 's>, RecordingError> {
        let plan = guarded(&self.name, || self.plan(&self.reader(selection, &Context::new())))?;
        let clocks = self.clocks(&plan, context)?;
        Ok(Box::new(Part { opened: self, clocks, plan }))
    }
}

/// Selected channels.
struct Part<'s> {
    opened: &'s Opened,
    clocks: Arc<Clocks>,
    plan: Plan,
}

impl Part<'_> {
    /// The channels in the order of the file, each with the index of its clock.
    fn headings(&self) -> Vec<(usize, &Heading)> {
        let groups = self.plan.groups.iter().enumerate();
        let mut all: Vec<_> =
            groups.flat_map(|(raster, group)| group.channels.iter().map(move |heading| (raster, heading))).collect();
        all.sort_by_key(|(_, heading)| heading.column);
        all
    }

    /// Reads some rows of the channels of a group.
    fn group(&self, raster: usize, rows: &Range<u64>, context: &Context) -> Result<Vec<Channel>, RecordingError> {
        let own = place(rows.start)..place(rows.end);
        let all = self.clocks.rows;
        let (range, surplus) = self.clocks.places.get(raster).map_or((0..0, 0), |places| places.rows(&own, all));
        let range = if own.is_empty() { 0..0 } else { range };
        let plan = self.plan.of_channels(raster);
        let columns = plan.columns.clone();
        let mut table = Table::new(plan, None, &[range.len()]).starting_at(range.start);
        if !range.is_empty() {
            let reader = self.opened.reader(&Selection::All, context);
            guarded(&self.opened.name, || self.opened.append(&reader, &columns, range, &mut table))?;
        }
        let mut channels = table.finish().channels;
        for channel in &mut channels {
            channel.raster = raster;
            channel.samples.truncate(surplus + own.len());
            channel.samples.drain(..surplus.min(channel.samples.len()));
        }
        Ok(channels)
    }

    /// Findings on the file, its clocks, and channels with integers that were rounded, in the order of the whole.
    fn findings(&self, channels: &[Channel]) -> Vec<Finding> {
        let wide = self.headings().into_iter().filter(|(_, heading)| heading.is_wide);
        let wide = wide.map(|(_, heading)| Finding::RoundedIntegers { channel: heading.name.clone() });
        let rounded = wide.filter(|finding| concerns(finding, channels));
        let of_clocks = self.clocks.recording.findings.iter().cloned();
        let mut all: Vec<Finding> = self.plan.findings.iter().cloned().chain(of_clocks).chain(rounded).collect();
        all.sort_by_key(|finding| match finding {
            Finding::SkippedChannel { .. } => (0, String::new()),
            Finding::DoubtfulSeconds { .. } => (1, String::new()),
            Finding::RoundedIntegers { channel } => (2, channel.clone()),
            _ => (3, String::new()),
        });
        all.dedup();
        all
    }
}

impl part::Part for Part<'_> {
    fn clocks(&self) -> Result<Vec<ClockShape>, RecordingError> {
        let clocks = self.clocks.recording.rasters.iter().zip(&self.clocks.are_sorted);
        let shape = |(raster, is_sorted): (&Raster, &bool)| ClockShape {
            samples: raster.time_s.len() as u64,
            grain: 1,
            is_out_of_order: !is_sorted,
        };
        Ok(clocks.map(shape).collect())
    }

    fn channels(&self) -> Vec<(String, usize)> {
        self.headings().into_iter().map(|(raster, heading)| (heading.name.clone(), raster)).collect()
    }

    fn stamps(&self, clock: usize, rows: Range<u64>, _: &Context) -> Result<Vec<f64>, RecordingError> {
        let time_s = self.clocks.recording.rasters.get(clock).map(|raster| raster.time_s.as_slice());
        Ok(part::slice(time_s.unwrap_or_default(), &rows).to_vec())
    }

    fn read(&self, rows: &[Range<u64>], context: &Context) -> Result<Recording, RecordingError> {
        let of = |raster: usize| rows.get(raster).cloned().unwrap_or(0..0);
        let groups = (0..self.plan.groups.len()).map(|raster| self.group(raster, &of(raster), context));
        let mut groups: Vec<_> = groups.map(|group| group.map(Vec::into_iter)).collect::<Result<_, _>>()?;
        let headings = self.headings();
        let channels = headings.iter().filter_map(|(raster, _)| groups.get_mut(*raster)?.next()).collect::<Vec<_>>();
        let whole = &self.clocks.recording;
        let raster = |(index, raster): (usize, &Raster)| Raster {
            time_s: part::slice(&raster.time_s, &of(index)).to_vec(),
            name: raster.name.clone(),
        };
        Ok(Recording {
            format: whole.format,
            comment: whole.comment.clone(),
            start_time: whole.start_time,
            rasters: whole.rasters.iter().enumerate().map(raster).collect(),
            findings: self.findings(&channels),
            channels,
        })
    }

    fn visit(&self, context: &Context, each: Each<'_>) -> Result<(), RecordingError> {
        let headings = self.headings();
        let total: u64 = self.clocks.recording.rasters.iter().map(|raster| raster.time_s.len() as u64).sum();
        let mut done = 0;
        for (index, raster) in self.clocks.recording.rasters.iter().enumerate() {
            for (number, stamps) in raster.time_s.chunks(STEP).enumerate() {
                each(Series::Clock(index), (number * STEP) as u64, stamps);
            }
            let own = headings.iter().enumerate().filter(|(_, (raster, _))| *raster == index);
            let own: Vec<usize> = own.map(|(channel, _)| channel).collect();
            let samples = raster.time_s.len();
            let step = (MOST_NUMBERS / own.len().max(1)).max(STEP);
            for first in (0..samples).step_by(step) {
                let rows = first as u64..samples.min(first + step) as u64;
                let channels = self.group(index, &rows, context)?;
                for (channel, read) in own.iter().zip(channels) {
                    each(Series::Channel(*channel), rows.start, &read.samples);
                }
                done += rows.end - rows.start;
                context.reach(done, total);
            }
        }
        Ok(())
    }
}

fn place(row: u64) -> usize {
    usize::try_from(row).unwrap_or(usize::MAX)
}
