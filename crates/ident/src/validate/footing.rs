//! What an estimate does to residuals: what it took out of them, and what its errors add.

use faer::Mat;

use super::quadratic::{Covariance, Sums};

use super::sensitivity::Stack;
use super::series::{Series, pair_counts, products};
use crate::colour::{Colour, Sandwich};
use crate::uncertainty::root::inverse_root;
use crate::{IdentError, Triangle};

/// Multiplications spent on covariances that are exact to the ends of the record; beyond, the lags count as stationary.
const AFFORDABLE: usize = 500_000_000;
/// Most lags, and directions taken out, of such a covariance.
const MOST_COLUMNS: usize = 500;
/// Singular values below this part of the largest are directions that do not show.
const UNSEEN: f64 = 1e-9;

/// Residuals of outputs that are there at the same instants, in the first order of what the estimate did to them:
/// `ε = M v − Ψ δ` with errors `v` of covariance `R`, `M = I − A Eᵀ`, and `δ` of covariance one.
pub(super) struct Footing {
    stack: Stack,
    /// `M ε`.
    errors: Vec<f64>,
    /// `A`: the sensitivities that are taken out, turned so that `EᵀA = I`.
    removed: Mat<f64>,
    /// `E`: the same, weighed by the inverse covariance of the outputs' noise.
    weights: Mat<f64>,
    /// `M Ψ`.
    uncertain: Mat<f64>,
    colour: Colour,
    /// What fitting has made the residuals' variance smaller by.
    inflation: f64,
}

impl Footing {
    /// Of residuals, zero where `missing`, with the sensitivities taken out of them (a constant besides) and those of
    /// parameters that are uncertain, a standard deviation each.
    ///
    /// # Errors
    /// [`IdentError::Decomposition`].
    pub(super) fn new(
        stack: Stack,
        errors: &[f64],
        missing: &[bool],
        removed: &[Vec<f64>],
        uncertain: &[Vec<f64>],
        noise_covariance: &Mat<f64>,
    ) -> Result<Self, IdentError> {
        let constant = |output: usize| {
            let mut column = vec![0.0; stack.rows()];
            for range in (0..stack.lengths().len()).map(|m| stack.range(m, output)) {
                range.for_each(|row| column[row] = f64::from(u8::from(!missing[row])));
            }
            column
        };
        let mut columns: Vec<Vec<f64>> = (0..stack.outputs()).map(constant).collect();
        columns.extend_from_slice(removed);
        let whiten = scaled_inverse_root(noise_covariance)?;
        let removed = orthonormal(&columns, &stack, &whiten)?;
        let weights = weigh(&removed, &stack, &(&whiten * whiten.transpose()));
        let cleared = |column: &[f64]| -> Vec<f64> {
            let column = Mat::from_fn(column.len(), 1, |i, _| column[i]);
            (&column - &removed * (weights.transpose() * &column)).col_as_slice(0).to_vec()
        };
        let errors = masked(cleared(errors), missing);
        let uncertain: Vec<Vec<f64>> = uncertain.iter().map(|column| cleared(column)).collect();
        let rows = missing.iter().filter(|m| !**m).count() as f64;
        let left = rows - removed.ncols() as f64;
        if left < 1.0 {
            return Err(IdentError::TooFewSamples { samples: rows as usize, parameters: removed.ncols() });
        }
        Ok(Footing {
            colour: Colour::of(&by_instants(&stack, &errors, missing), stack.outputs()),
            uncertain: Mat::from_fn(stack.rows(), uncertain.len(), |i, k| uncertain[k][i]),
            inflation: rows / left,
            stack,
            errors,
            removed,
            weights,
        })
    }

    /// `S_k = Σ_t ε(t) u(t − k)` for k = −M … M with their covariance, of one output whose samples `there` tells.
    ///
    /// # Errors
    /// Those of the correlations.
    pub(super) fn sums(&self, output: usize, there: &Series, u: &Series, lags: usize) -> Result<Sums, IdentError> {
        let correlate = |column: &[f64]| products(u, &Series::raw(&self.stack.series(column, output)), lags);
        let each = |m: &Mat<f64>| -> Result<Mat<f64>, IdentError> {
            let columns: Vec<Vec<f64>> =
                (0..m.ncols()).map(|k| correlate(m.col_as_slice(k))).collect::<Result<_, _>>()?;
            Ok(Mat::from_fn(2 * lags + 1, m.ncols(), |i, k| columns[k][i]))
        };
        let width = 2 * lags + 1 + self.removed.ncols();
        let work = self.stack.rows().saturating_mul(width * width);
        let (covariance, z, k) = if work <= AFFORDABLE && width <= MOST_COLUMNS {
            self.written_out(output, there, u, lags)
        } else {
            self.stationary(output, there, u, lags)?
        };
        Ok(Sums {
            values: correlate(&self.errors)?,
            covariance,
            z,
            b: each(&self.removed)?,
            k,
            j: each(&self.uncertain)?,
        })
    }

    /// `UᵀRU`, `UᵀRE` and `EᵀRE`.
    fn written_out(&self, output: usize, there: &Series, u: &Series, lags: usize) -> (Covariance, Mat<f64>, Mat<f64>) {
        let (count, r, p) = (2 * lags + 1, self.removed.ncols(), self.stack.outputs());
        let width = count + r;
        let mut sandwich = Sandwich::of_rows(&self.colour, width);
        let mut rows = vec![0.0; p * width];
        for (m, input) in u.parts.iter().enumerate() {
            for t in 0..input.len() {
                rows.fill(0.0);
                if there.is_there(m, t) {
                    let row = &mut rows[output * width..][..count];
                    // Column i holds u(t + M − i).
                    for (i, slot) in row.iter_mut().enumerate() {
                        *slot = (t + lags).checked_sub(i).and_then(|s| input.get(s)).copied().unwrap_or(0.0);
                    }
                }
                for i in 0..p {
                    let at = self.stack.range(m, i).start + t;
                    let row = &mut rows[i * width + count..][..r];
                    row.iter_mut().enumerate().for_each(|(k, slot)| *slot = self.weights[(at, k)]);
                }
                sandwich.push(&rows);
            }
            sandwich.finish_series();
        }
        let whole = faer::Scale(self.inflation) * sandwich.covariance();
        let part = |i: usize, j: usize, rows: usize, columns: usize| whole.submatrix(i, j, rows, columns).to_owned();
        (Covariance::Dense(part(0, 0, count, count)), part(0, count, count, r), part(count, count, r, r))
    }

    /// The same with lags that all count as full as the first, and each sum scaled to the products it has.
    fn stationary(
        &self,
        output: usize,
        there: &Series,
        u: &Series,
        lags: usize,
    ) -> Result<(Covariance, Mat<f64>, Mat<f64>), IdentError> {
        let rows = u.parts.iter().map(Vec::len).sum::<usize>();
        let longest = u.parts.iter().map(Vec::len).max().unwrap_or(1).max(1);
        let moments = self.colour.autocovariances((longest - 1).min(rows / 2));
        let reach = moments.len() - 1;
        let (ru, pairs) = (products(u, u, reach + 2 * lags)?, pair_counts(there, there, reach)?);
        // E v_i(t) v_j(t − τ) for τ = −reach … reach.
        let kernel = |j: usize| -> Vec<f64> {
            let at = |i: usize| match i.checked_sub(reach) {
                Some(lag) => moments[lag][(output, j)],
                None => moments[reach - i][(j, output)],
            };
            (0..=2 * reach).map(|i| self.inflation * at(i)).collect()
        };
        let own: Vec<f64> = kernel(output).iter().zip(&pairs).map(|(r, n)| r * n / rows as f64).collect();
        let middle = reach + 2 * lags;
        let covariance = |l: usize| crate::gram::dot(&own, &ru[middle + l - reach..=middle + l + reach]);
        let z = self.weights_through(&kernel, u, lags, reach)?;
        let mut sandwich = Sandwich::of_rows(&self.colour, z.ncols());
        let (p, r) = (self.stack.outputs(), z.ncols());
        let mut row = vec![0.0; p * r];
        for (m, length) in self.stack.lengths().iter().enumerate() {
            for t in 0..*length {
                for (slot, (i, k)) in row.iter_mut().zip((0..p).flat_map(|i| (0..r).map(move |k| (i, k)))) {
                    *slot = self.weights[(self.stack.range(m, i).start + t, k)];
                }
                sandwich.push(&row);
            }
            sandwich.finish_series();
        }
        // An input of any lag meets an output that is there as often as the input itself is.
        let counts = pair_counts(u, there, lags)?;
        let all = counts[lags].max(1.0);
        let scales = counts.iter().map(|n| (n / all).sqrt().max(f64::MIN_POSITIVE.sqrt())).collect();
        let covariances = (0..=2 * lags).map(covariance).collect();
        Ok((Covariance::Toeplitz { covariances, scales }, z, faer::Scale(self.inflation) * sandwich.covariance()))
    }

    /// `UᵀRE`: the correlations of u with E, through the autocovariance of the errors.
    fn weights_through(
        &self,
        kernel: &impl Fn(usize) -> Vec<f64>,
        u: &Series,
        lags: usize,
        reach: usize,
    ) -> Result<Mat<f64>, IdentError> {
        let count = 2 * lags + 1;
        let mut z = Mat::zeros(count, self.weights.ncols());
        for j in 0..self.stack.outputs() {
            let mut kernel = kernel(j);
            kernel.reverse();
            for k in 0..self.weights.ncols() {
                let e = Series::raw(&self.stack.series(self.weights.col_as_slice(k), j));
                let cross = products(u, &e, lags + reach)?;
                // Σ_τ r(τ) c(l − τ), with c from −M − reach on.
                (0..count).for_each(|l| z[(l, k)] += crate::gram::dot(&kernel, &cross[l..=l + 2 * reach]));
            }
        }
        Ok(z)
    }
}

fn masked(mut column: Vec<f64>, missing: &[bool]) -> Vec<f64> {
    column.iter_mut().zip(missing).filter(|(_, missing)| **missing).for_each(|(v, _)| *v = 0.0);
    column
}

/// Every output at an instant, instant by instant, of each experiment; NaN where missing.
fn by_instants(stack: &Stack, column: &[f64], missing: &[bool]) -> Vec<Vec<f64>> {
    let p = stack.outputs();
    let value = |m: usize, t: usize, i: usize| {
        let row = stack.range(m, i).start + t;
        if missing[row] { f64::NAN } else { column[row] }
    };
    let series = |m: usize| (0..stack.lengths()[m] * p).map(|at| value(m, at / p, at % p)).collect();
    (0..stack.lengths().len()).map(series).collect()
}

/// `W` with `W Wᵀ` the inverse of a covariance of mean variance one.
fn scaled_inverse_root(covariance: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    let n = covariance.nrows();
    let mean = (0..n).map(|i| covariance[(i, i)]).sum::<f64>() / n as f64;
    if !(mean.is_normal() && mean > 0.0) {
        return Ok(Mat::identity(n, n));
    }
    inverse_root(&Mat::from_fn(n, n, |i, j| covariance[(i, j)] / mean), f64::EPSILON.sqrt())
}

/// `weight` times the outputs of every instant.
fn weigh(columns: &Mat<f64>, stack: &Stack, weight: &Mat<f64>) -> Mat<f64> {
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

/// The span of columns, orthonormal once an instant's outputs are multiplied by `whitenᵀ`; columns of every size count alike.
fn orthonormal(columns: &[Vec<f64>], stack: &Stack, whiten: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    let norm = |c: &Vec<f64>| c.iter().map(|v| v * v).sum::<f64>().sqrt();
    let moving: Vec<(&Vec<f64>, f64)> = columns.iter().map(|c| (c, norm(c))).filter(|(_, n)| n.is_normal()).collect();
    let unit = Mat::from_fn(stack.rows(), moving.len(), |i, k| moving[k].0[i] / moving[k].1);
    let white = weigh(&unit, stack, &square_root_of(whiten)?);
    let mut triangle = Triangle::for_rows(moving.len(), stack.rows());
    triangle.push_columns(stack.rows(), |j, start, slot| {
        slot.copy_from_slice(&white.col_as_slice(j)[start..start + slot.len()]);
    });
    let svd = triangle.finish().svd().map_err(|_| IdentError::Decomposition { what: "singular value" })?;
    let values = svd.S().column_vector();
    let rank = (0..values.nrows()).filter(|k| values[*k] > UNSEEN * values[0]).count();
    let turn = Mat::from_fn(moving.len(), rank, |i, k| svd.V()[(i, k)] / values[k]);
    Ok(unit * turn)
}

/// The symmetric root of `W Wᵀ`: as good as `Wᵀ`, and square where that is not.
fn square_root_of(whiten: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    let svd = whiten.thin_svd().map_err(|_| IdentError::Decomposition { what: "singular value" })?;
    let values = svd.S().column_vector();
    Ok(Mat::from_fn(whiten.nrows(), whiten.nrows(), |i, j| {
        (0..values.nrows()).map(|k| svd.U()[(i, k)] * values[k] * svd.U()[(j, k)]).sum()
    }))
}
