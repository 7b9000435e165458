//! The inverted controller as a residual model: from T_d* to the speed that must have been measured.

use std::ops::Range;

use faer::MatMut;
use ident::{IdentError, ResidualModel};
use rig::results::DemandLags;
use signal::Signal;
use signal::spline::UniformSpline;

use super::lag::{lagged, shifted};

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
/// φ of a first-order filter on the measured speed, n_f(k) = (n(k) + φ n_f(k − 1))/(1 + φ).
pub(super) const FILTER: usize = 9;
/// r = K_d/(K_p T) of a derivative term.
pub(super) const DERIVATIVE: usize = 10;
/// w = K_ii T²/K_p of a second integrator.
pub(super) const SECOND_INTEGRATOR: usize = 11;
/// By how much more the controller sees than is logged, rad/s.
pub(super) const OFFSET: usize = 12;
/// Parameters of every inverted controller; coefficients of further feed-forward terms follow.
pub(super) const COUNT: usize = 13;

/// Data of one stretch.
pub(super) struct InverseController {
    /// T_d*, Nm, on the controller's clock.
    demand: Vec<f64>,
    /// N_d* as it enters the speed error, rad/s, on the controller's clock.
    reference: Vec<f64>,
    /// Signals fed forward, each with its parameter: N_d*, its change from sample to sample, further terms.
    feeds: Vec<(usize, Vec<f64>)>,
    /// N_d, rad/s, on its own clock.
    speed: Vec<f64>,
    /// N_d cos φ and N_d sin φ.
    turn: [Vec<f64>; 2],
    /// Instant of each sample of N_d, in samples of the controller.
    positions: Vec<f64>,
    /// Samples of N_d that are predicted.
    kept: Range<usize>,
    /// Parameters with a column in the Jacobian; that of the others stays zero.
    free: Vec<bool>,
    /// The speed error seen by the controller, reused at every evaluation.
    error: Vec<f64>,
}

impl InverseController {
    /// `demand`, `reference` and `further` share the controller's clock; `phase_rad` is the shaft angle at each sample
    /// of `speed`. `further` are terms of the feed-forward beside N_d* and its change; their coefficients, Nm, are the
    /// parameters from [`COUNT`] on.
    pub(super) fn new(
        demand: &Signal,
        reference: &Signal,
        further: &[Signal],
        speed: &Signal,
        phase_rad: &[f64],
        lags: DemandLags,
        free: &dyn Fn(usize) -> bool,
    ) -> Self {
        let n = demand.len().min(reference.len());
        let position = |i: usize| (speed.time_s(i) - demand.start_s) / demand.sample_time_s;
        let positions: Vec<f64> = (0..speed.len()).map(position).collect();
        let inside = |p: &f64| *p >= EDGE as f64 && *p <= n as f64 - EDGE as f64;
        let first = positions.iter().position(inside).unwrap_or(0);
        let count = positions.iter().filter(|p| inside(p)).count();
        let turn =
            [f64::cos, f64::sin].map(|f| speed.samples.iter().zip(phase_rad).map(|(w, angle)| w * f(*angle)).collect());
        let reference = &reference.samples[..n];
        let fed = shifted(reference, lags.feed_forward);
        let change = (0..n).map(|k| fed[k] - lagged(reference, k, lags.feed_forward + 1)).collect();
        let late = |signal: &Signal| shifted(&signal.samples[..n], lags.feed_forward);
        let further = further.iter().enumerate().map(|(i, signal)| (COUNT + i, late(signal)));
        InverseController {
            demand: demand.samples[..n].to_vec(),
            feeds: [(K, fed), (K_A, change)].into_iter().chain(further.clone()).collect(),
            reference: shifted(reference, lags.speed_error),
            speed: speed.samples.clone(),
            turn,
            positions,
            kept: first..first + count,
            free: (0..COUNT + further.len()).map(free).collect(),
            error: vec![0.0; n],
        }
    }

    /// Samples of N_d that are predicted.
    pub(super) fn kept(&self) -> Range<usize> {
        self.kept.clone()
    }

    /// Instant of a sample of N_d, in samples of the controller.
    pub(super) fn position(&self, i: usize) -> f64 {
        self.positions[i]
    }

    /// N_d cos φ and N_d sin φ at the samples that are predicted.
    pub(super) fn once_a_turn(&self) -> [Vec<f64>; 2] {
        [0, 1].map(|k| self.turn[k][self.kept()].to_vec())
    }

    /// e(k) = [p Δv(k) + (1 − q) e(k − 1) + r (2 e(k − 1) − e(k − 2)) − w Σ_{j ≤ k−2} e(j)]/(1 + r), v = T_d* less the
    /// feed-forward. k_a is per sample here.
    fn invert(&mut self, theta: &[f64]) {
        let forcing: Vec<f64> = (0..self.demand.len()).map(|i| theta[P] * self.change(theta, i)).collect();
        self.error = recursion(theta, theta[FIRST_ERROR], &forcing);
    }

    /// Δv at sample i.
    fn change(&self, theta: &[f64], i: usize) -> f64 {
        let step = |series: &[f64]| if i == 0 { 0.0 } else { series[i] - series[i - 1] };
        step(&self.demand) - self.feeds.iter().map(|(j, series)| theta[*j] * step(series)).sum::<f64>()
    }

    /// ∂e/∂θ_j, for the parameters of the controller itself.
    fn derivative(&self, theta: &[f64], j: usize) -> Option<Vec<f64>> {
        let e = &self.error;
        let n = e.len();
        let before = |i: usize, back: usize| e[i.saturating_sub(back)];
        let forcing: Vec<f64> = match j {
            P => (0..n).map(|i| self.change(theta, i)).collect(),
            Q => (0..n).map(|i| -before(i, 1)).collect(),
            FIRST_ERROR => vec![0.0; n],
            DERIVATIVE => (0..n).map(|i| -(e[i] - 2.0 * before(i, 1) + before(i, 2))).collect(),
            SECOND_INTEGRATOR => {
                let mut sum = 0.0;
                let delayed = |i: usize| {
                    sum += if i < 2 { 0.0 } else { e[i - 2] };
                    -sum
                };
                (0..n).map(delayed).collect()
            }
            _ => {
                let (_, series) = self.feeds.iter().find(|(k, _)| *k == j)?;
                let step = |i: usize| if i == 0 { 0.0 } else { series[i] - series[i - 1] };
                (0..n).map(|i| -theta[P] * step(i)).collect()
            }
        };
        Some(recursion(theta, if j == FIRST_ERROR { 1.0 } else { 0.0 }, &forcing))
    }

    /// The speed that the controller's own filter has let through, on the controller's clock.
    fn filtered_speed(&self) -> Vec<f64> {
        self.error.iter().zip(&self.reference).map(|(error, demand)| error + demand).collect()
    }

    fn write_jacobian(
        &self,
        theta: &[f64],
        spline: &UniformSpline,
        mut jacobian: MatMut<'_, f64>,
    ) -> Result<(), IdentError> {
        let half = theta[GATE_SQUARED] / 24.0;
        for j in (0..self.free.len()).filter(|j| self.free[*j]) {
            let series = match j {
                FILTER => Some(steps(&self.filtered_speed())),
                _ => self.derivative(theta, j).map(|series| unfiltered(series, theta[FILTER])),
            };
            let spline = series.map(spline_of).transpose()?;
            for (row, i) in self.kept().enumerate() {
                let at = self.positions[i] + theta[LEAD];
                jacobian[(row, j)] = -spline.as_ref().map_or(0.0, |s| s.value(at) + half * s.curvature(at));
            }
        }
        for (row, i) in self.kept().enumerate() {
            let at = self.positions[i] + theta[LEAD];
            let direct = [
                (LEAD, -(spline.slope(at) + half * spline.jerk(at))),
                (GATE_SQUARED, -spline.curvature(at) / 24.0),
                (COSINE, -self.turn[0][i]),
                (SINE, -self.turn[1][i]),
                (OFFSET, 1.0),
            ];
            direct.into_iter().filter(|(j, _)| self.free[*j]).for_each(|(j, value)| jacobian[(row, j)] = value);
        }
        Ok(())
    }
}

impl ResidualModel for InverseController {
    fn parameter_count(&self) -> usize {
        self.free.len()
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
        self.invert(theta);
        let spline = spline_of(unfiltered(self.filtered_speed(), theta[FILTER]))?;
        for (row, i) in self.kept().enumerate() {
            let at = self.positions[i] + theta[LEAD];
            let seen = spline.value(at) + theta[GATE_SQUARED] / 24.0 * spline.curvature(at);
            let turn = theta[COSINE] * self.turn[0][i] + theta[SINE] * self.turn[1][i];
            residuals[row] = self.speed[i] - (seen - theta[OFFSET]) - turn;
        }
        match jacobian {
            Some(jacobian) => self.write_jacobian(theta, &spline, jacobian),
            None => Ok(()),
        }
    }
}

/// x(k) = [f(k) + (1 − q) x(k − 1) + r (2 x(k − 1) − x(k − 2)) − w Σ_{j ≤ k−2} x(j)]/(1 + r) from x(0) = x(−1) on.
pub(super) fn recursion(theta: &[f64], first: f64, forcing: &[f64]) -> Vec<f64> {
    let (keep, r, w) = (1.0 - theta[Q], theta[DERIVATIVE], theta[SECOND_INTEGRATOR]);
    let mut all = Vec::with_capacity(forcing.len());
    all.push(first);
    if r == 0.0 && w == 0.0 {
        // PI alone, which most searches are about.
        let mut last = first;
        let next = |force: &f64| {
            last = force + keep * last;
            last
        };
        all.extend(forcing.iter().skip(1).map(next));
        return all;
    }
    let (mut last, mut before, mut sum) = (first, first, 0.0);
    for (i, force) in forcing.iter().enumerate().skip(1) {
        if i > 1 {
            sum += before;
        }
        let next = (force + keep * last + r * (2.0 * last - before) - w * sum) / (1.0 + r);
        (before, last) = (last, next);
        all.push(next);
    }
    all
}

/// Input of a first-order filter, from its output.
fn unfiltered(series: Vec<f64>, phi: f64) -> Vec<f64> {
    if phi == 0.0 {
        return series;
    }
    series.iter().zip(steps(&series)).map(|(value, step)| value + phi * step).collect()
}

/// Change from sample to sample, zero at the first.
fn steps(series: &[f64]) -> Vec<f64> {
    std::iter::once(0.0).chain(series.windows(2).map(|pair| pair[1] - pair[0])).collect()
}

pub(super) fn spline_of(values: Vec<f64>) -> Result<UniformSpline, IdentError> {
    let samples = values.len();
    UniformSpline::new(values).map_err(|_| IdentError::TooFewSamples { samples, parameters: COUNT })
}
