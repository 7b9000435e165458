//! The prediction errors of an innovations form and their derivatives, streamed through a triangular factor.

use faer::{Mat, MatRef};
use numerics::linalg;
use numerics::parallel;

use super::derivatives::Derivatives;
use super::predictor::{Free, Instant, Predictor, Walk};
use super::sensitivities::Sensitivities;
use crate::data::Experiment;
use crate::{Dataset, IdentError, Triangle};

/// Instants whose derivatives are held before they are folded away, at most ...
const CHUNK: usize = 512;
/// ... and so few that the data make about so many chunks.
const SHORTEST_SPLIT: usize = 100;
/// Directions of an initial state that the data show less than this part of the best are left alone.
const STATE_TOLERANCE: f64 = 1e-10;

/// The problem min ‖L⁻¹(ε − Ψ δ − Ψ₀ δx₀)‖², `Λ = L Lᵀ`, in triangular form with the initial states taken out.
#[derive(Debug, Clone)]
pub(crate) struct Linearised {
    /// R of `[Ψ·basis, ε]`.
    pub(crate) factor: Mat<f64>,
    /// Scalar residuals.
    pub(crate) rows: usize,
    /// For each experiment the equations of its initial state: `[R₀, R₁, r]`, states × (states + parameters + 1).
    pub(super) tops: Vec<Mat<f64>>,
}

impl Linearised {
    /// For each experiment what its initial state explains of each direction, states × parameters.
    pub(crate) fn explained(&self) -> Result<Vec<Mat<f64>>, IdentError> {
        let solve = |top: &Mat<f64>| {
            let (n, columns) = (top.nrows(), top.ncols() - 1);
            linalg::least_norm(top.subcols(0, n), top.subcols(n, columns - n), STATE_TOLERANCE)
        };
        Ok(self.tops.iter().map(solve).collect::<Result<_, _>>()?)
    }

    /// Change of each initial state when the parameters change by `step`; parts the data do not show stay.
    pub(crate) fn initial_steps(&self, step: &[f64]) -> Result<Vec<Vec<f64>>, IdentError> {
        let solve = |top: &Mat<f64>| {
            let n = top.nrows();
            let right = Mat::from_fn(n, 1, |i, _| {
                top[(i, n + step.len())] - step.iter().enumerate().map(|(j, s)| top[(i, n + j)] * s).sum::<f64>()
            });
            let solution = linalg::least_norm(top.subcols(0, n), right.as_ref(), STATE_TOLERANCE)?;
            Ok((0..n).map(|i| solution[(i, 0)]).collect())
        };
        self.tops.iter().map(solve).collect()
    }
}

/// Derivatives of the prediction errors of one model, gathered over data.
pub(crate) struct Lineariser<'a> {
    pub(crate) predictor: &'a Predictor,
    pub(crate) free: Free,
    /// Directions in the space of the free entries, entries × directions.
    pub(crate) basis: MatRef<'a, f64>,
    /// `L⁻¹`, lower triangular, outputs × outputs.
    pub(crate) whitening: MatRef<'a, f64>,
    /// How many of the leading states are estimated at the start of each experiment.
    pub(crate) initial: usize,
}

impl Lineariser<'_> {
    /// Linearises around the model and these initial states.
    pub(crate) fn over(&self, data: &Dataset, x0: &[Vec<f64>]) -> Linearised {
        let states = self.initial;
        let columns = self.basis.ncols();
        let mut whole = Triangle::new(columns + 1);
        let (mut tops, mut rows) = (Vec::new(), 0);
        let chunk = (data.samples() / SHORTEST_SPLIT).clamp(16, CHUNK);
        for (experiment, x0) in data.experiments().iter().zip(x0) {
            let triangle = self.experiment(experiment, x0, chunk);
            rows += triangle.rows();
            let factor = triangle.finish();
            tops.push(factor.subrows(0, states).to_owned());
            let mut row = vec![0.0; columns + 1];
            for i in states..factor.nrows() {
                row.iter_mut().enumerate().for_each(|(j, v)| *v = factor[(i, states + j)]);
                whole.push_row(&row);
            }
        }
        Linearised { factor: whole.finish(), rows, tops }
    }

    /// The factor of `[Ψ₀, Ψ·basis, ε]` of one experiment. While a chunk is folded, the derivatives of the next are
    /// formed.
    fn experiment(&self, experiment: &Experiment, x0: &[f64], instants: usize) -> Triangle {
        let mut triangle = Triangle::new(self.initial + self.basis.ncols() + 1);
        let mut rows = Rows::new(self, experiment, x0);
        if experiment.len() <= 4 * CHUNK {
            std::iter::from_fn(|| rows.chunk(instants)).for_each(|chunk| self.fold(&chunk, &mut triangle));
            return triangle;
        }
        let mut chunk = rows.chunk(instants);
        while let Some(formed) = chunk {
            ((), chunk) = parallel::join(|| self.fold(&formed, &mut triangle), || rows.chunk(instants));
        }
        triangle
    }

    /// Turns the rows of a chunk into the directions, where they are not along them already, and appends them.
    fn fold(&self, chunk: &Chunk, triangle: &mut Triangle) {
        let (states, width) = (self.initial, chunk.width);
        let rows = chunk.rows.len() / width;
        let all = MatRef::from_row_major_slice(&chunk.rows, rows, width);
        let turned = match chunk.along_directions {
            true => all.subcols(states, self.basis.ncols()).to_owned(),
            false => all.subcols(states, self.basis.nrows()) * self.basis,
        };
        triangle.push_columns(rows, |j, start, slot| {
            let direction = j.checked_sub(states).filter(|d| *d < turned.ncols());
            match direction.and_then(|d| turned.col(d).try_as_col_major()) {
                Some(column) => slot.copy_from_slice(&column.as_slice()[start..start + slot.len()]),
                None => {
                    let raw = all.col(if j < states { j } else { width - 1 });
                    slot.iter_mut().enumerate().for_each(|(i, v)| *v = raw[start + i]);
                }
            }
        });
    }

    /// Shows `visit` the rows `[Ψ₀, Ψ, ε]` of all outputs at every instant, whitened, and whether every output is
    /// there; where not, they are without meaning. For a model without a noise model.
    pub(crate) fn rows(&self, experiment: &Experiment, x0: &[f64], visit: impl FnMut(&[f64], bool)) {
        Rows::new(self, experiment, x0).advance(experiment.len(), visit);
    }

    /// The whitened errors instant by instant, NaN where an output is missing.
    pub(crate) fn errors(&self, experiment: &Experiment, x0: &[f64]) -> Vec<f64> {
        let mut all = Vec::with_capacity(experiment.len() * self.predictor.p);
        let mut e = vec![0.0; self.predictor.p];
        self.predictor.walk(experiment, x0, |now| {
            let first = all.len();
            now.weighed(&mut e);
            all.extend(e.iter().map(|v| if now.complete { *v } else { f64::NAN }));
            self.whiten(&mut all[first..], 1);
        });
        all
    }

    /// `L⁻¹` from the left, in place: the last row first, since it needs those above it as they were.
    fn whiten(&self, rows: &mut [f64], width: usize) {
        for i in (0..self.predictor.p).rev() {
            let (above, below) = rows.split_at_mut(i * width);
            let row = &mut below[..width];
            row.iter_mut().for_each(|v| *v *= self.whitening[(i, i)]);
            for (l, other) in above.chunks_exact(width).enumerate() {
                let weight = self.whitening[(i, l)];
                row.iter_mut().zip(other).for_each(|(v, o)| *v += weight * o);
            }
        }
    }
}

/// Rows of successive instants.
struct Chunk {
    rows: Vec<f64>,
    width: usize,
    /// True if derivatives are those along the directions, not those of the entries.
    along_directions: bool,
}

/// How derivatives are formed.
enum Slopes<'a> {
    /// Of the entries, with a gain that stays.
    Steady(Derivatives<'a>),
    /// Along the directions, with a gain that changes.
    Filtered(Sensitivities<'a>),
}

/// The rows `[Ψ₀, Ψ, ε]` of an experiment, formed piece by piece.
struct Rows<'a> {
    of: &'a Lineariser<'a>,
    walk: Walk<'a>,
    slopes: Slopes<'a>,
    /// Length of a row.
    width: usize,
    /// Those of one instant.
    rows: Vec<f64>,
}

impl<'a> Rows<'a> {
    fn new(of: &'a Lineariser<'a>, experiment: &'a Experiment, x0: &[f64]) -> Self {
        let walk = Walk::new(of.predictor, experiment, x0);
        let (slopes, columns) = match walk.is_filtered() {
            true => {
                (Slopes::Filtered(Sensitivities::new(of.predictor, of.free, of.basis, of.initial)), of.basis.ncols())
            }
            false => (Slopes::Steady(Derivatives::new(of.predictor, of.free, of.initial)), of.basis.nrows()),
        };
        let width = of.initial + columns + 1;
        Rows { of, walk, slopes, width, rows: vec![0.0; of.predictor.p * width] }
    }

    /// Goes on by this many instants. `visit` as in [`Lineariser::rows`].
    fn advance(&mut self, instants: usize, mut visit: impl FnMut(&[f64], bool)) {
        let Rows { of, walk, slopes, width, rows } = self;
        walk.advance(instants, |now| {
            let Instant { x, u, e, complete, .. } = *now;
            match slopes {
                Slopes::Steady(derivatives) if complete => derivatives.write(x, u, e, rows),
                Slopes::Filtered(sensitivities) => sensitivities.write(now, rows),
                Slopes::Steady(_) => {}
            }
            if complete {
                of.whiten(rows, *width);
            }
            visit(rows, complete);
            match slopes {
                Slopes::Steady(derivatives) => derivatives.advance(x, u, e),
                Slopes::Filtered(sensitivities) => sensitivities.advance(now),
            }
        });
    }

    /// The rows of the next instants with every output, at most `instants` of them; `None` at the end.
    fn chunk(&mut self, instants: usize) -> Option<Chunk> {
        let mut chunk = Vec::with_capacity(instants * self.rows.len());
        while chunk.is_empty() && !self.walk.is_over() {
            self.advance(instants, |rows, complete| {
                if complete {
                    chunk.extend_from_slice(rows);
                }
            });
        }
        let along_directions = matches!(self.slopes, Slopes::Filtered(_));
        (!chunk.is_empty()).then_some(Chunk { rows: chunk, width: self.width, along_directions })
    }
}
