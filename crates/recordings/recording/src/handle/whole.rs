//! MAT-files and HDF5: what was decoded is kept, as far as it fits.

use std::ops::Range;
use std::sync::Arc;

use work::Context;

use crate::kept::Kept;
use crate::part::{ClockShape, Each, Opened, Part, concerns, slice};
use crate::source::Shared;
use crate::{Catalogue, Channel, Raster, Recording, RecordingError, Selection};
use crate::{epoch, mat};

/// A MAT-file.
pub(super) struct Whole {
    name: String,
    source: Shared,
    row_distance_s: Option<f64>,
    /// The selections that were decoded.
    kept: Kept<Selection, mat::Content>,
}

impl Whole {
    pub(super) fn new(name: &str, source: Shared, row_distance_s: Option<f64>) -> Self {
        Self { name: name.to_owned(), source, row_distance_s, kept: Kept::default() }
    }
}

fn bytes(recording: &Recording) -> usize {
    let times = recording.rasters.iter().map(|raster| raster.time_s.len());
    let samples = recording.channels.iter().map(|channel| channel.samples.len());
    times.chain(samples).sum::<usize>() * size_of::<f64>()
}

impl Opened for Whole {
    fn catalogue(&self) -> Result<Catalogue, RecordingError> {
        mat::catalogue(&self.name, &self.source, self.row_distance_s)
    }

    fn decode(&self, selection: &Selection, context: &Context) -> Result<Recording, RecordingError> {
        if let Some(kept) = self.kept.get(selection).filter(|kept| kept.is_whole()) {
            return Ok(kept.recording.clone());
        }
        let Self { name, source, row_distance_s, .. } = self;
        mat::decode(name, source, selection, *row_distance_s, context).map(epoch::counted_from_first)
    }

    fn part<'s>(&'s self, selection: &'s Selection, context: &Context) -> Result<Box<dyn Part + 's>, RecordingError> {
        let Self { name, source, row_distance_s, .. } = self;
        if let Some(content) = self.kept.get(selection) {
            return Ok(Box::new(Content { name, content }));
        }
        let mut content = mat::content(name, source, selection, *row_distance_s, context)?;
        content.recording = epoch::counted_from_first(content.recording);
        let bytes = bytes(&content.recording);
        Ok(Box::new(Content { name, content: self.kept.keep(selection.clone(), content, bytes) }))
    }
}

/// Selected channels.
struct Content<'s> {
    name: &'s str,
    content: Arc<mat::Content>,
}

impl Part for Content<'_> {
    fn clocks(&self) -> Result<Vec<ClockShape>, RecordingError> {
        let shape = |raster: &Raster| {
            let samples = raster.time_s.len() as u64;
            ClockShape { samples, grain: samples.max(1), is_out_of_order: false }
        };
        Ok(self.content.recording.rasters.iter().map(shape).collect())
    }

    fn channels(&self) -> Vec<(String, usize)> {
        self.content.recording.channels.iter().map(|channel| (channel.name.clone(), channel.raster)).collect()
    }

    fn stamps(&self, clock: usize, rows: Range<u64>, _: &Context) -> Result<Vec<f64>, RecordingError> {
        Ok(self
            .content
            .recording
            .rasters
            .get(clock)
            .map(|raster| slice(&raster.time_s, &rows))
            .unwrap_or_default()
            .to_vec())
    }

    fn read(&self, rows: &[Range<u64>], _: &Context) -> Result<Recording, RecordingError> {
        let of = |raster: usize| rows.get(raster).cloned().unwrap_or(0..0);
        let whole = &self.content.recording;
        let raster = |(index, raster): (usize, &Raster)| {
            work::checkpoint();
            Raster { time_s: slice(&raster.time_s, &of(index)).to_vec(), name: raster.name.clone() }
        };
        let channel = |channel: &Channel| Channel {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            comment: channel.comment.clone(),
            raster: channel.raster,
            samples: Vec::new(),
        };
        let mut channels: Vec<Channel> = whole.channels.iter().map(channel).collect();
        for raster in 0..whole.rasters.len() {
            for (index, samples) in self.content.samples(self.name, raster, &of(raster))? {
                channels[index].samples = samples;
            }
        }
        let findings = whole.findings.iter().filter(|finding| concerns(finding, &channels)).cloned().collect();
        Ok(Recording {
            format: whole.format,
            comment: whole.comment.clone(),
            start_time: whole.start_time,
            rasters: whole.rasters.iter().enumerate().map(raster).collect(),
            channels,
            findings,
        })
    }

    fn visit(&self, _: &Context, each: Each<'_>) -> Result<(), RecordingError> {
        self.content.visit(self.name, each)
    }
}
