//! Starting values by iterated weighted linear least squares.

use faer::Mat;
use numerics::linalg;
use signal::Complex64;

use super::basis::Basis;
use super::data::Lines;
use crate::Triangle;

/// Rounds of reweighting.
const ROUNDS: usize = 20;

/// Numerator and denominator in their bases, and what they leave.
#[derive(Debug, Clone)]
pub(crate) struct Start {
    pub(crate) num: Basis,
    pub(crate) den: Basis,
    pub(crate) b: Vec<f64>,
    pub(crate) a: Vec<f64>,
    pub(crate) delay_s: f64,
    pub(crate) cost: f64,
}

/// Minimises `Σ |D Y − N U e^{−jωτ}|²/σ²` with σ from the round before, `‖a‖ = 1` in the basis that is orthonormal
/// under the weights of that round; the best round by the likelihood's own cost is returned.
pub(crate) fn start(
    lines: &Lines,
    points: &[Complex64],
    orders: (usize, usize),
    delay_s: f64,
    stable: Option<bool>,
) -> Option<Start> {
    let one = Complex64::new(1.0, 0.0);
    let mut weights: Vec<f64> = lines.lines.iter().map(|l| 1.0 / l.variance(l.y / l.u, one).sqrt()).collect();
    let mut best: Option<Start> = None;
    let mut last = f64::INFINITY;
    for _ in 0..ROUNDS {
        let Some(found) = round(lines, points, &weights, orders, delay_s) else { break };
        for (k, (weight, line)) in weights.iter_mut().zip(&lines.lines).enumerate() {
            let n = found.num.at(&found.b, k) * Complex64::cis(-line.omega * delay_s);
            *weight = 1.0 / line.variance(n, found.den.at(&found.a, k)).sqrt();
        }
        if weights.iter().any(|w| !w.is_finite()) {
            break;
        }
        let (cost, before) = (found.cost, std::mem::replace(&mut last, found.cost));
        let usable = stable.is_none_or(|discrete| is_stable(&found.den, &found.a, discrete));
        if usable && best.as_ref().is_none_or(|b| cost < b.cost) {
            best = Some(found);
        }
        if (cost - before).abs() <= 1e-9 * cost {
            break;
        }
    }
    best
}

fn round(lines: &Lines, points: &[Complex64], weights: &[f64], (m, n): (usize, usize), delay_s: f64) -> Option<Start> {
    let weighted = |size: &dyn Fn(usize) -> f64| (0..points.len()).map(|k| weights[k] * size(k)).collect::<Vec<f64>>();
    let num = Basis::new(points, &weighted(&|k| lines.lines[k].u.norm()), m)?;
    let den = Basis::new(points, &weighted(&|k| lines.lines[k].y.norm()), n)?;
    let mut triangle = Triangle::new(m + n + 2);
    let (mut real, mut imaginary) = (vec![0.0; m + n + 2], vec![0.0; m + n + 2]);
    for (k, line) in lines.lines.iter().enumerate() {
        let (u, y) = (line.u * Complex64::cis(-line.omega * delay_s) * -weights[k], line.y * weights[k]);
        let of_num = num.values.iter().map(|p| p[k] * u);
        for (j, value) in of_num.chain(den.values.iter().map(|q| q[k] * y)).enumerate() {
            (real[j], imaginary[j]) = (value.re, value.im);
        }
        triangle.push_row(&real);
        triangle.push_row(&imaginary);
    }
    let (b, a) = null_vector(&triangle.finish(), m + 1, n + 1)?;
    let mut found = Start { num, den, b, a, delay_s, cost: 0.0 };
    found.cost = cost(lines, &found);
    found.cost.is_finite().then_some(found)
}

/// The numerator and the unit denominator that the triangle `[R₁₁ R₁₂; 0 R₂₂]` sends nearest to zero.
fn null_vector(factor: &Mat<f64>, m: usize, n: usize) -> Option<(Vec<f64>, Vec<f64>)> {
    let lower = factor.submatrix(m, m, n, n).to_owned();
    let svd = linalg::svd(lower.as_ref()).ok()?;
    let a: Vec<f64> = (0..n).map(|j| svd.v[(j, n - 1)]).collect();
    let mut b = vec![0.0; m];
    for i in (0..m).rev() {
        let known: f64 = (i + 1..m).map(|j| factor[(i, j)] * b[j]).sum::<f64>()
            + (0..n).map(|j| factor[(i, m + j)] * a[j]).sum::<f64>();
        b[i] = -known / factor[(i, i)];
    }
    b.iter().all(|v| v.is_finite()).then_some((b, a))
}

fn cost(lines: &Lines, found: &Start) -> f64 {
    let misfit = |(k, line): (usize, &super::data::Line)| {
        let n = found.num.at(&found.b, k) * Complex64::cis(-line.omega * found.delay_s);
        let d = found.den.at(&found.a, k);
        (d * line.y - n * line.u).norm_sqr() / line.variance(n, d)
    };
    lines.lines.iter().enumerate().map(misfit).sum()
}

/// Returns true if every pole is in the left half-plane, or within the unit circle.
pub(crate) fn is_stable(den: &Basis, a: &[f64], discrete: bool) -> bool {
    let mut descending = vec![0.0; a.len()];
    for (p, value) in den.coefficients.iter().zip(a) {
        p.iter().enumerate().for_each(|(i, c)| descending[a.len() - 1 - i] += value * c);
    }
    let inside = |p: &Complex64| if discrete { p.norm() < 1.0 } else { p.re < 0.0 };
    lti::polynomial::roots(&descending).is_ok_and(|poles| poles.iter().all(inside))
}
