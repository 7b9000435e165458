//! How prediction errors change along directions of the parameters, by the linear equations that the changes obey.
//!
//! With `x⁺ = A x + B u + K e` and `e = y − C x − D u`, a change of the matrices makes `de = −(C s + dC x + dD u)` and
//! `s⁺ = A s + K de + dA x + dB u + dK e` from `s = 0` on. All directions go through the record side by side, so that
//! each entry of a matrix is read once a sample, and serves whole vector registers.
//!
//! # Source
//! Ljung 1999, §10.3 (gradients of the predictor).

use lti::Innovations;

use crate::Experiment;

/// The entries of a matrix that are not zero.
struct Entries {
    places: Vec<(usize, usize)>,
    values: Vec<f64>,
}

impl Entries {
    fn new(rows: usize, columns: usize, value: impl Fn(usize, usize) -> f64) -> Self {
        let places = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).filter(|(i, j)| value(*i, *j) != 0.0);
        let places: Vec<(usize, usize)> = places.collect();
        let values = places.iter().map(|(i, j)| value(*i, *j)).collect();
        Entries { places, values }
    }

    /// `out += factor · M table`, where a row of both tables holds all directions.
    fn add_product(&self, factor: f64, table: &[f64], width: usize, out: &mut [f64]) {
        for ((i, j), value) in self.places.iter().zip(&self.values) {
            add_scaled(factor * value, &table[j * width..][..width], &mut out[i * width..][..width]);
        }
    }

    /// `out += M z`.
    fn add_vector(&self, z: &[f64], out: &mut [f64]) {
        for ((i, j), value) in self.places.iter().zip(&self.values) {
            out[*i] += value * z[*j];
        }
    }
}

/// `out += weight · row`.
fn add_scaled(weight: f64, row: &[f64], out: &mut [f64]) {
    for (slot, value) in out.iter_mut().zip(row) {
        *slot += weight * value;
    }
}

/// Change of a matrix that acts on `[x; u; e]` by one unit of each direction: an entry that changes in any of them,
/// with its change in each.
struct Changes {
    places: Vec<(usize, usize)>,
    weights: Vec<f64>,
}

impl Changes {
    /// `change(direction, row, column)`.
    fn new(rows: usize, columns: usize, width: usize, change: impl Fn(usize, usize, usize) -> f64) -> Self {
        let (mut places, mut weights) = (Vec::new(), Vec::new());
        for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            if (0..width).any(|k| change(k, i, j) != 0.0) {
                places.push((i, j));
                weights.extend((0..width).map(|k| change(k, i, j)));
            }
        }
        Changes { places, weights }
    }

    /// `out += factor · dM z`.
    fn add_product(&self, factor: f64, z: &[f64], width: usize, out: &mut [f64]) {
        for ((i, j), weights) in self.places.iter().zip(self.weights.chunks_exact(width)) {
            add_scaled(factor * z[*j], weights, &mut out[i * width..][..width]);
        }
    }
}

/// A model in innovations form, and what directions of its parameters change of it.
pub(super) struct Tangent {
    states: usize,
    inputs: usize,
    outputs: usize,
    width: usize,
    a: Entries,
    c: Entries,
    k: Entries,
    /// `[A B K]` and `[C D]` on `[x; u; e]`.
    transition: Entries,
    output: Entries,
    d_transition: Changes,
    d_output: Changes,
    /// Changes of the first state along the directions, states × directions.
    start: Vec<f64>,
}

/// Part of its largest changes below which a part that nothing drives has ended. Beyond lie numbers so small that the
/// processor is slow with them.
const ENDED: f64 = 1e-30;
/// Samples from one look at that to the next.
const LOOKS: usize = 16;

impl Tangent {
    /// The form of a model, with a unit of each entry of its first state as a direction.
    pub(super) fn of_states(form: &Innovations) -> Self {
        let n = form.system().states();
        let unmoved = vec![form; n];
        let start = (0..n * n).map(|at| f64::from(u8::from(at % (n + 1) == 0))).collect();
        Tangent { start, ..Tangent::new(form, &unmoved, 1.0) }
    }

    /// The form of a model, and the forms that it has a step `h` along each direction from there. All have the same
    /// size.
    pub(super) fn new(form: &Innovations, moved: &[&Innovations], h: f64) -> Self {
        let system = form.system();
        let (n, m, p, width) = (system.states(), system.inputs(), system.outputs(), moved.len());
        let transition = |form: &Innovations, i: usize, j: usize| match j {
            j if j < n => form.system().a()[(i, j)],
            j if j < n + m => form.system().b()[(i, j - n)],
            j => form.k()[(i, j - n - m)],
        };
        let output = |form: &Innovations, i: usize, j: usize| match j {
            j if j < n => form.system().c()[(i, j)],
            j => form.system().d()[(i, j - n)],
        };
        Tangent {
            states: n,
            inputs: m,
            outputs: p,
            width,
            a: Entries::new(n, n, |i, j| system.a()[(i, j)]),
            c: Entries::new(p, n, |i, j| system.c()[(i, j)]),
            k: Entries::new(n, p, |i, j| form.k()[(i, j)]),
            transition: Entries::new(n, n + m + p, |i, j| transition(form, i, j)),
            output: Entries::new(p, n + m, |i, j| output(form, i, j)),
            d_transition: Changes::new(n, n + m + p, width, |k, i, j| {
                (transition(moved[k], i, j) - transition(form, i, j)) / h
            }),
            d_output: Changes::new(p, n + m, width, |k, i, j| (output(moved[k], i, j) - output(form, i, j)) / h),
            start: vec![0.0; n * width],
        }
    }

    fn is_driven(&self) -> bool {
        !self.d_transition.places.is_empty() || !self.d_output.places.is_empty()
    }

    /// Writes the change of the errors of one experiment without missing outputs into its rows of a column for each
    /// direction, output by output. Whether each stays finite.
    pub(super) fn errors(&self, experiment: &Experiment, x0: &[f64], columns: &mut [&mut [f64]]) -> Vec<bool> {
        let Tangent { states, inputs, outputs, width, .. } = *self;
        let length = experiment.len();
        // [x; u; e], the changes of x and of e, and what comes next of both.
        let mut z = x0.to_vec();
        z.resize(states + inputs + outputs, 0.0);
        let (mut s, mut next_s) = (self.start.clone(), vec![0.0; states * width]);
        let (mut de, mut next_x, mut y) = (vec![0.0; outputs * width], vec![0.0; states], vec![0.0; outputs]);
        let mut largest = 0.0_f64;
        for t in work::checked(0..length) {
            de.fill(0.0);
            self.c.add_product(-1.0, &s, width, &mut de);
            if self.is_driven() {
                (0..inputs).for_each(|k| z[states + k] = experiment.input(k)[t]);
                y.fill(0.0);
                self.output.add_vector(&z, &mut y);
                (0..outputs).for_each(|i| z[states + inputs + i] = experiment.output(i)[t] - y[i]);
                self.d_output.add_product(-1.0, &z, width, &mut de);
            } else if t % LOOKS == 0 {
                let size = s.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
                largest = largest.max(size);
                if size <= ENDED * largest {
                    break;
                }
            }
            for (k, column) in columns.iter_mut().enumerate() {
                (0..outputs).for_each(|i| column[i * length + t] = de[i * width + k]);
            }
            next_s.fill(0.0);
            self.a.add_product(1.0, &s, width, &mut next_s);
            self.k.add_product(1.0, &de, width, &mut next_s);
            std::mem::swap(&mut s, &mut next_s);
            if self.is_driven() {
                self.d_transition.add_product(1.0, &z, width, &mut s);
                next_x.fill(0.0);
                self.transition.add_vector(&z, &mut next_x);
                z[..states].copy_from_slice(&next_x);
            }
        }
        let is_finite = z.iter().all(|v| v.is_finite());
        (0..width).map(|k| is_finite && (0..states).all(|i| s[i * width + k].is_finite())).collect()
    }
}
