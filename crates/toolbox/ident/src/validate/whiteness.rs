//! The correlation of residuals with their own past.

use faer::Mat;
use numerics::vector::dot;

use super::JointTest;
use super::linearised_residuals::LinearisedResiduals;
use super::quadratic::{Covariance, HELD, STILL, Sums};
use super::series::{Series, later_products, pair_counts};
use super::span::{Block, square_root_of, weigh};
use crate::IdentError;
use crate::colour::variance_course;
use crate::dense::covariance_root::inverse_root;

/// Residuals below this part of what they were before their mean was taken off are a constant and rounding.
const VARYING: f64 = 1e-12;
/// Most sums of which the covariance that blocks leave is written out; of more, regions are too wide by what these
/// take.
const MOST_SUMS: usize = 500;

/// The sums `S_ijk = Σ_t ε_i(t) ε_j(t − k)` for k = 1 … M of residuals in units of their deviations, and the covariance
/// they have if the errors are white.
///
/// Each is a sum of the errors with what the past determines, so what an estimate takes out of the errors, or its own
/// errors add to them, changes it as it changes a sum with an input; in `ε_j(t − k)` such changes are of second order.
/// The covariance of the errors themselves is that of independent ones, `E S_ijk S_i'j'k = n_k Λ_ii' Λ_jj'`. Where the
/// errors change in size over time, it has the mean of `ε_i²(t) ε_j²(t − k)` in place of `Λ_ii Λ_jj`.
///
/// # Source
/// Lobato, Nankervis & Savin, *Testing for autocorrelation using a modified Box–Pierce Q test*, Int. Econ. Rev. 42,
/// 2001.
pub(super) struct PastSums {
    outputs: usize,
    /// Pairs behind the sums at the lags 0 … M, outputs × outputs.
    pairs: Vec<Mat<f64>>,
    /// Of the residuals at the same instant.
    correlation: Mat<f64>,
    inflation: f64,
    /// Of every sum, lag by lag and row by row of `S_k`: itself, then `UᵀRE`, `UᵀA` and `UᵀMΨ`.
    columns: Mat<f64>,
    taken: usize,
    /// `EᵀRE`.
    k: Mat<f64>,
    /// Change of the covariance by the blocks.
    blocks: Option<Mat<f64>>,
    /// The deviation of each sum over that of independent errors, by which all columns are divided.
    spread: Vec<f64>,
}

/// Of one output: correlations at the lags 0 … M, their deviations, and the test. Where an estimate leaves next to
/// nothing, what is of second order in its errors is no longer small beside it: deviations are no less than with
/// [`HELD`].
pub(super) struct OwnPast {
    pub(super) auto: Vec<f64>,
    pub(super) deviations: Vec<f64>,
    pub(super) joint: JointTest,
}

impl PastSums {
    /// Of linearised residuals, at the samples of each output that are there, up to a lag.
    ///
    /// # Errors
    /// [`IdentError::Constant`] where a residual does not vary; those of the correlations.
    pub(super) fn new(linearised: &LinearisedResiduals, outputs: &[Series], lags: usize) -> Result<Self, IdentError> {
        let sizes: Vec<f64> = (0..outputs.len()).map(|i| size(linearised, i, &outputs[i])).collect::<Result<_, _>>()?;
        let units = Units { linearised, past: unit_series(linearised, &sizes), sizes, lags };
        let pairs = all_pairs(outputs, lags)?;
        let correlation = units.at_once(&pairs[0])?;
        let covariance =
            Mat::from_fn(outputs.len(), outputs.len(), |i, j| units.sizes[i] * correlation[(i, j)] * units.sizes[j]);
        let mut through = weigh(&linearised.weights, &linearised.stack, &covariance);
        for k in 0..through.ncols() {
            units.mask(through.col_as_slice_mut(k), outputs);
        }
        let of = |m: &Mat<f64>| (0..m.ncols()).map(|k| units.sums(m.col_as_slice(k))).collect::<Result<Vec<_>, _>>();
        let parts = [
            vec![units.sums(&linearised.errors)?],
            of(&through)?,
            of(&linearised.removed)?,
            of(&linearised.uncertain)?,
        ];
        let columns = parts.concat();
        let sums = columns[0].len();
        let mut columns = Mat::from_fn(sums, columns.len(), |i, c| columns[c][i]);
        let mut blocks = None;
        if !linearised.blocks.is_empty() && sums <= MOST_SUMS {
            let (change, crossing) = units.change_by_blocks(outputs, &covariance, &through);
            let mut with_errors = columns.subcols_mut(1, through.ncols());
            with_errors += crossing;
            blocks = Some(change);
        }
        let spread = units.spread(outputs, &pairs)?;
        for (i, spread) in spread.iter().enumerate().filter(|(_, spread)| **spread != 1.0) {
            columns.row_mut(i).iter_mut().for_each(|v| *v /= spread);
            if let Some(change) = &mut blocks {
                change.row_mut(i).iter_mut().for_each(|v| *v /= spread);
                change.col_mut(i).iter_mut().for_each(|v| *v /= spread);
            }
        }
        Ok(PastSums {
            outputs: outputs.len(),
            pairs,
            correlation,
            inflation: linearised.inflation,
            columns,
            taken: linearised.removed.ncols(),
            k: linearised.weights.transpose() * &through,
            blocks,
            spread,
        })
    }

    /// Every output with the past of every output.
    ///
    /// # Errors
    /// [`IdentError::Constant`] where the residuals of an output depend on those of others.
    pub(super) fn joint(&self) -> Result<JointTest, IdentError> {
        let whiten = inverse_root(&self.correlation, STILL)?;
        if whiten.ncols() < self.outputs {
            return Err(IdentError::Constant { what: "the residual" });
        }
        // The symmetric root leaves outputs that never meet where they are.
        let turned = Turned { outputs: (0..self.outputs).collect(), turn: square_root_of(&whiten)? };
        let sums = turned.sums(self);
        sums.test(0, sums.values.len())
    }

    /// An output with its own past.
    pub(super) fn own(&self, output: usize) -> Result<OwnPast, IdentError> {
        let turned = Turned { outputs: vec![output], turn: Mat::identity(1, 1) };
        let (kept, sums) = (turned.kept(self), turned.sums(self));
        let n = self.pairs[0][(output, output)];
        let mut past = OwnPast {
            auto: vec![f64::NAN; self.pairs.len()],
            deviations: vec![f64::NAN; self.pairs.len()],
            joint: sums.test(0, sums.values.len())?,
        };
        (past.auto[0], past.deviations[0]) = (1.0, 0.0);
        for ((lag, ..), variance) in kept.into_iter().zip(sums.variances()) {
            let pairs = self.pairs[lag][(output, output)];
            let place = self.place(lag, output, output);
            past.auto[lag] = self.spread[place] * self.columns[(place, 0)] / n;
            let deviation = (variance.max(HELD) * self.inflation * pairs / (n * (n + 2.0))).sqrt();
            past.deviations[lag] = self.spread[place] * deviation;
        }
        Ok(past)
    }

    fn place(&self, lag: usize, i: usize, j: usize) -> usize {
        ((lag - 1) * self.outputs + i) * self.outputs + j
    }
}

/// Some outputs, turned so that their residuals are independent and of variance one.
struct Turned {
    outputs: Vec<usize>,
    turn: Mat<f64>,
}

impl Turned {
    /// The sums that have pairs: lag, and the two outputs.
    fn kept(&self, past: &PastSums) -> Vec<(usize, usize, usize)> {
        let p = self.outputs.len();
        let there = |(lag, a, b): &(usize, usize, usize)| past.pairs[*lag][(self.outputs[*a], self.outputs[*b])] > 0.0;
        let all = (1..past.pairs.len()).flat_map(|lag| (0..p * p).map(move |i| (lag, i / p, i % p)));
        all.filter(there).collect()
    }

    /// The sums over the root of their pairs, in units of what known parameters would leave them.
    fn sums(&self, past: &PastSums) -> Sums {
        let (kept, r) = (self.kept(past), past.taken);
        let columns = self.apply(past, &kept, &past.columns);
        let n = past.pairs[0][(self.outputs[0], self.outputs[0])];
        let part = |from: usize, count: usize| columns.subcols(from, count).to_owned();
        let uncertain = columns.ncols() - 1 - 2 * r;
        let change = past.blocks.as_ref().map(|change| {
            let half = self.apply(past, &kept, change);
            self.apply(past, &kept, &half.transpose().to_owned())
        });
        let scale = ((n + 2.0) / (n * past.inflation)).sqrt();
        Sums {
            values: columns.col_as_slice(0).iter().map(|v| v * scale).collect(),
            covariance: Covariance::Identity,
            change,
            z: part(1, r),
            b: part(1 + r, r),
            k: past.k.clone(),
            j: faer::Scale(past.inflation.sqrt().recip()) * part(1 + 2 * r, uncertain),
        }
    }

    /// `Tᵀ S_k T/√n_k`, column by column.
    fn apply(&self, past: &PastSums, kept: &[(usize, usize, usize)], columns: &Mat<f64>) -> Mat<f64> {
        let places = || self.outputs.iter().enumerate();
        let pairs = || places().flat_map(|i| places().map(move |j| (i, j)));
        let count = |lag: usize| {
            let there = || pairs().map(|((_, i), (_, j))| past.pairs[lag][(*i, *j)]).filter(|n| *n > 0.0);
            there().sum::<f64>() / there().count().max(1) as f64
        };
        let roots: Vec<f64> = (0..past.pairs.len()).map(|lag| count(lag).sqrt()).collect();
        Mat::from_fn(kept.len(), columns.ncols(), |row, column| {
            let (lag, a, b) = kept[row];
            let turned = |((x, i), (y, j)): ((usize, &usize), (usize, &usize))| {
                self.turn[(x, a)] * self.turn[(y, b)] * columns[(past.place(lag, *i, *j), column)]
            };
            pairs().map(turned).sum::<f64>() / roots[lag]
        })
    }
}

/// Residuals in units of their deviations.
struct Units<'a> {
    linearised: &'a LinearisedResiduals,
    sizes: Vec<f64>,
    /// Of each output.
    past: Vec<Series>,
    lags: usize,
}

impl Units<'_> {
    /// `Σ_t x_i(t) ε_j(t − k)` of a column, lag by lag and row by row.
    fn sums(&self, column: &[f64]) -> Result<Vec<f64>, IdentError> {
        let p = self.past.len();
        let mut sums = vec![0.0; p * p * self.lags];
        for i in 0..p {
            let x = Series::raw(&self.linearised.stack.series(column, i));
            for (j, past) in self.past.iter().enumerate() {
                let found = later_products(past, &x, self.lags)?;
                let places = sums.iter_mut().skip(i * p + j).step_by(p * p);
                places.zip(&found[1..]).for_each(|(slot, v)| *slot = v / self.sizes[i]);
            }
        }
        Ok(sums)
    }

    /// The correlation of the outputs at the same instant.
    fn at_once(&self, pairs: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
        let p = self.past.len();
        let mut found = Mat::zeros(p, p);
        for (i, j) in (0..p).flat_map(|i| (0..p).map(move |j| (i, j))) {
            found[(i, j)] = later_products(&self.past[i], &self.past[j], 0)?[0] / pairs[(i, j)].max(1.0);
        }
        Ok(found)
    }

    /// The deviation of each sum over that of independent errors, `√(mean of ε_i²(t) ε_j²(t − k))`: one where no output
    /// changes in size.
    fn spread(&self, outputs: &[Series], pairs: &[Mat<f64>]) -> Result<Vec<f64>, IdentError> {
        let p = self.past.len();
        let mut spread = vec![1.0; p * p * self.lags];
        let known = |(past, output): (&Series, &Series)| {
            let value = |m: usize, t: usize, v: f64| if output.is_there(m, t) { v } else { f64::NAN };
            let part = |(m, x): (usize, &Vec<f64>)| x.iter().enumerate().map(|(t, v)| value(m, t, *v)).collect();
            past.parts.iter().enumerate().map(part).collect::<Vec<Vec<f64>>>()
        };
        if !self.past.iter().zip(outputs).any(|both| variance_course::changes(&known(both))) {
            return Ok(spread);
        }
        let squared = |past: &Series| {
            let parts: Vec<Vec<f64>> = past.parts.iter().map(|x| x.iter().map(|v| v * v).collect()).collect();
            Series::raw(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>())
        };
        let squares: Vec<Series> = self.past.iter().map(squared).collect();
        for (i, j) in (0..p).flat_map(|i| (0..p).map(move |j| (i, j))) {
            let found = later_products(&squares[j], &squares[i], self.lags)?;
            for lag in 1..=self.lags {
                let mean = found[lag] / pairs[lag][(i, j)].max(1.0);
                if mean > 0.0 {
                    spread[((lag - 1) * p + i) * p + j] = mean.sqrt();
                }
            }
        }
        Ok(spread)
    }

    /// Zero where an output is not there.
    fn mask(&self, column: &mut [f64], outputs: &[Series]) {
        let lengths = self.linearised.stack.lengths();
        for (m, i) in (0..lengths.len()).flat_map(|m| (0..outputs.len()).map(move |i| (m, i))) {
            let part = &mut column[self.linearised.stack.range(m, i)];
            part.iter_mut().enumerate().filter(|(t, _)| !outputs[i].is_there(m, *t)).for_each(|(_, v)| *v = 0.0);
        }
    }

    /// `Σ (−Z Bᵀ − B Zᵀ + B K Bᵀ)` over the blocks, and `−Σ B EᵀR E₀`, which makes `UᵀRE₀` that of `U` cleared of them,
    /// from `R E₀`.
    fn change_by_blocks(
        &self,
        outputs: &[Series],
        covariance: &Mat<f64>,
        through_all: &Mat<f64>,
    ) -> (Mat<f64>, Mat<f64>) {
        let sums = self.past.len().pow(2) * self.lags;
        let (mut change, mut crossing) = (Mat::<f64>::zeros(sums, sums), Mat::zeros(sums, through_all.ncols()));
        for (m, block) in self.linearised.blocks.iter().enumerate() {
            let through = self.through(m, block, outputs, covariance);
            let (z, b) = (self.block_sums(m, &through), self.block_sums(m, &block.removed));
            let k = block.weights.transpose() * &through;
            let half = &b * (faer::Scale(0.5) * k) - z;
            let product = half * b.transpose();
            change += &product + product.transpose();
            let rows = through_all.subrows(block.rows.start, block.rows.len());
            crossing -= b * (block.weights.transpose() * rows);
        }
        (change, crossing)
    }

    /// `R E` of a block.
    fn through(&self, m: usize, block: &Block, outputs: &[Series], covariance: &Mat<f64>) -> Mat<f64> {
        let length = self.linearised.stack.lengths()[m];
        Mat::from_fn(block.weights.nrows(), block.weights.ncols(), |row, q| {
            let (i, t) = (row / length, row % length);
            let mixed = (0..outputs.len()).map(|j| covariance[(i, j)] * block.weights[(j * length + t, q)]);
            if outputs[i].is_there(m, t) { mixed.sum() } else { 0.0 }
        })
    }

    /// [`Units::sums`] of columns that show in one experiment.
    fn block_sums(&self, m: usize, columns: &Mat<f64>) -> Mat<f64> {
        let (p, length) = (self.past.len(), self.linearised.stack.lengths()[m]);
        Mat::from_fn(p * p * self.lags, columns.ncols(), |place, q| {
            let (lag, i, j) = (place / (p * p) + 1, place / p % p, place % p);
            let x = &columns.col_as_slice(q)[i * length..(i + 1) * length];
            let later = x.get(lag..).unwrap_or_default();
            dot(later, &self.past[j].parts[m][..later.len()]) / self.sizes[i]
        })
    }
}

/// The root of the mean square of a residual.
fn size(linearised: &LinearisedResiduals, output: usize, raw: &Series) -> Result<f64, IdentError> {
    let energy = |part: &[f64]| part.iter().map(|v| v * v).sum::<f64>();
    let left: f64 = linearised.stack.series(&linearised.errors, output).into_iter().map(energy).sum();
    let before = raw.energy() + raw.present * raw.mean.powi(2);
    let size = (left / raw.present.max(1.0)).sqrt();
    if !size.is_normal() || left <= VARYING * VARYING * before {
        return Err(IdentError::Constant { what: "the residual" });
    }
    Ok(size)
}

fn unit_series(linearised: &LinearisedResiduals, sizes: &[f64]) -> Vec<Series> {
    let of = |(i, size): (usize, &f64)| {
        let scaled = |part: &[f64]| part.iter().map(|v| v / size).collect::<Vec<_>>();
        let parts: Vec<Vec<f64>> = linearised.stack.series(&linearised.errors, i).into_iter().map(scaled).collect();
        Series::raw(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>())
    };
    sizes.iter().enumerate().map(of).collect()
}

/// How many `t` there are with output i at `t` and output j at `t − k`, for k = 0 … M.
fn all_pairs(outputs: &[Series], lags: usize) -> Result<Vec<Mat<f64>>, IdentError> {
    let p = outputs.len();
    let mut pairs = vec![Mat::zeros(p, p); lags + 1];
    for (i, j) in (0..p).flat_map(|i| (0..p).map(move |j| (i, j))) {
        let found = pair_counts(&outputs[j], &outputs[i], lags)?;
        pairs.iter_mut().zip(&found[lags..]).for_each(|(slot, n)| slot[(i, j)] = *n);
    }
    Ok(pairs)
}
