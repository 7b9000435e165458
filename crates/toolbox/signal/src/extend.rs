//! Continuation of a signal beyond its ends.

/// `x` at any index: odd reflection about the end samples (`2·x[0] − x[k]` at `−k`), so that value and slope continue;
/// beyond the reflected record the outermost reflected value holds. An empty `x` reads as zero.
pub(crate) fn odd_extended(x: &[f64], index: i64) -> f64 {
    let (Some(&first), Some(&last)) = (x.first(), x.last()) else {
        return 0.0;
    };
    let end = x.len() as i64 - 1;
    if index < 0 {
        2.0 * first - x[(-index).min(end) as usize]
    } else if index > end {
        2.0 * last - x[(2 * end - index).max(0) as usize]
    } else {
        x[index as usize]
    }
}
