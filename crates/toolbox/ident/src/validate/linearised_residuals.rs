//! Effect of an estimate on residuals: the part it took out of them, and the part its errors add.

use std::sync::OnceLock;

use faer::Mat;
use numerics::vector::dot;

use super::quadratic::{Covariance, Sums};
use super::sensitivity::Stack;
use super::series::{Series, pair_counts, products};
use super::span::{Block, orthonormal, scaled_inverse_root, weigh};
use crate::IdentError;
use crate::colour::{Colour, Sandwich};

/// Multiplications spent on covariances that are exact to the ends of the record; beyond, the lags count as stationary.
const AFFORDABLE: usize = 500_000_000;
/// Most lags, and directions taken out, of such a covariance.
const MOST_COLUMNS: usize = 500;
/// So many entries of initial states are treated as any other direction that is taken out.
const FEW_STATES: usize = 60;
/// Part of a column that has to remain after clearing, so that it is more than its combination of the others.
const LEFT: f64 = 1e-7;

/// Residuals of outputs that are there at the same instants, in the first order of what the estimate did to them:
/// `ε = M v − Ψ δ` with errors `v` of covariance `R`, `M = I − A Eᵀ`, and `δ` of covariance one.
pub(super) struct LinearisedResiduals {
    pub(super) stack: Stack,
    /// `M ε`.
    pub(super) errors: Vec<f64>,
    /// `A`: the sensitivities that are taken out, turned so that `EᵀA = I`.
    pub(super) removed: Mat<f64>,
    /// `E`: the same, weighed by the inverse covariance of the outputs' noise.
    pub(super) weights: Mat<f64>,
    /// Directions that are taken out of each experiment on its own: `AᵀE = 0` between these and the others. None where
    /// all is in `removed`.
    pub(super) blocks: Vec<Block>,
    /// `M Ψ`.
    pub(super) uncertain: Mat<f64>,
    colour: Colour,
    /// `EᵀRE`, which serves every pair of an output and an input.
    covariance_of_weights: OnceLock<Mat<f64>>,
    /// Factor by which fitting has made the residuals' variance smaller.
    pub(super) inflation: f64,
}

/// Columns of the stack that residuals move along.
#[derive(Default)]
pub(super) struct Columns {
    /// Taken out, as what the estimate had taken out or the initial states: of each experiment its rows × directions.
    pub(super) states: Vec<Mat<f64>>,
    /// Taken out of all experiments together.
    pub(super) removed: Vec<Vec<f64>>,
    /// Directions of parameters that are uncertain, a standard deviation each.
    pub(super) uncertain: Vec<Vec<f64>>,
}

impl Columns {
    /// Those that hold one output alone.
    pub(super) fn alone(&self, stack: &Stack, output: usize) -> Columns {
        let each = |all: &[Vec<f64>]| all.iter().map(|c| stack.alone(c, output)).collect();
        let rows = |(m, s): (usize, &Mat<f64>)| {
            let length = stack.lengths()[m];
            s.submatrix(output * length, 0, length, s.ncols()).to_owned()
        };
        Columns {
            states: self.states.iter().enumerate().map(rows).collect(),
            removed: each(&self.removed),
            uncertain: each(&self.uncertain),
        }
    }

    /// The initial states among the columns that are taken out of all experiments.
    fn states_in_full(&self, stack: &Stack) -> Vec<Vec<f64>> {
        let full = |m: usize, k: usize| {
            let mut column = vec![0.0; stack.rows()];
            column[stack.rows_of(m)].copy_from_slice(self.states[m].col_as_slice(k));
            column
        };
        (0..self.states.len()).flat_map(|m| (0..self.states[m].ncols()).map(move |k| full(m, k))).collect()
    }
}

impl LinearisedResiduals {
    /// Of residuals, zero where `missing`, with what is taken out of them (a constant besides) and what is uncertain.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] where nothing is left of the residuals; [`IdentError::Decomposition`].
    pub(super) fn new(
        stack: Stack,
        errors: &[f64],
        missing: &[bool],
        columns: &Columns,
        noise_covariance: &Mat<f64>,
    ) -> Result<Self, IdentError> {
        Self::with_few_states(stack, errors, missing, columns, noise_covariance, FEW_STATES)
    }

    fn with_few_states(
        stack: Stack,
        errors: &[f64],
        missing: &[bool],
        columns: &Columns,
        noise_covariance: &Mat<f64>,
        few_states: usize,
    ) -> Result<Self, IdentError> {
        let whiten = scaled_inverse_root(noise_covariance)?;
        let mut all: Vec<Vec<f64>> = (0..stack.outputs()).map(|i| constant(&stack, i, missing)).collect();
        all.extend_from_slice(&columns.removed);
        let mut blocks = Vec::new();
        if columns.states.iter().map(Mat::ncols).sum::<usize>() <= few_states {
            all.extend(columns.states_in_full(&stack));
        } else {
            // The experiments' states are orthogonal: taken out one experiment at a time they cost no more than one of
            // all.
            blocks = Block::each(&columns.states, &stack, &whiten)?;
            all.retain_mut(|column| is_left(column, &blocks));
        }
        let removed = orthonormal(&all, &stack, &whiten)?;
        let weights = weigh(&removed, &stack, &(&whiten * whiten.transpose()));
        let cleared = |column: &[f64]| -> Vec<f64> {
            let mut column = column.to_vec();
            blocks.iter().for_each(|block| block.clear(&mut column));
            let column = Mat::from_fn(column.len(), 1, |i, _| column[i]);
            (&column - &removed * (weights.transpose() * &column)).col_as_slice(0).to_vec()
        };
        let errors = masked(cleared(errors), missing);
        let uncertain: Vec<Vec<f64>> = columns.uncertain.iter().map(|column| cleared(column)).collect();
        let rows = missing.iter().filter(|m| !**m).count();
        let directions = removed.ncols() + blocks.iter().map(|block| block.removed.ncols()).sum::<usize>();
        if rows <= directions {
            return Err(IdentError::TooFewSamples { samples: rows, parameters: directions });
        }
        Ok(LinearisedResiduals {
            colour: Colour::of(&by_instants(&stack, &errors, missing), stack.outputs()),
            covariance_of_weights: OnceLock::new(),
            uncertain: Mat::from_fn(stack.rows(), uncertain.len(), |i, k| uncertain[k][i]),
            inflation: rows as f64 / (rows - directions) as f64,
            stack,
            errors,
            removed,
            weights,
            blocks,
        })
    }

    /// `S_k = Σ_t ε(t) u(t − k)` for k = −M … M with their covariance, of one output whose samples are marked by
    /// `there`.
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
        let sides = if self.blocks.is_empty() { 1 } else { 2 };
        let width = sides * (2 * lags + 1) + self.removed.ncols();
        let work = self.stack.rows().saturating_mul(width * width);
        let parts = if work <= AFFORDABLE && width <= MOST_COLUMNS {
            self.written_out(output, there, u, lags)
        } else {
            self.stationary(output, there, u, lags)?
        };
        Ok(Sums {
            values: correlate(&self.errors)?,
            covariance: parts.covariance,
            change: parts.change,
            z: parts.z,
            b: each(&self.removed)?,
            k: parts.k,
            j: each(&self.uncertain)?,
        })
    }

    /// `UᵀRU`, what clearing `U` of the blocks changes of it, `UᵀRE` with `U` cleared, and `EᵀRE`.
    fn written_out(&self, output: usize, there: &Series, u: &Series, lags: usize) -> Parts {
        let (count, r, p) = (2 * lags + 1, self.removed.ncols(), self.stack.outputs());
        // Columns of U cleared, E, and with blocks those of U as they are.
        let width = count + r + if self.blocks.is_empty() { 0 } else { count };
        let mut sandwich = Sandwich::of_rows(&self.colour, width);
        let mut rows = vec![0.0; p * width];
        for (m, input) in u.parts.iter().enumerate() {
            let along = self.lagged_along_block(m, output, there, u, lags);
            for t in work::checked(0..input.len()) {
                rows.fill(0.0);
                if there.is_there(m, t) {
                    let row = &mut rows[output * width..][..width];
                    lagged(&mut row[..count], input, t, lags);
                    let (cleared, rest) = row.split_at_mut(count + r);
                    rest.copy_from_slice(&cleared[..rest.len()]);
                }
                for i in 0..p {
                    let at = self.stack.range(m, i).start + t;
                    let (sums, row) = rows[i * width..][..count + r].split_at_mut(count);
                    row.iter_mut().enumerate().for_each(|(k, slot)| *slot = self.weights[(at, k)]);
                    for (q, along) in along.iter().enumerate() {
                        let weight = self.blocks[m].weights[(at - self.blocks[m].rows.start, q)];
                        sums.iter_mut().zip(along).for_each(|(slot, along)| *slot -= weight * along);
                    }
                }
                sandwich.push(&rows);
            }
            sandwich.finish_series();
        }
        let all = faer::Scale(self.inflation) * sandwich.covariance();
        let part = |i: usize, j: usize, rows: usize, columns: usize| all.submatrix(i, j, rows, columns).to_owned();
        let (cleared, z, k) = (part(0, 0, count, count), part(0, count, count, r), part(count, count, r, r));
        if self.blocks.is_empty() {
            return Parts { covariance: Covariance::Dense(cleared), change: None, z, k };
        }
        let whole = part(count + r, count + r, count, count);
        Parts { change: Some(cleared - &whole), covariance: Covariance::Dense(whole), z, k }
    }

    /// `AᵀU` of an experiment's block, a direction after the other.
    fn lagged_along_block(&self, m: usize, output: usize, there: &Series, u: &Series, lags: usize) -> Vec<Vec<f64>> {
        let Some(block) = self.blocks.get(m) else { return Vec::new() };
        let (count, first) = (2 * lags + 1, self.stack.range(m, output).start - block.rows.start);
        let mut along = vec![vec![0.0; count]; block.removed.ncols()];
        let mut row = vec![0.0; count];
        for t in work::checked(0..u.parts[m].len()).filter(|t| there.is_there(m, *t)) {
            lagged(&mut row, &u.parts[m], t, lags);
            for (q, along) in along.iter_mut().enumerate() {
                let weight = block.removed[(first + t, q)];
                along.iter_mut().zip(&row).for_each(|(slot, v)| *slot += weight * v);
            }
        }
        along
    }

    /// The same with lags that all count as full as the first, and each sum scaled to the products it has. What the
    /// blocks take out is left in, little beside so many samples: regions are too wide by that.
    fn stationary(&self, output: usize, there: &Series, u: &Series, lags: usize) -> Result<Parts, IdentError> {
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
        let covariance = |l: usize| dot(&own, &ru[middle + l - reach..=middle + l + reach]);
        let z = self.weights_through(&kernel, u, lags, reach)?;
        // An input of any lag meets an output that is there as often as the input itself is.
        let counts = pair_counts(u, there, lags)?;
        let all = counts[lags].max(1.0);
        let scales: Vec<f64> = counts.iter().map(|n| (n / all).sqrt()).collect();
        let covariances: Vec<f64> = (0..=2 * lags).map(covariance).collect();
        let covariance = Covariance::Toeplitz { covariances, scales };
        let k = self.covariance_of_weights.get_or_init(|| self.through_weights()).clone();
        Ok(Parts { covariance, change: None, z, k })
    }

    /// `EᵀRE`.
    fn through_weights(&self) -> Mat<f64> {
        let (p, r) = (self.stack.outputs(), self.weights.ncols());
        let mut sandwich = Sandwich::of_rows(&self.colour, r);
        let mut row = vec![0.0; p * r];
        for (m, length) in self.stack.lengths().iter().enumerate() {
            for t in work::checked(0..*length) {
                for (slot, (i, k)) in row.iter_mut().zip((0..p).flat_map(|i| (0..r).map(move |k| (i, k)))) {
                    *slot = self.weights[(self.stack.range(m, i).start + t, k)];
                }
                sandwich.push(&row);
            }
            sandwich.finish_series();
        }
        faer::Scale(self.inflation) * sandwich.covariance()
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
                (0..count).for_each(|l| z[(l, k)] += dot(&kernel, &cross[l..=l + 2 * reach]));
            }
        }
        Ok(z)
    }
}

/// `T`, `C`, `Z` and `K` of [`Sums`].
struct Parts {
    covariance: Covariance,
    change: Option<Mat<f64>>,
    z: Mat<f64>,
    k: Mat<f64>,
}

/// One at the samples of an output that are there.
fn constant(stack: &Stack, output: usize, missing: &[bool]) -> Vec<f64> {
    let mut column = vec![0.0; stack.rows()];
    for range in (0..stack.lengths().len()).map(|m| stack.range(m, output)) {
        range.for_each(|row| column[row] = f64::from(u8::from(!missing[row])));
    }
    column
}

/// Clears a column of blocks. Whether anything is left.
fn is_left(column: &mut [f64], blocks: &[Block]) -> bool {
    let before = dot(column, column);
    blocks.iter().for_each(|block| block.clear(column));
    dot(column, column) > LEFT * LEFT * before
}

/// `u(t + M − i)` at place i.
fn lagged(row: &mut [f64], input: &[f64], t: usize, lags: usize) {
    for (i, slot) in row.iter_mut().enumerate() {
        *slot = (t + lags).checked_sub(i).and_then(|s| input.get(s)).copied().unwrap_or(0.0);
    }
}

fn masked(mut column: Vec<f64>, missing: &[bool]) -> Vec<f64> {
    column.iter_mut().zip(missing).filter(|(_, missing)| **missing).for_each(|(v, _)| *v = 0.0);
    column
}

/// Every output at an instant, instant by instant, of each experiment; NaN where one is missing.
fn by_instants(stack: &Stack, column: &[f64], missing: &[bool]) -> Vec<Vec<f64>> {
    let p = stack.outputs();
    let value = |m: usize, t: usize, i: usize| {
        let row = |i: usize| stack.range(m, i).start + t;
        if (0..p).any(|i| missing[row(i)]) { f64::NAN } else { column[row(i)] }
    };
    let series = |m: usize| (0..stack.lengths()[m] * p).map(|at| value(m, at / p, at % p)).collect();
    (0..stack.lengths().len()).map(series).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use signal::excitation::Random;

    use super::*;
    use crate::validate::whiteness::PastSums;

    /// Stretches of unlike length, two outputs with errors that depend on each other, a gap in both.
    fn linearised(few_states: usize) -> (LinearisedResiduals, Vec<Series>, Series) {
        let mut random = Random::new(4);
        let lengths = vec![40, 3, 25, 60, 30];
        let stack = Stack::new(lengths.clone(), 2);
        let mut normals = |count: usize| (0..count).map(|_| random.normal()).collect::<Vec<_>>();
        let mut errors = normals(stack.rows());
        let mut missing = vec![false; stack.rows()];
        for i in 0..2 {
            (5..9).for_each(|t| missing[stack.range(3, i).start + t] = true);
        }
        let decaying = |length: &usize| {
            Mat::from_fn(2 * length, 2, |row, k| {
                f64::powi([0.9, -0.7][k], (row % length) as i32) + 0.1 * (row / length) as f64
            })
        };
        let mut columns = Columns {
            states: lengths.iter().map(decaying).collect(),
            removed: vec![normals(stack.rows())],
            uncertain: vec![normals(stack.rows())],
        };
        for row in (0..stack.rows()).filter(|row| missing[*row]) {
            (errors[row], columns.removed[0][row], columns.uncertain[0][row]) = (0.0, 0.0, 0.0);
            let m = 3;
            columns.states[m].row_mut(row - stack.rows_of(m).start).fill(0.0);
        }
        let input: Vec<Vec<f64>> = lengths.iter().map(|length| normals(*length)).collect();
        let input = Series::new(&input.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let output = |i: usize| {
            let there = |m: usize| stack.range(m, i).map(|row| if missing[row] { f64::NAN } else { errors[row] });
            let parts: Vec<Vec<f64>> = (0..lengths.len()).map(|m| there(m).collect()).collect();
            Series::new(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>())
        };
        let outputs = (0..2).map(output).collect();
        let noise = faer::mat![[1.0, 0.3], [0.3, 0.5]];
        let found =
            LinearisedResiduals::with_few_states(stack, &errors, &missing, &columns, &noise, few_states).unwrap();
        (found, outputs, input)
    }

    #[test]
    fn exact_states_are_taken_out_one_stretch_at_a_time_as_all_at_once() {
        let (whole, outputs, input) = linearised(1000);
        let (blocks, ..) = linearised(0);
        assert!(whole.blocks.is_empty() && blocks.blocks.len() == 5);
        assert_eq!(whole.inflation, blocks.inflation);
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-8 * (1.0 + a.abs().max(b.abs()));
        for output in 0..2 {
            let sums =
                [&whole, &blocks].map(|linearised| linearised.sums(output, &outputs[output], &input, 6).unwrap());
            assert!(sums[0].variances().iter().zip(sums[1].variances()).all(|(a, b)| near(*a, b)));
            let tests = sums.map(|sums| sums.test(6, 7).unwrap());
            assert!(near(tests[0].statistic, tests[1].statistic), "{tests:?}");
            assert_eq!(tests[0].degrees_of_freedom, tests[1].degrees_of_freedom);
        }
        let past = [&whole, &blocks].map(|linearised| PastSums::new(linearised, &outputs, 6).unwrap());
        let own = [0, 1].map(|k| past[k].own(1).unwrap());
        assert!(own[0].deviations.iter().zip(&own[1].deviations).all(|(a, b)| near(*a, *b)));
        let joint = past.map(|past| past.joint().unwrap());
        assert!(near(joint[0].statistic, joint[1].statistic), "{joint:?}");
        assert_eq!(joint[0].degrees_of_freedom, 24.0);
    }
}
