//! The least and the largest of many numbers, over more and more of them.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Numbers in a bin of the lowest level, at least.
const LEAST_BASE: u64 = 64;
/// Bins of the lowest level, at most: 12 MB. There are as many above it.
const MOST_BINS: u64 = 1 << 19;
/// Numbers that are compared at the same time.
const LANES: usize = 8;

/// The least and the largest of some numbers; infinities the wrong way round where all are missing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bin {
    pub(super) min: f64,
    pub(super) max: f64,
    /// Numbers that are NaN.
    pub(super) missing: u64,
}

impl Bin {
    pub(super) const EMPTY: Self = Self { min: f64::INFINITY, max: f64::NEG_INFINITY, missing: 0 };

    pub(super) fn of(numbers: &[f64]) -> Self {
        let (whole, rest) = numbers.as_chunks::<LANES>();
        let (mut min, mut max, mut missing) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES], [0_u64; LANES]);
        for chunk in whole {
            for lane in 0..LANES {
                let number = chunk[lane];
                // NaN is neither.
                min[lane] = if number < min[lane] { number } else { min[lane] };
                max[lane] = if number > max[lane] { number } else { max[lane] };
                missing[lane] += u64::from(number.is_nan());
            }
        }
        let lanes = (0..LANES).map(|lane| Self { min: min[lane], max: max[lane], missing: missing[lane] });
        let rest = rest.iter().map(|&number| match number.is_nan() {
            true => Self { missing: 1, ..Self::EMPTY },
            false => Self { min: number, max: number, missing: 0 },
        });
        lanes.chain(rest).fold(Self::EMPTY, Self::with)
    }

    pub(super) fn with(self, other: Self) -> Self {
        Self {
            min: if other.min < self.min { other.min } else { self.min },
            max: if other.max > self.max { other.max } else { self.max },
            missing: self.missing + other.missing,
        }
    }
}

/// Bins of numbers, over 2^k·base of them on level k.
#[derive(Debug)]
pub(super) struct Levels {
    pub(super) samples: u64,
    pub(super) base: u64,
    levels: Vec<Vec<Bin>>,
}

impl Levels {
    /// The bin over rows that begin and end at multiples of the base, or at the end of all.
    pub(super) fn over(&self, rows: Range<u64>) -> Bin {
        let (mut bin, mut at) = (Bin::EMPTY, rows.start);
        while at < rows.end {
            let fits = |level: &usize| {
                let width = self.base << level;
                at.is_multiple_of(width) && (at + width <= rows.end || rows.end == self.samples && *level == 0)
            };
            let Some(level) = (0..self.levels.len()).rev().find(fits) else { break };
            let width = self.base << level;
            let found = self.levels[level].get(usize::try_from(at / width).unwrap_or(usize::MAX));
            bin = bin.with(found.copied().unwrap_or(Bin::EMPTY));
            at += width;
        }
        bin
    }
}

/// Levels under construction, to which several threads add.
pub(super) struct Builder {
    samples: u64,
    base: u64,
    bins: Mutex<Vec<Bin>>,
}

impl Builder {
    pub(super) fn new(samples: u64) -> Self {
        let mut base = LEAST_BASE;
        while samples.div_ceil(base) > MOST_BINS {
            base *= 2;
        }
        let bins = usize::try_from(samples.div_ceil(base)).unwrap_or_default();
        Self { samples, base, bins: Mutex::new(vec![Bin::EMPTY; bins]) }
    }

    /// Adds numbers from a row on.
    pub(super) fn add(&self, first: u64, numbers: &[f64]) {
        let into_bin = usize::try_from(first % self.base).unwrap_or_default();
        let width = usize::try_from(self.base).unwrap_or(usize::MAX);
        let (head, rest) = numbers.split_at((width - into_bin).min(numbers.len()));
        // Worked out before the bins are taken, for which others wait.
        let bins: Vec<Bin> = std::iter::once(head).chain(rest.chunks(width)).map(Bin::of).collect();
        let place = usize::try_from(first / self.base).unwrap_or(usize::MAX);
        let mut all = self.bins.lock().unwrap_or_else(PoisonError::into_inner);
        for (own, bin) in all.iter_mut().skip(place).zip(bins) {
            *own = own.with(bin);
        }
    }

    pub(super) fn finish(self) -> Levels {
        let mut levels = vec![self.bins.into_inner().unwrap_or_else(PoisonError::into_inner)];
        while let Some(last) = levels.last().filter(|level| level.len() > 1) {
            let joined = |pair: &[Bin]| pair.iter().copied().fold(Bin::EMPTY, Bin::with);
            levels.push(last.chunks(2).map(joined).collect());
        }
        Levels { samples: self.samples, base: self.base, levels }
    }
}
