//! The derivatives of predictions whose gain changes, as it does after a missing output.
//!
//! With x̂⁺ = A x̂ + B u + L ε and ε = y − C x̂ − D u, a change of the matrices makes
//! `dx̂⁺ = A dx̂ + dA x̂ + dB u + dL ε − L dŷ`, `dŷ = C dx̂ + dC x̂ + dD u`, with zero columns of L for what is
//! missing. The gain is that of [`Gain`](crate::prediction::Gain): `L = M S⁻¹`, `S = C_o P C_oᵀ + Λ_oo`,
//! `M = A P C_oᵀ + K Λ_o`, `P⁺ = A P Aᵀ + K Λ Kᵀ − L S Lᵀ`, from which follow `dL = (dM − L dS) S⁻¹` and dP⁺.
//!
//! # Source
//! Gupta & Mehra, *Computational aspects of maximum likelihood estimation and reduction in sensitivity function
//! calculations*, IEEE Trans. Autom. Control 19(6), 1974; Ljung 1999, §14.2 (missing data).

use faer::{Mat, MatRef};

use super::predictor::{Free, Instant, Predictor};
use crate::prediction::Gain;

/// Change of each matrix by one unit of a direction, and the sensitivities `dP` and `dL` that follow.
struct Direction {
    a: Mat<f64>,
    b: Mat<f64>,
    c: Mat<f64>,
    d: Mat<f64>,
    k: Mat<f64>,
    /// dP and dL.
    covariance: Mat<f64>,
    gain: Mat<f64>,
}

impl Direction {
    /// From the changes of the free entries, in their order.
    fn new(of: &Predictor, free: Free, entry: impl Fn(usize) -> f64) -> Self {
        let Predictor { n, m, p, .. } = *of;
        let mut first = 0;
        let mut next = |rows: usize, columns: usize, is_free: bool| {
            let start = first;
            first += if is_free { rows * columns } else { 0 };
            Mat::from_fn(rows, columns, |i, j| if is_free { entry(start + i * columns + j) } else { 0.0 })
        };
        let (a, b, c) = (next(n, n, free.dynamics), next(n, m, true), next(p, n, free.dynamics));
        let (d, k) = (next(p, m, free.feedthrough), next(n, p, free.noise));
        Direction { a, b, c, d, covariance: Mat::zeros(n, n), gain: k.clone(), k }
    }

    /// Moves dL to the instant of `gain`, and dP to the one after it.
    fn follow(&mut self, of: &Predictor, gain: &Gain<'_>) {
        if gain.is_settled() {
            self.gain.copy_from(&self.k);
            self.covariance.fill(0.0);
            return;
        }
        let (system, there) = (of.form.model.system(), gain.present());
        let (a, p, noise) = (system.a(), gain.covariance_before(), gain.noise());
        let rows = |m: MatRef<'_, f64>| Mat::from_fn(there.len(), m.ncols(), |i, j| m[(there[i], j)]);
        let columns = |m: MatRef<'_, f64>| Mat::from_fn(m.nrows(), there.len(), |i, j| m[(i, there[j])]);
        let (c, dc, l) = (rows(system.c()), rows(self.c.as_ref()), columns(gain.gain().as_ref()));
        let (noise_there, shown, dp) = (columns(noise.as_ref()), p * c.transpose(), &self.covariance);
        let innovation = rows((system.c() * &shown + &noise_there).as_ref());
        let d_innovation = twice_symmetric(&dc * &shown) + &c * dp * c.transpose();
        let d_shown = dp * c.transpose() + p * dc.transpose();
        let d_product = &self.a * &shown + a * d_shown + &self.k * &noise_there;
        let mut dl = d_product - &l * &d_innovation;
        gain.divide(&mut dl);
        let grown = twice_symmetric(&self.a * p * a.transpose()) + a * dp * a.transpose();
        let driven = twice_symmetric(&self.k * noise * of.form.model.k().transpose());
        let learnt = twice_symmetric(&dl * innovation * l.transpose()) + &l * d_innovation * l.transpose();
        self.covariance = grown + driven - learnt;
        self.gain.fill(0.0);
        for (j, output) in there.iter().enumerate() {
            self.gain.col_mut(*output).copy_from(dl.col(j));
        }
    }
}

/// `M + Mᵀ`.
fn twice_symmetric(m: Mat<f64>) -> Mat<f64> {
    &m + m.transpose()
}

/// The derivatives of x̂ and ŷ by the initial state and along directions of the free entries.
pub(super) struct Sensitivities<'a> {
    of: &'a Predictor,
    directions: Vec<Direction>,
    initial: usize,
    /// dx̂, states × columns.
    state: Mat<f64>,
    /// dŷ, outputs × columns.
    output: Mat<f64>,
}

impl<'a> Sensitivities<'a> {
    pub(super) fn new(of: &'a Predictor, free: Free, basis: MatRef<'_, f64>, initial: usize) -> Self {
        let directions: Vec<Direction> =
            (0..basis.ncols()).map(|j| Direction::new(of, free, |i| basis[(i, j)])).collect();
        let columns = initial + directions.len();
        let state = Mat::from_fn(of.n, columns, |i, j| if i == j && j < initial { 1.0 } else { 0.0 });
        Sensitivities { of, directions, initial, state, output: Mat::zeros(of.p, columns) }
    }

    /// Writes the weighed rows `[Ψ₀, Ψ, ε]` of all outputs.
    pub(super) fn write(&mut self, now: &Instant<'_>, rows: &mut [f64]) {
        self.output = self.of.form.model.system().c() * &self.state;
        for (j, direction) in self.directions.iter().enumerate() {
            add(&direction.c, now.x, self.output.col_mut(self.initial + j));
            add(&direction.d, now.u, self.output.col_mut(self.initial + j));
        }
        let width = rows.len() / self.of.p;
        for (i, row) in rows.chunks_exact_mut(width).enumerate() {
            (0..width - 1).for_each(|j| row[j] = self.output[(i, j)]);
            row[width - 1] = now.e[i];
        }
        if let Some(filter) = now.filter.filter(|_| now.complete) {
            filter.weigh(rows, width);
        }
    }

    /// Goes on to the next instant; [`write`](Self::write) comes first.
    pub(super) fn advance(&mut self, now: &Instant<'_>) {
        let Some(filter) = now.filter else { return };
        let model = &self.of.form.model;
        let gain = if filter.gain.is_settled() { model.k() } else { filter.gain.gain().as_ref() };
        let mut next = model.system().a() * &self.state - gain * &self.output;
        for (j, direction) in self.directions.iter_mut().enumerate() {
            direction.follow(self.of, &filter.gain);
            add(&direction.a, now.x, next.col_mut(self.initial + j));
            add(&direction.b, now.u, next.col_mut(self.initial + j));
            add(&direction.gain, now.e, next.col_mut(self.initial + j));
        }
        self.state = next;
    }
}

/// `y += M x`.
fn add(m: &Mat<f64>, x: &[f64], mut y: faer::ColMut<'_, f64>) {
    for (j, x) in x.iter().enumerate() {
        (0..m.nrows()).for_each(|i| y[i] += m[(i, j)] * x);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use faer::{Mat, mat};
    use lti::{Innovations, StateSpace};
    use signal::excitation::Random;

    use crate::state_space::lineariser::Lineariser;
    use crate::state_space::predictor::{Free, Predictor};
    use crate::{Dataset, Parametric, StateSpaceModel};

    /// Order 3, one input, two outputs.
    fn model() -> StateSpaceModel {
        let a = mat![[0.8, 0.4, 0.0], [-0.4, 0.8, 0.1], [0.0, 0.0, 0.5]];
        let c = mat![[1.0, 0.0, 0.4], [0.2, 0.8, 0.0]];
        let system = StateSpace::discrete(a, mat![[1.0], [0.5], [0.7]], c, mat![[0.1], [0.2]], 0.1).unwrap();
        let k = mat![[0.4, 0.1], [0.0, 0.5], [0.2, 0.0]];
        let innovations = Innovations::new(system, k, mat![[1.0, 0.3], [0.3, 0.5]]).unwrap();
        StateSpaceModel::new(innovations, true, true)
    }

    fn lineariser<'a>(predictor: &'a Predictor, entries: &'a Mat<f64>, whitening: &'a Mat<f64>) -> Lineariser<'a> {
        let free = Free { dynamics: true, feedthrough: true, noise: true };
        Lineariser { predictor, free, basis: entries.as_ref(), whitening: whitening.as_ref(), initial: 3 }
    }

    #[test]
    fn prop_derivatives_equal_differences_where_outputs_are_missing() {
        let (model, samples) = (model(), 60);
        let mut random = Random::new(5);
        let u = Mat::from_fn(samples, 1, |_, _| random.normal());
        let mut y = Mat::from_fn(samples, 2, |_, _| random.normal());
        for (t, i) in [(5, 0), (5, 1), (6, 1), (7, 1), (8, 0), (20, 0), (40, 0), (40, 1), (41, 0), (41, 1)] {
            y[(t, i)] = f64::NAN;
        }
        let data = Dataset::new(0.1, u, y).unwrap();
        let (experiment, x0) = (&data.experiments()[0], [0.3, -0.2, 0.1]);
        let theta = model.parameters();
        let (entries, whitening) = (Mat::<f64>::identity(theta.len(), theta.len()), Mat::<f64>::identity(2, 2));
        let now = Predictor::new(model.innovations());
        let here = lineariser(&now, &entries, &whitening);
        let mut rows = Vec::new();
        here.rows(experiment, &x0, |row, complete| {
            if complete {
                rows.extend_from_slice(row);
            }
        });
        let width = 3 + theta.len() + 1;
        let errors = |theta: &[f64], x0: &[f64]| -> Vec<f64> {
            let moved = model.with_parameters(theta).unwrap();
            let predictor = Predictor::new(moved.innovations()).weighed_as(&now);
            lineariser(&predictor, &entries, &whitening)
                .errors(experiment, x0)
                .into_iter()
                .filter(|e| !e.is_nan())
                .collect()
        };
        let step = 1e-6;
        for j in 0..width - 1 {
            let at = |by: f64| {
                let (mut theta, mut x0) = (theta.clone(), x0.to_vec());
                if j < 3 {
                    x0[j] += by
                } else {
                    theta[j - 3] += by
                }
                errors(&theta, &x0)
            };
            let (above, below) = (at(step), at(-step));
            assert_eq!(above.len() * width, rows.len());
            for (i, (a, b)) in above.iter().zip(&below).enumerate() {
                let (difference, found) = ((b - a) / (2.0 * step), rows[i * width + j]);
                assert!(
                    (difference - found).abs() < 1e-7 * (1.0 + found.abs()),
                    "column {j}, row {i}: {found} {difference}"
                );
            }
        }
    }
}
