//! The triangular factor of a tall matrix, gathered a block of rows at a time.

use faer::{Mat, MatRef};

/// Rows held before they are folded into the factor: small enough for the cache, large enough for blocked QR.
const CHUNK: usize = 4096;

/// The factor R of the QR decomposition of a tall matrix whose rows arrive in order: RᵀR = AᵀA, computed without ever
/// forming AᵀA, in memory that does not grow with the number of rows.
///
/// # Source
/// Golub & Van Loan, *Matrix Computations*, 4th ed., §5.3 and §6.5 (row appending); known as TSQR.
#[derive(Debug, Clone)]
pub struct Triangle {
    block: Mat<f64>,
    filled: usize,
    rows: usize,
}

impl Triangle {
    /// Most rows that can be appended at once.
    pub(crate) const BLOCK: usize = CHUNK;

    /// An empty factor for matrices of `columns` columns.
    pub fn new(columns: usize) -> Self {
        Triangle { block: Mat::zeros(CHUNK + columns, columns), filled: 0, rows: 0 }
    }

    /// Appends one row.
    pub fn push_row(&mut self, row: &[f64]) {
        for (column, value) in row.iter().enumerate() {
            self.block[(self.filled, column)] = *value;
        }
        self.filled += 1;
        self.rows += 1;
        if self.filled == self.block.nrows() {
            self.fold();
        }
    }

    /// Appends a block of rows, at most [`Triangle::BLOCK`], column by column: `write(j, slice)` fills column j.
    pub(crate) fn push_columns(&mut self, rows: usize, mut write: impl FnMut(usize, &mut [f64])) {
        if self.filled + rows > self.block.nrows() {
            self.fold();
        }
        let (first, columns) = (self.filled, self.block.ncols());
        for j in 0..columns {
            if let Some(column) = self.block.col_mut(j).try_as_col_major_mut() {
                write(j, &mut column.as_slice_mut()[first..first + rows]);
            }
        }
        self.filled += rows;
        self.rows += rows;
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

    fn fold(&mut self) {
        let columns = self.block.ncols();
        let factor = self.block.get(..self.filled, ..).qr();
        let r: MatRef<'_, f64> = factor.thin_R();
        let kept = r.nrows();
        for j in 0..columns {
            for i in 0..kept {
                self.block[(i, j)] = if i <= j { r[(i, j)] } else { 0.0 };
            }
        }
        self.filled = kept;
    }
}
