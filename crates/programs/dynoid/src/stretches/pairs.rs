//! Two channels of a stretch against each other.

use dataset::{CommonClock, DatasetOptions, dataset};
use recording::Span;
use signal::histogram::Cells;
use toolbox_report::one_clock::adjustments;
use work::Context;

use super::{CellsFacts, PIECE, PairsFacts, RecordedStretch};
use crate::error::Error;

/// Pairs that are handed on one by one; more are counted in cells.
const MOST_POINTS: usize = 20_000;
const COLUMNS: usize = 240;
const ROWS: usize = 160;

impl RecordedStretch {
    /// Values of two channels at the same instants: those of the slower one, on whose clock the faster one is brought
    /// through a low-pass filter without phase shift ([`dataset()`]). A stretch with more samples than fit into memory
    /// ends earlier.
    ///
    /// # Errors
    /// Channels that cannot be read, and such as have no clock or no time in common.
    pub fn pairs(&self, x: &str, y: &str, context: &Context) -> Result<PairsFacts, Error> {
        let (one, other) = (self.some_course(x, context)?, self.some_course(y, context)?);
        let (from_s, mut to_s) = (one.from_s.min(other.from_s), one.to_s.max(other.to_s));
        let share = PIECE as f64 / one.samples.max(other.samples) as f64;
        let is_cut = share < 1.0;
        if is_cut {
            to_s = from_s + share * (to_s - from_s);
        }
        let names = if x == y { vec![x] } else { vec![x, y] };
        let read = self.read(&names, &Span::Time { from_s, to_s }, context)?;
        let outputs = vec![x.to_owned(), y.to_owned()];
        let options = DatasetOptions { outputs, clock: CommonClock::Slowest, ..DatasetOptions::default() };
        let (data, adjusted) = dataset(&[(&self.file, &read)], &options)?;
        let experiment = &data.experiments()[0];
        let (along_x, along_y) = (experiment.output(0), experiment.output(1));
        let are_numbers = |(x, y): &(&f64, &f64)| x.is_finite() && y.is_finite();
        let whole = || along_x.iter().zip(along_y).filter(are_numbers);
        let pairs = whole().count();
        let is_drawn = pairs <= MOST_POINTS;
        let cells = (!is_drawn).then(|| Cells::of(along_x, along_y, COLUMNS, ROWS)).transpose();
        let cells = cells.map_err(|source| self.unusable(x, source))?;
        Ok(PairsFacts {
            units: [self.unit(x)?, self.unit(y)?],
            from_s: experiment.start_s,
            to_s: experiment.start_s + experiment.len().saturating_sub(1) as f64 * data.sample_time_s(),
            sample_time_s: data.sample_time_s(),
            pairs,
            missing: experiment.len() - pairs,
            is_cut,
            points: if is_drawn { whole().map(|(x, y)| [*x, *y]).collect() } else { Vec::new() },
            cells: cells.map(|found| CellsFacts {
                along_x: found.along_x(),
                along_y: found.along_y(),
                counts: found.counts,
            }),
            notes: adjustments(&adjusted),
        })
    }
}
