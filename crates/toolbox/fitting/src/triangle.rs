//! The triangular factor of a tall matrix, gathered a block of rows at a time.

use faer::{Mat, MatRef};
use numerics::linalg;

use crate::gram;

/// Smallest diagonal of the Cholesky factor of a Gram matrix with unit diagonal at which a block is folded by way of
/// it.
const WELL_CONDITIONED: f64 = 1e-3;
/// Rows a column from which that pays.
const TALL: usize = 4;

/// The factor R of the QR decomposition of a tall matrix whose rows arrive in order: RᵀR = AᵀA, in memory that does not
/// grow with the number of rows. A column that depends on those before it to within about 1e-11 of its norm counts as
/// dependent. Blocks of rows are folded by Cholesky decomposition of their AᵀA as long as that leaves a relative
/// rounding below 1e-10 in R, and by Householder reflections where it would not. The sign of a row of R is free.
///
/// # Example
/// ```
/// let column = [3.0, 4.0];
/// let mut triangle = fitting::Triangle::new(1);
/// triangle.push_columns(2, |_, start, target| target.copy_from_slice(&column[start..start + target.len()]));
/// assert!((triangle.finish()[(0, 0)].abs() - 5.0).abs() < 1e-15);
/// ```
///
/// # Source
/// Golub & Van Loan, *Matrix Computations*, 4th ed., §5.3 and §6.5 (row appending); known as TSQR.
#[derive(Debug, Clone)]
pub struct Triangle {
    block: Mat<f64>,
    filled: usize,
    rows: usize,
    /// True if every block so far could be folded by way of its Gram matrix.
    well_conditioned: bool,
}

impl Triangle {
    /// Rows held before they are folded into the factor: small enough for the cache, large enough for blocked QR.
    pub const BLOCK: usize = 4096;

    /// An empty factor for matrices of `columns` columns.
    pub fn new(columns: usize) -> Self {
        Self::for_rows(columns, Self::BLOCK)
    }

    /// Appends one row.
    pub fn push_row(&mut self, row: &[f64]) {
        for (column, value) in row.iter().enumerate() {
            self.block[(self.filled, column)] = *value;
        }
        self.advance(1);
    }

    /// Appends `rows` rows, a stretch of one column at a time: `fill(column, start, target)` writes the rows
    /// `start..start + target.len()` of that column, at most 4096 of them. Far faster than rows one by one where
    /// columns are slices.
    pub fn push_columns(&mut self, rows: usize, mut fill: impl FnMut(usize, usize, &mut [f64])) {
        let mut start = 0;
        while start < rows {
            let count = (rows - start).min(Self::BLOCK);
            if self.filled + count > self.block.nrows() {
                self.fold();
            }
            for j in 0..self.block.ncols() {
                if let Some(column) = self.block.col_mut(j).try_as_col_major_mut() {
                    fill(j, start, &mut column.as_slice_mut()[self.filled..self.filled + count]);
                }
            }
            start += count;
            self.advance(count);
        }
    }

    /// Appends the rows that another factor of as many columns stands for.
    pub fn merge(&mut self, other: Triangle) {
        let rows = self.rows + other.rows;
        self.push_upper(other.finish().as_ref());
        self.rows = rows;
    }

    /// Rows appended so far.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The factor, square and upper triangular (rows are zero where fewer rows than columns were given).
    pub fn finish(mut self) -> Mat<f64> {
        self.fold();
        let columns = self.block.ncols();
        Mat::from_fn(columns, columns, |i, j| if i <= j && i < self.filled { self.block[(i, j)] } else { 0.0 })
    }

    /// An empty factor that is to hold few rows, in less memory.
    pub fn for_rows(columns: usize, rows: usize) -> Self {
        let block = Mat::zeros(rows.min(Self::BLOCK) + columns, columns);
        Triangle { block, filled: 0, rows: 0, well_conditioned: true }
    }

    fn push_upper(&mut self, factor: MatRef<'_, f64>) {
        self.push_columns(factor.nrows(), |j, start, target| {
            target.iter_mut().enumerate().for_each(|(i, v)| *v = factor[(start + i, j)]);
        });
    }

    fn advance(&mut self, count: usize) {
        self.filled += count;
        self.rows += count;
        if self.filled == self.block.nrows() {
            self.fold();
        }
    }

    fn fold(&mut self) {
        let (rows, columns) = (self.filled, self.block.ncols());
        if self.well_conditioned && rows >= TALL * columns {
            let gram = linalg::gram(self.block.get(..rows, ..));
            if let Some(factor) = gram::cholesky_with_zeros(&gram, WELL_CONDITIONED) {
                self.block.get_mut(..columns, ..).copy_from(&factor);
                self.filled = columns;
                return;
            }
            // One block is like the next: what failed is not tried again.
            self.well_conditioned = false;
        }
        self.filled = linalg::triangularise(self.block.get_mut(..rows, ..));
    }
}

/// The upper triangular factor of a matrix of few rows, as many rows as the smaller of its sizes.
pub fn upper_factor(mut matrix: Mat<f64>) -> Mat<f64> {
    let kept = linalg::triangularise(matrix.as_mut());
    matrix.get(..kept, ..).to_owned()
}
