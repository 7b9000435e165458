//! Channels over all experiments, and sums of their products.

use numerics::vector::dot;
use signal::correlation::cross_correlation;

use crate::IdentError;

/// One channel over all experiments: its mean taken off, zeros for what is missing.
pub(super) struct Series {
    pub(super) parts: Vec<Vec<f64>>,
    /// One where a sample is there; none where all are.
    pub(super) there: Option<Vec<Vec<f64>>>,
    pub(super) mean: f64,
    pub(super) present: f64,
}

impl Series {
    pub(super) fn new(parts: &[&[f64]]) -> Self {
        let there = || parts.iter().flat_map(|p| p.iter()).filter(|v| !v.is_nan());
        let present = there().count() as f64;
        let mean = there().sum::<f64>() / present.max(1.0);
        let gaps = parts.iter().any(|p| p.iter().any(|v| v.is_nan()));
        let centred = |v: &f64| if v.is_nan() { 0.0 } else { v - mean };
        let indicator = |v: &f64| f64::from(u8::from(!v.is_nan()));
        Series {
            parts: parts.iter().map(|p| p.iter().map(centred).collect()).collect(),
            there: gaps.then(|| parts.iter().map(|p| p.iter().map(indicator).collect()).collect()),
            mean,
            present,
        }
    }

    /// Values as they are, with none missing.
    pub(super) fn raw(parts: &[&[f64]]) -> Self {
        let parts: Vec<Vec<f64>> = parts.iter().map(|p| p.to_vec()).collect();
        let present = parts.iter().map(Vec::len).sum::<usize>() as f64;
        Series { parts, there: None, mean: 0.0, present }
    }

    /// Returns true if a sample is there.
    pub(super) fn is_there(&self, part: usize, t: usize) -> bool {
        self.there.as_ref().is_none_or(|there| there[part][t] > 0.0)
    }

    pub(super) fn energy(&self) -> f64 {
        self.parts.iter().flatten().map(|v| v * v).sum()
    }

    fn indicators(&self) -> Vec<Vec<f64>> {
        self.there.clone().unwrap_or_else(|| self.parts.iter().map(|p| vec![1.0; p.len()]).collect())
    }
}

/// `Σ_t x(t) y(t + k)` for k = −M … M, summed over the experiments.
pub(super) fn products(x: &Series, y: &Series, lags: usize) -> Result<Vec<f64>, IdentError> {
    sum_products(&x.parts, &y.parts, lags)
}

/// `Σ_t x(t) y(t + k)` for k = 0 … M alone.
pub(super) fn later_products(x: &Series, y: &Series, lags: usize) -> Result<Vec<f64>, IdentError> {
    if lags > FEW_LAGS {
        return Ok(products(x, y, lags)?.split_off(lags));
    }
    let mut sums = vec![0.0; lags + 1];
    x.parts.iter().zip(&y.parts).for_each(|(x, y)| add_one_by_one(x, y, sums.iter_mut()));
    finite(sums)
}

/// Lags up to which sums one by one cost less than transforms.
const FEW_LAGS: usize = 40;

fn sum_products(x: &[Vec<f64>], y: &[Vec<f64>], lags: usize) -> Result<Vec<f64>, IdentError> {
    let mut sums = vec![0.0; 2 * lags + 1];
    for (x, y) in x.iter().zip(y).filter(|(x, _)| !x.is_empty()) {
        let reach = lags.min(x.len() - 1);
        if reach <= FEW_LAGS {
            let (before, after) = sums.split_at_mut(lags);
            add_one_by_one(x, y, after.iter_mut());
            // Lag zero is among those after.
            add_one_by_one(y, x, std::iter::once(&mut 0.0).chain(before.iter_mut().rev()));
            continue;
        }
        let correlation = cross_correlation(x, y, reach)?;
        for (slot, value) in sums[lags - reach..].iter_mut().zip(&correlation.values) {
            *slot += value * x.len() as f64;
        }
    }
    finite(sums)
}

/// Samples that are read for all lags while they are in the nearest cache.
const BLOCK: usize = 1024;

/// Adds `Σ_t x(t) y(t + k)` for k = 0, 1, …
fn add_one_by_one<'a>(x: &[f64], y: &[f64], sums: impl Iterator<Item = &'a mut f64>) {
    let mut sums: Vec<&mut f64> = sums.take(x.len()).collect();
    for (first, x) in (0..).step_by(BLOCK).zip(x.chunks(BLOCK)) {
        work::checkpoint();
        for (k, slot) in sums.iter_mut().enumerate() {
            let y = &y[y.len().min(first + k)..];
            let there = x.len().min(y.len());
            **slot += dot(&x[..there], &y[..there]);
        }
    }
}

fn finite(sums: Vec<f64>) -> Result<Vec<f64>, IdentError> {
    match sums.iter().position(|sum| !sum.is_finite()) {
        Some(index) => Err(IdentError::NotFinite { what: "a correlation", index }),
        None => Ok(sums),
    }
}

/// How many pairs `x(t)`, `y(t + k)` are there, for k = −M … M.
pub(super) fn pair_counts(x: &Series, y: &Series, lags: usize) -> Result<Vec<f64>, IdentError> {
    if x.there.is_some() || y.there.is_some() {
        return Ok(sum_products(&x.indicators(), &y.indicators(), lags)?.iter().map(|v| v.round()).collect());
    }
    let count = |k: usize| x.parts.iter().map(|p| p.len().saturating_sub(k)).sum::<usize>() as f64;
    Ok((0..=2 * lags).map(|i| count(i.abs_diff(lags))).collect())
}
