//! A continuous system of one input behind a delay, exactly at the samples.

use faer::Mat;
use lti::{LtiError, StateSpace};
use numerics::vector::dot;

use super::record::Course;
use crate::Intersample;
use crate::data::band_limited::COEFFICIENTS;

/// States of a discrete system, one for each sample of a delay: its matrix takes 128 MB.
const MOST_STATES: usize = 4_000;

/// A delay this close to a whole number of samples counts as whole, as in [`lti::DelayedStateSpace`].
const WHOLE: f64 = 1e-9;

/// Longest delay, in samples.
const MAX_SAMPLES: f64 = 1e9;

/// Part of the largest value of a free response below which it counts as nothing: far below rounding, whatever the
/// states that it is written in.
const DECAYED: f64 = 1e-30;

/// `ẋ = F x + g v`, `v(t) = u(t − τ)`, at the samples `t = k` (time in samples, `τ = w + f`, `w` whole, `0 ≤ f < 1`):
///
/// `x_{k+1} = Φ x_k + γ₊ u_{k−w+1} + Γ c_{k−w} + Γ₋ c_{k−w−1}`, `v_k = s c_{k−w} + s₋ c_{k−w−1}`.
///
/// Between samples `u` is held, or runs straight, and `c_k = u_k`; or it is band-limited, and `c_k` are the
/// coefficients of its [course](crate::data::band_limited) from sample k on. A fractional delay puts the change from
/// one interval's `u` to the next within the interval.
///
/// # Source
/// Van Loan, C. F. (1978), IEEE Trans. Autom. Control 23(3), 395–404; Åström & Wittenmark (1997), *Computer-Controlled
/// Systems*, ch. 2, of which the first-order hold with a fraction is the analogue.
#[derive(Debug, Clone)]
pub(crate) struct Sampled {
    states: usize,
    /// Columns that the input comes in.
    width: usize,
    /// Φ by rows.
    phi: Vec<f64>,
    /// γ₊.
    late: Vec<f64>,
    /// Γ and Γ₋ by rows.
    gains: [Vec<f64>; 2],
    whole: usize,
    /// s, s₋.
    seen: [Vec<f64>; 2],
    /// The slope of `v` at the samples, from the same, and from `u_{k−w+1}`.
    slope: [Vec<f64>; 2],
    slope_ahead: f64,
}

/// Response over a stretch of time: transition, and to an input `τ^j` for each j.
struct Stretch {
    phi: Mat<f64>,
    powers: Mat<f64>,
}

/// The response to powers below `count`.
fn stretch(f: &Mat<f64>, g: &[f64], length: f64, count: usize) -> Result<Stretch, LtiError> {
    let n = g.len();
    if length == 0.0 {
        return Ok(Stretch { phi: Mat::identity(n, n), powers: Mat::zeros(n, count) });
    }
    // After the states: the input and what its derivatives are made of, `ċ_j = (j + 1) c_{j+1}`.
    let generator = Mat::from_fn(n + count, n + count, |i, j| match (i < n, j < n) {
        (true, true) => length * f[(i, j)],
        (true, false) if j == n => length * g[i],
        (false, false) if j == i + 1 => length * (j - n) as f64,
        _ => 0.0,
    });
    let e = lti::expm(generator.as_ref())?;
    let part = |column: usize, width: usize| Mat::from_fn(n, width, |i, j| e[(i, column + j)]);
    Ok(Stretch { phi: part(0, n), powers: part(n, count) })
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
        let n = g.len();
        let all = stretch(f, g, 1.0, 2)?;
        let sampled = Sampled {
            states: n,
            width: 1,
            phi: (0..n * n).map(|i| all.phi[(i / n, i % n)]).collect(),
            late: vec![0.0; n],
            gains: [vec![0.0; n], vec![0.0; n]],
            whole,
            seen: [vec![0.0], vec![0.0]],
            slope: [vec![0.0], vec![0.0]],
            slope_ahead: 0.0,
        };
        match intersample {
            Intersample::ZeroOrderHold => sampled.held(f, g, fraction),
            Intersample::FirstOrderHold => sampled.straight(f, g, fraction),
            Intersample::BandLimited => sampled.band_limited(f, g, fraction),
        }
    }

    fn held(mut self, f: &Mat<f64>, g: &[f64], fraction: f64) -> Result<Self, LtiError> {
        let (early, rest) = (stretch(f, g, fraction, 1)?, stretch(f, g, 1.0 - fraction, 1)?);
        self.gains = [by_rows(&rest.powers), by_rows(&(rest.phi * early.powers))];
        let before = f64::from(u8::from(fraction > 0.0));
        self.seen = [vec![1.0 - before], vec![before]];
        Ok(self)
    }

    /// The input changes its slope at the fraction `f` of the interval: first `v₀ + (u_{k−w} − u_{k−w−1}) t`, then from
    /// `u_{k−w}` on towards `u_{k−w+1}`.
    fn straight(mut self, f: &Mat<f64>, g: &[f64], fraction: f64) -> Result<Self, LtiError> {
        let (early, rest) = (stretch(f, g, fraction, 2)?, stretch(f, g, 1.0 - fraction, 2)?);
        let first = &rest.phi * &early.powers;
        for i in 0..self.states {
            let (step, ramp) = (first[(i, 0)], first[(i, 1)]);
            self.late[i] = rest.powers[(i, 1)];
            self.gains[0][i] = (1.0 - fraction) * step + ramp + rest.powers[(i, 0)] - rest.powers[(i, 1)];
            self.gains[1][i] = fraction * step - ramp;
        }
        self.seen = [vec![1.0 - fraction], vec![fraction]];
        if fraction > 0.0 {
            self.slope = [vec![1.0], vec![-1.0]];
        } else {
            (self.slope[0], self.slope_ahead) = (vec![-1.0], 1.0);
        }
        Ok(self)
    }

    /// The delayed input is the end of one course, from `1 − f` on, and then the next from its beginning.
    fn band_limited(mut self, f: &Mat<f64>, g: &[f64], fraction: f64) -> Result<Self, LtiError> {
        let (early, rest) = (stretch(f, g, fraction, COEFFICIENTS)?, stretch(f, g, 1.0 - fraction, COEFFICIENTS)?);
        let from = shifted(1.0 - fraction);
        self.width = COEFFICIENTS;
        self.gains = [by_rows(&rest.powers), by_rows(&(&rest.phi * &early.powers * &from))];
        let row = |m: &Mat<f64>, i: usize| (0..COEFFICIENTS).map(|j| m[(i, j)]).collect::<Vec<f64>>();
        let (at_start, none) = (shifted(0.0), vec![0.0; COEFFICIENTS]);
        if fraction > 0.0 {
            self.seen = [none.clone(), row(&from, 0)];
            self.slope = [none, row(&from, 1)];
        } else {
            self.seen = [row(&at_start, 0), none.clone()];
            self.slope = [row(&at_start, 1), none];
        }
        Ok(self)
    }

    /// Runs from the state `x` at sample `first` through the record `u` and shows `visit` the sample, the state, what
    /// the input is behind its delay, and its slope there.
    pub(crate) fn run(
        &self,
        u: &Course<'_>,
        first: usize,
        x: &mut [f64],
        mut visit: impl FnMut(usize, &[f64], f64, f64),
    ) {
        let (n, width) = (self.states, self.width);
        let Course { columns, before: past } = u;
        let length = columns.first().map_or(0, |column| column.len());
        // All coefficients of a constant but the first are zero.
        let at = |k: usize, back: usize, j: usize| {
            k.checked_sub(back).map_or(if j == 0 { *past } else { 0.0 }, |i| columns[j][i])
        };
        let (mut next, mut now, mut before) = (vec![0.0; n], vec![0.0; width], vec![0.0; width]);
        for k in work::checked(first..length) {
            for j in 0..width {
                (now[j], before[j]) = (at(k, self.whole, j), at(k, self.whole + 1, j));
            }
            let newer = (k + 1).checked_sub(self.whole).map_or(Some(past), |i| columns[0].get(i)).unwrap_or(&now[0]);
            let [seen, slope] = [&self.seen, &self.slope].map(|of| dot(&of[0], &now) + dot(&of[1], &before));
            visit(k, x, seen, slope + self.slope_ahead * newer);
            for i in 0..n {
                let carried = dot(&self.phi[i * n..(i + 1) * n], x);
                let row = i * width..(i + 1) * width;
                let driven = dot(&self.gains[0][row.clone()], &now) + dot(&self.gains[1][row], &before);
                next[i] = carried + self.late[i] * newer + driven;
            }
            x.copy_from_slice(&next);
        }
    }

    /// `c Φ^k`, one column a state, for `length` samples or until nothing is left of them: a stable system's initial
    /// state is soon forgotten, and a long record then costs no more than a short one.
    pub(crate) fn free_responses(&self, c: &[f64], length: usize) -> Vec<Vec<f64>> {
        let (mut row, mut scratch) = (c.to_vec(), vec![0.0; c.len()]);
        let mut columns = vec![Vec::new(); c.len()];
        let mut largest = vec![0.0_f64; c.len()];
        for _ in work::checked(0..length) {
            columns.iter_mut().zip(&row).for_each(|(column, value)| column.push(*value));
            self.advance_row(&mut row, &mut scratch);
            largest.iter_mut().zip(&row).for_each(|(most, value)| *most = most.max(value.abs()));
            if row.iter().zip(&largest).all(|(value, most)| value.abs() <= DECAYED * most) {
                break;
            }
        }
        columns
    }

    /// `r Φ`, the row that maps an earlier state to a later output one sample further on.
    fn advance_row(&self, row: &mut [f64], scratch: &mut [f64]) {
        scratch.fill(0.0);
        for (i, value) in row.iter().enumerate() {
            let phi = &self.phi[i * self.states..(i + 1) * self.states];
            scratch.iter_mut().zip(phi).for_each(|(s, p)| *s += value * p);
        }
        row.copy_from_slice(scratch);
    }

    /// The discrete system with the output `c x + d v`: `x` first (less `γ₊ u_k` where the input ahead of it is not yet
    /// delayed), then the inputs before as far back as they are needed. An input by its course must not be delayed.
    pub(crate) fn to_state_space(&self, c: &[f64], d: f64, sample_time_s: f64) -> Result<StateSpace, LtiError> {
        let n = self.states;
        let is_zero = |v: &[f64]| v.iter().all(|v| *v == 0.0);
        let (ahead, [now, before]) = (!is_zero(&self.late), &self.gains);
        let reach = self.whole + usize::from(!is_zero(before) || !is_zero(&self.seen[1]));
        if self.width > 1 && reach > 0 {
            return Err(LtiError::DelayPresent { delay_s: self.whole as f64 * sample_time_s });
        }
        let total = n + reach;
        if total > MOST_STATES {
            return Err(LtiError::Delay { delay_s: self.whole as f64 * sample_time_s });
        }
        let (mut a, mut b) = (Mat::zeros(total, total), Mat::zeros(total, self.width));
        let (mut out, mut direct) = (Mat::zeros(1, total), Mat::zeros(1, self.width));
        for (i, j) in (0..n * n).map(|i| (i / n, i % n)) {
            a[(i, j)] = self.phi[i * n + j];
        }
        (0..n).for_each(|j| out[(0, j)] = c[j]);
        (0..reach).for_each(|i| if i == 0 { b[(n, 0)] = 1.0 } else { a[(n + i, n + i - 1)] = 1.0 });
        let mut enter = |gain: &[f64], back: usize| {
            for (place, g) in gain.iter().enumerate() {
                let (i, j) = (place / self.width, place % self.width);
                if back == 0 { b[(i, j)] += g } else { a[(i, n + back - 1)] += g }
            }
        };
        enter(now, self.whole);
        if !is_zero(before) {
            enter(before, self.whole + 1);
        }
        if ahead && self.whole > 0 {
            enter(&self.late, self.whole - 1);
        } else if ahead {
            let carried = |i: usize| dot(&self.phi[i * n..(i + 1) * n], &self.late);
            enter(&(0..n).map(carried).collect::<Vec<f64>>(), 0);
            direct[(0, 0)] += dot(c, &self.late);
        }
        for (weights, back) in self.seen.iter().zip([self.whole, self.whole + 1]) {
            for (j, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
                if back == 0 { direct[(0, j)] += d * weight } else { out[(0, n + back - 1)] += d * weight }
            }
        }
        StateSpace::discrete(a, b, out, direct, sample_time_s)
    }
}

/// The transition over a sample, and the response to one input of the powers of time counted in samples.
pub(crate) fn response_to_powers(
    system: &StateSpace,
    input: usize,
    sample_time_s: f64,
) -> Result<(Mat<f64>, Mat<f64>), LtiError> {
    let f = system.a() * faer::Scale(sample_time_s);
    let g: Vec<f64> = system.b().col(input).iter().map(|b| b * sample_time_s).collect();
    let Stretch { phi, powers } = stretch(&f, &g, 1.0, COEFFICIENTS)?;
    Ok((phi, powers))
}

fn by_rows(m: &Mat<f64>) -> Vec<f64> {
    (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)])).collect()
}

/// Matrix from the coefficients of a polynomial in `τ` to those in `τ − by`.
fn shifted(by: f64) -> Mat<f64> {
    let mut m = Mat::zeros(COEFFICIENTS, COEFFICIENTS);
    for j in 0..COEFFICIENTS {
        // C(j, i) by^{j − i}, from the last row up.
        let mut term = 1.0;
        for i in (0..=j).rev() {
            m[(i, j)] = term;
            term *= by * i as f64 / (j - i + 1) as f64;
        }
    }
    m
}
