//! Split of the errors and of their gradient into the part that the initial state explains and the rest.

use faer::Mat;
use numerics::linalg;

use crate::{IdentError, Triangle};

/// Directions of the initial state that move the residuals less than this fraction of the strongest are left at zero.
const STATE_TOLERANCE: f64 = 1e-10;

/// The factor of [X J e] split into what the initial state explains and what is left.
pub(super) struct Split {
    scale: Vec<f64>,
    directions: Mat<f64>,
    strengths: Vec<f64>,
    /// Rows that belong to the directions of the state, rotated to them; columns [J e].
    along: Mat<f64>,
    factor: Mat<f64>,
}

impl Split {
    pub(super) fn new(factor: &Mat<f64>, count: usize) -> Result<Self, IdentError> {
        let norms = (0..count).map(|j| factor.col(j).norm_l2());
        let scale: Vec<f64> = norms.map(|n| if n > 0.0 { n } else { 1.0 }).collect();
        let scaled = Mat::from_fn(count, count, |i, j| factor[(i, j)] / scale[j]);
        let svd = linalg::svd(scaled.as_ref())?;
        let along = svd.u.transpose() * factor.get(..count, count..);
        Ok(Split { scale, directions: svd.v, strengths: svd.values, along, factor: factor.clone() })
    }

    fn is_felt(&self, direction: usize) -> bool {
        let strength = self.strengths[direction];
        strength > 0.0 && strength >= STATE_TOLERANCE * self.strengths[0]
    }

    /// The state that makes e smallest.
    pub(super) fn state(&self) -> Vec<f64> {
        let n = self.scale.len();
        let last = self.along.ncols() - 1;
        let felt: Vec<usize> = (0..n).filter(|i| self.is_felt(*i)).collect();
        let element = |j: usize| -> f64 {
            felt.iter().map(|i| -self.directions[(j, *i)] * self.along[(*i, last)] / self.strengths[*i]).sum()
        };
        (0..n).map(|j| element(j) / self.scale[j]).collect()
    }

    /// The combination of the state's directions that comes closest to each column of J.
    pub(super) fn explained(&self) -> Mat<f64> {
        let (n, columns) = (self.scale.len(), self.along.ncols() - 1);
        let felt: Vec<usize> = (0..n).filter(|i| self.is_felt(*i)).collect();
        Mat::from_fn(n, columns, |j, m| {
            let one = |i: &usize| self.directions[(j, *i)] * self.along[(*i, m)] / self.strengths[*i];
            felt.iter().map(one).sum::<f64>() / self.scale[j]
        })
    }

    /// ‖e‖² at that state.
    pub(super) fn rest(&self) -> f64 {
        let n = self.scale.len();
        let (last, corner) = (self.along.ncols() - 1, self.factor.ncols() - 1);
        let unfelt: f64 = (0..n).filter(|i| !self.is_felt(*i)).map(|i| self.along[(i, last)].powi(2)).sum();
        unfelt + (n..=corner).map(|i| self.factor[(i, corner)].powi(2)).sum::<f64>()
    }

    /// Appends the rows of [J e] that the state does not explain.
    pub(super) fn push_rest(&self, all: &mut Triangle) {
        let (n, total) = (self.scale.len(), self.factor.ncols());
        for i in (0..n).filter(|i| !self.is_felt(*i)) {
            let row: Vec<f64> = (0..total - n).map(|j| self.along[(i, j)]).collect();
            all.push_row(&row);
        }
        for i in n..total {
            let row: Vec<f64> = (n..total).map(|j| self.factor[(i, j)]).collect();
            all.push_row(&row);
        }
    }
}
