//! Counts of values, and of pairs of values, in bins of one width.

use std::ops::RangeInclusive;

use crate::error::{SignalError, check_range, check_same_length};

/// Bins that are counted before the width is chosen.
const FINE: usize = 1 << 14;
/// Bins of the chosen width, at least and at most.
const USUAL: RangeInclusive<usize> = 10..=200;

/// Counts of values in bins of one width.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    bins: Bins,
    counts: Vec<u64>,
}

/// Bins of one width over a range.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bins {
    low: f64,
    width: f64,
    count: usize,
}

impl Bins {
    fn over(range: &RangeInclusive<f64>, count: usize) -> Result<Self, SignalError> {
        let (mut low, mut high) = (*range.start(), *range.end());
        check_range("least", low, f64::MIN, f64::MAX)?;
        check_range("largest", high, low, f64::MAX)?;
        check_range("bins", count as f64, 1.0, f64::INFINITY)?;
        if low == high {
            // Of equal values: they are in the middle of a range that can be seen.
            let half = if low == 0.0 { 0.5 } else { 0.5 * low.abs() };
            (low, high) = (low - half, high + half);
        }
        Ok(Bins { low, width: high / count as f64 - low / count as f64, count })
    }

    /// The bin of a value; the last one has its upper edge too. None for what is outside or no number.
    fn of(&self, value: f64) -> Option<usize> {
        let position = (value - self.low) / self.width;
        (position >= 0.0 && position <= self.count as f64 * (1.0 + f64::EPSILON))
            .then(|| (position as usize).min(self.count - 1))
    }
}

impl Histogram {
    /// Empty bins over a range, from the lower edge of the first to the upper edge of the last.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a range that is not finite or ends before it begins, and for no bins.
    pub fn over(range: RangeInclusive<f64>, bins: usize) -> Result<Self, SignalError> {
        Ok(Histogram { bins: Bins::over(&range, bins)?, counts: vec![0; bins] })
    }

    /// Fine bins, for [`Histogram::joined`].
    ///
    /// # Errors
    /// Those of [`Histogram::over`].
    pub fn fine(range: RangeInclusive<f64>) -> Result<Self, SignalError> {
        Self::over(range, FINE)
    }

    /// Counts more values; those outside of the range, and NaN, are left out.
    pub fn add(&mut self, values: &[f64]) {
        for bin in work::checked(values).filter_map(|value| self.bins.of(*value)) {
            self.counts[bin] += 1;
        }
    }

    /// Lower edge of the first bin.
    #[must_use]
    pub fn low(&self) -> f64 {
        self.bins.low
    }

    /// Width of a bin.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.bins.width
    }

    /// Values in each bin.
    #[must_use]
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// Value below which this share of the counted values lies, known to a bin; none where nothing was counted.
    #[must_use]
    pub fn quantile(&self, share: f64) -> Option<f64> {
        let wanted = share * self.counts.iter().sum::<u64>() as f64;
        let mut below = 0;
        let bin = self.counts.iter().position(|count| {
            below += count;
            *count > 0 && below as f64 >= wanted
        })?;
        Some(self.bins.low + (bin as f64 + 0.5) * self.bins.width)
    }

    /// The same with neighbouring bins joined to a width near `2 IQR / ∛n`, but to 10 bins at least and 200 at most.
    ///
    /// # Example
    /// ```
    /// use signal::histogram::Histogram;
    /// let values: Vec<f64> = (0..8000).map(|i| f64::from(i) / 8000.0).collect();
    /// let mut fine = Histogram::fine(0.0..=1.0)?;
    /// fine.add(&values);
    /// // The quartiles are 0.5 apart, and ∛8000 is 20.
    /// assert!((fine.joined().width() - 0.05).abs() < 1e-3);
    /// # Ok::<(), signal::SignalError>(())
    /// ```
    ///
    /// # Source
    /// Freedman, D., and Diaconis, P. (1981), Z. Wahrscheinlichkeitstheorie 57, 453–476.
    #[must_use]
    pub fn joined(&self) -> Self {
        let count = self.counts.iter().sum::<u64>() as f64;
        let middle_half = self.quantile(0.75).zip(self.quantile(0.25)).map_or(0.0, |(upper, lower)| upper - lower);
        let wanted = (2.0 * middle_half / count.cbrt() / self.bins.width).round() as usize;
        let several = wanted.clamp(self.counts.len().div_ceil(*USUAL.end()), self.counts.len() / USUAL.start());
        let several = several.max(1);
        let counts: Vec<u64> = self.counts.chunks(several).map(|bins| bins.iter().sum()).collect();
        Histogram { bins: Bins { width: several as f64 * self.bins.width, count: counts.len(), ..self.bins }, counts }
    }
}

/// Counts of pairs of values in cells of a plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    x: Bins,
    y: Bins,
    /// Of each bin along x the counts of those along y.
    pub counts: Vec<Vec<u64>>,
}

impl Cells {
    /// Counts pairs; those of which a part is no number are left out.
    ///
    /// # Errors
    /// [`SignalError::LengthMismatch`], [`SignalError::TooShort`] without a pair, [`SignalError::Parameter`] without a
    /// cell.
    pub fn of(x: &[f64], y: &[f64], columns: usize, rows: usize) -> Result<Self, SignalError> {
        check_same_length(x.len(), y.len())?;
        let pairs = || x.iter().zip(y).filter(|(x, y)| x.is_finite() && y.is_finite());
        let range = |value: fn((&f64, &f64)) -> f64| {
            let empty = (f64::INFINITY, f64::NEG_INFINITY);
            let (low, high) = pairs().map(value).fold(empty, |(low, high), v| (low.min(v), high.max(v)));
            if low <= high { Ok(low..=high) } else { Err(SignalError::TooShort { needed: 1, got: 0 }) }
        };
        let (x, y) = (Bins::over(&range(|(x, _)| *x)?, columns)?, Bins::over(&range(|(_, y)| *y)?, rows)?);
        let mut counts = vec![vec![0; rows]; columns];
        for (at_x, at_y) in work::checked(pairs()) {
            if let Some((column, row)) = x.of(*at_x).zip(y.of(*at_y)) {
                counts[column][row] += 1;
            }
        }
        Ok(Cells { x, y, counts })
    }

    /// Lower edge of the first bin along x, and the width of one.
    #[must_use]
    pub fn along_x(&self) -> [f64; 2] {
        [self.x.low, self.x.width]
    }

    /// Lower edge of the first bin along y, and the width of one.
    #[must_use]
    pub fn along_y(&self) -> [f64; 2] {
        [self.y.low, self.y.width]
    }
}
