//! The signals of one equation, run through a block at a time: errors, and what their gradient is made of.

use super::line::{BLOCK, Line};
use super::orders::Orders;
use super::segment::Segment;

/// Which error is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// That of the one-step prediction.
    Prediction,
    /// That of the simulated output: `e = y − (Σ w_k + X_a)/A`, whatever `C` and `D`.
    Simulation,
}

/// A response that has decayed to this fraction of its peak is over.
const DECAYED: f64 = 1e-20;

/// One column of the gradient: a signal, how far it is shifted, and its sign.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
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
pub(super) struct Polynomials<'t> {
    a: &'t [f64],
    b: Vec<&'t [f64]>,
    c: &'t [f64],
    d: &'t [f64],
    pub(super) f: Vec<&'t [f64]>,
}

impl<'t> Polynomials<'t> {
    pub(super) fn new(orders: &Orders, theta: &'t [f64]) -> Self {
        Polynomials {
            a: &theta[orders.a()],
            b: (0..orders.inputs()).map(|k| &theta[orders.b(k)]).collect(),
            c: &theta[orders.c()],
            d: &theta[orders.d()],
            f: (0..orders.inputs()).map(|k| &theta[orders.f(k)]).collect(),
        }
    }

    /// Numerator and denominator of the way from `v` to the error.
    pub(super) fn filter(&self, aim: Aim) -> (&'t [f64], &'t [f64]) {
        match aim {
            Aim::Prediction => (self.d, self.c),
            Aim::Simulation => (&[], self.a),
        }
    }
}

/// The columns [X θ e] of the gradient.
pub(super) fn columns(orders: &Orders, with_states: bool) -> Vec<Column> {
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

/// Rows `first…` of a segment that starts in `state` (empty for zero).
#[derive(Clone, Copy)]
pub(super) struct Block<'b> {
    pub(super) segment: &'b Segment<'b>,
    pub(super) first: usize,
    pub(super) rows: usize,
    pub(super) state: &'b [f64],
}

impl<'b> Block<'b> {
    /// The blocks of a segment, in order.
    pub(super) fn all(segment: &'b Segment<'b>, state: &'b [f64]) -> impl Iterator<Item = Block<'b>> {
        let total = segment.len();
        let block = move |first| {
            work::checkpoint();
            Block { segment, first, rows: BLOCK.min(total - first), state }
        };
        (0..total).step_by(BLOCK).map(block)
    }

    /// Returns true if it ends its segment.
    pub(super) fn is_last(&self) -> bool {
        self.first + self.rows == self.segment.len()
    }
}

/// Every signal of an equation, a block at a time.
pub(super) struct Lines<'a> {
    orders: &'a Orders,
    aim: Aim,
    y: Line,
    u: Vec<Line>,
    /// `w_k`.
    w: Vec<Line>,
    /// `v`; under [`Aim::Simulation`] the simulated output.
    v: Line,
    pub(super) e: Line,
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

impl<'a> Lines<'a> {
    pub(super) fn new(orders: &'a Orders, aim: Aim) -> Self {
        let line = Line::new(orders.memory());
        let each = vec![line.clone(); orders.inputs()];
        Lines {
            orders,
            aim,
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

    pub(super) fn clear(&mut self) {
        self.for_each(Line::clear);
    }

    pub(super) fn advance(&mut self, rows: usize) {
        self.for_each(|line| line.advance(rows));
    }

    /// `e`, and all it comes from.
    pub(super) fn errors(&mut self, block: &Block<'_>, p: &Polynomials<'_>) {
        let Block { segment, first, rows, state } = *block;
        let orders = self.orders;
        self.y.now_mut(rows).copy_from_slice(&segment.output[first..first + rows]);
        let mut taken = orders.output_states();
        let of_state = |from: usize, count: usize| state.get(from..from + count).unwrap_or(&[]);
        let inject = |rows: &mut [f64], state: &[f64], sign: f64| inject(rows, state, sign, first, segment);
        for k in 0..orders.inputs() {
            self.u[k].now_mut(rows).copy_from_slice(&segment.inputs[k][first..first + rows]);
            self.w[k].weigh(&self.u[k], p.b[k], orders.nk[k], rows);
            let count = orders.input_states(k);
            inject(self.w[k].now_mut(rows), of_state(taken, count), 1.0);
            self.w[k].recur(p.f[k], rows);
            taken += count;
        }
        self.v.now_mut(rows).fill(0.0);
        self.w.iter().for_each(|w| self.v.add_weighed(w, &[1.0], 0, rows));
        inject(self.v.now_mut(rows), of_state(0, orders.output_states()), 1.0);
        match self.aim {
            Aim::Prediction => {
                self.v.now_mut(rows).iter_mut().zip(self.y.now(rows)).for_each(|(v, y)| *v = y - *v);
                self.v.add_weighed(&self.y, p.a, 1, rows);
                self.e.weigh(&self.v, &[1.0], 0, rows);
                self.e.add_weighed(&self.v, p.d, 1, rows);
                inject(self.e.now_mut(rows), of_state(taken, orders.noise_states()), -1.0);
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
    pub(super) fn all(&mut self, block: &Block<'_>, p: &Polynomials<'_>) {
        self.errors(block, p);
        self.regressors(block.rows, p);
        self.impulses(block, p);
    }

    /// The filtered signals of the gradient, after [`Lines::errors`].
    pub(super) fn regressors(&mut self, rows: usize, p: &Polynomials<'_>) {
        let (orders, aim) = (self.orders, self.aim);
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
    pub(super) fn impulses(&mut self, block: &Block<'_>, p: &Polynomials<'_>) {
        let Block { segment, first, rows, .. } = *block;
        match &segment.impulse {
            Some(impulse) => self.impulse.now_mut(rows).copy_from_slice(&impulse[first..first + rows]),
            None => {
                self.impulse.now_mut(rows).fill(0.0);
                self.impulse.now_mut(rows).iter_mut().take(usize::from(first == 0)).for_each(|v| *v = 1.0);
            }
        }
        let (num, den) = p.filter(self.aim);
        self.output_impulse.run_through(&self.impulse, num, den, rows);
        for (line, f) in self.input_impulse.iter_mut().zip(&p.f) {
            line.run_through(&self.output_impulse, &[], f, rows);
        }
        if self.aim == Aim::Prediction {
            self.noise_impulse.run_through(&self.impulse, &[], p.c, rows);
        }
    }

    /// Returns true if nothing is left of the impulses, once the block that holds them is past.
    pub(super) fn impulses_are_over(&self) -> bool {
        let lines = [&self.output_impulse, &self.noise_impulse].into_iter().chain(&self.input_impulse);
        lines.flat_map(Line::past).all(|v| v.abs() < DECAYED)
    }

    /// Writes the rows of a column from `start` on of a block; rows with a missing output are zero.
    pub(super) fn write(&self, column: Column, block: &Block<'_>, start: usize, slot: &mut [f64]) {
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
        let source = &line.lag(column.lag, block.rows)[start..];
        slot.iter_mut().zip(source).for_each(|(s, v)| *s = column.sign * v);
        let first = block.first + start;
        block.segment.missing_in(first, slot.len()).iter().for_each(|t| slot[t - first] = 0.0);
    }
}

/// Adds `sign · state` to the first rows of a segment, of which `rows` are those from `first` on, each through what
/// became of an impulse there.
fn inject(rows: &mut [f64], state: &[f64], sign: f64, first: usize, segment: &Segment<'_>) {
    let Some(impulse) = &segment.impulse else {
        let part = state.get(first..).unwrap_or(&[]);
        return rows.iter_mut().zip(part).for_each(|(slot, x)| *slot += sign * x);
    };
    for (lag, x) in state.iter().enumerate().filter(|(_, x)| **x != 0.0) {
        let skipped = lag.saturating_sub(first);
        let later = impulse.get(first + skipped - lag..).unwrap_or(&[]);
        rows.iter_mut().skip(skipped).zip(later).for_each(|(slot, l)| *slot += sign * x * l);
    }
}
