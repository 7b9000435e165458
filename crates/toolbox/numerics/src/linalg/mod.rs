//! Decompositions and products of dense matrices in double precision, by faer.
//!
//! faer is generic over the numbers, so each crate that calls it compiles its decompositions anew. These functions are
//! not generic: they are compiled once, for all crates that use them.
//!
//! # Example
//! ```
//! use faer::mat;
//! use numerics::linalg;
//! let a = mat![[2.0, 1.0], [1.0, 3.0]];
//! assert!((linalg::determinant(a.as_ref()) - 5.0).abs() < 1e-12);
//! let x = linalg::solve(a.as_ref(), mat![[3.0], [5.0]].as_ref());
//! assert!((x[(0, 0)] - 0.8).abs() < 1e-12 && (x[(1, 0)] - 1.4).abs() < 1e-12);
//! # Ok::<(), linalg::DecompositionError>(())
//! ```

mod cholesky;
mod eigen;
mod lu;
mod product;
mod qr;
mod svd;
mod triangular;

pub use cholesky::Cholesky;
pub use eigen::{Eigen, SymmetricEigen, eigen, eigenvalues, symmetric_eigen, symmetric_eigenvalues};
pub use lu::{FullyPivotedLu, Lu, complex_solve, determinant, inverse, solve};
pub use product::{complex_product, gram, product};
pub use qr::{Qr, triangularise};
pub use svd::{ComplexSvd, Svd, complex_svd, least_norm, singular_values, svd, thin_svd};
pub use triangular::{solve_lower, solve_upper};

/// A decomposition that does not exist or cannot be computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecompositionError {
    /// The iteration for the singular values did not converge, as with values that are not finite.
    #[error("the singular value decomposition failed")]
    SingularValues,
    /// The iteration for the eigenvalues did not converge, as with values that are not finite.
    #[error("the eigenvalue decomposition failed")]
    Eigenvalues,
    /// The matrix is not positive definite.
    #[error("the Cholesky decomposition failed: the matrix is not positive definite")]
    NotPositiveDefinite,
}
