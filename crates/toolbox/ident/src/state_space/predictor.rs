//! One-step prediction errors of an innovations form.

use faer::{Mat, MatRef};
use lti::Innovations;

use crate::Dataset;
use crate::data::Experiment;
use crate::prediction::{Form, Gain};

/// Which matrices are free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Free {
    /// `A` and `C`.
    pub(crate) dynamics: bool,
    /// `D`.
    pub(crate) feedthrough: bool,
    /// `K`.
    pub(crate) noise: bool,
}

impl Free {
    /// The number of entries, `B` counted always: in the order A, B, C, D, K, each by rows.
    pub(crate) fn count(self, n: usize, m: usize, p: usize) -> usize {
        let when = |yes: bool, count: usize| if yes { count } else { 0 };
        n * m + when(self.dynamics, n * n + p * n) + when(self.feedthrough, p * m) + when(self.noise, n * p)
    }
}

/// The predictor's matrices by rows, for the time loop.
#[derive(Debug, Clone)]
pub(crate) struct Predictor {
    pub(crate) n: usize,
    pub(crate) m: usize,
    pub(crate) p: usize,
    a: Vec<f64>,
    b: Vec<f64>,
    pub(super) c: Vec<f64>,
    d: Vec<f64>,
    pub(super) k: Vec<f64>,
    /// `(A − K C)ᵀ`.
    pub(super) adjoint: Vec<f64>,
    pub(super) form: Form,
    /// The model whose errors after a missing output are as uncertain as errors are taken to be there.
    weighing: Form,
}

/// One instant of a pass over the data.
pub(super) struct Instant<'a> {
    /// x̂.
    pub(super) x: &'a [f64],
    pub(super) u: &'a [f64],
    /// ε, zero for an output that is missing.
    pub(super) e: &'a [f64],
    /// True if every output is there.
    pub(super) complete: bool,
    /// The gain, and what errors are weighed by, in an experiment where they change.
    pub(super) filter: Option<&'a Filter<'a>>,
}

/// The gain of the predictor in an experiment with missing outputs.
#[derive(Debug, Clone)]
pub(super) struct Filter<'a> {
    pub(super) gain: Gain<'a>,
    weights: Gain<'a>,
}

impl<'a> Filter<'a> {
    /// `None` where the gain stays: without missing outputs, or without a noise model.
    fn new(predictor: &'a Predictor, experiment: &Experiment) -> Option<Self> {
        let misses = (0..predictor.p).any(|i| experiment.output(i).iter().any(|y| y.is_nan()));
        let varies = misses && !predictor.form.is_output_error();
        varies.then(|| Filter { gain: Gain::new(&predictor.form), weights: Gain::new(&predictor.weighing) })
    }

    /// Moves on to an instant whose errors are `e`, NaN where an output is missing, which becomes zero.
    fn update(&mut self, e: &mut [f64]) {
        self.weights.update(&mut e.to_vec());
        self.gain.update(e);
    }

    /// Rows of errors or their derivatives with the weight that errors have where nothing was missing.
    pub(super) fn weigh(&self, rows: &mut [f64], width: usize) {
        self.weights.as_of_whole_data(rows, width);
    }
}

/// Sums over the prediction errors of a pass over the data.
pub(crate) struct Scatter {
    /// `Σ ε εᵀ`.
    pub(crate) sum: Mat<f64>,
    /// How many instants it runs over.
    pub(crate) instants: usize,
    /// States that were asked for.
    pub(crate) marked: Vec<Vec<f64>>,
}

fn by_rows(m: MatRef<'_, f64>) -> Vec<f64> {
    (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)])).collect()
}

/// `y += M x`, `M` by rows.
pub(super) fn add_product(m: &[f64], x: &[f64], y: &mut [f64]) {
    if x.is_empty() {
        return;
    }
    for (row, out) in m.chunks_exact(x.len()).zip(y) {
        let mut sum = 0.0;
        for (a, b) in row.iter().zip(x) {
            sum += a * b;
        }
        *out += sum;
    }
}

impl Predictor {
    pub(crate) fn new(model: &Innovations) -> Self {
        let system = model.system();
        let tilde = system.a() - model.k() * system.c();
        Predictor {
            n: system.states(),
            m: system.inputs(),
            p: system.outputs(),
            a: by_rows(system.a()),
            b: by_rows(system.b()),
            c: by_rows(system.c()),
            d: by_rows(system.d()),
            k: by_rows(model.k()),
            adjoint: by_rows(tilde.transpose()),
            form: Form::new(model.clone()),
            weighing: Form::new(model.clone()),
        }
    }

    /// With errors after a missing output as uncertain as they are by `other`.
    pub(crate) fn weighed_as(self, other: &Predictor) -> Self {
        Predictor { weighing: other.form.clone(), ..self }
    }

    /// Calls `visit` at every instant.
    pub(super) fn walk(&self, experiment: &Experiment, x0: &[f64], visit: impl FnMut(&Instant<'_>)) {
        Walk::new(self, experiment, x0).advance(experiment.len(), visit);
    }

    /// `Σ ε εᵀ` of the weighed errors, the instants it runs over, and the predicted states at the instants `marks` of
    /// each experiment, which ascend.
    pub(crate) fn scatter(&self, data: &Dataset, x0: &[Vec<f64>], marks: &[Vec<usize>]) -> Scatter {
        let mut sums = vec![0.0; self.p * self.p];
        let mut whole = Scatter { sum: Mat::zeros(self.p, self.p), instants: 0, marked: Vec::new() };
        for (index, (experiment, x0)) in data.experiments().iter().zip(x0).enumerate() {
            let mut awaited = marks.get(index).into_iter().flatten().peekable();
            let mut t = 0;
            let mut e = vec![0.0; self.p];
            self.walk(experiment, x0, |now| {
                if awaited.next_if(|mark| **mark == t).is_some() {
                    whole.marked.push(now.x.to_vec());
                }
                t += 1;
                if !now.complete {
                    return;
                }
                whole.instants += 1;
                now.weighed(&mut e);
                for (row, ei) in sums.chunks_exact_mut(self.p).zip(&e) {
                    row.iter_mut().zip(&e).for_each(|(s, ej)| *s += ei * ej);
                }
            });
        }
        whole.sum = Mat::from_fn(self.p, self.p, |i, j| sums[i * self.p + j]);
        whole
    }

    /// Root mean square of each predicted state, over the first instants of long experiments.
    pub(crate) fn state_sizes(&self, data: &Dataset, x0: &[Vec<f64>]) -> Vec<f64> {
        const ENOUGH: usize = 20_000;
        let mut sums = vec![0.0; self.n];
        let mut count = 0;
        for (experiment, x0) in data.experiments().iter().zip(x0) {
            let instants = experiment.len().min(ENOUGH);
            count += instants;
            Walk::new(self, experiment, x0).advance(instants, |now| {
                sums.iter_mut().zip(now.x).for_each(|(s, x)| *s += x * x);
            });
        }
        sums.iter().map(|s| (s / count.max(1) as f64).sqrt()).collect()
    }
}

impl Instant<'_> {
    /// Writes ε with the weight that errors have where nothing was missing.
    pub(super) fn weighed(&self, e: &mut [f64]) {
        e.copy_from_slice(self.e);
        if let Some(filter) = self.filter {
            filter.weigh(e, 1);
        }
    }
}

/// A pass of the predictor over an experiment, which may be interrupted.
pub(super) struct Walk<'a> {
    predictor: &'a Predictor,
    inputs: Vec<&'a [f64]>,
    outputs: Vec<&'a [f64]>,
    instant: usize,
    samples: usize,
    x: Vec<f64>,
    next: Vec<f64>,
    u: Vec<f64>,
    e: Vec<f64>,
    filter: Option<Filter<'a>>,
    correction: Vec<f64>,
}

impl<'a> Walk<'a> {
    pub(super) fn new(predictor: &'a Predictor, experiment: &'a Experiment, x0: &[f64]) -> Self {
        Walk {
            predictor,
            inputs: (0..predictor.m).map(|j| experiment.input(j)).collect(),
            outputs: (0..predictor.p).map(|i| experiment.output(i)).collect(),
            instant: 0,
            samples: experiment.len(),
            x: x0.to_vec(),
            next: vec![0.0; predictor.n],
            u: vec![0.0; predictor.m],
            e: vec![0.0; predictor.p],
            filter: Filter::new(predictor, experiment),
            correction: vec![0.0; predictor.n],
        }
    }

    /// Returns true if the gain changes on the way.
    pub(super) fn is_filtered(&self) -> bool {
        self.filter.is_some()
    }

    /// Returns true if the experiment has come to its end.
    pub(super) fn is_over(&self) -> bool {
        self.instant == self.samples
    }

    /// Goes on by this many instants, or to the end of the experiment.
    pub(super) fn advance(&mut self, instants: usize, mut visit: impl FnMut(&Instant<'_>)) {
        let Walk { predictor, inputs, outputs, x, next, u, e, filter, correction, .. } = self;
        let end = self.samples.min(self.instant + instants);
        for t in work::checked(self.instant..end) {
            u.iter_mut().zip(&*inputs).for_each(|(u, input)| *u = input[t]);
            e.fill(0.0);
            add_product(&predictor.c, x, e);
            add_product(&predictor.d, u, e);
            e.iter_mut().zip(&*outputs).for_each(|(e, output)| *e = output[t] - *e);
            let complete = outputs.iter().all(|output| !output[t].is_nan());
            match filter {
                Some(filter) => filter.update(e),
                None if !complete => {
                    let missing = e.iter_mut().zip(&*outputs).filter(|(_, output)| output[t].is_nan());
                    missing.for_each(|(e, _)| *e = 0.0);
                }
                None => {}
            }
            visit(&Instant { x, u, e, complete, filter: filter.as_ref() });
            next.fill(0.0);
            add_product(&predictor.a, x, next);
            add_product(&predictor.b, u, next);
            match filter {
                Some(filter) => {
                    filter.gain.apply(e, correction);
                    next.iter_mut().zip(&*correction).for_each(|(x, v)| *x += v);
                }
                None => add_product(&predictor.k, e, next),
            }
            std::mem::swap(x, next);
        }
        self.instant = end;
    }
}
