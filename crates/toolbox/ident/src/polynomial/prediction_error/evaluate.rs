//! Prediction errors, their gradient and the initial states, streamed through the data.
//!
//! With the states X of the innovations form as polynomials in q⁻¹ that act at the start of a segment:
//! `w_k = (B_k u_k + X_k)/F_k`, `v = A y − Σ w_k − X_a`, `e = (D v − X_v)/C`. The prediction error is linear in X,
//! which is therefore found by least squares for every θ and projected out of the gradient.

use faer::Mat;

use super::line::{BLOCK, is_stable, stabilised};
use super::orders::Orders;
use super::segment::Segment;
use super::signals::{Aim, Block, Column, Lines, Polynomials, columns};
use super::split::Split;
use crate::{IdentError, Triangle};
use fitting::nonlinear::SumOfSquares;
use fitting::{StructureError, UnstablePart};

/// How much farther from the unit circle a search may go on its way.
const WIDER: f64 = 10.0;
/// The part of the way from the unit circle to the edge from which on a root counts as being there.
const NEARLY: f64 = 0.95;

/// The sum of squares of one equation over all its segments.
pub(super) struct Evaluator<'a> {
    orders: &'a Orders,
    segments: &'a [Segment<'a>],
    aim: Aim,
    estimate_states: bool,
    lines: Lines<'a>,
    columns: Vec<Column>,
    largest_radius: f64,
    latest: Vec<f64>,
    states: Vec<Vec<f64>>,
}

impl<'a> Evaluator<'a> {
    pub(super) fn new(orders: &'a Orders, segments: &'a [Segment<'a>], aim: Aim, estimate_states: bool) -> Self {
        let longest = segments.iter().map(Segment::len).max().unwrap_or(1).max(1);
        Evaluator {
            orders,
            segments,
            aim,
            estimate_states,
            lines: Lines::new(orders, aim),
            columns: columns(orders, estimate_states),
            // Growth that the data cannot tell from a drift is let through, so that integrators can be met exactly.
            largest_radius: 1.0 + 1.0 / longest as f64,
            latest: Vec::new(),
            states: Vec::new(),
        }
    }

    /// Lets through a growth that only a search on its way to something slower may need.
    pub(super) fn with_wider_edge(self) -> Self {
        Evaluator { largest_radius: 1.0 + WIDER * (self.largest_radius - 1.0), ..self }
    }

    /// Returns true if a root of `F` at θ lies where growth is no longer let through.
    pub(super) fn is_at_the_edge(&self, theta: &[f64]) -> bool {
        let nearly = 1.0 + NEARLY * (self.largest_radius - 1.0);
        Polynomials::new(self.orders, theta).f.iter().any(|f| !is_stable(f, nearly))
    }

    /// The initial state of each segment at the θ evaluated last.
    pub(super) fn states(&self) -> &[Vec<f64>] {
        &self.states
    }

    /// Returns true if the filters of the predictor and of its gradient are stable at θ.
    pub(super) fn is_stable(&self, theta: &[f64]) -> bool {
        let p = Polynomials::new(self.orders, theta);
        let (_, c) = p.filter(self.aim);
        theta.iter().all(|v| v.is_finite())
            && is_stable(c, if self.aim == Aim::Simulation { self.largest_radius } else { 1.0 })
            && p.f.iter().all(|f| is_stable(f, self.largest_radius))
    }

    /// θ with the roots outside the unit circle mirrored into it, where one lies beyond the edge. A start that was
    /// found on a part of the data may lie there, as shorter data let through a faster growth.
    pub(super) fn within_the_edge(&self, theta: &[f64]) -> Vec<f64> {
        let mut theta = theta.to_vec();
        let denominators = (0..self.orders.inputs()).map(|k| self.orders.f(k));
        let simulated = (self.aim == Aim::Simulation).then(|| self.orders.a());
        for range in denominators.chain(simulated) {
            let inside = stabilised(&theta[range.clone()], self.largest_radius);
            theta[range].copy_from_slice(&inside);
        }
        theta
    }

    fn check(&self, theta: &[f64]) -> Result<(), IdentError> {
        if self.is_stable(theta) {
            return Ok(());
        }
        Err(StructureError::Unstable(UnstablePart::StartingPredictor).into())
    }

    /// Number of columns of the initial state.
    fn state_count(&self) -> usize {
        if self.estimate_states { self.orders.states() } else { 0 }
    }

    /// The errors of every segment at θ and the initial states that suit it best, zero where the output is missing.
    ///
    /// # Errors
    /// θ whose predictor is not stable.
    pub(super) fn residuals(&mut self, theta: &[f64]) -> Result<Vec<Vec<f64>>, IdentError> {
        self.settle_at(theta)?;
        let (segments, states) = (self.segments, self.states.clone());
        let p = Polynomials::new(self.orders, theta);
        let one = |(segment, state): (&Segment<'_>, &Vec<f64>)| {
            let mut errors = Vec::with_capacity(segment.len());
            self.lines.clear();
            for block in Block::all(segment, state) {
                self.lines.errors(&block, &p);
                errors.extend_from_slice(self.lines.e.now(block.rows));
                self.lines.advance(block.rows);
            }
            errors
        };
        Ok(segments.iter().zip(&states).map(one).collect())
    }

    fn settle_at(&mut self, theta: &[f64]) -> Result<(), IdentError> {
        if self.latest != theta {
            self.cost(theta)?;
        }
        Ok(())
    }

    /// The initial state that suits θ best in one segment, and the sum of squares it leaves.
    fn settle(&mut self, segment: &Segment<'_>, p: &Polynomials<'_>) -> Result<(Vec<f64>, f64), IdentError> {
        let count = self.state_count();
        let mut early = (count > 0).then(|| Triangle::for_rows(count + 1, segment.len()));
        let (mut state, mut cost) = (vec![0.0; self.orders.states()], 0.0);
        self.lines.clear();
        let last = self.columns.len() - 1;
        for block in Block::all(segment, &[]) {
            self.lines.errors(&block, p);
            match early.as_mut() {
                None => cost += self.lines.e.now(block.rows).iter().map(|v| v * v).sum::<f64>(),
                Some(triangle) => {
                    self.lines.impulses(&block, p);
                    triangle.push_columns(block.rows, |j, start, slot| {
                        let column = if j < count { j } else { last };
                        self.lines.write(self.columns[column], &block, start, slot);
                    });
                }
            }
            self.lines.advance(block.rows);
            if (block.is_last() || self.lines.impulses_are_over())
                && let Some(triangle) = early.take()
            {
                let split = Split::new(&triangle.finish(), count)?;
                (state, cost) = (split.state(), split.rest());
            }
        }
        Ok((state, cost))
    }

    /// Goes to θ, and returns for each segment what the directions of the initial state explain of each column of J.
    ///
    /// # Errors
    /// θ whose predictor is not stable.
    pub(super) fn linearise(&mut self, theta: &[f64]) -> Result<Vec<Mat<f64>>, IdentError> {
        self.settle_at(theta)?;
        let (segments, states) = (self.segments, self.states.clone());
        let p = Polynomials::new(self.orders, theta);
        segments.iter().zip(&states).map(|(segment, state)| self.explained(segment, state, &p)).collect()
    }

    /// Part of each column of J in one segment that the directions of the initial state explain.
    fn explained(&mut self, segment: &Segment<'_>, state: &[f64], p: &Polynomials<'_>) -> Result<Mat<f64>, IdentError> {
        let count = self.state_count();
        let mut triangle = Triangle::new(self.columns.len());
        self.lines.clear();
        for block in Block::all(segment, state) {
            self.lines.all(&block, p);
            let (lines, columns) = (&self.lines, &self.columns);
            triangle.push_columns(block.rows, |j, start, slot| lines.write(columns[j], &block, start, slot));
            self.lines.advance(block.rows);
            if self.lines.impulses_are_over() {
                break;
            }
        }
        Ok(Split::new(&triangle.finish(), count)?.explained())
    }

    /// Writes the rows of J, with the initial state projected out, and the errors of the part of a segment from a row
    /// on that follows the part written last, at the θ of [`Evaluator::linearise`]; at most [`BLOCK`] rows.
    pub(super) fn gradient(
        &mut self,
        theta: &[f64],
        index: usize,
        first: usize,
        explained: &Mat<f64>,
        rows: &mut [f64],
        errors: &mut [f64],
    ) {
        work::checkpoint();
        if first == 0 {
            self.lines.clear();
        }
        let (p, count, n) = (Polynomials::new(self.orders, theta), self.state_count(), self.orders.count());
        let block = Block { segment: &self.segments[index], first, rows: errors.len(), state: &self.states[index] };
        self.lines.all(&block, &p);
        let mut slot = [0.0; BLOCK];
        rows.fill(0.0);
        for j in 0..count + n {
            self.lines.write(self.columns[j], &block, 0, &mut slot[..block.rows]);
            for (row, x) in rows.chunks_exact_mut(n).zip(&slot[..block.rows]) {
                if j < count {
                    row.iter_mut().enumerate().for_each(|(m, v)| *v -= explained[(j, m)] * x);
                } else {
                    row[j - count] += x;
                }
            }
        }
        errors.copy_from_slice(self.lines.e.now(block.rows));
        self.lines.advance(block.rows);
    }

    /// Appends the rows [J e] of one segment, with its initial state projected out of J.
    fn append(
        &mut self,
        segment: &Segment<'_>,
        state: &[f64],
        p: &Polynomials<'_>,
        all: &mut Triangle,
    ) -> Result<(), IdentError> {
        let count = self.state_count();
        let mut early = (count > 0).then(|| Triangle::for_rows(self.columns.len(), segment.len()));
        self.lines.clear();
        for block in Block::all(segment, state) {
            self.lines.errors(&block, p);
            self.lines.regressors(block.rows, p);
            let (lines, columns) = (&mut self.lines, &self.columns);
            match early.as_mut() {
                None => {
                    all.push_columns(block.rows, |j, start, slot| lines.write(columns[count + j], &block, start, slot))
                }
                Some(triangle) => {
                    lines.impulses(&block, p);
                    triangle.push_columns(block.rows, |j, start, slot| lines.write(columns[j], &block, start, slot));
                }
            }
            self.lines.advance(block.rows);
            if (block.is_last() || self.lines.impulses_are_over())
                && let Some(triangle) = early.take()
            {
                Split::new(&triangle.finish(), count)?.push_rest(all);
            }
        }
        Ok(())
    }
}

impl SumOfSquares for Evaluator<'_> {
    fn parameter_count(&self) -> usize {
        self.orders.count()
    }

    fn residual_count(&self) -> usize {
        let rows: usize = self.segments.iter().map(Segment::known).sum();
        rows.saturating_sub(self.state_count() * self.segments.len())
    }

    fn cost(&mut self, theta: &[f64]) -> Result<f64, IdentError> {
        self.check(theta)?;
        let p = Polynomials::new(self.orders, theta);
        let (mut states, mut total) = (Vec::with_capacity(self.segments.len()), 0.0);
        for segment in self.segments {
            let (state, cost) = self.settle(segment, &p)?;
            states.push(state);
            total += cost;
        }
        (self.states, self.latest) = (states, theta.to_vec());
        Ok(total)
    }

    fn factor(&mut self, theta: &[f64]) -> Result<Mat<f64>, IdentError> {
        self.settle_at(theta)?;
        let p = Polynomials::new(self.orders, theta);
        let states = std::mem::take(&mut self.states);
        let mut all = Triangle::new(self.orders.count() + 1);
        let appended = self.segments.iter().zip(&states).try_for_each(|(s, x)| self.append(s, x, &p, &mut all));
        self.states = states;
        appended?;
        Ok(all.finish())
    }
}
