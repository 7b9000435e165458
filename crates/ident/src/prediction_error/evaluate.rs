//! Prediction errors, their gradient and the initial states, streamed through the data.
//!
//! With the states X of the innovations form as polynomials in q⁻¹ that act at the start of a segment:
//! `w_k = (B_k u_k + X_k)/F_k`, `v = A y − Σ w_k − X_a`, `e = (D v − X_v)/C`. The prediction error is linear in X, which
//! is therefore found by least squares for every θ and projected out of the gradient.

use faer::Mat;

use super::line::{BLOCK, Line, is_stable};
use super::orders::Orders;
use super::segment::Segment;
use crate::nonlinear::SumOfSquares;
use crate::{IdentError, Triangle};

/// Which error is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// That of the one-step prediction.
    Prediction,
    /// That of the simulated output: `e = y − (Σ w_k + X_a)/A`, whatever `C` and `D`.
    Simulation,
}

/// Directions of the initial state that move the residuals less than this fraction of the strongest are left at zero.
const STATE_TOLERANCE: f64 = 1e-10;

/// A response that has decayed to this fraction of its peak is over.
const DECAYED: f64 = 1e-20;

/// The sum of squares of one equation over all its segments.
pub(super) struct Evaluator<'a> {
    orders: &'a Orders,
    segments: &'a [Segment<'a>],
    aim: Aim,
    estimate_states: bool,
    lines: Lines,
    columns: Vec<Column>,
    largest_radius: f64,
    latest: Vec<f64>,
    states: Vec<Vec<f64>>,
}

/// One column of the gradient: a signal, how far it is shifted, and its sign.
#[derive(Debug, Clone, Copy)]
struct Column {
    signal: Signal,
    lag: usize,
    sign: f64,
}

#[derive(Debug, Clone, Copy)]
enum Signal {
    Output,
    Input(usize),
    Error,
    Noise,
    Response(usize),
    OutputImpulse,
    InputImpulse(usize),
    NoiseImpulse,
    Residual,
}

/// θ as the polynomials of an equation.
struct Polynomials<'t> {
    a: &'t [f64],
    b: Vec<&'t [f64]>,
    c: &'t [f64],
    d: &'t [f64],
    f: Vec<&'t [f64]>,
}

impl<'t> Polynomials<'t> {
    fn new(orders: &Orders, theta: &'t [f64]) -> Self {
        Polynomials {
            a: &theta[orders.a()],
            b: (0..orders.inputs()).map(|k| &theta[orders.b(k)]).collect(),
            c: &theta[orders.c()],
            d: &theta[orders.d()],
            f: (0..orders.inputs()).map(|k| &theta[orders.f(k)]).collect(),
        }
    }

    /// Numerator and denominator of the way from `v` to the error.
    fn filter(&self, aim: Aim) -> (&'t [f64], &'t [f64]) {
        match aim {
            Aim::Prediction => (self.d, self.c),
            Aim::Simulation => (&[], self.a),
        }
    }
}

impl<'a> Evaluator<'a> {
    pub(super) fn new(orders: &'a Orders, segments: &'a [Segment<'a>], aim: Aim, estimate_states: bool) -> Self {
        let longest = segments.iter().map(Segment::len).max().unwrap_or(1).max(1);
        Evaluator {
            orders,
            segments,
            aim,
            estimate_states,
            lines: Lines::new(orders),
            columns: columns(orders, estimate_states),
            // Growth that the data cannot tell from a drift is let through, so that integrators can be met exactly.
            largest_radius: 1.0 + 1.0 / longest as f64,
            latest: Vec::new(),
            states: Vec::new(),
        }
    }

    /// The initial state of each segment at the θ evaluated last.
    pub(super) fn states(&self) -> &[Vec<f64>] {
        &self.states
    }

    /// Whether the filters of the predictor and of its gradient are stable at θ.
    pub(super) fn is_stable(&self, theta: &[f64]) -> bool {
        let p = Polynomials::new(self.orders, theta);
        let (_, c) = p.filter(self.aim);
        theta.iter().all(|v| v.is_finite())
            && is_stable(c, if self.aim == Aim::Simulation { self.largest_radius } else { 1.0 })
            && p.f.iter().all(|f| is_stable(f, self.largest_radius))
    }

    fn check(&self, theta: &[f64]) -> Result<(), IdentError> {
        if self.is_stable(theta) {
            return Ok(());
        }
        Err(IdentError::Structure { what: "the predictor of the starting model is not stable" })
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
            for (first, rows) in blocks(segment) {
                self.lines.errors(self.orders, segment, first, rows, &p, self.aim, state);
                errors.extend_from_slice(self.lines.e.now(rows));
                self.lines.advance(rows);
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
        let mut early = (count > 0).then(|| Triangle::new(count + 1));
        let (mut state, mut cost) = (vec![0.0; self.orders.states()], 0.0);
        self.lines.clear();
        let last = self.columns.len() - 1;
        for (first, rows) in blocks(segment) {
            self.lines.errors(self.orders, segment, first, rows, p, self.aim, &[]);
            match early.as_mut() {
                None => cost += self.lines.e.now(rows).iter().map(|v| v * v).sum::<f64>(),
                Some(triangle) => {
                    self.lines.impulses(first, rows, p, self.aim);
                    triangle.push_columns(rows, |j, slot| {
                        let column = if j < count { j } else { last };
                        self.lines.write(self.columns[column], segment, first, slot);
                    });
                }
            }
            self.lines.advance(rows);
            if (first + rows == segment.len() || self.lines.impulses_are_over())
                && let Some(triangle) = early.take()
            {
                let split = Split::new(&triangle.finish(), count)?;
                (state, cost) = (split.state(), split.rest());
            }
        }
        Ok((state, cost))
    }

    /// The sums of `J_tᵀ e_t` over consecutive stretches of equal length, one row a stretch, with the initial states
    /// projected out of J.
    ///
    /// # Errors
    /// Fewer than two stretches, or stretches shorter than θ.
    pub(super) fn scores(&mut self, theta: &[f64], batches: usize) -> Result<Mat<f64>, IdentError> {
        self.settle_at(theta)?;
        let (total, n) = (self.segments.iter().map(Segment::len).sum::<usize>(), self.orders.count());
        if batches < 2 || total / batches <= n {
            return Err(IdentError::TooFewSamples { samples: total, parameters: n * batches.max(2) });
        }
        let p = Polynomials::new(self.orders, theta);
        let (segments, states) = (self.segments, self.states.clone());
        let mut sums = Mat::zeros(batches, n);
        let mut before = 0;
        for (segment, state) in segments.iter().zip(&states) {
            let explained = self.explained(segment, state, &p)?;
            let batch = |t: usize| (before + t) * batches / total;
            self.add_scores(segment, state, &p, &explained, batch, &mut sums);
            before += segment.len();
        }
        Ok(sums)
    }

    /// What the directions of the initial state explain of each column of J in one segment.
    fn explained(&mut self, segment: &Segment<'_>, state: &[f64], p: &Polynomials<'_>) -> Result<Mat<f64>, IdentError> {
        let count = self.state_count();
        let mut triangle = Triangle::new(self.columns.len());
        self.lines.clear();
        for (first, rows) in blocks(segment) {
            self.lines.all(self.orders, segment, first, rows, p, self.aim, state);
            let (lines, columns) = (&self.lines, &self.columns);
            triangle.push_columns(rows, |j, slot| lines.write(columns[j], segment, first, slot));
            self.lines.advance(rows);
            if self.lines.impulses_are_over() {
                break;
            }
        }
        Ok(Split::new(&triangle.finish(), count)?.explained())
    }

    fn add_scores(
        &mut self,
        segment: &Segment<'_>,
        state: &[f64],
        p: &Polynomials<'_>,
        explained: &Mat<f64>,
        batch: impl Fn(usize) -> usize,
        sums: &mut Mat<f64>,
    ) {
        let (count, n) = (self.state_count(), self.orders.count());
        let mut slot = vec![0.0; BLOCK];
        self.lines.clear();
        for (first, rows) in blocks(segment) {
            self.lines.all(self.orders, segment, first, rows, p, self.aim, state);
            for j in 0..count + n {
                self.lines.write(self.columns[j], segment, first, &mut slot[..rows]);
                for (i, (x, e)) in slot.iter().zip(self.lines.e.now(rows)).enumerate() {
                    let row = batch(first + i);
                    if j < count {
                        (0..n).for_each(|m| sums[(row, m)] -= explained[(j, m)] * x * e);
                    } else {
                        sums[(row, j - count)] += x * e;
                    }
                }
            }
            self.lines.advance(rows);
        }
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
        let mut early = (count > 0).then(|| Triangle::new(self.columns.len()));
        self.lines.clear();
        for (first, rows) in blocks(segment) {
            self.lines.errors(self.orders, segment, first, rows, p, self.aim, state);
            self.lines.regressors(self.orders, rows, p, self.aim);
            let (lines, columns) = (&mut self.lines, &self.columns);
            match early.as_mut() {
                None => all.push_columns(rows, |j, slot| lines.write(columns[count + j], segment, first, slot)),
                Some(triangle) => {
                    lines.impulses(first, rows, p, self.aim);
                    triangle.push_columns(rows, |j, slot| lines.write(columns[j], segment, first, slot));
                }
            }
            self.lines.advance(rows);
            if (first + rows == segment.len() || self.lines.impulses_are_over())
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

/// First row and length of each block of a segment.
fn blocks(segment: &Segment<'_>) -> impl Iterator<Item = (usize, usize)> + use<> {
    let total = segment.len();
    (0..total).step_by(BLOCK).map(move |first| (first, BLOCK.min(total - first)))
}

/// The columns [X θ e] of the gradient.
fn columns(orders: &Orders, with_states: bool) -> Vec<Column> {
    let mut all = Vec::new();
    let mut push = |signal, first: usize, count: usize, sign| {
        all.extend((first..first + count).map(|lag| Column { signal, lag, sign }));
    };
    let inputs = orders.inputs();
    if with_states {
        push(Signal::OutputImpulse, 0, orders.output_states(), -1.0);
        (0..inputs).for_each(|k| push(Signal::InputImpulse(k), 0, orders.input_states(k), -1.0));
        push(Signal::NoiseImpulse, 0, orders.noise_states(), -1.0);
    }
    push(Signal::Output, 1, orders.na, 1.0);
    (0..inputs).for_each(|k| push(Signal::Input(k), orders.nk[k], orders.nb[k], -1.0));
    push(Signal::Error, 1, orders.nc, -1.0);
    push(Signal::Noise, 1, orders.nd, 1.0);
    (0..inputs).for_each(|k| push(Signal::Response(k), 1, orders.nf[k], 1.0));
    push(Signal::Residual, 0, 1, 1.0);
    all
}

/// The factor of [X J e] split into what the initial state explains and what is left.
struct Split {
    scale: Vec<f64>,
    directions: Mat<f64>,
    strengths: Vec<f64>,
    /// Rows that belong to the directions of the state, rotated to them; columns [J e].
    along: Mat<f64>,
    factor: Mat<f64>,
}

impl Split {
    fn new(factor: &Mat<f64>, count: usize) -> Result<Self, IdentError> {
        let norms = (0..count).map(|j| factor.col(j).norm_l2());
        let scale: Vec<f64> = norms.map(|n| if n > 0.0 { n } else { 1.0 }).collect();
        let scaled = Mat::from_fn(count, count, |i, j| factor[(i, j)] / scale[j]);
        let svd = scaled.svd().map_err(|_| IdentError::Decomposition { what: "singular value" })?;
        let strengths: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        let along = svd.U().transpose() * factor.get(..count, count..);
        Ok(Split { scale, directions: svd.V().to_owned(), strengths, along, factor: factor.clone() })
    }

    fn is_felt(&self, direction: usize) -> bool {
        let strength = self.strengths[direction];
        strength > 0.0 && strength >= STATE_TOLERANCE * self.strengths[0]
    }

    /// The state that makes e smallest.
    fn state(&self) -> Vec<f64> {
        let n = self.scale.len();
        let last = self.along.ncols() - 1;
        let felt: Vec<usize> = (0..n).filter(|i| self.is_felt(*i)).collect();
        let element = |j: usize| -> f64 {
            felt.iter().map(|i| -self.directions[(j, *i)] * self.along[(*i, last)] / self.strengths[*i]).sum()
        };
        (0..n).map(|j| element(j) / self.scale[j]).collect()
    }

    /// The combination of the state's directions that comes closest to each column of J.
    fn explained(&self) -> Mat<f64> {
        let (n, columns) = (self.scale.len(), self.along.ncols() - 1);
        let felt: Vec<usize> = (0..n).filter(|i| self.is_felt(*i)).collect();
        Mat::from_fn(n, columns, |j, m| {
            let one = |i: &usize| self.directions[(j, *i)] * self.along[(*i, m)] / self.strengths[*i];
            felt.iter().map(one).sum::<f64>() / self.scale[j]
        })
    }

    /// ‖e‖² at that state.
    fn rest(&self) -> f64 {
        let n = self.scale.len();
        let (last, corner) = (self.along.ncols() - 1, self.factor.ncols() - 1);
        let unfelt: f64 = (0..n).filter(|i| !self.is_felt(*i)).map(|i| self.along[(i, last)].powi(2)).sum();
        unfelt + (n..=corner).map(|i| self.factor[(i, corner)].powi(2)).sum::<f64>()
    }

    /// Appends the rows of [J e] that the state does not explain.
    fn push_rest(&self, all: &mut Triangle) {
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

/// Every signal of an equation, a block at a time.
struct Lines {
    y: Line,
    u: Vec<Line>,
    /// `w_k`.
    w: Vec<Line>,
    /// `v`; under [`Aim::Simulation`] the simulated output.
    v: Line,
    e: Line,
    /// Filtered signals that the columns of the gradient are shifts of.
    output: Line,
    input: Vec<Line>,
    response: Vec<Line>,
    error: Line,
    noise: Line,
    /// Inputs and their responses on the way through the filter.
    halfway: Vec<[Line; 2]>,
    impulse: Line,
    output_impulse: Line,
    input_impulse: Vec<Line>,
    noise_impulse: Line,
}

impl Lines {
    fn new(orders: &Orders) -> Self {
        let line = Line::new(orders.memory());
        let each = vec![line.clone(); orders.inputs()];
        Lines {
            y: line.clone(),
            u: each.clone(),
            w: each.clone(),
            v: line.clone(),
            e: line.clone(),
            output: line.clone(),
            input: each.clone(),
            response: each.clone(),
            error: line.clone(),
            noise: line.clone(),
            halfway: vec![[line.clone(), line.clone()]; orders.inputs()],
            impulse: line.clone(),
            output_impulse: line.clone(),
            input_impulse: each,
            noise_impulse: line,
        }
    }

    fn for_each(&mut self, change: impl FnMut(&mut Line)) {
        let Lines { y, v, e, output, error, noise, impulse, output_impulse, noise_impulse, .. } = self;
        let single = [y, v, e, output, error, noise, impulse, output_impulse, noise_impulse].into_iter();
        let several = [&mut self.u, &mut self.w, &mut self.input, &mut self.response, &mut self.input_impulse];
        let halfway = self.halfway.iter_mut().flatten();
        single.chain(several.into_iter().flatten()).chain(halfway).for_each(change);
    }

    fn clear(&mut self) {
        self.for_each(Line::clear);
    }

    fn advance(&mut self, rows: usize) {
        self.for_each(|line| line.advance(rows));
    }

    /// `e`, and all it comes from, for rows `first…` of a segment that starts in `state` (empty for zero).
    #[allow(clippy::too_many_arguments, reason = "the innermost loop's whole context")]
    fn errors(
        &mut self,
        orders: &Orders,
        segment: &Segment<'_>,
        first: usize,
        rows: usize,
        p: &Polynomials<'_>,
        aim: Aim,
        state: &[f64],
    ) {
        self.y.now_mut(rows).copy_from_slice(&segment.output[first..first + rows]);
        let mut taken = orders.output_states();
        let of_state = |from: usize, count: usize| state.get(from..from + count).unwrap_or(&[]);
        for k in 0..orders.inputs() {
            self.u[k].now_mut(rows).copy_from_slice(&segment.inputs[k][first..first + rows]);
            self.w[k].weigh(&self.u[k], p.b[k], orders.nk[k], rows);
            let count = orders.input_states(k);
            inject(self.w[k].now_mut(rows), of_state(taken, count), first, 1.0);
            self.w[k].recur(p.f[k], rows);
            taken += count;
        }
        self.v.now_mut(rows).fill(0.0);
        self.w.iter().for_each(|w| self.v.add_weighed(w, &[1.0], 0, rows));
        inject(self.v.now_mut(rows), of_state(0, orders.output_states()), first, 1.0);
        match aim {
            Aim::Prediction => {
                self.v.now_mut(rows).iter_mut().zip(self.y.now(rows)).for_each(|(v, y)| *v = y - *v);
                self.v.add_weighed(&self.y, p.a, 1, rows);
                self.e.weigh(&self.v, &[1.0], 0, rows);
                self.e.add_weighed(&self.v, p.d, 1, rows);
                inject(self.e.now_mut(rows), of_state(taken, orders.noise_states()), first, -1.0);
                self.e.recur(p.c, rows);
            }
            Aim::Simulation => {
                self.v.recur(p.a, rows);
                let pairs = self.y.now(rows).iter().zip(self.v.now(rows));
                self.e.now_mut(rows).iter_mut().zip(pairs).for_each(|(e, (y, z))| *e = y - z);
            }
        }
        segment.missing_in(first, rows).iter().for_each(|t| self.e.now_mut(rows)[t - first] = 0.0);
    }

    /// Errors, regressors and impulses.
    #[allow(clippy::too_many_arguments, reason = "the innermost loop's whole context")]
    fn all(
        &mut self,
        orders: &Orders,
        segment: &Segment<'_>,
        first: usize,
        rows: usize,
        p: &Polynomials<'_>,
        aim: Aim,
        state: &[f64],
    ) {
        self.errors(orders, segment, first, rows, p, aim, state);
        self.regressors(orders, rows, p, aim);
        self.impulses(first, rows, p, aim);
    }

    /// The filtered signals of the gradient, after [`Lines::errors`].
    fn regressors(&mut self, orders: &Orders, rows: usize, p: &Polynomials<'_>, aim: Aim) {
        let (num, den) = p.filter(aim);
        let source = if aim == Aim::Prediction { &self.y } else { &self.v };
        if orders.na > 0 {
            self.output.run_through(source, num, den, rows);
        }
        for k in 0..orders.inputs() {
            let [input, response] = &mut self.halfway[k];
            input.run_through(&self.u[k], num, den, rows);
            self.input[k].run_through(input, &[], p.f[k], rows);
            if orders.nf[k] > 0 {
                response.run_through(&self.w[k], num, den, rows);
                self.response[k].run_through(response, &[], p.f[k], rows);
            }
        }
        // Under `Aim::Simulation` the noise polynomials have no part: their lines stay zero.
        if orders.nc > 0 && aim == Aim::Prediction {
            self.error.run_through(&self.e, &[], p.c, rows);
        }
        if orders.nd > 0 && aim == Aim::Prediction {
            self.noise.run_through(&self.v, &[], p.c, rows);
        }
    }

    /// The responses of the error to impulses of the initial state.
    fn impulses(&mut self, first: usize, rows: usize, p: &Polynomials<'_>, aim: Aim) {
        self.impulse.now_mut(rows).fill(0.0);
        if first == 0 && rows > 0 {
            self.impulse.now_mut(rows)[0] = 1.0;
        }
        let (num, den) = p.filter(aim);
        self.output_impulse.run_through(&self.impulse, num, den, rows);
        for (line, f) in self.input_impulse.iter_mut().zip(&p.f) {
            line.run_through(&self.output_impulse, &[], f, rows);
        }
        if aim == Aim::Prediction {
            self.noise_impulse.run_through(&self.impulse, &[], p.c, rows);
        }
    }

    /// Whether nothing is left of the impulses, once the block that holds them is past.
    fn impulses_are_over(&self) -> bool {
        let lines = [&self.output_impulse, &self.noise_impulse].into_iter().chain(&self.input_impulse);
        lines.flat_map(Line::past).all(|v| v.abs() < DECAYED)
    }

    /// Writes a column for the rows `first…` of a segment; rows with a missing output are zero.
    fn write(&self, column: Column, segment: &Segment<'_>, first: usize, slot: &mut [f64]) {
        let line = match column.signal {
            Signal::Output => &self.output,
            Signal::Input(k) => &self.input[k],
            Signal::Error => &self.error,
            Signal::Noise => &self.noise,
            Signal::Response(k) => &self.response[k],
            Signal::OutputImpulse => &self.output_impulse,
            Signal::InputImpulse(k) => &self.input_impulse[k],
            Signal::NoiseImpulse => &self.noise_impulse,
            Signal::Residual => &self.e,
        };
        let source = line.lag(column.lag, slot.len());
        slot.iter_mut().zip(source).for_each(|(s, v)| *s = column.sign * v);
        segment.missing_in(first, slot.len()).iter().for_each(|t| slot[t - first] = 0.0);
    }
}

/// Adds `sign · state` to the first rows of a segment, of which `block` holds those from `first` on.
fn inject(block: &mut [f64], state: &[f64], first: usize, sign: f64) {
    let part = state.get(first..).unwrap_or(&[]);
    block.iter_mut().zip(part).for_each(|(slot, x)| *slot += sign * x);
}
