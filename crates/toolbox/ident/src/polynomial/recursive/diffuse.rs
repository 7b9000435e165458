//! A start that needs no guess: information gathered until it determines the parameters.

use faer::Mat;

use fitting::condition::checked_condition;

/// Columns scaled to one must be conditioned better than this before the information is inverted.
const CONDITION: f64 = 1e4;

/// Rows for every parameter before the start ends.
const ROWS: usize = 2;

/// The triangular factor of the rows [ψ y], one Givens rotation a column at a time.
#[derive(Debug, Clone)]
pub(super) struct Information {
    factor: Mat<f64>,
    row: Vec<f64>,
    rows: usize,
}

impl Information {
    pub(super) fn new(count: usize) -> Self {
        Information { factor: Mat::zeros(count + 1, count + 1), row: vec![0.0; count + 1], rows: 0 }
    }

    /// Weights what was gathered by `forgetting`, and adds a row.
    pub(super) fn push(&mut self, psi: &[f64], target: f64, forgetting: f64) {
        let n = self.row.len();
        let root = forgetting.sqrt();
        self.row[..n - 1].copy_from_slice(psi);
        self.row[n - 1] = target;
        self.rows += 1;
        for i in 0..n {
            for j in i..n {
                self.factor[(i, j)] *= root;
            }
            let radius = self.factor[(i, i)].hypot(self.row[i]);
            if radius == 0.0 {
                continue;
            }
            let (cos, sin) = (self.factor[(i, i)] / radius, self.row[i] / radius);
            for j in i..n {
                let (above, below) = (self.factor[(i, j)], self.row[j]);
                self.factor[(i, j)] = cos * above + sin * below;
                self.row[j] = cos * below - sin * above;
            }
        }
    }

    /// Parameters, the inverse of the factor (an upper root of the covariance for noise of variance one), and the sum
    /// of squares left; `None` as long as they are not well determined.
    pub(super) fn solve(&self) -> Option<(Vec<f64>, Mat<f64>, f64)> {
        let n = self.row.len() - 1;
        if self.rows < ROWS * n + 1 {
            return None;
        }
        let scale: Vec<f64> =
            (0..n).map(|j| (0..=j).map(|i| self.factor[(i, j)].powi(2)).sum::<f64>().sqrt()).collect();
        if scale.contains(&0.0) {
            return None;
        }
        let scaled = Mat::from_fn(n, n, |i, j| if i <= j { self.factor[(i, j)] / scale[j] } else { 0.0 });
        if checked_condition(scaled.as_ref()).is_ok_and(|condition| condition < CONDITION) {
            let root = inverse_upper(&self.factor, n);
            let solution = (0..n).map(|i| (i..n).map(|j| root[(i, j)] * self.factor[(j, n)]).sum()).collect();
            return Some((solution, root, self.factor[(n, n)].powi(2)));
        }
        None
    }
}

fn inverse_upper(r: &Mat<f64>, n: usize) -> Mat<f64> {
    let mut inverse = Mat::zeros(n, n);
    for j in 0..n {
        inverse[(j, j)] = 1.0 / r[(j, j)];
        for i in (0..j).rev() {
            let sum: f64 = (i + 1..=j).map(|k| r[(i, k)] * inverse[(k, j)]).sum();
            inverse[(i, j)] = -sum / r[(i, i)];
        }
    }
    inverse
}
