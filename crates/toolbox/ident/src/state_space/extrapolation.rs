//! Anderson's extrapolation of a search's steps (Walker and Ni, SIAM J. Numer. Anal. 49, 2011, p. 1715).
//!
//! Gauss–Newton steps towards a model that explains the data shrink fast. Towards one of too low an order each is
//! nearly the same part of the one before, and there may be hundreds: how they shrink shows where they lead.

use std::collections::VecDeque;

use faer::{Mat, MatRef};
use numerics::linalg;

use super::gather::scaled_columns;
use crate::IdentError;

/// As many steps are used, the last ones ...
const USED: usize = 6;
/// ... once there are as many: a search that converges fast needs no help.
const NEEDED: usize = 3;
/// Combinations of the last steps that are weaker than this part of the strongest are not used.
const RANK_TOLERANCE: f64 = 1e-9;

/// Where the last iterations were, and the step that each proposed: both in the entries of the model's matrices.
#[derive(Default)]
pub(super) struct Extrapolation {
    past: VecDeque<(Vec<f64>, Vec<f64>)>,
}

impl Extrapolation {
    /// Takes down the step that was proposed at these entries.
    pub(super) fn remember(&mut self, at: Vec<f64>, step: Vec<f64>) {
        if self.past.len() == USED {
            self.past.pop_front();
        }
        self.past.push_back((at, step));
    }

    /// Where steps like the last ones lead from these entries, as a step along the columns of `basis`, entries ×
    /// directions; the next one by itself is `step`. Steps are as long as the changes of the errors, `jacobian` times
    /// the step. `None` as long as there are too few.
    pub(super) fn step(
        &self,
        at: &[f64],
        step: &[f64],
        basis: MatRef<'_, f64>,
        jacobian: MatRef<'_, f64>,
    ) -> Result<Option<Vec<f64>>, IdentError> {
        let count = self.past.len();
        if count < NEEDED {
            return Ok(None);
        }
        let step = Mat::from_fn(step.len(), 1, |i, _| step[i]);
        let moves = Mat::from_fn(at.len(), 2 * count, |i, j| match j.checked_sub(count) {
            None => at[i] - self.past[j].0[i],
            Some(j) => self.past[j].1[i],
        });
        let moves = along(basis, &moves)?;
        let steps = moves.subcols(count, count);
        let shorter = Mat::from_fn(step.nrows(), count, |i, j| step[(i, 0)] - steps[(i, j)]);
        let (errors, lengths) = scaled_columns((jacobian * &shorter).as_ref());
        let shares = linalg::least_norm(errors.as_ref(), (jacobian * &step).as_ref(), RANK_TOLERANCE)?;
        let shares = Mat::from_fn(count, 1, |j, _| shares[(j, 0)] / lengths[j]);
        let further = step - (moves.subcols(0, count) + shorter) * shares;
        Ok(Some(further.col(0).iter().copied().collect()))
    }
}

/// Coordinates of `moves`, a column each, along the columns of `basis`: what only turns the states' basis is left out.
/// Entries count by the sizes of their rows, which have the entries' units.
fn along(basis: MatRef<'_, f64>, moves: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    let (rows, sizes) = scaled_columns(basis.transpose());
    let moves = Mat::from_fn(moves.nrows(), moves.ncols(), |i, j| moves[(i, j)] / sizes[i]);
    Ok(linalg::least_norm(rows.transpose(), moves.as_ref(), RANK_TOLERANCE)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of a linear iteration with three rates lead to its fixed point, in a basis of any scale.
    #[test]
    fn exact_steps_that_shrink_by_constant_factors_lead_to_their_limit() {
        let (rates, limit) = ([0.99, 0.9, 0.5], [3.0, -1e3, 2e-4]);
        let basis = Mat::from_fn(3, 3, |i, j| limit[i] * if i == j { 2.0 } else { 0.3 });
        let (mut x, mut extrapolation) = (vec![0.0; 3], Extrapolation::default());
        let proposed = |x: &[f64]| -> Vec<f64> { (0..3).map(|i| (1.0 - rates[i]) * (limit[i] - x[i])).collect() };
        for _ in 0..NEEDED {
            let step = proposed(&x);
            extrapolation.remember(x.clone(), step.clone());
            x.iter_mut().zip(&step).for_each(|(x, by)| *x += by);
        }
        let step = along(basis.as_ref(), &Mat::from_fn(3, 1, |i, _| proposed(&x)[i])).unwrap();
        let step: Vec<f64> = step.col(0).iter().copied().collect();
        let jacobian = Mat::<f64>::identity(3, 3);
        let further = extrapolation.step(&x, &step, basis.as_ref(), jacobian.as_ref()).unwrap().unwrap();
        let reached = &basis * Mat::from_fn(3, 1, |i, _| further[i]);
        for i in 0..3 {
            assert!(
                (x[i] + reached[(i, 0)] - limit[i]).abs() < 1e-6 * limit[i].abs(),
                "{i}: {}",
                x[i] + reached[(i, 0)]
            );
        }
    }
}
