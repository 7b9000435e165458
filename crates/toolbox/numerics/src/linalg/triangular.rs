//! Equations of triangular matrices.

use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{MatMut, MatRef, Par};

/// Replaces `B` by `L⁻¹ B`; what is above the diagonal of `L` is not read.
pub fn solve_lower(l: MatRef<'_, f64>, b: MatMut<'_, f64>) {
    solve_lower_triangular_in_place(l, b, Par::Seq);
}

/// Replaces `B` by `R⁻¹ B`; what is below the diagonal of `R` is not read.
pub fn solve_upper(r: MatRef<'_, f64>, b: MatMut<'_, f64>) {
    solve_upper_triangular_in_place(r, b, Par::Seq);
}
