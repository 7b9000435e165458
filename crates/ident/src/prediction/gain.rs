//! The gain of the predictor, which changes once an output is missing.

use faer::Mat;

use super::form::Form;

/// The gain from prediction errors to states at each sample: `K` while every output is there, that of the time-varying
/// Kalman filter from a missing one until the state is known again.
///
/// Its state is the covariance `P` of the error of the predicted state. With `o` the outputs that are there and `E_o` the
/// selection of them, `S = C_o P C_oᵀ + Λ_oo`, `L = (A P C_oᵀ + K Λ_o) S⁻¹` and
/// `P⁺ = (A − L C_o) P (A − L C_o)ᵀ + (K − L E_o) Λ (K − L E_o)ᵀ`: zero where nothing is missing.
///
/// # Source
/// Anderson & Moore, *Optimal Filtering*, 1979, §5.4 (noises that depend on each other), in the form that keeps P
/// non-negative.
pub(super) struct Gain<'a> {
    form: &'a Form,
    lambda: Mat<f64>,
    /// Cholesky factor of Λ, for samples at which nothing is missing and the state is known.
    steady_factor: Mat<f64>,
    settled: bool,
    /// `P`, and the largest value each of its diagonal elements had.
    covariance: Mat<f64>,
    peak: Vec<f64>,
    /// `L`, zero in the columns of missing outputs.
    varying: Mat<f64>,
    varying_factor: Mat<f64>,
    present: Vec<usize>,
}

/// Below this fraction of its largest value the variance of a state counts as zero.
const SETTLED: f64 = 1e-16;

impl<'a> Gain<'a> {
    pub(super) fn new(form: &'a Form) -> Self {
        let (n, outputs) = (form.states, form.outputs);
        let lambda = usable_covariance(form);
        Gain {
            form,
            steady_factor: cholesky(&lambda),
            lambda,
            settled: true,
            covariance: Mat::zeros(n, n),
            peak: vec![0.0; n],
            varying: Mat::zeros(n, outputs),
            varying_factor: Mat::zeros(0, 0),
            present: Vec::with_capacity(outputs),
        }
    }

    /// Moves on to a sample whose prediction errors are `e`, NaN where the output is missing, and sets those to zero.
    pub(super) fn update(&mut self, e: &mut [f64]) {
        self.present.clear();
        for (i, value) in e.iter_mut().enumerate() {
            if value.is_nan() {
                *value = 0.0;
            } else {
                self.present.push(i);
            }
        }
        let whole = self.present.len() == e.len();
        if self.settled && whole {
            return;
        }
        if self.form.is_output_error() {
            self.settled = whole;
            self.varying_factor = cholesky(&self.present_block(&self.lambda));
            return;
        }
        self.settled = false;
        self.vary();
        if whole {
            self.settle();
        }
    }

    fn vary(&mut self) {
        let system = self.form.model.system();
        let (n, outputs, count) = (self.form.states, self.form.outputs, self.present.len());
        let c = Mat::from_fn(count, n, |i, j| system.c()[(self.present[i], j)]);
        let pc = &self.covariance * c.transpose();
        let noise = self.form.model.k() * &self.lambda;
        let cross = system.a() * &pc + Mat::from_fn(n, count, |i, j| noise[(i, self.present[j])]);
        self.varying_factor = cholesky(&(&c * &pc + self.present_block(&self.lambda)));
        let gain = divided_by(&cross, &self.varying_factor);
        self.varying = Mat::zeros(n, outputs);
        for (position, output) in self.present.iter().enumerate() {
            for i in 0..n {
                self.varying[(i, *output)] = gain[(i, position)];
            }
        }
        let closed = system.a() - &gain * &c;
        let rest = self.form.model.k() - &self.varying;
        self.covariance = &closed * &self.covariance * closed.transpose() + &rest * &self.lambda * rest.transpose();
        for (i, peak) in self.peak.iter_mut().enumerate() {
            *peak = peak.max(self.covariance[(i, i)]);
        }
    }

    /// Goes back to `K` once the uncertainty that missing samples left has died away.
    fn settle(&mut self) {
        let n = self.form.states;
        if (0..n).all(|i| self.covariance[(i, i)] <= SETTLED * self.peak[i]) {
            self.covariance = Mat::zeros(n, n);
            self.peak.fill(0.0);
            self.settled = true;
        }
    }

    fn present_block(&self, m: &Mat<f64>) -> Mat<f64> {
        let count = self.present.len();
        Mat::from_fn(count, count, |i, j| m[(self.present[i], self.present[j])])
    }

    /// `v = L e`, with zeros in `e` for missing outputs.
    pub(super) fn apply(&self, e: &[f64], v: &mut [f64]) {
        if self.settled || self.form.is_output_error() {
            return self.form.gain.product(e, v);
        }
        for (i, slot) in v.iter_mut().enumerate() {
            *slot = self.present.iter().map(|j| self.varying[(i, *j)] * e[*j]).sum();
        }
    }

    /// The outputs that are there.
    pub(super) fn present(&self) -> &[usize] {
        &self.present
    }

    /// The lower Cholesky factor of the covariance of the prediction errors that are there.
    pub(super) fn factor(&self) -> &Mat<f64> {
        if self.settled { &self.steady_factor } else { &self.varying_factor }
    }
}

/// Λ made safely positive: the identity where the model says there is no noise at all.
fn usable_covariance(form: &Form) -> Mat<f64> {
    let lambda = form.model.noise_covariance();
    let n = form.outputs;
    let largest = (0..n).map(|i| lambda[(i, i)]).fold(0.0, f64::max);
    if largest <= 0.0 {
        return Mat::identity(n, n);
    }
    // Only ratios matter, so the scale is taken off; an output without noise gets a millionth of the largest deviation.
    let floor = |i: usize, j: usize| if i == j { 1e-12 } else { 0.0 };
    Mat::from_fn(n, n, |i, j| 0.5 * (lambda[(i, j)] + lambda[(j, i)]) / largest + floor(i, j))
}

/// The lower Cholesky factor; a pivot lost to rounding is held at a small part of the diagonal.
fn cholesky(m: &Mat<f64>) -> Mat<f64> {
    let n = m.nrows();
    let mut l = Mat::<f64>::zeros(n, n);
    for j in 0..n {
        let pivot = m[(j, j)] - (0..j).map(|k| l[(j, k)] * l[(j, k)]).sum::<f64>();
        l[(j, j)] = pivot.max(1e-15 * m[(j, j)]).max(f64::MIN_POSITIVE).sqrt();
        for i in j + 1..n {
            let rest = m[(i, j)] - (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum::<f64>();
            l[(i, j)] = rest / l[(j, j)];
        }
    }
    l
}

/// `M (L Lᵀ)⁻¹`.
fn divided_by(m: &Mat<f64>, l: &Mat<f64>) -> Mat<f64> {
    let mut x = m.clone();
    for row in 0..x.nrows() {
        for i in 0..x.ncols() {
            let known: f64 = (0..i).map(|k| l[(i, k)] * x[(row, k)]).sum();
            x[(row, i)] = (x[(row, i)] - known) / l[(i, i)];
        }
        for i in (0..x.ncols()).rev() {
            let known: f64 = (i + 1..x.ncols()).map(|k| l[(k, i)] * x[(row, k)]).sum();
            x[(row, i)] = (x[(row, i)] - known) / l[(i, i)];
        }
    }
    x
}
