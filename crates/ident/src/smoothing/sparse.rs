//! Rows with few entries that are not zero: each oscillator of a model moves by itself, and an output shows few states.

use faer::MatRef;
use numerics::vector::add_scaled;

/// The entries of a row that are not zero, with their places.
#[derive(Debug, Clone)]
pub(super) struct SparseRow(Vec<(usize, f64)>);

/// The rows of a matrix.
pub(super) fn sparse_rows(m: MatRef<'_, f64>) -> Vec<SparseRow> {
    let row = |i: usize| (0..m.ncols()).map(|j| (j, m[(i, j)])).filter(|(_, value)| *value != 0.0).collect();
    (0..m.nrows()).map(|i| SparseRow(row(i))).collect()
}

impl SparseRow {
    /// The scalar product with a vector.
    pub(super) fn dot(&self, x: &[f64]) -> f64 {
        self.0.iter().map(|(place, value)| value * x[*place]).sum()
    }

    /// The product with a square matrix of `n` columns, by rows.
    pub(super) fn times(&self, matrix: &[f64], n: usize, product: &mut [f64]) {
        product.fill(0.0);
        self.0.iter().for_each(|(place, value)| add_scaled(*value, &matrix[place * n..(place + 1) * n], product));
    }

    /// Adds a multiple of the row to a vector.
    pub(super) fn add_to(&self, x: &mut [f64], factor: f64) {
        self.0.iter().for_each(|(place, value)| x[*place] += factor * value);
    }
}
