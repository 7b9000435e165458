//! Thinning of long traces that keeps every peak: of each bucket of samples its smallest and largest stay, at their own
//! times, so that delays can still be read off the plot.

/// Indices to keep so that at most about `max_points` remain; `None` if all samples can stay.
///
/// A bucket that holds a value that is not finite keeps one such sample as well, so that gaps stay visible.
pub(crate) fn kept_indices(values: &[f64], max_points: usize) -> Option<Vec<usize>> {
    if values.len() <= max_points {
        return None;
    }
    let bucket = values.len().div_ceil((max_points / 2).max(1));
    let mut kept = vec![0];
    for (number, samples) in values.chunks(bucket).enumerate() {
        let first = number * bucket;
        let mut extremes: Vec<usize> = bucket_extremes(samples).into_iter().flatten().map(|at| first + at).collect();
        extremes.sort_unstable();
        kept.extend(extremes);
    }
    kept.push(values.len() - 1);
    kept.dedup();
    Some(kept)
}

/// Positions of the smallest, the largest and the first sample that is not finite.
fn bucket_extremes(samples: &[f64]) -> [Option<usize>; 3] {
    let finite = || samples.iter().enumerate().filter(|(_, value)| value.is_finite());
    let smallest = finite().min_by(|a, b| a.1.total_cmp(b.1)).map(|(at, _)| at);
    let largest = finite().max_by(|a, b| a.1.total_cmp(b.1)).map(|(at, _)| at);
    [smallest, largest, samples.iter().position(|value| !value.is_finite())]
}

/// The step from each kept index to the next, the first counted from zero.
pub(crate) fn steps(kept: &[usize]) -> Vec<u32> {
    let previous = std::iter::once(&0).chain(kept);
    kept.iter().zip(previous).map(|(index, before)| u32::try_from(index - before).unwrap_or(u32::MAX)).collect()
}
