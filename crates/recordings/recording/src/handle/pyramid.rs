//! Overviews of channels.

use std::collections::HashMap;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use work::Context;

use super::levels::{Bin, Builder, Ends, Levels};
use super::span::Span;
use crate::part::{Opened, Part, Series};
use crate::{RecordingError, Selection};

/// Columns that a view has room for, at least, while it looks for a level: the first and the last are begun.
const LEAST_COLUMNS: u64 = 3;

/// Levels of a channel and of its clock.
#[derive(Debug, Clone)]
pub(super) struct Kept {
    samples: Arc<Levels>,
    clock: Arc<Levels>,
}

/// Overview of a channel: the least and the largest sample over 64 rows, 128 rows, and so on, from which plots of any
/// width are made. Of long channels it begins with more rows, so that it takes at most 60 MB.
#[derive(Clone)]
pub struct Pyramid {
    opened: Arc<dyn Opened>,
    channel: String,
    kept: Kept,
}

/// Samples of a channel that share a column of a plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    /// The first time stamp, s.
    pub from_s: f64,
    /// The last time stamp, s.
    pub to_s: f64,
    /// How many samples there are.
    pub samples: u64,
    /// How many of them are missing.
    pub missing: u64,
    /// The least sample; none where all are missing.
    pub min: Option<f64>,
    /// The largest sample; none where all are missing.
    pub max: Option<f64>,
    /// The first sample that is not missing; none where all are.
    pub first: Option<f64>,
    /// The last sample that is not missing; none where all are.
    pub last: Option<f64>,
}

/// Makes the overviews of all channels of a part, in one pass.
pub(super) fn make(part: &dyn Part, context: &Context) -> Result<HashMap<String, Kept>, RecordingError> {
    let (shapes, channels) = (part.clocks()?, part.channels());
    let clocks: Vec<Builder> = shapes.iter().map(|shape| Builder::new(shape.samples, false)).collect();
    let samples_of = |raster: usize| shapes.get(raster).map_or(0, |shape| shape.samples);
    let builders: Vec<Builder> = channels.iter().map(|(_, raster)| Builder::new(samples_of(*raster), true)).collect();
    part.visit(context, &|series, first, numbers| {
        let builder = match series {
            Series::Clock(index) => clocks.get(index),
            Series::Channel(index) => builders.get(index),
        };
        if let Some(builder) = builder {
            builder.add(first, numbers);
        }
    })?;
    let clocks: Vec<Arc<Levels>> = clocks.into_iter().map(|clock| Arc::new(clock.finish())).collect();
    let mut made = HashMap::new();
    for ((name, raster), builder) in channels.into_iter().zip(builders) {
        if let Some(clock) = clocks.get(raster) {
            let kept = || Kept { samples: Arc::new(builder.finish()), clock: clock.clone() };
            made.entry(name).or_insert_with(kept);
        }
    }
    Ok(made)
}

impl Pyramid {
    pub(super) fn new(opened: Arc<dyn Opened>, channel: &str, kept: Kept) -> Self {
        Self { opened, channel: channel.to_owned(), kept }
    }

    /// The name of the channel.
    #[must_use]
    pub fn channel(&self) -> &str {
        &self.channel
    }

    /// How many samples it has.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.kept.samples.samples
    }

    /// Rows of the lowest level that share a least and a largest sample.
    #[must_use]
    pub fn base(&self) -> u64 {
        self.kept.samples.base
    }

    /// At most so many columns of a plot of a span of time: of each the least and the largest sample, the first and the
    /// last one, and the first and the last stamp. Together they hold each sample whose row is in the span, and no
    /// other. Where there are fewer samples than columns, each has its own.
    ///
    /// Of the file it reads few rows: those at both ends of the span, or all of a span in which few remain.
    ///
    /// # Errors
    ///
    /// As [`crate::decode_from`].
    pub fn view(&self, from_s: f64, to_s: f64, columns: usize) -> Result<Vec<Envelope>, RecordingError> {
        let selection = Selection::names([self.channel.as_str()]);
        let context = Context::new();
        let part = self.opened.part(&selection, &context)?;
        let raster = part.channels().first().map_or(0, |(_, raster)| *raster);
        let Some(shape) = part.clocks()?.get(raster).copied() else { return Ok(Vec::new()) };
        let stamps = |rows: Range<u64>| part.stamps(raster, rows, &context);
        let rows = Span::Time { from_s, to_s }.rows(&shape, &stamps)?;
        View { pyramid: self, part: &*part, raster }.columns(rows, columns.max(1) as u64)
    }
}

impl fmt::Debug for Pyramid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pyramid").field("channel", &self.channel).finish_non_exhaustive()
    }
}

/// Overview that is looked at.
struct View<'a> {
    pyramid: &'a Pyramid,
    part: &'a dyn Part,
    raster: usize,
}

/// Bins of the stamps and the samples of some rows.
#[derive(Clone, Copy)]
struct Pair {
    rows: u64,
    clock: Bin,
    samples: Bin,
    ends: Ends,
}

impl View<'_> {
    fn columns(&self, rows: Range<u64>, columns: u64) -> Result<Vec<Envelope>, RecordingError> {
        let (count, base) = (rows.end - rows.start, self.pyramid.base());
        if count <= columns.saturating_mul(2 * base) {
            return self.exact_columns(rows, columns);
        }
        let mut width = base;
        while count / width + 2 > columns.max(LEAST_COLUMNS) {
            width = width.saturating_mul(2);
        }
        let mut pairs = Vec::new();
        let mut first = rows.start;
        while first < rows.end {
            let end = rows.end.min((first / width + 1).saturating_mul(width));
            pairs.push(self.pair(first..end)?);
            first = end;
        }
        let several = pairs.len().div_ceil(usize::try_from(columns).unwrap_or(usize::MAX)).max(1);
        let joined = |pairs: &[Pair]| pairs.iter().copied().reduce(Pair::with).map(Pair::envelope);
        Ok(pairs.chunks(several).filter_map(joined).collect())
    }

    /// Columns of samples that are read.
    fn exact_columns(&self, rows: Range<u64>, columns: u64) -> Result<Vec<Envelope>, RecordingError> {
        let width = usize::try_from((rows.end - rows.start).div_ceil(columns)).unwrap_or(usize::MAX).max(1);
        let (time_s, samples) = self.read(rows)?;
        let columns = time_s.chunks(width).zip(samples.chunks(width));
        Ok(columns.map(|(time_s, samples)| Pair::of(time_s, samples).envelope()).collect())
    }

    /// The bins of some rows; what begins or ends within a bin of the lowest level is read.
    fn pair(&self, rows: Range<u64>) -> Result<Pair, RecordingError> {
        let Kept { samples, clock } = &self.pyramid.kept;
        let base = samples.base;
        let begin = rows.start.next_multiple_of(base).min(rows.end);
        let end = if rows.end == samples.samples { rows.end } else { (rows.end / base * base).max(begin) };
        let [before, after] = [rows.start..begin, end..rows.end].map(|edge| self.read_pair(edge));
        let whole = Pair {
            rows: end - begin,
            clock: clock.over(begin..end),
            samples: samples.over(begin..end),
            ends: samples.ends(begin..end),
        };
        Ok(before?.with(whole).with(after?))
    }

    /// The bins of rows that are read; of none empty ones.
    fn read_pair(&self, rows: Range<u64>) -> Result<Pair, RecordingError> {
        let (time_s, samples) = if rows.is_empty() { (Vec::new(), Vec::new()) } else { self.read(rows)? };
        Ok(Pair::of(&time_s, &samples))
    }

    /// Stamps and samples of some rows.
    fn read(&self, rows: Range<u64>) -> Result<(Vec<f64>, Vec<f64>), RecordingError> {
        let mut of_clocks = vec![0..0; self.part.clocks()?.len()];
        if let Some(own) = of_clocks.get_mut(self.raster) {
            *own = rows;
        }
        let recording = self.part.read(&of_clocks, &Context::new())?;
        let time_s = recording.rasters.into_iter().nth(self.raster).map(|raster| raster.time_s);
        let samples = recording.channels.into_iter().next().map(|channel| channel.samples);
        Ok((time_s.unwrap_or_default(), samples.unwrap_or_default()))
    }
}

impl Pair {
    fn of(time_s: &[f64], samples: &[f64]) -> Self {
        let rows = samples.len() as u64;
        Self { rows, clock: Bin::of(time_s), samples: Bin::of(samples), ends: Ends::of(samples) }
    }

    /// These rows and later ones.
    fn with(self, other: Self) -> Self {
        Self {
            rows: self.rows + other.rows,
            clock: self.clock.with(other.clock),
            samples: self.samples.with(other.samples),
            ends: self.ends.then(other.ends),
        }
    }

    fn envelope(self) -> Envelope {
        let present = (self.samples.missing < self.rows).then_some(self.samples);
        Envelope {
            from_s: self.clock.min,
            to_s: self.clock.max,
            samples: self.rows,
            missing: self.samples.missing,
            min: present.map(|bin| bin.min),
            max: present.map(|bin| bin.max),
            first: present.map(|_| self.ends.first),
            last: present.map(|_| self.ends.last),
        }
    }
}
