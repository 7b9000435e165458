//! Medians of windows that slide over a series, at the logarithm of its length for each step.

use std::ops::Range;

/// Rank of NaN and infinite values, which have none.
const NONE: u32 = u32::MAX;

/// A series with the place of each finite value in ascending order.
#[derive(Debug, Clone)]
pub struct Ranked {
    sorted: Vec<f64>,
    ranks: Vec<u32>,
}

impl Ranked {
    /// Of a series of fewer than 2³² values.
    ///
    /// # Example
    /// ```
    /// let ranked = numerics::sliding_median::Ranked::of(&[5.0, 1.0, f64::NAN, 3.0, 4.0]);
    /// let mut window = ranked.window();
    /// window.slide_to(0..4);
    /// assert_eq!((window.count(), window.upper_median()), (3, Some(3.0)));
    /// window.slide_to(1..5);
    /// assert_eq!(window.upper_median(), Some(3.0));
    /// window.slide_to(4..5);
    /// assert_eq!(window.upper_median(), Some(4.0));
    /// ```
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        let mut places: Vec<u32> = (0..values.len() as u32).filter(|k| values[*k as usize].is_finite()).collect();
        places.sort_unstable_by(|a, b| values[*a as usize].total_cmp(&values[*b as usize]));
        let mut ranks = vec![NONE; values.len()];
        places.iter().enumerate().for_each(|(rank, k)| ranks[*k as usize] = rank as u32);
        Ranked { sorted: places.iter().map(|k| values[*k as usize]).collect(), ranks }
    }

    /// An empty window at its beginning.
    #[must_use]
    pub fn window(&self) -> Window<'_> {
        Window { ranked: self, counts: vec![0; self.sorted.len() + 1], range: 0..0, count: 0 }
    }
}

/// A window over a series.
#[derive(Debug, Clone)]
pub struct Window<'a> {
    ranked: &'a Ranked,
    /// How many values of the window have ranks in the range that ends at each rank, as long as its lowest bit
    /// (Fenwick, *A new data structure for cumulative frequency tables*, Softw. Pract. Exp. 24, 1994).
    counts: Vec<u32>,
    range: Range<usize>,
    count: usize,
}

impl Window<'_> {
    /// Moves the window; the cheaper, the nearer.
    pub fn slide_to(&mut self, range: Range<usize>) {
        let (first, end) = (range.start, range.end.max(range.start).min(self.ranked.ranks.len()));
        if first >= self.range.end || end <= self.range.start {
            self.take(self.range.clone(), false);
            self.range = first..first;
        }
        self.take(first..self.range.start, true);
        self.take(self.range.start..first, false);
        self.take(self.range.end..end, true);
        self.take(end..self.range.end, false);
        self.range = first..end;
    }

    /// How many finite values it holds.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Their median, of an even number the upper of the two in the middle.
    #[must_use]
    pub fn upper_median(&self) -> Option<f64> {
        if self.count == 0 {
            return None;
        }
        let (mut rank, mut left) = (0, (self.count / 2) as u32);
        let mut step = self.counts.len().next_power_of_two() / 2;
        while step > 0 {
            if let Some(count) = self.counts.get(rank + step)
                && *count <= left
            {
                rank += step;
                left -= count;
            }
            step /= 2;
        }
        self.ranked.sorted.get(rank).copied()
    }

    /// Takes values of these places in, or out.
    fn take(&mut self, places: Range<usize>, is_in: bool) {
        for rank in places.filter_map(|k| self.ranked.ranks.get(k)).filter(|rank| **rank != NONE) {
            let mut at = *rank as usize + 1;
            while let Some(count) = self.counts.get_mut(at) {
                *count = if is_in { *count + 1 } else { *count - 1 };
                at += at & at.wrapping_neg();
            }
            self.count = if is_in { self.count + 1 } else { self.count - 1 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Ranked;
    use crate::order::upper_median;

    #[test]
    fn exact_medians_of_windows_that_move_anywhere() {
        let noise = |i: usize| ((i as f64 * 12.9898).sin() * 43758.5453).fract();
        let values: Vec<f64> = (0..300)
            .map(|i| match i % 17 {
                3 => f64::NAN,
                5 => f64::INFINITY,
                7 => 0.25,
                _ => noise(i),
            })
            .collect();
        let ranked = Ranked::of(&values);
        let mut window = ranked.window();
        for i in 0..400 {
            let first = (150.0 + 149.0 * noise(i + 1000)) as usize;
            let range = first..(first + (60.0 * noise(i + 5000).abs()) as usize);
            window.slide_to(range.clone());
            let within = &values[range.start..range.end.min(values.len())];
            let mut finite: Vec<f64> = within.iter().copied().filter(|v| v.is_finite()).collect();
            assert_eq!((window.count(), window.upper_median()), (finite.len(), upper_median(&mut finite)), "{range:?}");
        }
        assert_eq!(Ranked::of(&[]).window().upper_median(), None);
    }
}
