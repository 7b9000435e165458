//! Tests of `lti` through its public face.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod analysis;
mod conversion;
mod delay;
mod edges;
mod polynomial_model;
mod process_model;
mod properties;
mod reduction;
mod reference;
mod sampling;

use faer::{Mat, MatRef};

fn assert_close(got: MatRef<'_, f64>, expected: MatRef<'_, f64>, tolerance: f64) {
    assert_eq!(got.shape(), expected.shape());
    for i in 0..got.nrows() {
        for j in 0..got.ncols() {
            let (a, b) = (got[(i, j)], expected[(i, j)]);
            assert!((a - b).abs() <= tolerance, "at ({i}, {j}): {a} instead of {b}");
        }
    }
}

fn column(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), 1, |i, _| values[i])
}
