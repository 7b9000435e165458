//! MAT-files and HDF5 in part: arrays in memory, and datasets of which rows are read.

use std::collections::HashMap;
use std::ops::Range;

use super::dataset::{Dataset, rows};
use super::stored::{Numbers, Stored};
use crate::part::{Series, slice};
use crate::{Recording, RecordingError};

/// Numbers that are read at once.
const MOST_NUMBERS: usize = 1 << 19;

/// A recording of which some samples are in datasets.
pub(crate) struct Content {
    pub(crate) recording: Recording,
    /// For each channel where its samples are, if they are not in the recording.
    pub(super) stored: Vec<Option<Stored>>,
    pub(super) datasets: Vec<Dataset>,
}

impl Content {
    /// Reads the channels that are rows of a dataset.
    pub(super) fn fill(&mut self, file: &str) -> Result<(), RecordingError> {
        for (channel, stored) in self.recording.channels.iter_mut().zip(&mut self.stored) {
            if let Some(Stored { dataset, part: Numbers::Row(row) }) = *stored {
                channel.samples = rows(file, &self.datasets[dataset], row..row + 1)?;
                *stored = None;
            }
        }
        Ok(())
    }

    /// Tells whether all samples are in the recording.
    pub(crate) fn is_whole(&self) -> bool {
        self.stored.iter().all(Option::is_none)
    }

    /// Rows of the channels of a raster, by the index of the channel.
    pub(crate) fn samples(
        &self,
        file: &str,
        raster: usize,
        range: &Range<u64>,
    ) -> Result<Vec<(usize, Vec<f64>)>, RecordingError> {
        let place = |row: u64| usize::try_from(row).unwrap_or(usize::MAX);
        let (mut read, mut found) = (HashMap::new(), Vec::new());
        for (index, (channel, stored)) in self.recording.channels.iter().zip(&self.stored).enumerate() {
            work::checkpoint();
            if channel.raster != raster {
                continue;
            }
            let Some(Stored { dataset, part }) = stored else {
                found.push((index, slice(&channel.samples, range).to_vec()));
                continue;
            };
            if !read.contains_key(dataset) {
                let numbers = rows(file, &self.datasets[*dataset], place(range.start)..place(range.end))?;
                read.insert(*dataset, numbers);
            }
            let numbers = read.get(dataset).map(Vec::as_slice).unwrap_or_default();
            let own = match *part {
                Numbers::Across { index, width } => numbers.iter().skip(index).step_by(width.max(1)).copied().collect(),
                Numbers::Vector | Numbers::Row(_) => numbers.to_vec(),
            };
            found.push((index, own));
        }
        Ok(found)
    }

    /// Goes through all samples once, so many rows of a raster at a time.
    pub(crate) fn visit(&self, file: &str, each: &dyn Fn(Series, u64, &[f64])) -> Result<(), RecordingError> {
        for (raster, clock) in self.recording.rasters.iter().enumerate() {
            let samples = clock.time_s.len();
            let own = self.recording.channels.iter().filter(|channel| channel.raster == raster).count();
            let step = (MOST_NUMBERS / own.max(1)).max(1 << 14);
            for first in (0..samples).step_by(step) {
                work::checkpoint();
                let range = first as u64..samples.min(first + step) as u64;
                each(Series::Clock(raster), range.start, slice(&clock.time_s, &range));
                for (channel, numbers) in self.samples(file, raster, &range)? {
                    each(Series::Channel(channel), range.start, &numbers);
                }
            }
        }
        Ok(())
    }
}
