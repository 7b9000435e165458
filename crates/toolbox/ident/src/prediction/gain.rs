//! The gain of the predictor, which changes once an output is missing.

use faer::Mat;

use super::form::Form;

/// The gain from prediction errors to states at each sample: `K` while every output is there, that of the time-varying
/// Kalman filter from a missing one until the state is known again.
///
/// Its state is the covariance `P` of the error of the predicted state. With `o` the outputs that are there and `E_o`
/// the selection of them, `S = C_o P C_oᵀ + Λ_oo`, `L = (A P C_oᵀ + K Λ_o) S⁻¹` and
/// `P⁺ = (A − L C_o) P (A − L C_o)ᵀ + (K − L E_o) Λ (K − L E_o)ᵀ`: zero where nothing is missing.
///
/// # Source
/// Anderson & Moore, *Optimal Filtering*, 1979, §5.4 (noises that depend on each other), in the form that keeps P
/// non-negative.
#[derive(Debug, Clone)]
pub(crate) struct Gain<'a> {
    form: &'a Form,
    lambda: Mat<f64>,
    /// Cholesky factor of Λ, for samples at which nothing is missing and the state is known.
    steady_factor: Mat<f64>,
    settled: bool,
    /// `P` after the sample and before it, and the largest value each of its diagonal elements had.
    covariance: Mat<f64>,
    before: Mat<f64>,
    peak: Vec<f64>,
    /// `L`, zero in the columns of missing outputs.
    varying: Mat<f64>,
    /// Its leading part, as large as there are outputs, is the factor.
    varying_factor: Mat<f64>,
    present: Vec<usize>,
    scratch: Scratch,
}

/// Tables that are written anew at each sample.
#[derive(Debug, Clone)]
struct Scratch {
    /// `K Λ`, which stays.
    noise: Mat<f64>,
    /// `P C_oᵀ`, and what becomes `L`.
    shown: Mat<f64>,
    cross: Mat<f64>,
    innovation: Mat<f64>,
    /// `A − L C`, and that times `P`.
    closed: Mat<f64>,
    moved: Mat<f64>,
    /// `K − L`, and that times `Λ`.
    rest: Mat<f64>,
    rest_noise: Mat<f64>,
}

impl Scratch {
    fn new(form: &Form, lambda: &Mat<f64>) -> Self {
        let (tall, square) = (Mat::zeros(form.states, form.outputs), Mat::zeros(form.states, form.states));
        Scratch {
            noise: form.model.k() * lambda,
            shown: tall.clone(),
            cross: tall.clone(),
            innovation: Mat::zeros(form.outputs, form.outputs),
            closed: square.clone(),
            moved: square,
            rest: tall.clone(),
            rest_noise: tall,
        }
    }
}

/// Below this fraction of its largest value the variance of a state counts as zero.
const SETTLED: f64 = 1e-16;

impl<'a> Gain<'a> {
    pub(crate) fn new(form: &'a Form) -> Self {
        let (n, outputs) = (form.states, form.outputs);
        let lambda = usable_covariance(form);
        Gain {
            form,
            steady_factor: cholesky(&lambda),
            scratch: Scratch::new(form, &lambda),
            lambda,
            settled: true,
            covariance: Mat::zeros(n, n),
            before: Mat::zeros(n, n),
            peak: vec![0.0; n],
            varying: Mat::zeros(n, outputs),
            varying_factor: Mat::zeros(outputs, outputs),
            present: Vec::with_capacity(outputs),
        }
    }

    /// Moves on to a sample whose prediction errors are `e`, NaN where the output is missing, and sets those to zero.
    pub(crate) fn update(&mut self, e: &mut [f64]) {
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
            let there = &self.present;
            let lambda = |i: usize, j: usize| self.lambda[(there[i], there[j])];
            cholesky_into(there.len(), lambda, &mut self.varying_factor);
            return;
        }
        self.settled = false;
        self.before.copy_from(&self.covariance);
        self.vary();
        if whole {
            self.settle();
        }
    }

    fn vary(&mut self) {
        self.find_gain();
        self.move_covariance();
        for (i, peak) in self.peak.iter_mut().enumerate() {
            *peak = peak.max(self.covariance[(i, i)]);
        }
    }

    /// `S`, its factor, and `L`.
    fn find_gain(&mut self) {
        let (form, there, w) = (self.form, &self.present, &mut self.scratch);
        let (a, c, n) = (form.model.system().a(), form.model.system().c(), form.states);
        for (j, output) in there.iter().enumerate() {
            for i in 0..n {
                w.shown[(i, j)] = (0..n).map(|k| self.covariance[(i, k)] * c[(*output, k)]).sum();
            }
            for i in 0..n {
                let moved: f64 = (0..n).map(|k| a[(i, k)] * w.shown[(k, j)]).sum();
                w.cross[(i, j)] = moved + w.noise[(i, *output)];
            }
            for (i, other) in there.iter().enumerate() {
                let shown: f64 = (0..n).map(|k| c[(*other, k)] * w.shown[(k, j)]).sum();
                w.innovation[(i, j)] = shown + self.lambda[(*other, *output)];
            }
        }
        cholesky_into(there.len(), |i, j| w.innovation[(i, j)], &mut self.varying_factor);
        divide(&mut w.cross, there.len(), &self.varying_factor);
        self.varying.fill(0.0);
        for (j, output) in there.iter().enumerate() {
            (0..n).for_each(|i| self.varying[(i, *output)] = w.cross[(i, j)]);
        }
    }

    /// `P⁺`.
    fn move_covariance(&mut self) {
        let (form, w) = (self.form, &mut self.scratch);
        let (system, k) = (form.model.system(), form.model.k());
        let (n, outputs) = (form.states, form.outputs);
        for i in 0..n {
            for j in 0..outputs {
                w.rest[(i, j)] = k[(i, j)] - self.varying[(i, j)];
            }
            for j in 0..n {
                let fed: f64 = (0..outputs).map(|o| self.varying[(i, o)] * system.c()[(o, j)]).sum();
                w.closed[(i, j)] = system.a()[(i, j)] - fed;
            }
            for j in 0..n {
                w.moved[(i, j)] = (0..n).map(|m| w.closed[(i, m)] * self.covariance[(m, j)]).sum();
            }
            for j in 0..outputs {
                w.rest_noise[(i, j)] = (0..outputs).map(|o| w.rest[(i, o)] * self.lambda[(o, j)]).sum();
            }
        }
        for i in 0..n {
            for j in 0..=i {
                let carried: f64 = (0..n).map(|m| w.moved[(i, m)] * w.closed[(j, m)]).sum();
                let added: f64 = (0..outputs).map(|o| w.rest_noise[(i, o)] * w.rest[(j, o)]).sum();
                self.covariance[(i, j)] = carried + added;
                self.covariance[(j, i)] = carried + added;
            }
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

    /// `v = L e`, with zeros in `e` for missing outputs.
    pub(crate) fn apply(&self, e: &[f64], v: &mut [f64]) {
        if self.settled || self.form.is_output_error() {
            return self.form.gain.product(e, v);
        }
        for (i, slot) in v.iter_mut().enumerate() {
            *slot = self.present.iter().map(|j| self.varying[(i, *j)] * e[*j]).sum();
        }
    }

    /// Returns true if the gain is `K`: nothing is missing, and the state is known.
    pub(crate) fn is_settled(&self) -> bool {
        self.settled
    }

    /// `P` before the sample, relative to [`Gain::noise`].
    pub(crate) fn covariance_before(&self) -> &Mat<f64> {
        &self.before
    }

    /// `L`.
    pub(crate) fn gain(&self) -> &Mat<f64> {
        &self.varying
    }

    /// `Λ`, up to a factor.
    pub(crate) fn noise(&self) -> &Mat<f64> {
        &self.lambda
    }

    /// `X ← X S⁻¹`.
    pub(crate) fn divide(&self, x: &mut Mat<f64>) {
        divide(x, x.ncols(), self.factor());
    }

    /// Gives prediction errors of covariance `S` the covariance `Λ` that they have where nothing was missing; rows of
    /// all outputs, one after the other.
    pub(crate) fn as_of_whole_data(&self, rows: &mut [f64], width: usize) {
        if self.settled {
            return;
        }
        let (count, factor) = (rows.len() / width.max(1), &self.varying_factor);
        for i in 0..count {
            let (before, rest) = rows.split_at_mut(i * width);
            let row = &mut rest[..width];
            for (k, other) in before.chunks_exact(width).enumerate() {
                row.iter_mut().zip(other).for_each(|(v, o)| *v -= factor[(i, k)] * o);
            }
            row.iter_mut().for_each(|v| *v /= factor[(i, i)]);
        }
        for i in (0..count).rev() {
            let (before, rest) = rows.split_at_mut(i * width);
            let row = &mut rest[..width];
            row.iter_mut().for_each(|v| *v *= self.steady_factor[(i, i)]);
            for (k, other) in before.chunks_exact(width).enumerate() {
                row.iter_mut().zip(other).for_each(|(v, o)| *v += self.steady_factor[(i, k)] * o);
            }
        }
    }

    /// The outputs that are there.
    pub(crate) fn present(&self) -> &[usize] {
        &self.present
    }

    /// The lower Cholesky factor of the covariance of the prediction errors that are there.
    pub(crate) fn factor(&self) -> &Mat<f64> {
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

fn cholesky(m: &Mat<f64>) -> Mat<f64> {
    let mut l = Mat::zeros(m.nrows(), m.nrows());
    cholesky_into(m.nrows(), |i, j| m[(i, j)], &mut l);
    l
}

/// Writes the lower Cholesky factor of an n × n matrix; a pivot lost to rounding is held at a small part of the
/// diagonal.
fn cholesky_into(n: usize, m: impl Fn(usize, usize) -> f64, l: &mut Mat<f64>) {
    for j in 0..n {
        let pivot = m(j, j) - (0..j).map(|k| l[(j, k)] * l[(j, k)]).sum::<f64>();
        l[(j, j)] = pivot.max(1e-15 * m(j, j)).max(f64::MIN_POSITIVE).sqrt();
        for i in j + 1..n {
            let rest = m(i, j) - (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum::<f64>();
            l[(i, j)] = rest / l[(j, j)];
        }
    }
}

/// `X ← X (L Lᵀ)⁻¹` for the first `n` columns.
fn divide(x: &mut Mat<f64>, n: usize, l: &Mat<f64>) {
    for row in 0..x.nrows() {
        for i in 0..n {
            let known: f64 = (0..i).map(|k| l[(i, k)] * x[(row, k)]).sum();
            x[(row, i)] = (x[(row, i)] - known) / l[(i, i)];
        }
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|k| l[(k, i)] * x[(row, k)]).sum();
            x[(row, i)] = (x[(row, i)] - known) / l[(i, i)];
        }
    }
}
