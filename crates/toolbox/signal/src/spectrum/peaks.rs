//! Peaks of a spectrum that stand out of what is around them.

use std::ops::RangeInclusive;

use numerics::sliding_median::{Ranked, Window};

/// A peak.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectralPeak {
    /// Its place among the values.
    pub index: usize,
    /// The value over that of the background.
    pub excess: f64,
}

/// Fewest values to either side that make a background.
const FEWEST: usize = 3;

/// The peaks of `values`, a power or a gain over rising frequencies, by rising frequency: largest within `lobe` values
/// to either side, at least `excess` times the background, and more than chance makes of it, which is where the lower
/// end of the value's interval lies above the background. Of two tops without a valley between them whose value, at the
/// upper end of its interval, is less than `√excess` below the lower top, that one is a ripple on the other and left
/// out.
///
/// The background is the geometric mean of two medians, over the octave below and the octave above without the `lobe`
/// nearest values: the slope of a spectrum cancels in it. Where either has fewer than three values, nothing is a peak.
///
/// # Example
/// ```
/// use signal::spectrum::peaks;
/// let freq_hz: Vec<f64> = (0..100).map(f64::from).collect();
/// let mut power: Vec<f64> = freq_hz.iter().map(|f| 1.0 / (1.0 + f * f)).collect();
/// power[40] *= 30.0;
/// let intervals: Vec<(f64, f64)> = power.iter().map(|p| (0.7 * p, 1.5 * p)).collect();
/// let found = peaks(&freq_hz, &power, &intervals, 1, 4.0);
/// assert_eq!(found.len(), 1);
/// assert_eq!(found[0].index, 40);
/// ```
#[must_use]
pub fn peaks(freq_hz: &[f64], values: &[f64], intervals: &[(f64, f64)], lobe: usize, excess: f64) -> Vec<SpectralPeak> {
    let count = freq_hz.len().min(values.len()).min(intervals.len());
    let lobe = lobe.max(1);
    let ranked = Ranked::of(&values[..count]);
    let mut background =
        Background { freq_hz: &freq_hz[..count], lobe, below: ranked.window(), above: ranked.window() };
    let mut found = Vec::new();
    for index in 1..count.saturating_sub(1) {
        let near = &values[index.saturating_sub(lobe)..(index + lobe + 1).min(count)];
        let is_top = values[index] > values[index - 1] && near.iter().all(|v| *v <= values[index]);
        let lower = intervals[index].0;
        if !is_top || lower <= 0.0 || lower.is_nan() {
            continue;
        }
        let Some(background) = background.at(index) else { continue };
        if values[index] >= excess * background && lower > background {
            found.push(SpectralPeak { index, excess: values[index] / background });
        }
    }
    without_ripples(found, values, intervals, excess.sqrt())
}

/// The first and the last place around `index` at which the top of a peak may be: as far as the upper ends of the
/// intervals reach above the lower end at the peak. With intervals that hold all at once, as probably as those do.
///
/// # Example
/// ```
/// // Broad, and known to a tenth: four values may be the largest.
/// let intervals: Vec<(f64, f64)> = [1.0, 2.9, 3.0, 3.1, 2.9, 1.0].iter().map(|p| (0.9 * p, 1.1 * p)).collect();
/// assert_eq!(signal::spectrum::top_range(&intervals, 3), 1..=4);
/// ```
#[must_use]
pub fn top_range(intervals: &[(f64, f64)], index: usize) -> RangeInclusive<usize> {
    let Some((lower, _)) = intervals.get(index) else { return index..=index };
    let may_be = |(_, upper): &&(f64, f64)| upper >= lower;
    let before = intervals[..index].iter().rev().take_while(may_be).count();
    let after = intervals[index + 1..].iter().take_while(may_be).count();
    index - before..=index + after
}

fn without_ripples(
    mut found: Vec<SpectralPeak>,
    values: &[f64],
    intervals: &[(f64, f64)],
    depth: f64,
) -> Vec<SpectralPeak> {
    found.sort_by(|a, b| values[b.index].total_cmp(&values[a.index]));
    let mut kept: Vec<SpectralPeak> = Vec::new();
    for peak in found {
        let is_apart = |other: &SpectralPeak| {
            let (from, to) = (peak.index.min(other.index), peak.index.max(other.index));
            intervals[from..to].iter().any(|(_, upper)| depth * upper <= values[peak.index])
        };
        if kept.iter().all(is_apart) {
            kept.push(peak);
        }
    }
    kept.sort_by_key(|peak| peak.index);
    kept
}

/// Surroundings of a value: the octave below and the octave above.
struct Background<'a> {
    freq_hz: &'a [f64],
    lobe: usize,
    below: Window<'a>,
    above: Window<'a>,
}

impl Background<'_> {
    fn at(&mut self, index: usize) -> Option<f64> {
        let (freq_hz, at_hz) = (self.freq_hz, self.freq_hz[index]);
        let first = freq_hz.partition_point(|f| *f < 0.5 * at_hz);
        let end = freq_hz.partition_point(|f| *f <= 2.0 * at_hz);
        self.below.slide_to(first..index.saturating_sub(self.lobe));
        self.above.slide_to(index + self.lobe + 1..end);
        let is_enough = self.below.count().min(self.above.count()) >= FEWEST;
        let (below, above) = (self.below.upper_median()?, self.above.upper_median()?);
        is_enough.then(|| (below * above).sqrt())
    }
}
