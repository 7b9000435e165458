//! The initial state by least squares.

use faer::{Mat, MatRef};
use lti::StateSpace;
use numerics::linalg;

use super::form::Form;
use super::gain::Gain;
use super::stepper::Stepper;
use crate::{Experiment, IdentError, Triangle};

/// Sensitivities to the initial state below this fraction of the largest they had are forgotten.
const FORGOTTEN: f64 = 1e-10;
/// Singular values below this fraction of the largest belong to directions that the data do not show.
const UNSEEN: f64 = 1e-12;
/// Coordinates worse conditioned than this do more harm than good.
const WORST_COORDINATES: f64 = 1e8;

/// The state `x(0)` that makes the sum of squared errors of one experiment smallest: one-step prediction errors,
/// weighed by their covariance, with `feedback`; simulation errors, each output in units of its own deviation, without.
///
/// The errors are affine in the state, `e(t) = e₀(t) − C Φ(t) x(0)`, where `Φ` is the product of `A − L(t) C` or of
/// `A`. Rows are taken until `Φ` is forgotten: a few for a predictor, all of them for a slow mode in simulation.
/// Coordinates along the eigenvectors keep modes that grow from hiding those that decay. In simulation only states that
/// inputs can move are estimated: the free response of a noise model is no part of it, and would take up the
/// disturbance. Without a noise model prediction is simulation, and both take the state of the first.
pub(super) fn estimate(form: &Form, experiment: &Experiment, feedback: bool) -> Result<Vec<f64>, IdentError> {
    let n = form.states;
    if n == 0 || experiment.is_empty() {
        return Ok(vec![0.0; n]);
    }
    let system = form.model.system();
    let feedback = feedback || form.model.k().norm_max() == 0.0;
    let basis =
        if feedback { modal_basis((system.a() - form.model.k() * system.c()).as_ref()) } else { driven_basis(system) };
    let columns = basis.ncols();
    if columns == 0 {
        return Ok(vec![0.0; n]);
    }
    let mut regression = Regression::new(form, experiment, &basis, feedback);
    for t in work::checked(0..experiment.len()) {
        regression.step(t);
        if regression.forgotten(t) {
            break;
        }
    }
    let coordinates = smallest_solution(regression.triangle, columns)?;
    let state: Vec<f64> = (0..n).map(|i| (0..columns).map(|j| basis[(i, j)] * coordinates[j]).sum()).collect();
    match state.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(IdentError::NotFinite { what: "the estimated initial state", index }),
        None => Ok(state),
    }
}

struct Regression<'a> {
    form: &'a Form,
    measured: Vec<&'a [f64]>,
    /// Deviation of each output, in simulation.
    deviations: Vec<f64>,
    gain: Option<Gain<'a>>,
    forced: Stepper<'a>,
    /// Columns of `Φ(t)`, and `C` times each.
    columns: Vec<Vec<f64>>,
    shown: Vec<Vec<f64>>,
    peaks: Vec<f64>,
    quiet: usize,
    triangle: Triangle,
    errors: Vec<f64>,
    correction: Vec<f64>,
    next: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

impl<'a> Regression<'a> {
    fn new(form: &'a Form, experiment: &'a Experiment, basis: &Mat<f64>, feedback: bool) -> Self {
        let (n, count) = (form.states, basis.ncols());
        let column = |j: usize| (0..n).map(|i| basis[(i, j)]).chain(std::iter::repeat_n(0.0, form.inputs)).collect();
        Regression {
            form,
            measured: (0..form.outputs).map(|i| experiment.output(i)).collect(),
            deviations: (0..form.outputs).map(|i| deviation(experiment.output(i))).collect(),
            gain: feedback.then(|| Gain::new(form)),
            forced: Stepper::new(form, experiment, &vec![0.0; n]),
            columns: (0..count).map(column).collect(),
            shown: vec![vec![0.0; form.outputs]; count],
            peaks: vec![0.0; count],
            quiet: 0,
            triangle: Triangle::new(count + 1),
            errors: vec![0.0; form.outputs],
            correction: vec![0.0; n],
            next: vec![0.0; n],
            rows: vec![vec![0.0; count + 1]; form.outputs],
        }
    }

    fn step(&mut self, t: usize) {
        let form = self.form;
        self.forced.output(t, &mut self.errors);
        for (i, e) in self.errors.iter_mut().enumerate() {
            *e = self.measured[i][t] - *e;
        }
        for (column, shown) in self.columns.iter().zip(&mut self.shown) {
            form.output.product(column, shown);
        }
        match &mut self.gain {
            Some(gain) => {
                gain.update(&mut self.errors);
                gather(gain.present(), &self.errors, &self.shown, &mut self.rows);
                whiten(gain.factor(), &mut self.rows[..gain.present().len()]);
                self.rows[..gain.present().len()].iter().for_each(|row| self.triangle.push_row(row));
                gain.apply(&self.errors, &mut self.correction);
                self.forced.advance_corrected(&self.correction);
            }
            None => {
                for i in (0..form.outputs).filter(|i| !self.errors[*i].is_nan()) {
                    gather(&[i], &self.errors, &self.shown, &mut self.rows);
                    self.rows[0].iter_mut().for_each(|v| *v /= self.deviations[i]);
                    self.triangle.push_row(&self.rows[0]);
                }
                self.forced.advance();
            }
        }
        self.advance_columns();
    }

    fn advance_columns(&mut self) {
        for (column, shown) in self.columns.iter_mut().zip(&self.shown) {
            self.form.transition.product(column, &mut self.next);
            if let Some(gain) = &self.gain {
                gain.apply(shown, &mut self.correction);
                self.next.iter_mut().zip(&self.correction).for_each(|(x, v)| *x -= v);
            }
            column[..self.form.states].copy_from_slice(&self.next);
        }
    }

    /// Returns true if no column has shown anything for as long as it may take a state to reach an output.
    fn forgotten(&mut self, t: usize) -> bool {
        let mut quiet = true;
        for (shown, peak) in self.shown.iter().zip(&mut self.peaks) {
            let size = shown.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            *peak = peak.max(size);
            quiet &= size <= FORGOTTEN * *peak;
        }
        self.quiet = if quiet { self.quiet + 1 } else { 0 };
        t > 2 * self.form.states && self.quiet > self.form.states
    }
}

/// Rows `[C Φ, e]` of the outputs listed.
fn gather(outputs: &[usize], errors: &[f64], shown: &[Vec<f64>], rows: &mut [Vec<f64>]) {
    for (row, i) in rows.iter_mut().zip(outputs) {
        for (slot, column) in row.iter_mut().zip(shown) {
            *slot = column[*i];
        }
        row[shown.len()] = errors[*i];
    }
}

/// `L⁻¹` times the rows.
fn whiten(factor: &Mat<f64>, rows: &mut [Vec<f64>]) {
    for i in 0..rows.len() {
        let (before, rest) = rows.split_at_mut(i);
        for (k, row) in before.iter().enumerate() {
            rest[0].iter_mut().zip(row).for_each(|(v, known)| *v -= factor[(i, k)] * known);
        }
        rest[0].iter_mut().for_each(|v| *v /= factor[(i, i)]);
    }
}

/// Standard deviation of the samples that are there; one where they do not vary.
fn deviation(values: &[f64]) -> f64 {
    let there = || values.iter().filter(|v| !v.is_nan());
    let count = there().count().max(1) as f64;
    let mean = there().sum::<f64>() / count;
    let deviation = (there().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt();
    if deviation > 0.0 && deviation.is_finite() { deviation } else { 1.0 }
}

/// The least-squares solution that is shortest in scaled coordinates.
fn smallest_solution(triangle: Triangle, n: usize) -> Result<Vec<f64>, IdentError> {
    if triangle.rows() == 0 {
        return Ok(vec![0.0; n]);
    }
    let factor = triangle.finish();
    if let Some(index) = (0..n).find(|j| !factor.col(*j).norm_l2().is_finite()) {
        return Err(IdentError::NotFinite { what: "the sensitivity to the initial state", index });
    }
    let scale: Vec<f64> = (0..n).map(|j| factor.col(j).norm_l2()).collect();
    let scaled = Mat::from_fn(n, n, |i, j| if scale[j] > 0.0 { factor[(i, j)] / scale[j] } else { 0.0 });
    let svd = linalg::svd(scaled.as_ref())?;
    let singular = |k: usize| svd.values[k];
    let mut solution = vec![0.0; n];
    for k in (0..n).filter(|k| singular(*k) > UNSEEN * singular(0)) {
        let along: f64 = (0..n).map(|i| svd.u[(i, k)] * factor[(i, n)]).sum::<f64>() / singular(k);
        for (j, slot) in solution.iter_mut().enumerate() {
            *slot += svd.v[(j, k)] * along;
        }
    }
    Ok(solution.iter().zip(&scale).map(|(v, s)| if *s > 0.0 { v / s } else { 0.0 }).collect())
}

/// Modal coordinates of the states that an input reaches along entries of `B` and `A` other than zero; of all states
/// where there is no input. These states are closed under `A`.
fn driven_basis(system: &StateSpace) -> Mat<f64> {
    let (n, inputs) = (system.states(), system.inputs());
    let mut driven: Vec<bool> = (0..n).map(|i| inputs == 0 || (0..inputs).any(|k| system.b()[(i, k)] != 0.0)).collect();
    let mut waiting: Vec<usize> = (0..n).filter(|i| driven[*i]).collect();
    while let Some(j) = waiting.pop() {
        for i in 0..n {
            if system.a()[(i, j)] != 0.0 && !driven[i] {
                driven[i] = true;
                waiting.push(i);
            }
        }
    }
    let places: Vec<usize> = (0..n).filter(|i| driven[*i]).collect();
    let count = places.len();
    let own = modal_basis(Mat::from_fn(count, count, |i, j| system.a()[(places[i], places[j])]).as_ref());
    let mut basis = Mat::zeros(n, count);
    for (i, place) in places.iter().enumerate() {
        for j in 0..count {
            basis[(*place, j)] = own[(i, j)];
        }
    }
    basis
}

/// Real eigenvectors as columns (real and imaginary part of a pair), or the identity where they are nearly dependent.
fn modal_basis(a: MatRef<'_, f64>) -> Mat<f64> {
    let n = a.nrows();
    let identity = Mat::identity(n, n);
    if n == 0 {
        return identity;
    }
    let Ok(eigen) = linalg::eigen(a) else {
        return identity;
    };
    let (vectors, values) = (eigen.vectors, eigen.values);
    let basis = Mat::from_fn(n, n, |i, j| if values[j].im < 0.0 { vectors[(i, j)].im } else { vectors[(i, j)].re });
    let Ok(singular) = linalg::singular_values(basis.as_ref()) else {
        return identity;
    };
    let usable = singular.iter().all(|s| s.is_finite()) && singular[n - 1] * WORST_COORDINATES > singular[0];
    if usable { basis } else { identity }
}
