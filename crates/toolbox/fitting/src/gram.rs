//! Gram matrices, and the triangular factor they give where that is accurate.

use faer::Mat;
use numerics::linalg::Cholesky;
use numerics::parallel;
use numerics::vector::{add_scaled, dot};

/// Samples of a block of the correlation sums, chosen to stay in the cache.
const BLOCK: usize = 2048;
/// Samples of the correlation sums that one task forms.
const PART: usize = 8 * BLOCK;

/// The upper triangular R with `RᵀR` = `gram`, of which the lower half is read; `None` where a diagonal of R, with the
/// columns scaled to one, falls below `least`. The Gram matrix squares the condition of the data: at this bound its
/// rounding is `1e-16/least²` of the smallest direction.
pub fn cholesky(gram: &Mat<f64>, least: f64) -> Option<Mat<f64>> {
    let is_zero = |i: usize| gram[(i, i)] == 0.0;
    if (0..gram.nrows()).any(is_zero) { None } else { cholesky_with_zeros(gram, least) }
}

/// The same where a column may be zero, as that of a parameter that is held: its column and row of R are zero too.
pub fn cholesky_with_zeros(gram: &Mat<f64>, least: f64) -> Option<Mat<f64>> {
    let n = gram.nrows();
    let size: Vec<f64> = (0..n).map(|i| gram[(i, i)].sqrt()).collect();
    if size.iter().any(|s| !(s.is_normal() || *s == 0.0)) {
        return None;
    }
    let scaled = Mat::from_fn(n, n, |i, j| match size[i] * size[j] {
        _ if j > i => 0.0,
        0.0 => f64::from(u8::from(i == j)),
        scale => gram[(i, j)] / scale,
    });
    let factor = Cholesky::new(scaled.as_ref()).ok()?;
    let lower = factor.lower();
    if (0..n).any(|i| lower[(i, i)].is_nan() || lower[(i, i)] < least) {
        return None;
    }
    Some(Mat::from_fn(n, n, |i, j| if i <= j { lower[(j, i)] * size[j] } else { 0.0 }))
}

/// `Σ_t x_c(t + i) x_d(t + j)` over all windows of `width` samples, at row `i q + c` and column `j q + d` of q channels
/// of equal length. The first block row is summed; a block further down the diagonal differs from the one before it by
/// what leaves and what enters at the ends of the record.
///
/// # Source
/// Mastronardi, Kressner, Sima, Van Dooren & Van Huffel, *A fast algorithm for subspace state-space system
/// identification via exploitation of the displacement structure*, J. Comput. Appl. Math. 132, 2001.
pub fn of_windows(channels: &[&[f64]], width: usize) -> Mat<f64> {
    let q = channels.len();
    let mut gram = Mat::zeros(width * q, width * q);
    let Some(windows) = channels.first().and_then(|c| (c.len() + 1).checked_sub(width)) else { return gram };
    let first = correlations(channels, width, windows);
    for lag in 0..width {
        for (c, d) in (0..q).flat_map(|c| (0..q).map(move |d| (c, d))) {
            let (x, y) = (channels[c], channels[d]);
            let mut sum = first[(lag * q + c) * q + d];
            for block in 0..width - lag {
                if block > 0 {
                    let (leaves, enters) = (block - 1, block - 1 + windows);
                    sum += x[enters] * y[enters + lag] - x[leaves] * y[leaves + lag];
                }
                let (i, j) = (block * q + c, (block + lag) * q + d);
                gram[(i, j)] = sum;
                gram[(j, i)] = sum;
            }
        }
    }
    gram
}

/// `Σ_t x_c(t) x_d(t + lag)` at `(lag · channels + c) · channels + d`.
fn correlations(channels: &[&[f64]], width: usize, windows: usize) -> Vec<f64> {
    let part = |range| correlate(channels, width, range);
    let add = |mut sums: Vec<f64>, others: Vec<f64>| {
        add_scaled(1.0, &others, &mut sums);
        sums
    };
    parallel::reduce(windows, PART, part, add).unwrap_or_else(|| vec![0.0; width * channels.len().pow(2)])
}

fn correlate(channels: &[&[f64]], width: usize, range: std::ops::Range<usize>) -> Vec<f64> {
    let q = channels.len();
    let mut sums = vec![0.0; width * q * q];
    let mut start = range.start;
    while start < range.end {
        let end = (start + BLOCK).min(range.end);
        for (c, d) in (0..q).flat_map(|c| (0..q).map(move |d| (c, d))) {
            let x = &channels[c][start..end];
            for lag in 0..width {
                sums[(lag * q + c) * q + d] += dot(x, &channels[d][start + lag..end + lag]);
            }
        }
        start = end;
    }
    sums
}
