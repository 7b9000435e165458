//! Text read in part: one pass makes an index, then ranges take the rows that they need.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use work::Context;

use super::index::{EVERY, Index};
use super::table::{Table, names};
use crate::epoch::{Origin, counted_from_first};
use crate::kept::Kept;
use crate::part::{ClockShape, Each, Opened, Part, Series, concerns};
use crate::required::require_names;
use crate::source::Shared;
use crate::{Catalogue, Recording, RecordingError, Selection};

/// Rows that are handed on at once.
const STEP: usize = 1 << 14;

/// A text that is read by an index.
pub(crate) struct Indexed {
    name: String,
    source: Shared,
    row_distance_s: Option<f64>,
    /// The index of all columns, once it was made; none where it does not hold for every selection.
    of_all: OnceLock<Option<Arc<Index>>>,
    /// Indices for selections.
    kept: Kept<Selection, Index>,
}

impl Indexed {
    pub(crate) fn new(name: &str, source: Shared, row_distance_s: Option<f64>) -> Self {
        Self { name: name.to_owned(), source, row_distance_s, of_all: OnceLock::new(), kept: Kept::default() }
    }

    /// The index for a selection: that of all columns, unless these cannot all be read.
    fn index(&self, selection: &Selection, context: &Context) -> Result<Arc<Index>, RecordingError> {
        let made = |selection| Index::new(&self.name, &*self.source, selection, self.row_distance_s, context);
        let of_all = match self.of_all.get() {
            Some(of_all) => of_all,
            None => {
                let made = made(&Selection::All);
                if let Err(error @ RecordingError::Unreadable { .. }) = made {
                    return Err(error);
                }
                let index = made.ok().filter(Index::is_of_any_selection).map(Arc::new);
                self.of_all.get_or_init(|| index)
            }
        };
        if let Some(index) = of_all.clone().or_else(|| self.kept.get(selection)) {
            return Ok(index);
        }
        let index = made(selection)?;
        let bytes = index.bytes();
        Ok(self.kept.keep(selection.clone(), index, bytes))
    }
}

impl Opened for Indexed {
    fn catalogue(&self) -> Result<Catalogue, RecordingError> {
        super::catalogue(&self.name, &*self.source, self.row_distance_s)
    }

    fn decode(&self, selection: &Selection, context: &Context) -> Result<Recording, RecordingError> {
        super::decode(&self.name, &*self.source, selection, self.row_distance_s, context).map(counted_from_first)
    }

    fn part<'s>(&'s self, selection: &'s Selection, context: &Context) -> Result<Box<dyn Part + 's>, RecordingError> {
        let index = self.index(selection, context)?;
        let table = index.table(selection);
        require_names(&self.name, selection, names(&table.headings))?;
        let blocks = table.filled_blocks();
        let mut recording = index.without_numbers(table.clone(), selection)?;
        let origin = Origin::of(blocks.iter().map(|&block| index.clocks[block].first_s));
        if let Some(origin) = &origin {
            origin.note(&mut recording);
        }
        Ok(Box::new(Chosen { opened: self, index, table, blocks, recording, origin }))
    }
}

/// Selected channels.
struct Chosen<'s> {
    opened: &'s Indexed,
    index: Arc<Index>,
    table: Table,
    /// The block of each raster.
    blocks: Vec<usize>,
    /// The recording without numbers.
    recording: Recording,
    origin: Option<Origin>,
}

impl Chosen<'_> {
    fn samples(&self, raster: usize) -> usize {
        self.blocks.get(raster).map_or(0, |&block| self.index.clocks[block].samples)
    }

    /// Reads rows of a raster: its stamps, and of its channels those in `table`.
    fn rows(
        &self,
        table: &Table,
        raster: usize,
        rows: &Range<u64>,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), RecordingError> {
        let place = |row: u64| usize::try_from(row).unwrap_or(usize::MAX).min(self.samples(raster));
        let rows = place(rows.start)..place(rows.end);
        let (mut time_s, mut channels) = (Vec::new(), Vec::new());
        let Some(block) = self.blocks.get(raster) else { return Ok((time_s, channels)) };
        let file = (self.opened.name.as_str(), &*self.opened.source);
        self.index.read(file, (table, &[*block]), rows.clone(), &mut |series, first, numbers| {
            let numbers = numbers.get(rows.start.saturating_sub(first)..).unwrap_or_default();
            match series {
                Series::Clock(_) => time_s.extend_from_slice(numbers),
                Series::Channel(channel) => {
                    channels.resize_with(channels.len().max(channel + 1), Vec::new);
                    channels[channel].extend_from_slice(numbers);
                }
            }
        })?;
        if let Some(origin) = &self.origin {
            origin.count(raster, &mut time_s);
        }
        Ok((time_s, channels))
    }
}

impl Part for Chosen<'_> {
    fn clocks(&self) -> Result<Vec<ClockShape>, RecordingError> {
        let shape = |block: &usize| {
            let clock = &self.index.clocks[*block];
            ClockShape { samples: clock.samples as u64, grain: EVERY as u64, is_out_of_order: !clock.is_sorted }
        };
        Ok(self.blocks.iter().map(shape).collect())
    }

    fn channels(&self) -> Vec<(String, usize)> {
        self.recording.channels.iter().map(|channel| (channel.name.clone(), channel.raster)).collect()
    }

    fn stamps(&self, clock: usize, rows: Range<u64>, _: &Context) -> Result<Vec<f64>, RecordingError> {
        let none = self.table.narrowed(&Selection::Names(Vec::new()));
        Ok(self.rows(&none, clock, &rows)?.0)
    }

    fn read(&self, rows: &[Range<u64>], _: &Context) -> Result<Recording, RecordingError> {
        let mut recording = self.recording.clone();
        for (raster, rows) in rows.iter().enumerate().take(recording.rasters.len()) {
            let (time_s, samples) = self.rows(&self.table, raster, rows)?;
            recording.rasters[raster].time_s = time_s;
            let own = recording.channels.iter_mut().filter(|channel| channel.raster == raster);
            own.zip(samples).for_each(|(channel, samples)| channel.samples = samples);
        }
        let Recording { channels, findings, .. } = &mut recording;
        findings.retain(|finding| concerns(finding, channels));
        Ok(recording)
    }

    fn visit(&self, context: &Context, each: Each<'_>) -> Result<(), RecordingError> {
        let all = (0..self.blocks.len()).map(|raster| self.samples(raster)).max().unwrap_or(0);
        let file = (self.opened.name.as_str(), &*self.opened.source);
        for first in (0..all).step_by(STEP) {
            let rows = first..all.min(first + STEP);
            self.index.read(file, (&self.table, &self.blocks), rows.clone(), &mut |series, first, numbers| match (
                series,
                &self.origin,
            ) {
                (Series::Clock(clock), Some(origin)) => {
                    let mut time_s = numbers.to_vec();
                    origin.count(clock, &mut time_s);
                    each(series, first as u64, &time_s);
                }
                _ => each(series, first as u64, numbers),
            })?;
            context.reach(rows.end as u64, all as u64);
        }
        Ok(())
    }
}
