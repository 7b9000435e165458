//! Stretches of recordings: their figures, histograms, spectra over frequency and time, and pairs of two channels.
//!
//! A stretch is read in pieces, so that memory does not grow with it.

mod facts;
mod pairs;
mod spectra;

use dataset::inspection::{Gathered, Stretch};
use recording::{Handle, Recording, Selection, Span};
use signal::histogram::Histogram;
use work::Context;

use crate::error::Error;

pub use facts::{CellsFacts, HistogramFacts, PairsFacts, PowerFacts, SegmentsFacts, SpectrogramFacts};

/// Samples that are read at once.
const PIECE: u64 = 1 << 21;
/// Times by which a stretch that has no sample grows.
const GROWTH: f64 = 10.0;

/// A stretch of an open recording.
#[derive(Debug, Clone)]
pub struct RecordedStretch {
    handle: Handle,
    file: String,
    from_s: f64,
    to_s: f64,
}

/// How a channel runs in a stretch.
#[derive(Debug, Clone, Copy)]
struct Course {
    from_s: f64,
    to_s: f64,
    samples: u64,
}

impl RecordedStretch {
    /// A stretch of a recording with this name, from one stamp to another, s; infinite where it has no end.
    #[must_use]
    pub fn new(handle: Handle, file: &str, from_s: f64, to_s: f64) -> Self {
        RecordedStretch { handle, file: file.to_owned(), from_s, to_s }
    }

    /// Figures of a channel; of a single instant those of the next sample.
    ///
    /// # Errors
    /// A channel that cannot be read.
    pub fn figures(&self, channel: &str, context: &Context) -> Result<Stretch, Error> {
        let course = match self.to_s <= self.from_s {
            true => self.next_sample(channel, context)?,
            false => self.course(channel, context)?,
        };
        let mut gathered = Gathered::default();
        if let Some(course) = course {
            self.each_piece(channel, course, context, |time_s, samples| gathered.add(time_s, samples))?;
        }
        Ok(gathered.figures())
    }

    /// Counts of a channel's samples in so many bins; without a number in bins of a width that suits them.
    ///
    /// # Errors
    /// A channel that cannot be read, or has no sample there that is a number.
    pub fn histogram(&self, channel: &str, bins: Option<usize>, context: &Context) -> Result<HistogramFacts, Error> {
        let (course, figures) = (self.some_course(channel, context)?, self.figures(channel, context)?);
        let range = figures.least.zip(figures.largest).map(|(least, largest)| least..=largest);
        let range =
            range.ok_or_else(|| self.unusable(channel, "no sample in this stretch is a number; choose another"))?;
        let counted = match bins {
            Some(bins) => Histogram::over(range, bins),
            None => Histogram::fine(range),
        };
        let mut counted = counted.map_err(|source| self.unusable(channel, source))?;
        self.each_piece(channel, course, context, |_, samples| counted.add(samples))?;
        let shown = if bins.is_some() { counted } else { counted.joined() };
        Ok(HistogramFacts {
            unit: self.unit(channel)?,
            figures,
            low: shown.low(),
            width: shown.width(),
            counts: shown.counts().to_vec(),
        })
    }

    fn course(&self, channel: &str, context: &Context) -> Result<Option<Course>, Error> {
        let pyramid = self.handle.pyramid(channel, context).map_err(of_recording)?;
        let seen = pyramid.view(self.from_s, self.to_s, 1).map_err(of_recording)?;
        Ok(seen.first().map(|seen| Course { from_s: seen.from_s, to_s: seen.to_s, samples: seen.samples }))
    }

    fn some_course(&self, channel: &str, context: &Context) -> Result<Course, Error> {
        self.course(channel, context)?.ok_or_else(|| self.no_sample(channel))
    }

    fn no_sample(&self, channel: &str) -> Error {
        self.unusable(channel, "it has no sample in this stretch; choose a longer one")
    }

    /// The sample at the beginning or the next one, perhaps with some that follow; none behind the last sample.
    fn next_sample(&self, channel: &str, context: &Context) -> Result<Option<Course>, Error> {
        let all = RecordedStretch { from_s: f64::NEG_INFINITY, to_s: f64::INFINITY, ..self.clone() };
        let Some(whole) = all.course(channel, context)? else { return Ok(None) };
        let from_s = self.from_s.max(whole.from_s);
        let mut wider_s = 0.0;
        loop {
            let to_s = (from_s + wider_s).min(whole.to_s);
            let found = RecordedStretch { from_s, to_s, ..self.clone() }.course(channel, context)?;
            if found.is_some() || to_s >= whole.to_s {
                return Ok(found);
            }
            wider_s = (wider_s * GROWTH).max((whole.to_s - whole.from_s) / whole.samples as f64);
        }
    }

    fn each_piece(
        &self,
        channel: &str,
        course: Course,
        context: &Context,
        mut each: impl FnMut(&[f64], &[f64]),
    ) -> Result<(), Error> {
        for span in course.pieces() {
            let read = self.read(&[channel], &span, context)?;
            for channel in &read.channels {
                each(read.time_s(channel).unwrap_or_default(), &channel.samples);
            }
        }
        Ok(())
    }

    /// Reads channels; of several of one name the first, as plots do.
    fn read(&self, channels: &[&str], span: &Span, context: &Context) -> Result<Recording, Error> {
        work::checkpoint();
        let selection = Selection::names(channels.iter().copied());
        let mut read = self.handle.read(&selection, span, context).map_err(of_recording)?;
        let mut seen: Vec<String> = Vec::new();
        read.channels.retain(|channel| {
            let is_first = !seen.contains(&channel.name);
            seen.push(channel.name.clone());
            is_first
        });
        Ok(read)
    }

    fn unit(&self, channel: &str) -> Result<String, Error> {
        let catalogue = self.handle.catalogue().map_err(of_recording)?;
        let found = catalogue.channels.into_iter().find(|listed| listed.name == channel);
        Ok(found.map(|listed| listed.unit).unwrap_or_default())
    }

    fn unusable(&self, channel: &str, fault: impl ToString) -> Error {
        Error::UnusableChannel { data: self.file.clone(), channel: channel.to_owned(), fault: fault.to_string() }
    }
}

impl Course {
    /// Spans of time with about as many samples each. A stamp at a seam belongs to the piece before.
    fn pieces(self) -> impl Iterator<Item = Span> {
        let count = self.samples.div_ceil(PIECE).max(1);
        let at = move |k: u64| self.from_s + (self.to_s - self.from_s) * (k as f64 / count as f64);
        (0..count).map(move |k| Span::Time {
            from_s: if k == 0 { self.from_s } else { at(k).next_up() },
            to_s: if k + 1 == count { self.to_s } else { at(k + 1) },
        })
    }
}

fn of_recording(source: recording::RecordingError) -> Error {
    Error::Recording { source, untimed: false }
}
