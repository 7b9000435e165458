//! A covariance in factors.

use faer::Mat;

/// `P = U D Uᵀ` with `U` unit upper triangular and `D` diagonal and positive: P stays symmetric and positive whatever
/// rounding does.
///
/// # Source
/// Bierman, *Factorization Methods for Discrete Sequential Estimation*, 1977, ch. V (measurement update) and VI (time
/// update by weighted Gram–Schmidt).
#[derive(Debug, Clone)]
pub(super) struct UdFactor {
    u: Mat<f64>,
    d: Vec<f64>,
    gain: Vec<f64>,
}

impl UdFactor {
    /// From an upper triangular root, `P = T Tᵀ`.
    pub(super) fn from_upper_root(root: &Mat<f64>) -> Self {
        let n = root.nrows();
        let u = Mat::from_fn(n, n, |i, j| if i <= j { root[(i, j)] / root[(j, j)] } else { 0.0 });
        UdFactor { u, d: (0..n).map(|j| root[(j, j)].powi(2)).collect(), gain: vec![0.0; n] }
    }

    pub(super) fn diagonal(&self) -> &[f64] {
        &self.d
    }

    pub(super) fn scale(&mut self, factor: f64) {
        self.d.iter_mut().for_each(|d| *d *= factor);
    }

    /// `P − P ψ ψᵀ P / (r + ψᵀ P ψ)`; returns the gain `P ψ / (r + ψᵀ P ψ)` and `r + ψᵀ P ψ`.
    pub(super) fn measure(&mut self, psi: &[f64], r: f64) -> (&[f64], f64) {
        let n = psi.len();
        let mut alpha = r;
        for j in 0..n {
            let f = psi[j] + (0..j).map(|i| self.u[(i, j)] * psi[i]).sum::<f64>();
            let v = self.d[j] * f;
            let before = alpha;
            alpha += f * v;
            self.d[j] *= before / alpha;
            self.gain[j] = v;
            let lambda = -f / before;
            for i in 0..j {
                let old = self.u[(i, j)];
                self.u[(i, j)] = old + self.gain[i] * lambda;
                self.gain[i] += v * old;
            }
        }
        self.gain.iter_mut().for_each(|g| *g /= alpha);
        (&self.gain, alpha)
    }

    /// `P + diag(q)`.
    pub(super) fn diffuse(&mut self, q: &[f64]) {
        let n = q.len();
        // Rows of [U I] with weights [D q], made orthogonal from the last to the first.
        let mut w = Mat::from_fn(n, 2 * n, |i, j| if j < n { self.u[(i, j)] } else { f64::from(u8::from(j - n == i)) });
        let weight = |d: &[f64], j: usize| if j < n { d[j] } else { q[j - n] };
        let old = self.d.clone();
        for j in (0..n).rev() {
            let norm: f64 = (0..2 * n).map(|k| w[(j, k)] * w[(j, k)] * weight(&old, k)).sum();
            self.d[j] = norm;
            for i in 0..j {
                let along: f64 = (0..2 * n).map(|k| w[(i, k)] * w[(j, k)] * weight(&old, k)).sum();
                let share = if norm > 0.0 { along / norm } else { 0.0 };
                self.u[(i, j)] = share;
                (0..2 * n).for_each(|k| w[(i, k)] -= share * w[(j, k)]);
            }
        }
    }

    pub(super) fn covariance(&self) -> Mat<f64> {
        let n = self.d.len();
        Mat::from_fn(n, n, |i, j| (i.max(j)..n).map(|k| self.u[(i, k)] * self.d[k] * self.u[(j, k)]).sum())
    }
}
