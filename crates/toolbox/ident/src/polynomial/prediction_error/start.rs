//! Starting values: a long ARX model, from which the noise and the noise-free outputs are read, then linear
//! regressions.

use faer::Mat;
use numerics::linalg;

use super::evaluate::Evaluator;
use super::line::{divide, is_stable, stabilised};
use super::orders::Orders;
use super::segment::Segment;
use super::signals::Aim;
use crate::distributions::chi_squared_quantile;
use crate::{IdentError, Triangle};
use fitting::nonlinear::SumOfSquares;
use fitting::triangle::upper_factor;

/// Order of the long ARX model where the data allow it.
const LONG_ORDER: usize = 30;
/// Rounds of prefiltering by the denominator found last.
const ROUNDS: usize = 12;
/// The rounds are over when no coefficient of the denominator changes by more than this fraction.
const SETTLED: f64 = 1e-6;
/// Singular values below this fraction of the largest carry nothing.
const TOLERANCE: f64 = 1e-11;

/// Past residuals, and samples of each input, that are tested for whether they explain more, and rows a coefficient at
/// least.
const TOLD_ORDER: usize = 16;
const TOLD_ROWS: usize = 10;
/// A fraction of what is left is noticeable from here on, and where chance makes a larger one with this probability
/// only.
const CLEAR: f64 = 0.02;
const CHANCE: f64 = 1e-3;

/// Starting values of θ, the best guess not necessarily first.
///
/// # Errors
/// Too few samples for the first regressions.
///
/// # Source
/// Hannan & Rissanen 1982 (noise polynomials from the residuals of a long autoregression); Steiglitz & McBride 1965
/// (denominators by iterated prefiltering); Ljung 1999, §10.5.
pub(super) fn candidates(orders: &Orders, segments: &[Segment<'_>]) -> Result<Vec<Vec<f64>>, IdentError> {
    let long = Long::new(orders, segments)?;
    let mut all = dynamics(orders, segments, &long, &[orders.memory()])?;
    all.iter_mut().for_each(|theta| fill_noise(orders, segments, theta));
    all.extend(by_noise(orders, segments, &long));
    Ok(all)
}

/// Starting values of the dynamics, the noise polynomials zero, by way of this long ARX model and, since in few data a
/// shorter one has less noise in it, by way of those of `shorter` orders.
pub(super) fn dynamics(
    orders: &Orders,
    segments: &[Segment<'_>],
    long: &Long<'_>,
    shorter: &[usize],
) -> Result<Vec<Vec<f64>>, IdentError> {
    let mut all = Vec::new();
    if orders.inputs() > 0 {
        all.push(by_denominators(orders, segments, &long.contributions()));
        for order in shorter {
            let model = long.shortened((*order).min(long.order))?;
            all.push(by_denominators(orders, segments, &model.contributions()));
        }
        if orders.inputs() == 1 {
            let measured: Vec<_> = segments.iter().map(|s| vec![s.output.to_vec()]).collect();
            all.push(by_denominators(orders, segments, &measured));
        }
    }
    Ok(all)
}

/// Starting values by way of the noise, where the structure has such.
pub(super) fn by_noise(orders: &Orders, segments: &[Segment<'_>], long: &Long<'_>) -> Option<Vec<f64>> {
    if orders.na > 0 {
        return Some(by_regression(orders, segments, &long.errors()));
    }
    let series = || {
        let (c, d) = noise_polynomials(orders.nc, orders.nd, &outputs(segments));
        [c, d].concat()
    };
    (orders.inputs() == 0).then(series)
}

fn outputs(segments: &[Segment<'_>]) -> Vec<Vec<f64>> {
    segments.iter().map(|s| s.output.to_vec()).collect()
}

/// A long ARX model, and what it says of every segment.
pub(super) struct Long<'a> {
    orders: &'a Orders,
    segments: &'a [Segment<'a>],
    order: usize,
    theta: Vec<f64>,
}

impl<'a> Long<'a> {
    /// As long as these data allow.
    ///
    /// # Errors
    /// Too few samples.
    pub(super) fn new(orders: &'a Orders, segments: &'a [Segment<'a>]) -> Result<Self, IdentError> {
        let rows: usize = segments.iter().map(Segment::known).sum();
        let empty = Long { orders, segments, order: long_order(rows, orders.inputs()), theta: Vec::new() };
        empty.shortened(empty.order)
    }

    /// With these coefficients: of the past outputs, then of each input.
    pub(super) fn of(orders: &'a Orders, segments: &'a [Segment<'a>], order: usize, theta: Vec<f64>) -> Self {
        Long { orders, segments, order, theta }
    }

    /// A model of another order.
    fn shortened(&self, order: usize) -> Result<Self, IdentError> {
        let Long { orders, segments, .. } = *self;
        let signals: Vec<Vec<&[f64]>> = segments.iter().map(|s| signals(s)).collect();
        Ok(Long { orders, segments, order, theta: regress(&signals, &terms(orders, order))? })
    }

    /// Its prediction errors.
    fn errors(&self) -> Vec<Vec<f64>> {
        let wanted = terms(self.orders, self.order);
        self.segments.iter().map(|s| errors(&signals(s), &wanted, &self.theta)).collect()
    }

    /// Contribution of each input to the output: segments, then inputs.
    fn contributions(&self) -> Vec<Vec<Vec<f64>>> {
        let Long { orders, segments, order, .. } = *self;
        let a: Vec<f64> = self.theta[..order].iter().map(|v| -v).collect();
        let a_stable = stabilised(&a, 1.0);
        let contribution = |s: &Segment<'_>, k: usize| {
            let first = order * (1 + k);
            let numerator = delayed(&self.theta[first..first + order], orders.nk[k]);
            filtered(&numerator, &a_stable, &s.inputs[k])
        };
        segments.iter().map(|s| (0..orders.inputs()).map(|k| contribution(s, k)).collect()).collect()
    }
}

/// The terms of an ARX model of this order.
fn terms(orders: &Orders, order: usize) -> Vec<Term> {
    let of_input = |k: usize| (0..order).map(move |j| Term { signal: 1 + k, lag: orders.nk[k] + j });
    let past = (1..=order).map(|lag| Term { signal: 0, lag });
    past.chain((0..orders.inputs()).flat_map(of_input)).collect()
}

fn long_order(rows: usize, inputs: usize) -> usize {
    (rows / (6 * (1 + inputs))).clamp(1, LONG_ORDER)
}

/// The output, then the inputs.
fn signals<'s>(segment: &'s Segment<'_>) -> Vec<&'s [f64]> {
    std::iter::once(&*segment.output).chain(segment.inputs.iter().map(|u| &**u)).collect()
}

/// A signal of a regression and how far it is shifted.
#[derive(Clone, Copy)]
struct Term {
    signal: usize,
    lag: usize,
}

/// Signal 0 as a linear combination of the terms, by least squares over all segments.
fn regress(signals: &[Vec<&[f64]>], terms: &[Term]) -> Result<Vec<f64>, IdentError> {
    solve(&factor(signals, terms)?)
}

/// The factor of the terms and signal 0 over all segments; rows before the largest lag are left out where that leaves
/// enough of them, else the past counts as zero.
fn factor(signals: &[Vec<&[f64]>], terms: &[Term]) -> Result<Mat<f64>, IdentError> {
    let memory = terms.iter().map(|t| t.lag).max().unwrap_or(0);
    let full: usize = signals.iter().map(|s| s[0].len().saturating_sub(memory)).sum();
    let skip = if full > 2 * terms.len() { memory } else { 0 };
    let mut triangle = Triangle::for_rows(terms.len() + 1, signals.iter().map(|s| s[0].len()).sum());
    for segment in signals {
        triangle.push_columns(segment[0].len().saturating_sub(skip), |j, start, slot| {
            let Term { signal, lag } = terms.get(j).copied().unwrap_or(Term { signal: 0, lag: 0 });
            let before = lag.saturating_sub(skip + start).min(slot.len());
            let (zeros, values) = slot.split_at_mut(before);
            zeros.fill(0.0);
            let from = skip + start + before;
            if let Some(first) = from.checked_sub(lag) {
                values.copy_from_slice(&segment[signal][first..first + values.len()]);
            }
        });
    }
    if triangle.rows() == 0 {
        return Err(IdentError::TooFewSamples { samples: 0, parameters: terms.len() });
    }
    Ok(triangle.finish())
}

/// Returns true if past inputs explain noticeably more of the residuals of a model than their own past does. They would
/// not if nothing of the inputs' effect were left in the residuals.
pub(super) fn inputs_tell_more(orders: &Orders, segments: &[Segment<'_>], left: &[Vec<f64>]) -> bool {
    let signals: Vec<Vec<&[f64]>> = segments
        .iter()
        .zip(left)
        .map(|(s, e)| std::iter::once(e.as_slice()).chain(s.inputs.iter().map(|u| &**u)).collect())
        .collect();
    let rows: usize = left.iter().map(Vec::len).sum();
    let order = (rows / (TOLD_ROWS * (1 + orders.inputs()))).min(TOLD_ORDER);
    if order == 0 {
        return false;
    }
    let terms = terms(orders, order);
    let Ok(factor) = factor(&signals, &terms) else { return false };
    let energy = |rows: std::ops::RangeInclusive<usize>| rows.map(|i| factor[(i, terms.len())].powi(2)).sum::<f64>();
    let (gain, rest) = (energy(order..=terms.len() - 1), energy(terms.len()..=terms.len()));
    let chance = chi_squared_quantile(1.0 - CHANCE, (terms.len() - order) as f64) / rows as f64;
    gain > rest * chance.max(CLEAR)
}

/// The solution of least norm (with scaled columns) of the problem whose factor of [Φ y] is given: data without noise
/// leave a long model undetermined.
fn solve(factor: &Mat<f64>) -> Result<Vec<f64>, IdentError> {
    let n = factor.ncols() - 1;
    let norms: Vec<f64> = (0..n).map(|j| factor.col(j).norm_l2()).map(|v| if v > 0.0 { v } else { 1.0 }).collect();
    let scaled = Mat::from_fn(n, n, |i, j| factor[(i, j)] / norms[j]);
    let svd = linalg::svd(scaled.as_ref())?;
    let strengths = &svd.values;
    let along = svd.u.transpose() * factor.get(..n, n);
    let felt = |i: usize| strengths[i] > 0.0 && strengths[i] >= TOLERANCE * strengths[0];
    let inverse = |j: usize| (0..n).filter(|i| felt(*i)).map(|i| svd.v[(j, i)] * along[i] / strengths[i]).sum::<f64>();
    Ok((0..n).map(|j| inverse(j) / norms[j]).collect())
}

/// Residuals of a regression; zero until every term has its past.
fn errors(signals: &[&[f64]], terms: &[Term], theta: &[f64]) -> Vec<f64> {
    let memory = terms.iter().map(|t| t.lag).max().unwrap_or(0);
    let mut left = signals[0].to_vec();
    for (term, value) in terms.iter().zip(theta) {
        let source = signals[term.signal];
        (term.lag..left.len()).for_each(|t| left[t] -= value * source[t - term.lag]);
    }
    left.iter_mut().take(memory).for_each(|v| *v = 0.0);
    left
}

/// `A`, `B`, `C` by one regression on the errors of the long model (Hannan and Rissanen); `D` from what is left.
fn by_regression(orders: &Orders, segments: &[Segment<'_>], long_errors: &[Vec<f64>]) -> Vec<f64> {
    let inputs = orders.inputs();
    let nc = if orders.nd == 0 { orders.nc } else { 0 };
    let mut terms: Vec<Term> = (1..=orders.na).map(|lag| Term { signal: 0, lag }).collect();
    for k in 0..inputs {
        terms.extend((0..orders.nb[k]).map(|j| Term { signal: 1 + k, lag: orders.nk[k] + j }));
    }
    terms.extend((1..=nc).map(|lag| Term { signal: 1 + inputs, lag }));
    let with_errors = |(s, e): (&'_ _, &'_ Vec<f64>)| -> Vec<Vec<f64>> {
        signals(s).into_iter().chain([&**e]).map(<[f64]>::to_vec).collect()
    };
    let owned: Vec<Vec<Vec<f64>>> = segments.iter().zip(long_errors).map(with_errors).collect();
    let all: Vec<Vec<&[f64]>> = owned.iter().map(|s| s.iter().map(Vec::as_slice).collect()).collect();
    let mut theta = vec![0.0; orders.count()];
    let Ok(found) = regress(&all, &terms) else { return theta };
    theta[..found.len()].copy_from_slice(&found);
    theta[orders.a()].iter_mut().for_each(|v| *v = -*v);
    if orders.nd > 0 {
        fill_noise(orders, segments, &mut theta);
    }
    stabilise(orders, &mut theta);
    theta
}

/// `A` or `F` and `B` from what each input contributes to the output.
fn by_denominators(orders: &Orders, segments: &[Segment<'_>], contributions: &[Vec<Vec<f64>>]) -> Vec<f64> {
    let mut theta = vec![0.0; orders.count()];
    let inputs: Vec<usize> = (0..orders.inputs()).collect();
    let of = |k: usize| -> Vec<Vec<f64>> { contributions.iter().map(|c| c[k].clone()).collect() };
    if orders.nf.iter().all(|nf| *nf == 0) {
        let total = |c: &Vec<Vec<f64>>| (0..c[0].len()).map(|t| c.iter().map(|k| k[t]).sum()).collect();
        let sum: Vec<Vec<f64>> = contributions.iter().map(total).collect();
        let (den, nums) = ratio(&sum, segments, &inputs, orders, orders.na);
        theta[orders.a()].copy_from_slice(&den);
        nums.iter().enumerate().for_each(|(k, num)| theta[orders.b(k)].copy_from_slice(num));
    } else {
        for k in inputs {
            let (den, nums) = ratio(&of(k), segments, &[k], orders, orders.nf[k]);
            theta[orders.f(k)].copy_from_slice(&den);
            theta[orders.b(k)].copy_from_slice(&nums[0]);
        }
    }
    stabilise(orders, &mut theta);
    theta
}

/// A common denominator of this order and the numerators from `inputs` to `target`, by the method of Steiglitz and
/// McBride: of all rounds the one that simulates the target best.
fn ratio(
    target: &[Vec<f64>],
    segments: &[Segment<'_>],
    inputs: &[usize],
    orders: &Orders,
    order: usize,
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut best = (f64::INFINITY, vec![0.0; order], inputs.iter().map(|k| vec![0.0; orders.nb[*k]]).collect());
    let mut den = vec![0.0; order];
    let round = Round { target, segments, inputs, orders };
    for _ in 0..if order == 0 { 1 } else { ROUNDS } {
        let Some(next) = round.solve(&den, order) else { break };
        let before = std::mem::replace(&mut den, stabilised(&next.denominator, 1.0));
        let Some(refined) = round.solve(&den, 0) else { break };
        if refined.left < best.0 {
            best = (refined.left, den.clone(), refined.numerators);
        }
        if den.iter().zip(&before).all(|(new, old)| (new - old).abs() <= SETTLED * new.abs()) {
            break;
        }
    }
    (best.1, best.2)
}

/// Data that the rounds of one [`ratio`] share.
struct Round<'a, 's> {
    target: &'a [Vec<f64>],
    segments: &'a [Segment<'s>],
    inputs: &'a [usize],
    orders: &'a Orders,
}

/// Result of one regression.
struct Found {
    denominator: Vec<f64>,
    numerators: Vec<Vec<f64>>,
    left: f64,
}

impl Round<'_, '_> {
    /// With inputs filtered by `1/den`: a denominator of this order for the target filtered alike, and numerators; for
    /// order zero, the numerators from the filtered inputs to the target itself.
    fn solve(&self, den: &[f64], order: usize) -> Option<Found> {
        let filter = |x: &[f64]| filtered(&[1.0], den, x);
        let rows = |(s, z): (&Segment<'_>, &Vec<f64>)| -> Vec<Vec<f64>> {
            let first = if order > 0 { filter(z) } else { z.clone() };
            std::iter::once(first).chain(self.inputs.iter().map(|k| filter(&s.inputs[*k]))).collect()
        };
        let owned: Vec<Vec<Vec<f64>>> = self.segments.iter().zip(self.target).map(rows).collect();
        let signals: Vec<Vec<&[f64]>> = owned.iter().map(|s| s.iter().map(Vec::as_slice).collect()).collect();
        let (nb, nk) = (&self.orders.nb, &self.orders.nk);
        let mut terms: Vec<Term> = (1..=order).map(|lag| Term { signal: 0, lag }).collect();
        for (i, k) in self.inputs.iter().enumerate() {
            terms.extend((0..nb[*k]).map(|j| Term { signal: 1 + i, lag: nk[*k] + j }));
        }
        let theta = regress(&signals, &terms).ok()?;
        let left = signals.iter().flat_map(|s| errors(s, &terms, &theta)).map(|v| v * v).sum();
        let mut rest = theta[order..].iter().copied();
        let numerators = self.inputs.iter().map(|k| rest.by_ref().take(nb[*k]).collect()).collect();
        Some(Found { denominator: theta[..order].iter().map(|v| -v).collect(), numerators, left })
    }
}

/// θ with the numerators that, with the initial states that suit them, simulate the output best at its denominators,
/// and the sum of squares they leave; `None` where a denominator is not stable.
pub(super) fn with_numerators(
    orders: &Orders,
    segments: &[Segment<'_>],
    theta: &[f64],
    estimate_states: bool,
) -> Option<(f64, Vec<f64>)> {
    let mut theta = theta.to_vec();
    let numerators = orders.na..orders.c().start;
    theta[numerators.clone()].fill(0.0);
    let factor = Evaluator::new(orders, segments, Aim::Simulation, estimate_states).factor(&theta).ok()?;
    // The error is linear in the numerators: one step from zero leads to the best.
    let wanted: Vec<usize> = numerators.clone().chain([orders.count()]).collect();
    let factor = upper_factor(Mat::from_fn(factor.nrows(), wanted.len(), |i, j| factor[(i, wanted[j])]));
    let step = solve(&factor).ok()?;
    theta[numerators].iter_mut().zip(&step).for_each(|(slot, v)| *slot = -v);
    let n = step.len();
    let left = |i: usize| factor[(i, n)] - (i..n).map(|j| factor[(i, j)] * step[j]).sum::<f64>();
    let cost: f64 = (0..=n).map(|i| left(i).powi(2)).sum();
    cost.is_finite().then_some((cost, theta))
}

/// `C` and `D` from `v = A y − Σ B/F u` at the other values in θ.
fn fill_noise(orders: &Orders, segments: &[Segment<'_>], theta: &mut [f64]) {
    if orders.nc + orders.nd == 0 {
        return;
    }
    let left = |s: &Segment<'_>| {
        let full: Vec<f64> = std::iter::once(1.0).chain(theta[orders.a()].iter().copied()).collect();
        let mut v = filtered(&full, &[], &s.output);
        for k in 0..orders.inputs() {
            let w = filtered(&delayed(&theta[orders.b(k)], orders.nk[k]), &theta[orders.f(k)], &s.inputs[k]);
            v.iter_mut().zip(w).for_each(|(v, w)| *v -= w);
        }
        v
    };
    let v: Vec<Vec<f64>> = segments.iter().map(left).collect();
    let (c, d) = noise_polynomials(orders.nc, orders.nd, &v);
    theta[orders.c()].copy_from_slice(&c);
    theta[orders.d()].copy_from_slice(&d);
}

/// `C` and `D` of `D v = C e`; zeros where the data do not say.
fn noise_polynomials(nc: usize, nd: usize, v: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
    let rows: usize = v.iter().map(Vec::len).sum();
    let long: Vec<Term> = (1..=long_order(rows, 0)).map(|lag| Term { signal: 0, lag }).collect();
    let alone: Vec<Vec<&[f64]>> = v.iter().map(|x| vec![x.as_slice()]).collect();
    let nothing = (vec![0.0; nc], vec![0.0; nd]);
    let Ok(ar) = regress(&alone, &long) else { return nothing };
    let e: Vec<Vec<f64>> = alone.iter().map(|s| errors(s, &long, &ar)).collect();
    let both: Vec<Vec<&[f64]>> = v.iter().zip(&e).map(|(v, e)| vec![v.as_slice(), e.as_slice()]).collect();
    let ours = (1..=nd).map(|lag| Term { signal: 0, lag }).chain((1..=nc).map(|lag| Term { signal: 1, lag }));
    let Ok(found) = regress(&both, &ours.collect::<Vec<_>>()) else { return nothing };
    (stabilised(&found[nd..], 1.0), found[..nd].iter().map(|v| -v).collect())
}

/// Brings the denominators of the predictor into the unit circle.
fn stabilise(orders: &Orders, theta: &mut [f64]) {
    (0..orders.inputs()).map(|k| orders.f(k)).chain([orders.c()]).for_each(|range| {
        let stable = stabilised(&theta[range.clone()], 1.0);
        let usable = is_stable(&stable, 1.0) && stable.iter().all(|v| v.is_finite());
        theta[range].iter_mut().zip(stable).for_each(|(slot, v)| *slot = if usable { v } else { 0.0 });
    });
}

fn delayed(numerator: &[f64], delay: usize) -> Vec<f64> {
    std::iter::repeat_n(0.0, delay).chain(numerator.iter().copied()).collect()
}

/// `x · num/(1 + den₁ q⁻¹ + …)` from zero state.
fn filtered(num: &[f64], den: &[f64], x: &[f64]) -> Vec<f64> {
    let past = den.len();
    let mut y = vec![0.0; past + x.len()];
    for (j, c) in num.iter().enumerate().filter(|(_, c)| **c != 0.0) {
        y.iter_mut().skip(past + j).zip(x).for_each(|(y, x)| *y += c * x);
    }
    divide(den, &mut y);
    y.drain(..past);
    y
}

/// θ with `C` and `D` estimated from what the other values leave.
pub(super) fn with_noise(orders: &Orders, segments: &[Segment<'_>], theta: &[f64]) -> Vec<f64> {
    let mut theta = theta.to_vec();
    fill_noise(orders, segments, &mut theta);
    theta
}
