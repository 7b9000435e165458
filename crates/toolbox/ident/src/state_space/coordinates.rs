//! Directions in the space of all matrices that change a model's behaviour and not merely the basis of its states.

use faer::Mat;
use lti::Innovations;
use numerics::linalg;

use super::predictor::{Free, Predictor};
use crate::{Dataset, IdentError};

/// Directions that only turn the basis have singular values above this part of the largest.
const RANK_TOLERANCE: f64 = 1e-10;

/// Size of one unit of each free entry, in the entries' order: states and channels are measured by their root mean
/// squares.
pub(super) fn entry_scales(predictor: &Predictor, free: Free, data: &Dataset, x0: &[Vec<f64>]) -> Vec<f64> {
    let positive = |v: f64| if v > 0.0 && v.is_finite() { v } else { 1.0 };
    let x: Vec<f64> = predictor.state_sizes(data, x0).into_iter().map(positive).collect();
    let size = |pick: &dyn Fn(&crate::Experiment) -> &[f64]| {
        let known = || data.experiments().iter().flat_map(|e| pick(e).iter()).filter(|v| !v.is_nan());
        positive((known().map(|v| v * v).sum::<f64>() / known().count().max(1) as f64).sqrt())
    };
    let u: Vec<f64> = (0..predictor.m).map(|k| size(&|e| e.input(k))).collect();
    let y: Vec<f64> = (0..predictor.p).map(|i| size(&|e| e.output(i))).collect();
    let table = |rows: &[f64], columns: &[f64]| -> Vec<f64> {
        rows.iter().flat_map(|r| columns.iter().map(move |c| r / c)).collect()
    };
    let none = Vec::new;
    let blocks = [
        if free.dynamics { table(&x, &x) } else { none() },
        table(&x, &u),
        if free.dynamics { table(&y, &x) } else { none() },
        if free.feedthrough { table(&y, &u) } else { none() },
        if free.noise { table(&x, &y) } else { none() },
    ];
    blocks.concat()
}

/// A basis, entries × directions, of the changes of all free matrices that are orthogonal, entries measured by
/// `scales`, to every change of the states' basis `T`: `dA = τA − Aτ`, `dB = τB`, `dC = −Cτ`, `dK = τK`.
pub(super) fn directions(model: &Innovations, free: Free, scales: &[f64]) -> Result<Mat<f64>, IdentError> {
    let system = model.system();
    let (a, b, c, k) = (system.a(), system.b(), system.c(), model.k());
    let n = system.states();
    let mut turns = Mat::<f64>::zeros(scales.len(), n * n);
    for (column, (r, s)) in (0..n).flat_map(|r| (0..n).map(move |s| (r, s))).enumerate() {
        let mut entries = Vec::with_capacity(scales.len());
        let row = |i: usize, value: f64| if i == r { value } else { 0.0 };
        let each = |rows: usize, columns: usize| (0..rows).flat_map(move |i| (0..columns).map(move |j| (i, j)));
        entries.extend(each(n, n).map(|(i, j)| row(i, a[(s, j)]) - if j == s { a[(i, r)] } else { 0.0 }));
        entries.extend(each(n, b.ncols()).map(|(i, j)| row(i, b[(s, j)])));
        entries.extend(each(c.nrows(), n).map(|(i, j)| if j == s { -c[(i, r)] } else { 0.0 }));
        if free.feedthrough {
            entries.extend(each(c.nrows(), b.ncols()).map(|_| 0.0));
        }
        if free.noise {
            entries.extend(each(n, c.nrows()).map(|(i, j)| row(i, k[(s, j)])));
        }
        for (i, entry) in entries.iter().enumerate() {
            turns[(i, column)] = entry / scales[i];
        }
    }
    let svd = linalg::svd(turns.as_ref())?;
    let largest = svd.values.first().copied().unwrap_or(0.0);
    let rank = svd.values.iter().filter(|v| **v > RANK_TOLERANCE * largest).count();
    let kept = svd.u.subcols(rank, scales.len() - rank);
    Ok(Mat::from_fn(scales.len(), kept.ncols(), |i, j| scales[i] * kept[(i, j)]))
}
