//! The least and the largest of many numbers, and the first and the last, over more and more of them.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Numbers in a bin of the lowest level, at least.
const LEAST_BASE: u64 = 64;
/// Bins of the lowest level, at most: 12 MB, and 8 MB of their ends. There are as many above it, without ends.
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

/// The first and the last of some numbers that are not missing; NaN where all are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ends {
    pub(super) first: f64,
    pub(super) last: f64,
}

impl Ends {
    pub(super) const NONE: Self = Self { first: f64::NAN, last: f64::NAN };

    pub(super) fn of(numbers: &[f64]) -> Self {
        let present = |number: &&f64| !number.is_nan();
        match (numbers.iter().find(present), numbers.iter().rev().find(present)) {
            (Some(first), Some(last)) => Self { first: *first, last: *last },
            _ => Self::NONE,
        }
    }

    /// These and later ones.
    pub(super) fn then(self, later: Self) -> Self {
        Self {
            first: if self.first.is_nan() { later.first } else { self.first },
            last: if later.last.is_nan() { self.last } else { later.last },
        }
    }
}

/// Bins of numbers, over 2^k·base of them on level k.
#[derive(Debug)]
pub(super) struct Levels {
    pub(super) samples: u64,
    pub(super) base: u64,
    levels: Vec<Vec<Bin>>,
    /// The ends of the bins of the lowest level; nothing of a clock, whose ends are its least and largest stamps.
    ends: Vec<Ends>,
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

    /// The ends of such rows.
    pub(super) fn ends(&self, rows: Range<u64>) -> Ends {
        let place = |row: u64| usize::try_from(row).unwrap_or(usize::MAX);
        let bins = place(rows.start / self.base)..place(rows.end.div_ceil(self.base));
        let ends = if rows.is_empty() { &[] } else { self.ends.get(bins).unwrap_or_default() };
        let first = ends.iter().map(|ends| ends.first).find(|first| !first.is_nan());
        let last = ends.iter().rev().map(|ends| ends.last).find(|last| !last.is_nan());
        Ends { first: first.unwrap_or(f64::NAN), last: last.unwrap_or(f64::NAN) }
    }
}

/// Levels under construction, to which several threads add.
pub(super) struct Builder {
    samples: u64,
    base: u64,
    bins: Mutex<Gathered>,
}

struct Gathered {
    bins: Vec<Bin>,
    /// Nothing where no ends are wanted.
    ends: Vec<Placed>,
}

/// Ends that may be gathered in any order, with the places in their bin that they are known of.
#[derive(Clone, Copy)]
struct Placed {
    ends: Ends,
    first_at: u64,
    last_at: u64,
}

impl Placed {
    const NONE: Self = Self { ends: Ends::NONE, first_at: u64::MAX, last_at: 0 };

    /// Takes in the ends of numbers from a place on.
    fn add(&mut self, at: u64, ends: Ends) {
        if ends.first.is_nan() {
            return;
        }
        if at < self.first_at {
            (self.ends.first, self.first_at) = (ends.first, at);
        }
        if at >= self.last_at {
            (self.ends.last, self.last_at) = (ends.last, at);
        }
    }
}

impl Builder {
    /// Levels of so many numbers, with the ends of their bins or without.
    pub(super) fn new(samples: u64, has_ends: bool) -> Self {
        let mut base = LEAST_BASE;
        while samples.div_ceil(base) > MOST_BINS {
            base *= 2;
        }
        let bins = usize::try_from(samples.div_ceil(base)).unwrap_or_default();
        let ends = if has_ends { vec![Placed::NONE; bins] } else { Vec::new() };
        Self { samples, base, bins: Mutex::new(Gathered { bins: vec![Bin::EMPTY; bins], ends }) }
    }

    /// Adds numbers from a row on.
    pub(super) fn add(&self, first: u64, numbers: &[f64]) {
        let into_bin = usize::try_from(first % self.base).unwrap_or_default();
        let width = usize::try_from(self.base).unwrap_or(usize::MAX);
        let (head, rest) = numbers.split_at((width - into_bin).min(numbers.len()));
        // Worked out before the bins are taken, for which others wait.
        let bins: Vec<(Bin, Ends)> =
            std::iter::once(head).chain(rest.chunks(width)).map(|some| (Bin::of(some), Ends::of(some))).collect();
        let place = usize::try_from(first / self.base).unwrap_or(usize::MAX);
        let mut all = self.bins.lock().unwrap_or_else(PoisonError::into_inner);
        for (own, (bin, _)) in all.bins.iter_mut().skip(place).zip(&bins) {
            *own = own.with(*bin);
        }
        // All but the first begin where their bin does.
        let places = std::iter::once(first % self.base).chain(std::iter::repeat(0));
        for ((own, (_, ends)), at) in all.ends.iter_mut().skip(place).zip(&bins).zip(places) {
            own.add(at, *ends);
        }
    }

    pub(super) fn finish(self) -> Levels {
        let Gathered { bins, ends } = self.bins.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut levels = vec![bins];
        while let Some(last) = levels.last().filter(|level| level.len() > 1) {
            let joined = |pair: &[Bin]| pair.iter().copied().fold(Bin::EMPTY, Bin::with);
            levels.push(last.chunks(2).map(joined).collect());
        }
        let ends = ends.into_iter().map(|placed| placed.ends).collect();
        Levels { samples: self.samples, base: self.base, levels, ends }
    }
}
