//! Small complex least-squares problems, one a frequency, in memory that is used again.

use crate::Complex64;

/// Columns are normalised; one that leaves less than this of itself beside the others depends on them.
const DEPENDENT: f64 = 1e-10;
/// A dependency that involves a leading unknown by less than this leaves that unknown determined.
const UNINVOLVED: f64 = 1e-5;

/// `min ‖A x − b‖` by modified Gram–Schmidt, each column orthogonalised twice.
///
/// Columns that depend on earlier ones get the coefficient zero, as long as that leaves the first `leading` unknowns
/// determined.
pub(super) struct LeastSquares {
    rows: usize,
    leading: usize,
    /// Orthonormal columns, one after the other.
    q: Vec<Complex64>,
    /// Column `m` of the triangle is at `m·(m+1)/2`, for the columns kept.
    r: Vec<Complex64>,
    /// For each kept column: its index and its norm.
    kept: Vec<(usize, f64)>,
    columns: usize,
    coefficients: Vec<Complex64>,
}

impl LeastSquares {
    /// An empty problem whose first `leading` unknowns are wanted.
    pub(super) fn new(rows: usize, leading: usize) -> Self {
        let (q, r, kept, coefficients) = (vec![], vec![], vec![], vec![]);
        Self { rows, leading, q, r, kept, columns: 0, coefficients }
    }

    /// Forgets the columns, keeps the memory.
    pub(super) fn clear(&mut self) {
        self.q.clear();
        self.r.clear();
        self.kept.clear();
        self.columns = 0;
    }

    /// Appends a column; false where a leading unknown is no longer determined.
    pub(super) fn push(&mut self, column: impl Iterator<Item = Complex64>) -> bool {
        let start = self.q.len();
        self.q.extend(column);
        self.columns += 1;
        let norm = norm(&self.q[start..]);
        if norm == 0.0 {
            self.q.truncate(start);
            return self.columns > self.leading;
        }
        self.q[start..].iter_mut().for_each(|v| *v /= norm);
        let (basis, column) = self.q.split_at_mut(start);
        project_out(basis, column, &mut self.coefficients);
        let left = self::norm(column);
        if left < DEPENDENT {
            self.q.truncate(start);
            back_substitute(&self.r, &mut self.coefficients);
            let involved = |z: &Complex64| z.norm() > UNINVOLVED;
            return self.columns > self.leading && !self.coefficients[..self.leading].iter().any(involved);
        }
        column.iter_mut().for_each(|v| *v /= left);
        self.r.extend_from_slice(&self.coefficients);
        self.r.push(Complex64::new(left, 0.0));
        self.kept.push((self.columns - 1, norm));
        true
    }

    /// `Σ_i w_i (1 − h_ii)`, `h` the projection on the columns: what the squared norm of the residual is expected to be
    /// for errors of variances `w`. Rows less columns for equal ones.
    pub(super) fn expected_residual(&self, weights: &[f64]) -> f64 {
        let leverage = |i: usize| self.q.iter().skip(i).step_by(self.rows).map(|q| q.norm_sqr()).sum::<f64>();
        weights.iter().enumerate().map(|(i, w)| w * (1.0 - leverage(i)).max(0.0)).sum()
    }

    /// Solves for `b`, which becomes the residual; writes the unknowns, one a column pushed.
    pub(super) fn solve(&mut self, b: &mut [Complex64], unknowns: &mut Vec<Complex64>) {
        project_out(&self.q, b, &mut self.coefficients);
        back_substitute(&self.r, &mut self.coefficients);
        unknowns.clear();
        unknowns.resize(self.columns, Complex64::ZERO);
        for ((index, norm), value) in self.kept.iter().zip(&self.coefficients) {
            unknowns[*index] = value / norm;
        }
    }

    /// Writes row `j` of the pseudoinverse: with which weight each row of `b` enters leading unknown `j`.
    pub(super) fn influence(&mut self, j: usize, weights: &mut Vec<Complex64>) {
        let row = &mut self.coefficients;
        row.clear();
        // Row j of the triangle's inverse.
        for m in 0..self.kept.len() {
            let column = &self.r[m * (m + 1) / 2..];
            let above: Complex64 = row.iter().zip(column).map(|(x, r)| x * r).sum();
            let unit = if m == j { 1.0 } else { 0.0 };
            row.push((Complex64::new(unit, 0.0) - above) / column[m]);
        }
        let (q, rows) = (&self.q, self.rows);
        let scale = self.kept.get(j).map_or(f64::INFINITY, |(_, norm)| 1.0 / norm);
        let of_row = |i: usize| row.iter().zip(q.iter().skip(i).step_by(rows)).map(|(x, q)| x * q.conj()).sum();
        weights.clear();
        weights.extend((0..rows).map(of_row).map(|sum: Complex64| sum * scale));
    }
}

pub(super) fn norm(v: &[Complex64]) -> f64 {
    v.iter().map(|z| z.norm_sqr()).sum::<f64>().sqrt()
}

/// Takes the components along the orthonormal `basis` off `v`, twice; writes them.
fn project_out(basis: &[Complex64], v: &mut [Complex64], coefficients: &mut Vec<Complex64>) {
    coefficients.clear();
    coefficients.resize(basis.len() / v.len().max(1), Complex64::ZERO);
    for _ in 0..2 {
        for (q, coefficient) in basis.chunks_exact(v.len().max(1)).zip(coefficients.iter_mut()) {
            let along: Complex64 = q.iter().zip(v.iter()).map(|(q, v)| q.conj() * v).sum();
            v.iter_mut().zip(q).for_each(|(v, q)| *v -= along * q);
            *coefficient += along;
        }
    }
}

/// Solves `R x = b` in place for the triangle packed by columns.
fn back_substitute(r: &[Complex64], b: &mut [Complex64]) {
    for m in (0..b.len()).rev() {
        let column = &r[m * (m + 1) / 2..];
        b[m] /= column[m];
        let value = b[m];
        b[..m].iter_mut().zip(column).for_each(|(b, r)| *b -= value * r);
    }
}
