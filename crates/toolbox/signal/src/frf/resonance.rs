//! A resonance between lines: one pole on a smooth background, fitted to the lines around a peak.

use std::f64::consts::FRAC_1_SQRT_2;

use numerics::search;

use super::least_squares::LeastSquares;
use crate::Complex64;
use crate::distributions::{f_quantile, interval};

/// Lines to either side of the peak that are fitted.
const REACH: usize = 3;
/// Complex unknowns: a pole, and a numerator of degree two, which is the pole's residue and a straight line.
const UNKNOWNS: usize = 4;
/// Rounds of reweighted linear equations and steps of Gauss and Newton.
const ROUNDS: usize = 30;
const STEPS: usize = 10;
/// Probability with which noise alone leaves less than what is taken for noise.
const MISFIT_LEVEL: f64 = 0.99;
/// Relative noise below which rounding counts.
const ROUNDING: f64 = 1e-9;
/// Places between neighbouring lines at which the fitted curve is evaluated.
const FINE: usize = 200;
/// Relative step of numerical derivatives: a top is found to a root of the rounding.
const STEP: f64 = 1e-4;

/// A number with its standard error, and the degrees of freedom of that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimated {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Of Student's t.
    pub degrees_of_freedom: f64,
}

impl Estimated {
    /// The interval that holds the number with this probability.
    #[must_use]
    pub fn interval(&self, level: f64) -> (f64, f64) {
        interval(self.value, self.standard_error, self.degrees_of_freedom, level)
    }
}

/// A resonance, with what interpolation between the lines leaves open in its errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// Where the magnitude is largest, in hertz.
    pub freq_hz: Estimated,
    /// The magnitude there.
    pub height: Estimated,
    /// Between the frequencies at which the magnitude is down by 3 dB, in hertz; none where one of them lies beyond the
    /// lines fitted.
    pub bandwidth_hz: Option<Estimated>,
    /// Residual of the fit over the part that the noise explains: about one where one pole on a smooth background is
    /// right. Beyond the part that noise may leave, the standard errors are larger in proportion to its root.
    pub misfit: f64,
}

/// The resonance at the peak with this index among lines: a pole `r/(f − p)` and a straight line `c₀ + c₁f`, fitted to
/// three lines on either side with the weights of their noise.
///
/// `variance` is that of the complex gains, each with `degrees_of_freedom`. None where there are too few lines, where
/// the fitted curve has no top between the neighbours of the peak, or where what the fit leaves makes that uncertain by
/// more than the distance of the lines.
///
/// # Source
/// Pintelon and Schoukens (2012), *System Identification: A Frequency Domain Approach*, §7.2.2 (local rational models)
/// and ch. 9.
#[must_use]
pub fn resonance(
    freq_hz: &[f64],
    response: &[Complex64],
    variance: &[f64],
    degrees_of_freedom: f64,
    peak: usize,
) -> Option<Resonance> {
    let count = freq_hz.len();
    let width = 2 * REACH + 1;
    if count < width || peak == 0 || peak + 1 >= count || response.len() != count || variance.len() != count {
        return None;
    }
    let first = peak.saturating_sub(REACH).min(count - width);
    let lines = first..first + width;
    let fit = Local::new(&freq_hz[lines.clone()], &response[lines.clone()], &variance[lines], freq_hz[peak]);
    let theta = fit.solve()?;
    fit.judged(&theta, degrees_of_freedom, peak - first)
}

/// The lines, with frequencies scaled about the peak.
struct Local {
    centre_hz: f64,
    scale_hz: f64,
    x: Vec<f64>,
    gain: Vec<Complex64>,
    /// Variance for all lines: few degrees of freedom make bad weights.
    variance: f64,
}

impl Local {
    fn new(freq_hz: &[f64], gain: &[Complex64], variance: &[f64], centre_hz: f64) -> Self {
        let scale_hz = 0.5 * (freq_hz[freq_hz.len() - 1] - freq_hz[0]);
        let largest = gain.iter().map(|g| g.norm()).fold(0.0, f64::max);
        let mean = variance.iter().sum::<f64>() / variance.len() as f64;
        Local {
            centre_hz,
            scale_hz,
            x: freq_hz.iter().map(|f| (f - centre_hz) / scale_hz).collect(),
            gain: gain.to_vec(),
            variance: mean.max((ROUNDING * largest).powi(2)),
        }
    }

    /// `b₀, b₁, b₂, a` of `(b₀ + b₁x + b₂x²)/(1 + ax)`.
    fn solve(&self) -> Option<[Complex64; UNKNOWNS]> {
        let mut theta = [Complex64::ZERO; UNKNOWNS];
        for _ in 0..ROUNDS {
            let weight: Vec<Complex64> = self.x.iter().map(|x| 1.0 / (1.0 + theta[3] * *x)).collect();
            let column = |j: usize| {
                let of =
                    move |k: usize| if j < 3 { self.x[k].powi(j as i32).into() } else { -self.gain[k] * self.x[k] };
                let weight = &weight;
                (0..self.x.len()).map(move |k| weight[k] * of(k))
            };
            let mut right: Vec<Complex64> = self.gain.iter().zip(&weight).map(|(g, w)| g * w).collect();
            theta.copy_from_slice(&solved((0..UNKNOWNS).map(column), &mut right)?);
        }
        for _ in 0..STEPS {
            let mut left: Vec<Complex64> = self.x.iter().zip(&self.gain).map(|(x, g)| g - gain(&theta, *x)).collect();
            let step = solved((0..UNKNOWNS).map(|j| self.x.iter().map(move |x| slope(&theta, *x, j))), &mut left)?;
            theta.iter_mut().zip(step).for_each(|(value, step)| *value += step);
        }
        theta.iter().all(|v| v.is_finite()).then_some(theta)
    }

    fn judged(&self, theta: &[Complex64; UNKNOWNS], noise_freedom: f64, peak: usize) -> Option<Resonance> {
        let (from, to) = (self.x[peak.checked_sub(1)?], *self.x.get(peak + 1)?);
        let top = top(theta, (from, to))?;
        let left: f64 = self.x.iter().zip(&self.gain).map(|(x, g)| (g - gain(theta, *x)).norm_sqr()).sum();
        let spare = 2.0 * (self.x.len() - UNKNOWNS) as f64;
        let misfit = 2.0 * left / spare / self.variance;
        let freedom = noise_freedom * self.x.len() as f64;
        let (scale, freedom) =
            if misfit > f_quantile(MISFIT_LEVEL, spare, freedom) { (misfit, spare) } else { (1.0, freedom) };
        let influence = self.influence(theta);
        let estimated = |of: &dyn Fn(&[Complex64; UNKNOWNS]) -> Option<f64>, factor: f64| {
            let variance = self.variance * scale * variance_of(theta, &influence, of)?;
            Some((of(theta)? * factor, variance.sqrt() * factor))
        };
        let number =
            |(value, standard_error): (f64, f64)| Estimated { value, standard_error, degrees_of_freedom: freedom };
        // The top moves with the parameters, and stays where they move by little.
        let near = (top - 0.5 * (to - from), top + 0.5 * (to - from));
        let place = |t: &[Complex64; UNKNOWNS]| self::top(t, near);
        let (offset, error) = estimated(&place, self.scale_hz)?;
        let height = estimated(&|t| place(t).map(|x| gain(t, x).norm()), 1.0)?;
        let ends = (self.x[0], self.x[self.x.len() - 1]);
        let bandwidth = estimated(&|t| place(t).and_then(|x| half_power(t, x, ends)), self.scale_hz);
        let is_known = error < 0.5 * (to - from) * self.scale_hz && height.1 < 0.5 * height.0;
        is_known.then(|| Resonance {
            freq_hz: number((self.centre_hz + offset, error)),
            height: number(height),
            bandwidth_hz: bandwidth.filter(|(value, error)| error < value).map(number),
            misfit,
        })
    }

    /// Effect of a unit of error at each line on the parameters: columns of the pseudo-inverse of the slopes.
    fn influence(&self, theta: &[Complex64; UNKNOWNS]) -> Vec<Vec<Complex64>> {
        let unit = |k: usize| {
            let mut right = vec![Complex64::ZERO; self.x.len()];
            right[k].re = 1.0;
            solved((0..UNKNOWNS).map(|j| self.x.iter().map(move |x| slope(theta, *x, j))), &mut right)
                .unwrap_or_default()
        };
        (0..self.x.len()).map(unit).collect()
    }
}

fn solved(
    columns: impl Iterator<Item = impl Iterator<Item = Complex64>>,
    right: &mut [Complex64],
) -> Option<Vec<Complex64>> {
    let mut problem = LeastSquares::new(right.len(), UNKNOWNS);
    for column in columns {
        if !problem.push(column) {
            return None;
        }
    }
    let mut unknowns = Vec::new();
    problem.solve(right, &mut unknowns);
    Some(unknowns)
}

fn gain(theta: &[Complex64; UNKNOWNS], x: f64) -> Complex64 {
    (theta[0] + (theta[1] + theta[2] * x) * x) / (1.0 + theta[3] * x)
}

fn slope(theta: &[Complex64; UNKNOWNS], x: f64, j: usize) -> Complex64 {
    let den = 1.0 + theta[3] * x;
    if j < 3 { x.powi(j as i32) / den } else { -gain(theta, x) * x / den }
}

/// Where the fitted magnitude is largest within a range; none where that is at an end.
fn top(theta: &[Complex64; UNKNOWNS], (from, to): (f64, f64)) -> Option<f64> {
    let x = search::global_maximum((from, to), FINE, |x| gain(theta, x).norm());
    let margin = 1e-3 * (to - from);
    (x > from + margin && x < to - margin).then_some(x)
}

/// Distance of the places on either side of the top where the magnitude is down by 3 dB.
fn half_power(theta: &[Complex64; UNKNOWNS], top: f64, (first, last): (f64, f64)) -> Option<f64> {
    let limit = FRAC_1_SQRT_2 * gain(theta, top).norm();
    let reach = |end: f64| {
        let at = |part: f64| top + part * (end - top);
        let fine = |i: usize| i as f64 / FINE as f64;
        let below = (1..=FINE).find(|i| gain(theta, at(fine(*i))).norm() < limit)?;
        let (inside, _) = search::bisect((fine(below - 1), fine(below)), |p| gain(theta, at(p)).norm() >= limit);
        Some(at(inside))
    };
    Some(reach(last)? - reach(first)?)
}

/// The variance of a number made of the parameters, for errors of the lines of a variance of one: they act in both
/// parts alike, so that with `g` the derivative `½(∂/∂re − j ∂/∂im)` it is `2 Σ_k |g·influence_k|²`.
fn variance_of(
    theta: &[Complex64; UNKNOWNS],
    influence: &[Vec<Complex64>],
    of: &dyn Fn(&[Complex64; UNKNOWNS]) -> Option<f64>,
) -> Option<f64> {
    let size = theta.iter().map(|v| v.norm_sqr()).sum::<f64>().sqrt();
    let mut gradient = [Complex64::ZERO; UNKNOWNS];
    for (j, slot) in gradient.iter_mut().enumerate() {
        let step = STEP * theta[j].norm().max(1e-3 * size);
        let change = |direction: Complex64| {
            let moved = |sign: f64| {
                let mut other = *theta;
                other[j] += sign * step * direction;
                of(&other)
            };
            Some((moved(1.0)? - moved(-1.0)?) / (2.0 * step))
        };
        *slot = 0.5 * Complex64::new(change(Complex64::ONE)?, -change(Complex64::I)?);
    }
    let along =
        |column: &Vec<Complex64>| column.iter().zip(&gradient).map(|(c, g)| c * g).sum::<Complex64>().norm_sqr();
    Some(2.0 * influence.iter().map(along).sum::<f64>())
}
