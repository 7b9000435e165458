//! The inverted controller as a residual model: from T_d* to the speed that must have been measured.

use std::ops::Range;

use faer::MatMut;
use ident::{IdentError, ResidualModel};
use signal::Signal;
use signal::spline::UniformSpline;

/// Samples at both ends that the spline's ends and the delay spoil.
const EDGE: usize = 20;

/// Parameters of the inverted controller, by position. p = 1/K_p and q = K_i T/K_p make the inverse linear in p.
pub(super) const P: usize = 0;
pub(super) const Q: usize = 1;
pub(super) const FIRST_ERROR: usize = 2;
/// τ less half a gate, in samples.
pub(super) const LEAD: usize = 3;
/// Square of the gate, in samples squared.
pub(super) const GATE_SQUARED: usize = 4;
pub(super) const COSINE: usize = 5;
pub(super) const SINE: usize = 6;
pub(super) const K: usize = 7;
pub(super) const K_A: usize = 8;
pub(super) const COUNT: usize = 9;

/// Data of one stretch.
pub(super) struct InverseController {
    /// T_d*, Nm, on the controller's clock.
    demand: Vec<f64>,
    /// N_d*, rad/s, on the controller's clock.
    reference: Vec<f64>,
    /// N_d, rad/s, on its own clock.
    speed: Vec<f64>,
    /// N_d cos φ and N_d sin φ.
    turn: [Vec<f64>; 2],
    /// Instant of each sample of N_d, in samples of the controller.
    positions: Vec<f64>,
    /// Samples of N_d that are predicted.
    kept: Range<usize>,
    /// Samples by which N_d* enters the speed error late.
    reference_lag: usize,
    /// Sequences reused at every evaluation: e and its derivatives.
    work: Work,
}

/// The speed error seen by the controller, and its derivatives by p, q, e(0), k and k_a.
struct Work {
    error: Vec<f64>,
    by: [Vec<f64>; 5],
}

impl InverseController {
    /// `demand` and `reference` share the controller's clock; `phase_rad` is the shaft angle at each sample of `speed`.
    pub(super) fn new(
        demand: &Signal,
        reference: &Signal,
        speed: &Signal,
        phase_rad: &[f64],
        reference_lag: usize,
    ) -> Self {
        let n = demand.len().min(reference.len());
        let position = |i: usize| (speed.time_s(i) - demand.start_s) / demand.sample_time_s;
        let positions: Vec<f64> = (0..speed.len()).map(position).collect();
        let inside = |p: &f64| *p >= EDGE as f64 && *p <= n as f64 - EDGE as f64;
        let first = positions.iter().position(inside).unwrap_or(0);
        let count = positions.iter().filter(|p| inside(p)).count();
        let turn = [f64::cos, f64::sin]
            .map(|f| speed.samples.iter().zip(phase_rad).map(|(w, angle)| w * f(*angle)).collect());
        InverseController {
            demand: demand.samples[..n].to_vec(),
            reference: reference.samples[..n].to_vec(),
            speed: speed.samples.clone(),
            turn,
            positions,
            kept: first..first + count,
            reference_lag,
            work: Work { error: vec![0.0; n], by: std::array::from_fn(|_| vec![0.0; n]) },
        }
    }

    /// Samples of N_d that are predicted.
    pub(super) fn kept(&self) -> Range<usize> {
        self.kept.clone()
    }

    fn lagged_reference(&self, k: usize) -> f64 {
        self.reference[k.saturating_sub(self.reference_lag)]
    }

    fn reference_step(&self, k: usize) -> f64 {
        if k == 0 { 0.0 } else { self.reference[k] - self.reference[k - 1] }
    }

    /// e(k) = p Δv(k) + (1 − q) e(k − 1), v = T_d* − k (N_d* − N_d*(0)) − k_a ΔN_d*, and its derivatives. k_a is per
    /// sample here.
    fn invert(&mut self, theta: &[f64], with_gradient: bool) {
        let n = self.demand.len();
        let (p, keep) = (theta[P], 1.0 - theta[Q]);
        let feed = |s: &Self, i: usize| theta[K] * s.reference[i] + theta[K_A] * s.reference_step(i);
        self.work.error[0] = theta[FIRST_ERROR];
        for series in &mut self.work.by {
            series[0] = 0.0;
        }
        self.work.by[FIRST_ERROR][0] = 1.0;
        for i in 1..n {
            let change = self.demand[i] - self.demand[i - 1] - (feed(self, i) - feed(self, i - 1));
            self.work.error[i] = p * change + keep * self.work.error[i - 1];
            if with_gradient {
                let step = self.reference_step(i);
                let bend = step - self.reference_step(i - 1);
                let previous = self.work.error[i - 1];
                let forcing = [change, -previous, 0.0, -p * step, -p * bend];
                for (series, force) in self.work.by.iter_mut().zip(forcing) {
                    series[i] = force + keep * series[i - 1];
                }
            }
        }
    }

    fn write_jacobian(
        &self,
        theta: &[f64],
        spline: &UniformSpline,
        mut jacobian: MatMut<'_, f64>,
    ) -> Result<(), IdentError> {
        const COLUMNS: [usize; 5] = [P, Q, FIRST_ERROR, K, K_A];
        let half = theta[GATE_SQUARED] / 24.0;
        for (series, column) in self.work.by.iter().zip(COLUMNS) {
            let spline = spline_of(series.clone())?;
            for (row, i) in self.kept().enumerate() {
                let at = self.positions[i] + theta[LEAD];
                jacobian[(row, column)] = -(spline.value(at) + half * spline.curvature(at));
            }
        }
        for (row, i) in self.kept().enumerate() {
            let at = self.positions[i] + theta[LEAD];
            jacobian[(row, LEAD)] = -(spline.slope(at) + half * spline.jerk(at));
            jacobian[(row, GATE_SQUARED)] = -spline.curvature(at) / 24.0;
            jacobian[(row, COSINE)] = -self.turn[0][i];
            jacobian[(row, SINE)] = -self.turn[1][i];
        }
        Ok(())
    }
}

impl ResidualModel for InverseController {
    fn parameter_count(&self) -> usize {
        COUNT
    }

    fn residual_count(&self) -> usize {
        self.kept().len()
    }

    /// Residual: measured speed − (mean over the gate of the speed the controller saw) − once-a-turn error.
    ///
    /// The mean over a gate T_g about its centre c is n(c) + T_g²/24 n″(c) to second order.
    fn evaluate(
        &mut self,
        theta: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        self.invert(theta, jacobian.is_some());
        let seen = (0..self.demand.len()).map(|k| self.work.error[k] + self.lagged_reference(k)).collect();
        let spline = spline_of(seen)?;
        for (row, i) in self.kept().enumerate() {
            let at = self.positions[i] + theta[LEAD];
            let predicted = spline.value(at) + theta[GATE_SQUARED] / 24.0 * spline.curvature(at);
            let turn = theta[COSINE] * self.turn[0][i] + theta[SINE] * self.turn[1][i];
            residuals[row] = self.speed[i] - predicted - turn;
        }
        match jacobian {
            Some(jacobian) => self.write_jacobian(theta, &spline, jacobian),
            None => Ok(()),
        }
    }
}

fn spline_of(values: Vec<f64>) -> Result<UniformSpline, IdentError> {
    let samples = values.len();
    UniformSpline::new(values).map_err(|_| IdentError::TooFewSamples { samples, parameters: COUNT })
}
