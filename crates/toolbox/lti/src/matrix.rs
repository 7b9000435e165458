//! Small dense helpers on faer matrices.

use faer::{Mat, MatRef};
use numerics::linalg;

use crate::Complex64;
use crate::error::{LtiError, check_finite, check_shape};

/// The same matrix in complex numbers.
pub(crate) fn complex(m: MatRef<'_, f64>) -> Mat<Complex64> {
    Mat::from_fn(m.nrows(), m.ncols(), |i, j| Complex64::new(m[(i, j)], 0.0))
}

/// Returns true if a square matrix is singular to working precision.
pub(crate) fn is_singular(m: MatRef<'_, f64>) -> Result<bool, LtiError> {
    let values = linalg::singular_values(m)?;
    let (Some(largest), Some(smallest)) = (values.first(), values.last()) else { return Ok(false) };
    Ok(*smallest <= f64::EPSILON * m.nrows() as f64 * largest)
}

/// `p − q`, zero where the two agree but for rounding: a feed-through of rounding errors would be read as one.
pub(crate) fn difference(p: MatRef<'_, f64>, q: MatRef<'_, f64>) -> Mat<f64> {
    const ROUNDING: f64 = 1e3 * f64::EPSILON;
    Mat::from_fn(p.nrows(), p.ncols(), |i, j| {
        let left = p[(i, j)] - q[(i, j)];
        if left.abs() <= ROUNDING * p[(i, j)].abs() { 0.0 } else { left }
    })
}

pub(crate) fn identity(n: usize) -> Mat<f64> {
    Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)))
}

/// Puts blocks together; block rows and columns must fit each other.
pub(crate) fn blocks<const R: usize, const C: usize>(parts: [[MatRef<'_, f64>; C]; R]) -> Mat<f64> {
    let rows = parts.iter().map(|row| row[0].nrows()).sum();
    let columns = parts[0].iter().map(|block| block.ncols()).sum();
    let mut whole = Mat::zeros(rows, columns);
    let mut top = 0;
    for row in parts {
        let mut left = 0;
        for block in row {
            whole.submatrix_mut(top, left, block.nrows(), block.ncols()).copy_from(block);
            left += block.ncols();
        }
        top += row[0].nrows();
    }
    whole
}

pub(crate) fn elements(m: MatRef<'_, f64>) -> impl Iterator<Item = f64> + '_ {
    (0..m.ncols()).flat_map(move |j| (0..m.nrows()).map(move |i| m[(i, j)]))
}

/// A matrix as a list of its rows, for writing down.
#[must_use]
pub fn to_rows(m: MatRef<'_, f64>) -> Vec<Vec<f64>> {
    (0..m.nrows()).map(|i| (0..m.ncols()).map(|j| m[(i, j)]).collect()).collect()
}

/// The matrix of `count` rows and so many `columns` whose rows are listed; `what` it is called in errors.
///
/// # Errors
/// [`LtiError::Shape`] where the list is not of these sizes.
pub fn from_rows(what: &'static str, rows: &[Vec<f64>], count: usize, columns: usize) -> Result<Mat<f64>, LtiError> {
    check_shape(what, (count, columns), (rows.len(), columns))?;
    for row in rows {
        check_shape(what, (count, columns), (count, row.len()))?;
    }
    Ok(Mat::from_fn(count, columns, |i, j| rows[i][j]))
}

/// Largest column sum of magnitudes.
pub(crate) fn norm_1(m: MatRef<'_, f64>) -> f64 {
    (0..m.ncols()).map(|j| (0..m.nrows()).map(|i| m[(i, j)].abs()).sum()).fold(0.0, f64::max)
}

pub(crate) fn norm_2(m: MatRef<'_, f64>) -> f64 {
    elements(m).map(|v| v * v).sum::<f64>().sqrt()
}

/// The inverse, or `None` where the matrix is singular to working precision.
pub(crate) fn inverse(m: MatRef<'_, f64>) -> Option<Mat<f64>> {
    if m.nrows() == 0 {
        return Some(Mat::zeros(0, 0));
    }
    let inverse = linalg::inverse(m);
    let reciprocal_condition = 1.0 / (norm_1(m) * norm_1(inverse.as_ref()));
    let usable = reciprocal_condition >= f64::EPSILON && elements(inverse.as_ref()).all(f64::is_finite);
    usable.then_some(inverse)
}

/// Eigenvalues, after balancing.
///
/// Those of a matrix that a permutation makes block triangular, as that of systems in series, are those of the blocks
/// on the diagonal: taken one by one, they are not moved by what couples the blocks, however close together they lie.
pub(crate) fn eigenvalues(m: MatRef<'_, f64>) -> Result<Vec<Complex64>, LtiError> {
    let mut values = Vec::with_capacity(m.nrows());
    for block in irreducible_blocks(m) {
        let part = Mat::from_fn(block.len(), block.len(), |i, j| m[(block[i], block[j])]);
        let (balanced, _) = balance(part.as_ref());
        if !elements(balanced.as_ref()).all(f64::is_finite) {
            return Err(LtiError::NonFinite { what: "matrix of an eigenvalue problem" });
        }
        values.extend(linalg::eigenvalues(balanced.as_ref())?);
    }
    Ok(values)
}

/// The states of a matrix in groups that all act on each other, whether at once or by way of others.
fn irreducible_blocks(m: MatRef<'_, f64>) -> Vec<Vec<usize>> {
    let n = m.nrows();
    let mut acts: Vec<Vec<bool>> = (0..n).map(|i| (0..n).map(|j| i == j || m[(i, j)] != 0.0).collect()).collect();
    for via in 0..n {
        let row = acts[via].clone();
        for reached in acts.iter_mut().filter(|reached| reached[via]) {
            reached.iter_mut().zip(&row).for_each(|(to, further)| *to |= further);
        }
    }
    let first_of = |i: usize| (0..=i).find(|j| acts[i][*j] && acts[*j][i]);
    let starts = (0..n).filter(|i| first_of(*i) == Some(*i));
    starts.map(|i| (i..n).filter(|j| acts[i][*j] && acts[*j][i]).collect()).collect()
}

/// Balances a matrix: `D⁻¹ M D` and the diagonal of `D`, powers of two chosen to make the norms of rows and columns
/// alike. Nothing is rounded.
///
/// # Source
/// Parlett, B. N. and Reinsch, C. (1969), Numer. Math. 13, 293–304; without permutation.
pub(crate) fn balance(m: MatRef<'_, f64>) -> (Mat<f64>, Vec<f64>) {
    const MAX_SWEEPS: usize = 100;
    let n = m.nrows();
    let mut scaled = m.to_owned();
    let mut diagonal = vec![1.0; n];
    for _ in 0..MAX_SWEEPS {
        let mut changed = false;
        for k in 0..n {
            let others = || (0..n).filter(|&i| i != k);
            let column: f64 = others().map(|i| scaled[(i, k)].abs()).sum();
            let row: f64 = others().map(|i| scaled[(k, i)].abs()).sum();
            let factor = balancing_factor(column, row);
            if factor == 1.0 {
                continue;
            }
            changed = true;
            diagonal[k] *= factor;
            for i in 0..n {
                scaled[(i, k)] *= factor;
            }
            for i in 0..n {
                scaled[(k, i)] /= factor;
            }
        }
        if !changed {
            break;
        }
    }
    (scaled, diagonal)
}

/// The power of two that brings `column · f` and `row / f` together, one where there is little to gain.
fn balancing_factor(column: f64, row: f64) -> f64 {
    let usable = |v: f64| v > 0.0 && v.is_finite();
    if !usable(column) || !usable(row) {
        return 1.0;
    }
    let factor = (0.5 * (row / column).log2()).round().clamp(-500.0, 500.0).exp2();
    if column * factor + row / factor < 0.95 * (column + row) { factor } else { 1.0 }
}

/// The power of two that brings a column of this size to another size; one where either is zero or too far.
pub(crate) fn column_scale(size: f64, wanted: f64) -> f64 {
    let factor = (wanted / size).log2().round().exp2();
    if factor.is_normal() && (1.0 / factor).is_normal() { factor } else { 1.0 }
}

/// A matrix laid out by rows, for products with short vectors in a time loop.
#[derive(Debug, Clone)]
pub(crate) struct RowMajor {
    columns: usize,
    values: Vec<f64>,
}

impl RowMajor {
    pub(crate) fn new(m: MatRef<'_, f64>) -> Self {
        let values = (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)])).collect();
        Self { columns: m.ncols(), values }
    }

    /// `y += M x`
    pub(crate) fn add_product(&self, x: &[f64], y: &mut [f64]) {
        if self.columns == 0 {
            return;
        }
        for (row, out) in self.values.chunks_exact(self.columns).zip(y) {
            *out += row.iter().zip(x).map(|(m, v)| m * v).sum::<f64>();
        }
    }
}

/// Checks that a table of numbers is finite throughout.
pub(crate) fn check_matrix(what: &'static str, m: MatRef<'_, f64>) -> Result<(), LtiError> {
    check_finite(what, elements(m))
}

/// The table of outputs that `step(input, output)` makes of every row of inputs.
pub(crate) fn map_rows(u: MatRef<'_, f64>, outputs: usize, mut step: impl FnMut(&[f64], &mut [f64])) -> Mat<f64> {
    let mut y = Mat::zeros(u.nrows(), outputs);
    let (mut input, mut output) = (vec![0.0; u.ncols()], vec![0.0; outputs]);
    for k in work::checked(0..u.nrows()) {
        for (j, slot) in input.iter_mut().enumerate() {
            *slot = u[(k, j)];
        }
        step(&input, &mut output);
        for (j, value) in output.iter().enumerate() {
            y[(k, j)] = *value;
        }
    }
    y
}
