//! A continuous system of one input behind a delay, exactly at the samples.

use faer::Mat;
use lti::{LtiError, StateSpace};

use crate::Intersample;

/// A delay this close to a whole number of samples counts as whole, as in [`lti::DelayedStateSpace`].
const WHOLE: f64 = 1e-9;

/// Longest delay, in samples.
const MAX_SAMPLES: f64 = 1e9;

/// `ẋ = F x + g v`, `v(t) = u(t − τ)`, at the samples `t = k` (time in samples, `τ = w + f`, `w` whole, `0 ≤ f < 1`):
///
/// `x_{k+1} = Φ x_k + γ₊ u_{k−w+1} + γ u_{k−w} + γ₋ u_{k−w−1}`, `v_k = s u_{k−w} + s₋ u_{k−w−1}`.
///
/// Between samples `u` is held, or runs straight; a fractional delay puts the change of `u` within the interval.
///
/// # Source
/// Van Loan, C. F. (1978), IEEE Trans. Autom. Control 23(3), 395–404; Åström & Wittenmark (1997), *Computer-Controlled
/// Systems*, ch. 2, of which the first-order hold with a fraction is the analogue.
#[derive(Debug, Clone)]
pub(crate) struct Sampled {
    states: usize,
    /// Φ by rows.
    phi: Vec<f64>,
    /// γ₊, γ, γ₋.
    gains: [Vec<f64>; 3],
    whole: usize,
    /// s, s₋.
    seen: [f64; 2],
    straight: bool,
}

/// Response over a stretch of time: transition, to a unit step, to a unit ramp.
struct Stretch {
    phi: Mat<f64>,
    step: Mat<f64>,
    ramp: Mat<f64>,
}

fn stretch(f: &Mat<f64>, g: &[f64], length: f64) -> Result<Stretch, LtiError> {
    let n = g.len();
    let generator = Mat::from_fn(n + 2, n + 2, |i, j| match (i < n, j < n) {
        (true, true) => length * f[(i, j)],
        (true, false) if j == n => length * g[i],
        (false, false) if i == n && j == n + 1 => length,
        _ => 0.0,
    });
    let e = lti::expm(generator.as_ref())?;
    let part = |column: usize, width: usize| Mat::from_fn(n, width, |i, j| e[(i, column + j)]);
    Ok(Stretch { phi: part(0, n), step: part(n, 1), ramp: part(n + 1, 1) })
}

impl Sampled {
    /// Samples `ẋ = F x + g u(t − delay)`; time and delay in samples.
    pub(crate) fn new(f: &Mat<f64>, g: &[f64], delay: f64, intersample: Intersample) -> Result<Self, LtiError> {
        if !(0.0..=MAX_SAMPLES).contains(&delay) {
            return Err(LtiError::Delay { delay_s: delay });
        }
        let nearly_whole = (delay - delay.round()).abs() < WHOLE;
        let (whole, fraction) =
            if nearly_whole { (delay.round() as usize, 0.0) } else { (delay.floor() as usize, delay.fract()) };
        let straight = intersample != Intersample::ZeroOrderHold;
        let all = stretch(f, g, 1.0)?;
        let gains = if fraction == 0.0 { undivided(&all, straight) } else { divided(f, g, fraction, straight)? };
        let seen = match (straight, fraction > 0.0) {
            (true, _) => [1.0 - fraction, fraction],
            (false, false) => [1.0, 0.0],
            (false, true) => [0.0, 1.0],
        };
        let n = g.len();
        let phi = (0..n * n).map(|i| all.phi[(i / n, i % n)]).collect();
        Ok(Sampled { states: n, phi, gains, whole, seen, straight })
    }

    /// Runs from the state `x` at sample `first` through the record `u` and shows `visit` the sample, the state, what
    /// the input is behind its delay, and its slope there. Inputs before the record are zero.
    pub(crate) fn run(&self, u: &[f64], first: usize, x: &mut [f64], mut visit: impl FnMut(usize, &[f64], f64, f64)) {
        let n = self.states;
        let at = |k: usize, ahead: usize| (k + ahead).checked_sub(self.whole + 1).and_then(|i| u.get(i)).copied();
        let mut next = vec![0.0; n];
        let [late, now, before] = &self.gains;
        for k in first..u.len() {
            let (older, middle) = (at(k, 0).unwrap_or(0.0), at(k, 1).unwrap_or(0.0));
            let newer = at(k, 2).unwrap_or(middle);
            let slope = match (self.straight, self.seen[1] > 0.0) {
                (false, _) => 0.0,
                (true, true) => middle - older,
                (true, false) => newer - middle,
            };
            visit(k, x, self.seen[0] * middle + self.seen[1] * older, slope);
            for i in 0..n {
                let row = &self.phi[i * n..(i + 1) * n];
                let carried: f64 = row.iter().zip(x.iter()).map(|(p, v)| p * v).sum();
                next[i] = carried + late[i] * newer + now[i] * middle + before[i] * older;
            }
            x.copy_from_slice(&next);
        }
    }

    /// `r Φ`, the row that maps an earlier state to a later output one sample further on.
    pub(crate) fn advance_row(&self, row: &mut [f64], scratch: &mut [f64]) {
        scratch.fill(0.0);
        for (i, value) in row.iter().enumerate() {
            let phi = &self.phi[i * self.states..(i + 1) * self.states];
            scratch.iter_mut().zip(phi).for_each(|(s, p)| *s += value * p);
        }
        row.copy_from_slice(scratch);
    }

    /// The discrete system with the output `c x + d v`: `x` first (less `γ₊ u_k` where the input ahead of it is not yet
    /// delayed), then the inputs before as far back as they are needed.
    pub(crate) fn to_state_space(&self, c: &[f64], d: f64, sample_time_s: f64) -> Result<StateSpace, LtiError> {
        let n = self.states;
        let ahead = self.gains[0].iter().any(|g| *g != 0.0);
        let reach = self.whole + usize::from(self.gains[2].iter().any(|g| *g != 0.0) || self.seen[1] != 0.0);
        let total = n + reach;
        let (mut a, mut b) = (Mat::zeros(total, total), Mat::zeros(total, 1));
        let (mut out, mut direct) = (Mat::zeros(1, total), 0.0);
        for (i, j) in (0..n * n).map(|i| (i / n, i % n)) {
            a[(i, j)] = self.phi[i * n + j];
        }
        (0..n).for_each(|j| out[(0, j)] = c[j]);
        (0..reach).for_each(|i| if i == 0 { b[(n, 0)] = 1.0 } else { a[(n + i, n + i - 1)] = 1.0 });
        let mut enter = |gain: &[f64], back: usize| {
            for (i, g) in gain.iter().enumerate() {
                if back == 0 { b[(i, 0)] += g } else { a[(i, n + back - 1)] += g }
            }
        };
        enter(&self.gains[1], self.whole);
        if self.gains[2].iter().any(|g| *g != 0.0) {
            enter(&self.gains[2], self.whole + 1);
        }
        if ahead && self.whole > 0 {
            enter(&self.gains[0], self.whole - 1);
        } else if ahead {
            let late = &self.gains[0];
            let carried = |i: usize| (0..n).map(|j| self.phi[i * n + j] * late[j]).sum::<f64>();
            enter(&(0..n).map(carried).collect::<Vec<f64>>(), 0);
            direct += c.iter().zip(late).map(|(c, g)| c * g).sum::<f64>();
        }
        for (weight, back) in [(self.seen[0], self.whole), (self.seen[1], self.whole + 1)] {
            if weight == 0.0 {
                continue;
            }
            if back == 0 { direct += d * weight } else { out[(0, n + back - 1)] += d * weight }
        }
        StateSpace::discrete(a, b, out, Mat::full(1, 1, direct), sample_time_s)
    }
}

/// γ₊, γ, γ₋ without a fraction.
fn undivided(all: &Stretch, straight: bool) -> [Vec<f64>; 3] {
    let n = all.step.nrows();
    let late: Vec<f64> = (0..n).map(|i| if straight { all.ramp[(i, 0)] } else { 0.0 }).collect();
    let now = (0..n).map(|i| all.step[(i, 0)] - late[i]).collect();
    [late, now, vec![0.0; n]]
}

/// γ₊, γ, γ₋ where the input changes at the fraction `f` of the interval: first `v₀ + (u_{k−w} − u_{k−w−1}) t`, then from
/// `u_{k−w}` on towards `u_{k−w+1}`.
fn divided(f: &Mat<f64>, g: &[f64], fraction: f64, straight: bool) -> Result<[Vec<f64>; 3], LtiError> {
    let (early, rest) = (stretch(f, g, fraction)?, stretch(f, g, 1.0 - fraction)?);
    let column = |m: &Mat<f64>| (0..m.nrows()).map(|i| m[(i, 0)]).collect::<Vec<f64>>();
    let (first_step, first_ramp) = (column(&(&rest.phi * &early.step)), column(&(&rest.phi * &early.ramp)));
    let n = g.len();
    if !straight {
        return Ok([vec![0.0; n], column(&rest.step), first_step]);
    }
    let late = column(&rest.ramp);
    let now = (0..n).map(|i| (1.0 - fraction) * first_step[i] + first_ramp[i] + rest.step[(i, 0)] - late[i]).collect();
    let before = (0..n).map(|i| fraction * first_step[i] - first_ramp[i]).collect();
    Ok([late, now, before])
}
