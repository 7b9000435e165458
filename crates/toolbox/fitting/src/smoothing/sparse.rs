//! Rows with few entries that are not zero: each oscillator of a model moves by itself, and an output shows few states.

use faer::MatRef;

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

    /// The first entries of the product with a square matrix of `n` columns, by rows: as many as there is room for.
    pub(super) fn times(&self, matrix: &[f64], n: usize, product: &mut [f64]) {
        let (eights, rest) = product.as_chunks_mut::<8>();
        let (fours, ones) = rest.as_chunks_mut::<4>();
        let (first_four, first_one) = (8 * eights.len(), 8 * eights.len() + 4 * fours.len());
        eights.iter_mut().enumerate().for_each(|(k, sums)| *sums = self.sums(matrix, n, 8 * k));
        fours.iter_mut().for_each(|sums| *sums = self.sums(matrix, n, first_four));
        ones.iter_mut().enumerate().for_each(|(k, sum)| [*sum] = self.sums(matrix, n, first_one + k));
    }

    /// Neighbouring entries of the product, which stay in registers.
    fn sums<const WIDTH: usize>(&self, matrix: &[f64], n: usize, first: usize) -> [f64; WIDTH] {
        let mut sums = [0.0; WIDTH];
        for (place, value) in &self.0 {
            let row = &matrix[place * n + first..][..WIDTH];
            sums.iter_mut().zip(row).for_each(|(sum, entry)| *sum += value * entry);
        }
        sums
    }

    /// Adds a multiple of the row to a vector.
    pub(super) fn add_to(&self, x: &mut [f64], factor: f64) {
        self.0.iter().for_each(|(place, value)| x[*place] += factor * value);
    }
}
