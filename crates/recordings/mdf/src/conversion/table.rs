//! Tables from numbers to something.

/// Pairs of numbers in the order of their keys.
#[derive(Debug, Clone)]
pub(crate) struct NumberTable {
    keys: Vec<f64>,
    values: Vec<f64>,
}

impl NumberTable {
    /// Of pairs in any order; `None` where there is none.
    pub(crate) fn new(mut pairs: Vec<(f64, f64)>) -> Option<Self> {
        if pairs.is_empty() {
            return None;
        }
        if !pairs.is_sorted_by(|a, b| a.0 <= b.0) {
            pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        let (keys, values) = pairs.into_iter().unzip();
        Some(Self { keys, values })
    }
}

/// Linear between the keys, constant beyond them.
pub(crate) fn interpolated(table: &NumberTable, x: f64) -> f64 {
    let (keys, values) = (&table.keys, &table.values);
    if x.is_nan() {
        return x;
    }
    let above = keys.partition_point(|&k| k <= x);
    if above == 0 {
        return values[0];
    }
    let below = above - 1;
    if above == keys.len() || keys[below] == x {
        return values[below];
    }
    let slope = (values[above] - values[below]) / (keys[above] - keys[below]);
    slope * (x - keys[below]) + values[below]
}

/// The value of the closest key, of the lower one in the middle between two.
pub(crate) fn closest(table: &NumberTable, x: f64) -> f64 {
    let (keys, values) = (&table.keys, &table.values);
    if x.is_nan() {
        return x;
    }
    let above = keys.partition_point(|&k| k < x);
    let last = keys.len() - 1;
    if above == 0 || above > last {
        return values[above.min(last)];
    }
    let is_lower = x - keys[above - 1] <= keys[above] - x;
    values[if is_lower { above - 1 } else { above }]
}

/// Ranges with what each stands for; the first that holds a number counts.
#[derive(Debug, Clone)]
pub(crate) struct RangeTable<T> {
    /// Lower and upper bound.
    bounds: Vec<(f64, f64)>,
    outcomes: Vec<T>,
    /// The upper bound belongs to a range, as for integers.
    closed: bool,
    /// No range begins before the one before it ends, so that one can be searched for.
    is_ordered: bool,
}

impl<T> RangeTable<T> {
    pub(crate) fn new(entries: Vec<(f64, f64, T)>, closed: bool) -> Self {
        let (mut bounds, mut outcomes) = (Vec::new(), Vec::new());
        for (lower, upper, outcome) in entries {
            bounds.push((lower, upper));
            outcomes.push(outcome);
        }
        let ordered = |pair: &[(f64, f64)]| pair[0].1 < pair[1].0 && pair[0].0 <= pair[0].1;
        let is_ordered = bounds.windows(2).all(ordered);
        Self { bounds, outcomes, closed, is_ordered }
    }

    pub(crate) fn find(&self, x: f64) -> Option<&T> {
        let holds =
            |&(lower, upper): &(f64, f64)| lower <= x && (x < upper || ((self.closed || lower == upper) && x == upper));
        let index = match self.is_ordered {
            true => {
                let index = self.bounds.partition_point(|b| b.0 <= x).checked_sub(1)?;
                holds(&self.bounds[index]).then_some(index)
            }
            false => self.bounds.iter().position(holds),
        };
        self.outcomes.get(index?)
    }
}
