//! Values by their place in ascending order, of series that are too long for a copy.

/// So many values are copied and put in order; of more, those are that share enough leading bits to be so few.
const FEW: usize = 1 << 20;
/// Leading bits that are told apart in one pass over the values.
const DIGIT: u32 = 16;

/// The value whose place in ascending order (that of [`f64::total_cmp`], beginning with 0) is what `place` says of how
/// many there are; none of none, or if there is no such place.
///
/// # Source
/// Selection by radix: Knuth, D. E., The Art of Computer Programming, vol. 3, 5.2.5.
pub(crate) fn ranked<I: Iterator<Item = f64>>(
    values: impl Fn() -> I,
    place: impl FnOnce(usize) -> usize,
) -> Option<f64> {
    let mut few: Vec<f64> = values().take(FEW + 1).collect();
    if few.len() <= FEW {
        let place = place(few.len());
        return (place < few.len()).then(|| *few.select_nth_unstable_by(place, f64::total_cmp).1);
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
            return Some(*few.select_nth_unstable_by(place, f64::total_cmp).1);
        }
        counts.fill(0);
        of_prefix().for_each(|value| counts[digit(key(value), digits)] += 1);
    }
}

/// The lower median.
pub(crate) fn median<I: Iterator<Item = f64>>(values: impl Fn() -> I) -> Option<f64> {
    ranked(values, |count| count.saturating_sub(1) / 2)
}

/// The counter within which the value of a place falls, and what it counts; the place becomes the one among these.
fn holder(counts: &[usize], place: &mut usize) -> Option<(usize, usize)> {
    counts.iter().copied().enumerate().find(|(_, count)| {
        let is_holder = *place < *count;
        if !is_holder {
            *place -= count;
        }
        is_holder
    })
}

/// A number that grows with the value: the sign is flipped, and of negative values all bits, whose order is the other way.
fn key(value: f64) -> u64 {
    let bits = value.to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// The value of a key.
fn value(key: u64) -> f64 {
    f64::from_bits(if key >> 63 == 0 { !key } else { key & !(1 << 63) })
}

/// Leading bits of a key that follow those of so many digits.
fn digit(key: u64, digits: u32) -> usize {
    (key << (digits * DIGIT) >> (u64::BITS - DIGIT)) as usize
}

#[cfg(test)]
mod tests {
    use super::ranked;

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
                let found = ranked(|| values.iter().copied(), |all| place.min(all));
                assert_eq!(found.map(f64::to_bits), Some(sorted[place].to_bits()), "{place}");
            }
            assert_eq!(ranked(|| values.iter().copied(), |all| all), None);
        }
    }

    #[test]
    fn exact_places_of_short_series() {
        let values = [3.0, -1.0, 2.0];
        let at = |place| ranked(|| values.iter().copied(), |_| place);
        assert_eq!([at(0), at(1), at(2), at(3)], [Some(-1.0), Some(2.0), Some(3.0), None]);
        assert_eq!(ranked(std::iter::empty, |_| 0), None);
    }
}
