//! Spans of columns that residuals are cleared of, orthonormal in the sense of the noise's covariance.

use std::ops::Range;

use faer::Mat;
use numerics::linalg;
use numerics::vector::dot;

use super::sensitivity::Stack;
use crate::dense::covariance_root::inverse_root;
use crate::{IdentError, Triangle};

/// Singular values below this part of the largest are directions that do not show.
const UNSEEN: f64 = 1e-9;

/// Directions that show in one experiment alone, as those of its initial state.
#[derive(Debug, Clone)]
pub(super) struct Block {
    /// Where the experiment lies in the stack.
    pub(super) rows: Range<usize>,
    /// `A`: rows × directions.
    pub(super) removed: Mat<f64>,
    /// `E`: the same, weighed by the inverse covariance of the outputs' noise, with `EᵀA = I`.
    pub(super) weights: Mat<f64>,
}

impl Block {
    /// The span of the columns of each experiment.
    ///
    /// # Errors
    /// [`IdentError::Decomposition`].
    pub(super) fn each(states: &[Mat<f64>], stack: &Stack, whiten: &Mat<f64>) -> Result<Vec<Block>, IdentError> {
        let of = |(m, columns): (usize, &Mat<f64>)| {
            let alone = Stack::new(vec![stack.lengths()[m]], stack.outputs());
            let columns: Vec<Vec<f64>> = (0..columns.ncols()).map(|k| columns.col_as_slice(k).to_vec()).collect();
            let removed = orthonormal(&columns, &alone, whiten)?;
            let weights = weigh(&removed, &alone, &(whiten * whiten.transpose()));
            Ok(Block { rows: stack.rows_of(m), removed, weights })
        };
        states.iter().enumerate().map(of).collect()
    }

    /// `x − A Eᵀ x`, in place, of a column of the stack.
    pub(super) fn clear(&self, column: &mut [f64]) {
        let part = &mut column[self.rows.clone()];
        for k in 0..self.removed.ncols() {
            let along = dot(self.weights.col_as_slice(k), part);
            part.iter_mut().zip(self.removed.col_as_slice(k)).for_each(|(v, a)| *v -= along * a);
        }
    }
}

/// `W` with `W Wᵀ` the inverse of a covariance of mean variance one.
pub(super) fn scaled_inverse_root(covariance: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    let n = covariance.nrows();
    let mean = (0..n).map(|i| covariance[(i, i)]).sum::<f64>() / n as f64;
    if !(mean.is_normal() && mean > 0.0) {
        return Ok(Mat::identity(n, n));
    }
    inverse_root(&Mat::from_fn(n, n, |i, j| covariance[(i, j)] / mean), f64::EPSILON.sqrt())
}

/// `weight` times the outputs of every instant.
pub(super) fn weigh(columns: &Mat<f64>, stack: &Stack, weight: &Mat<f64>) -> Mat<f64> {
    let mut weighed = Mat::zeros(columns.nrows(), columns.ncols());
    for k in 0..columns.ncols() {
        let (from, to) = (columns.col_as_slice(k), weighed.col_as_slice_mut(k));
        for m in 0..stack.lengths().len() {
            for (i, j) in (0..stack.outputs()).flat_map(|i| (0..stack.outputs()).map(move |j| (i, j))) {
                let pairs = to[stack.range(m, i)].iter_mut().zip(&from[stack.range(m, j)]);
                pairs.for_each(|(slot, v)| *slot += weight[(i, j)] * v);
            }
        }
    }
    weighed
}

/// The span of columns, orthonormal once an instant's outputs are multiplied by `whitenᵀ`; columns of every size count
/// alike.
pub(super) fn orthonormal(columns: &[Vec<f64>], stack: &Stack, whiten: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    let norm = |c: &Vec<f64>| c.iter().map(|v| v * v).sum::<f64>().sqrt();
    let moving: Vec<(&Vec<f64>, f64)> = columns.iter().map(|c| (c, norm(c))).filter(|(_, n)| n.is_normal()).collect();
    let unit = Mat::from_fn(stack.rows(), moving.len(), |i, k| moving[k].0[i] / moving[k].1);
    let white = weigh(&unit, stack, &square_root_of(whiten)?);
    let mut triangle = Triangle::for_rows(moving.len(), stack.rows());
    triangle.push_columns(stack.rows(), |j, start, slot| {
        slot.copy_from_slice(&white.col_as_slice(j)[start..start + slot.len()]);
    });
    let svd = linalg::svd(triangle.finish().as_ref())?;
    let values = &svd.values;
    let rank = values.iter().filter(|value| **value > UNSEEN * values[0]).count();
    let turn = Mat::from_fn(moving.len(), rank, |i, k| svd.v[(i, k)] / values[k]);
    Ok(unit * turn)
}

/// The symmetric root of `W Wᵀ`: as good as `Wᵀ`, and square where that is not.
pub(super) fn square_root_of(whiten: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    let svd = linalg::thin_svd(whiten.as_ref())?;
    let (u, values) = (&svd.u, &svd.values);
    Ok(Mat::from_fn(whiten.nrows(), whiten.nrows(), |i, j| {
        (0..values.len()).map(|k| u[(i, k)] * values[k] * u[(j, k)]).sum()
    }))
}
