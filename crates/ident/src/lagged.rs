//! Regressions on lagged signals, factored once and then solved for any of their columns.

use faer::Mat;

use crate::Triangle;

/// A column: a signal by index, and how far back it is read; a negative lag reads ahead.
pub(crate) type Column = (usize, isize);

/// The factor of the rows `x_s(t − lag)` over all columns, for every t at which all are known. Each experiment is given as
/// its signals; rows do not reach across experiments.
pub(crate) fn factor_lagged(experiments: &[Vec<&[f64]>], columns: &[Column]) -> Triangle {
    let mut triangle = Triangle::new(columns.len());
    let mut row = vec![0.0; columns.len()];
    let back = columns.iter().map(|c| c.1).max().unwrap_or(0).max(0);
    let ahead = columns.iter().map(|c| -c.1).max().unwrap_or(0).max(0);
    for signals in experiments {
        let length = signals.first().map_or(0, |s| s.len()) as isize;
        for t in back..length - ahead {
            for (slot, (signal, lag)) in row.iter_mut().zip(columns) {
                *slot = signals[*signal][(t - lag) as usize];
            }
            if !row.iter().any(|v| v.is_nan()) {
                triangle.push_row(&row);
            }
        }
    }
    triangle
}

/// The triangular factor of some columns of what `factor` is the factor of, square.
pub(crate) fn choose_columns(factor: &Mat<f64>, columns: &[usize]) -> Mat<f64> {
    let chosen = Mat::from_fn(factor.nrows(), columns.len(), |i, j| factor[(i, columns[j])]);
    let r = chosen.qr().thin_R().to_owned();
    Mat::from_fn(columns.len(), columns.len(), |i, j| if i <= j && i < r.nrows() { r[(i, j)] } else { 0.0 })
}
