//! Order statistics: values by their place in ascending order, which is that of [`f64::total_cmp`] and begins with 0.

/// Series up to this length are copied; of longer ones, only values that share enough leading bits to be so few.
const FEW: usize = 1 << 20;
/// Leading bits that one pass over the values distinguishes.
const DIGIT: u32 = 16;

/// The value at a place in ascending order; `None` if there is no such place. Reorders the slice.
pub fn select(values: &mut [f64], place: usize) -> Option<f64> {
    (place < values.len()).then(|| *values.select_nth_unstable_by(place, f64::total_cmp).1)
}

/// The median, of an even number the mean of the two in the middle; `None` of an empty slice. Reorders the slice.
///
/// # Example
/// ```
/// assert_eq!(numerics::order::median(&mut [4.0, 1.0, 3.0, 2.0]), Some(2.5));
/// ```
pub fn median(values: &mut [f64]) -> Option<f64> {
    let upper = upper_median(values)?;
    Some(if values.len().is_multiple_of(2) { 0.5 * (lower_median(values)? + upper) } else { upper })
}

/// The median, of an even number the lower of the two in the middle; `None` of an empty slice. Reorders the slice.
pub fn lower_median(values: &mut [f64]) -> Option<f64> {
    select(values, values.len().checked_sub(1)? / 2)
}

/// The median, of an even number the upper of the two in the middle; `None` of an empty slice. Reorders the slice.
pub fn upper_median(values: &mut [f64]) -> Option<f64> {
    select(values, values.len() / 2)
}

/// The value that a further draw stays below with a probability, from draws that are sorted; linear between them,
/// `None` without any.
///
/// A further draw falls with 1/(n + 1) between any two neighbours, so that the quantile of p is at place p(n + 1) from
/// 1 on. The quantiles of 5 and 95 % then hold 90 % of all further draws for any n from 19 on. Those at place 1 + p(n −
/// 1), as spreadsheets have them, hold 87.8 % where n is 80.
///
/// # Example
/// ```
/// assert_eq!(numerics::order::quantile_of_sorted(&[0.0, 10.0, 20.0], 0.375), Some(5.0));
/// ```
///
/// # Source
/// Hyndman, R. J. and Fan, Y. (1996), *Sample quantiles in statistical packages*, definition 6.
#[must_use]
pub fn quantile_of_sorted(sorted: &[f64], probability: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)? as f64;
    let place = (probability * (last + 2.0) - 1.0).clamp(0.0, last);
    let (below, part) = (sorted[place.floor() as usize], place.fract());
    let above = sorted[place.ceil() as usize];
    Some(if part == 0.0 { below } else { below * (1.0 - part) + above * part })
}

/// The value at a place in ascending order, of a series too long for a copy; `None` if there is no such place.
///
/// `place` gets the number of values. `values` is run through several times.
///
/// # Example
/// ```
/// let largest = numerics::order::select_streamed(|| (0..9).map(f64::from), |count| count - 1);
/// assert_eq!(largest, Some(8.0));
/// ```
///
/// # Source
/// Selection by radix: Knuth, D. E., The Art of Computer Programming, vol. 3, 5.2.5.
pub fn select_streamed<I: Iterator<Item = f64>>(
    values: impl Fn() -> I,
    place: impl FnOnce(usize) -> usize,
) -> Option<f64> {
    let mut few: Vec<f64> = values().take(FEW + 1).collect();
    if few.len() <= FEW {
        let place = place(few.len());
        return select(&mut few, place);
    }
    let mut counts = vec![0_usize; 1 << DIGIT];
    values().for_each(|value| counts[digit(key(value), 0)] += 1);
    let mut place = place(counts.iter().sum());
    let (mut prefix, mut digits) = (0, 0);
    loop {
        let (next, count) = holder(&counts, &mut place)?;
        prefix |= (next as u64) << (u64::BITS - (digits + 1) * DIGIT);
        digits += 1;
        if digits * DIGIT == u64::BITS {
            return Some(value(prefix));
        }
        let shared = u64::BITS - digits * DIGIT;
        let of_prefix = || values().filter(|value| key(*value) >> shared == prefix >> shared);
        if count <= FEW {
            few.clear();
            few.extend(of_prefix());
            return select(&mut few, place);
        }
        counts.fill(0);
        of_prefix().for_each(|value| counts[digit(key(value), digits)] += 1);
    }
}

/// The lower median of a series too long for a copy.
pub fn lower_median_streamed<I: Iterator<Item = f64>>(values: impl Fn() -> I) -> Option<f64> {
    select_streamed(values, |count| count.saturating_sub(1) / 2)
}

/// The counter that holds the value of a place, and its count; the place becomes the one within this counter.
fn holder(counts: &[usize], place: &mut usize) -> Option<(usize, usize)> {
    counts.iter().copied().enumerate().find(|(_, count)| {
        let is_holder = *place < *count;
        if !is_holder {
            *place -= count;
        }
        is_holder
    })
}

/// An integer that grows with the value: the sign bit is flipped, and all bits of negative values, whose order is
/// reversed.
fn key(value: f64) -> u64 {
    let bits = value.to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// The value of a key.
fn value(key: u64) -> f64 {
    f64::from_bits(if key >> 63 == 0 { !key } else { key & !(1 << 63) })
}

/// The leading bits of a key after this many digits.
fn digit(key: u64, digits: u32) -> usize {
    (key << (digits * DIGIT) >> (u64::BITS - DIGIT)) as usize
}

/// Values that are compared at once.
const LANES: usize = 8;

/// The largest value of a function of pairs, or 0 if that is more, and the first pair that has it.
///
/// # Example
/// ```
/// let (before, after) = ([1.0, 4.0, 2.0], [4.0, 2.0, 5.0]);
/// let change = numerics::order::largest_of_pairs(&before, &after, |before, after| f64::abs(after - before));
/// assert_eq!(change, (3.0, 0));
/// ```
pub fn largest_of_pairs(a: &[f64], b: &[f64], of: impl Fn(f64, f64) -> f64) -> (f64, usize) {
    let larger = |most: f64, one: f64| if one > most { one } else { most };
    let mut most = [0.0; LANES];
    let (a_lanes, b_lanes) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    for (a, b) in a_lanes.zip(b_lanes) {
        most.iter_mut().zip(a.iter().zip(b)).for_each(|(most, (a, b))| *most = larger(*most, of(*a, *b)));
    }
    let whole = a.len().min(b.len()) / LANES * LANES;
    let rest = a[whole..].iter().zip(&b[whole..]).map(|(a, b)| of(*a, *b));
    let most = most.into_iter().chain(rest).fold(0.0, larger);
    let place = a.iter().zip(b).position(|(a, b)| of(*a, *b) == most);
    (most, place.filter(|_| most > 0.0).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::{lower_median, median, quantile_of_sorted, select_streamed, upper_median};

    fn sorted(values: &[f64]) -> Vec<f64> {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted
    }

    /// Series longer than are copied: spread, in a narrow band, of two values, with signs and what is no number.
    #[test]
    fn exact_places_of_long_series() {
        let count = super::FEW + super::FEW / 4;
        let noise = |i: usize| (i as f64 * 12.9898).sin() * 43758.5453;
        let series: [Vec<f64>; 5] = [
            (0..count).map(noise).collect(),
            (0..count).map(|i| 1.0 + 1e-13 * noise(i)).collect(),
            (0..count).map(|i| f64::from(u8::from(noise(i) > 4e4))).collect(),
            (0..count).map(|i| if i % 7 == 0 { -0.0 } else { noise(i).trunc().min(0.0) }).collect(),
            (0..count).map(|i| [f64::NAN, -f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, 0.0][i % 5]).collect(),
        ];
        for values in series {
            let sorted = sorted(&values);
            for place in [0, 1, count / 50, (count - 1) / 2, count - 2, count - 1] {
                let found = select_streamed(|| values.iter().copied(), |all| place.min(all));
                assert_eq!(found.map(f64::to_bits), Some(sorted[place].to_bits()), "{place}");
            }
            assert_eq!(select_streamed(|| values.iter().copied(), |all| all), None);
        }
    }

    #[test]
    fn exact_places_of_short_series() {
        let values = [3.0, -1.0, 2.0];
        let at = |place| select_streamed(|| values.iter().copied(), |_| place);
        assert_eq!([at(0), at(1), at(2), at(3)], [Some(-1.0), Some(2.0), Some(3.0), None]);
        assert_eq!(select_streamed(std::iter::empty, |_| 0), None);
    }

    #[test]
    fn exact_medians_of_odd_and_even_counts() {
        let all = |values: &[f64]| {
            let of = |f: fn(&mut [f64]) -> Option<f64>| f(&mut values.to_vec());
            [of(lower_median), of(median), of(upper_median)]
        };
        assert_eq!(all(&[]), [None; 3]);
        assert_eq!(all(&[3.0, 1.0, 2.0]), [Some(2.0); 3]);
        assert_eq!(all(&[4.0, 1.0, 3.0, 2.0]), [Some(2.0), Some(2.5), Some(3.0)]);
    }

    #[test]
    fn exact_quantiles_between_values() {
        let at = |probability| quantile_of_sorted(&[1.0, 2.0, 4.0], probability);
        assert_eq!([at(0.1), at(0.5), at(0.625), at(0.9)], [Some(1.0), Some(2.0), Some(3.0), Some(4.0)]);
        assert_eq!(quantile_of_sorted(&[], 0.5), None);
    }
}
