//! Orthogonal triangular factors.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting::factor::{qr_in_place, qr_in_place_scratch, recommended_block_size};
use faer::linalg::solvers::{self, SolveLstsq};
use faer::{Mat, MatMut, MatRef, Par};

/// `M = Q R` by Householder reflections.
#[derive(Debug, Clone)]
pub struct Qr(solvers::Qr<f64>);

impl Qr {
    /// Factorises a matrix.
    #[must_use]
    pub fn new(m: MatRef<'_, f64>) -> Self {
        work::checkpoint();
        Qr(m.qr())
    }

    /// `R`, upper triangular, with as many rows as the smaller of the sizes.
    #[must_use]
    pub fn r(&self) -> MatRef<'_, f64> {
        self.0.thin_R()
    }

    /// `Q`, with as many columns as the smaller of the sizes.
    #[must_use]
    pub fn thin_q(&self) -> Mat<f64> {
        self.0.compute_thin_Q()
    }

    /// `X` that makes `‖M X − B‖` least, for a matrix of full column rank.
    #[must_use]
    pub fn least_squares(&self, b: MatRef<'_, f64>) -> Mat<f64> {
        self.0.solve_lstsq(b)
    }
}

/// Replaces a matrix by its `R`: upper triangular, zero below. Returns how many rows `R` has, the smaller of the sizes.
///
/// # Example
/// ```
/// let mut m = faer::mat![[3.0], [4.0]];
/// assert_eq!(numerics::linalg::triangularise(m.as_mut()), 1);
/// assert!((m[(0, 0)].abs() - 5.0).abs() < 1e-12);
/// ```
pub fn triangularise(mut m: MatMut<'_, f64>) -> usize {
    work::checkpoint();
    let (rows, columns) = m.shape();
    let kept = rows.min(columns);
    if kept == 0 {
        return 0;
    }
    let size = recommended_block_size::<f64>(rows, columns);
    let mut coefficients = Mat::zeros(size, kept);
    let scratch = qr_in_place_scratch::<f64>(rows, columns, size, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(scratch);
    let stack = MemStack::new(&mut memory);
    qr_in_place(m.as_mut(), coefficients.as_mut(), Par::Seq, stack, Default::default());
    for j in 0..columns {
        for i in j + 1..kept {
            m[(i, j)] = 0.0;
        }
    }
    kept
}
