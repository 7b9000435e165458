//! The Kalman filter, one measurement after the other.

use std::ops::Range;

use faer::MatRef;

use super::sparse::{SparseRow, sparse_rows};
use super::steady::Memory;
use super::system::{Belief, NoisySystem, check_length, check_square};
use crate::IdentError;
use crate::structure_error::StructureError;

const CERTAIN: IdentError = IdentError::Structure(StructureError::CertainMeasurement);

/// A measurement against what was expected of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Innovation {
    pub(super) sample: usize,
    pub(super) output: usize,
    pub(super) value: f64,
    pub(super) variance: f64,
}

/// Result of the filter: innovations and, where it is asked for, the values that the way back needs. Matrices are by
/// rows.
pub(super) struct Forward {
    pub(super) states: usize,
    /// A, and the same without its zeros.
    pub(super) by_rows: Vec<f64>,
    pub(super) transition: Vec<SparseRow>,
    /// C.
    pub(super) output: Vec<SparseRow>,
    pub(super) innovations: Vec<Innovation>,
    /// Gain of each innovation.
    gains: Vec<f64>,
    /// x(k) given the measurements before sample k.
    pub(super) predicted: Vec<f64>,
    /// Its covariances, each different one once.
    covariances: Vec<f64>,
    /// Which of them is that of a sample: equal where gains and variances are.
    pub(super) settled: Vec<usize>,
}

/// Effect of one sample on a covariance.
#[derive(Clone)]
struct Sample {
    /// Which of the covariances that are kept it is made of.
    number: usize,
    /// Of each measurement.
    variances: Vec<f64>,
    /// Of each measurement, one after the other.
    gains: Vec<f64>,
    /// The covariance of the sample after it.
    next: Vec<f64>,
}

/// The filter on its way.
struct Filter<'a> {
    system: &'a NoisySystem,
    x: Vec<f64>,
    p: Vec<f64>,
    /// Room for a product.
    product: Vec<f64>,
    column: Vec<f64>,
    seen: Vec<f64>,
}

impl Forward {
    /// Runs the filter; `keep` what the smoother needs.
    pub(super) fn run(
        system: &NoisySystem,
        start: &Belief,
        inputs: MatRef<'_, f64>,
        outputs: MatRef<'_, f64>,
        keep: bool,
    ) -> Result<Forward, IdentError> {
        check(system, start, inputs, outputs)?;
        let n = system.system.states();
        let samples = outputs.nrows();
        let mut forward = Forward {
            states: n,
            by_rows: by_rows(system.system.a()),
            transition: sparse_rows(system.system.a()),
            output: sparse_rows(system.system.c()),
            innovations: Vec::with_capacity(samples),
            gains: Vec::new(),
            predicted: Vec::new(),
            covariances: Vec::new(),
            settled: Vec::new(),
        };
        let by_columns = by_rows(system.system.a().transpose());
        let mut memory: Memory<Vec<usize>, Sample> = Memory::new();
        let mut measured = Vec::with_capacity(outputs.ncols());
        let mut filter = Filter {
            system,
            x: start.mean.clone(),
            p: by_rows(start.covariance.as_ref()),
            product: vec![0.0; n * n],
            column: vec![0.0; n],
            seen: vec![0.0; n],
        };
        for sample in work::checked(0..samples) {
            if keep {
                forward.predicted.extend_from_slice(&filter.x);
            }
            measured.clear();
            measured.extend((0..outputs.ncols()).filter(|i| !outputs[(sample, *i)].is_nan()));
            let p = std::mem::take(&mut filter.p);
            let made = memory.step(&measured, &p, || {
                let number = forward.covariances.len() / (n * n).max(1);
                if keep {
                    forward.covariances.extend_from_slice(&p);
                }
                filter.covariances(&p, &forward.output, &forward.transition, &measured, number)
            })?;
            for (i, output) in measured.iter().enumerate() {
                let expected = filter.expected(&forward.output[*output], *output, inputs, sample);
                let value = outputs[(sample, *output)] - expected;
                if !value.is_finite() {
                    return Err(CERTAIN);
                }
                let gain = &made.gains[i * n..(i + 1) * n];
                filter.x.iter_mut().zip(gain).for_each(|(x, gain)| *x += gain * value);
                forward.innovations.push(Innovation { sample, output: *output, value, variance: made.variances[i] });
                if keep {
                    forward.gains.extend_from_slice(gain);
                }
            }
            if keep {
                forward.settled.push(made.number);
            }
            filter.advance(&by_columns, inputs, sample);
            filter.p = p;
            filter.p.copy_from_slice(&made.next);
        }
        Ok(forward)
    }

    /// The covariance of x(k) given the measurements before sample k.
    pub(super) fn covariance(&self, sample: usize) -> &[f64] {
        let square = self.states * self.states;
        &self.covariances[self.settled[sample] * square..(self.settled[sample] + 1) * square]
    }

    /// The innovations of a sample, which end at `end`; it is moved to where they begin.
    pub(super) fn measured_at(&self, sample: usize, end: &mut usize) -> Range<usize> {
        let last = *end;
        while *end > 0 && self.innovations[*end - 1].sample == sample {
            *end -= 1;
        }
        *end..last
    }

    /// The gain of an innovation.
    pub(super) fn gain(&self, innovation: usize) -> &[f64] {
        &self.gains[innovation * self.states..(innovation + 1) * self.states]
    }

    pub(super) fn log_likelihood(&self) -> f64 {
        let each = |one: &Innovation| (std::f64::consts::TAU * one.variance).ln() + one.value.powi(2) / one.variance;
        -0.5 * self.innovations.iter().map(each).sum::<f64>()
    }
}

impl Filter<'_> {
    /// Expected value of an output.
    fn expected(&self, c: &SparseRow, output: usize, inputs: MatRef<'_, f64>, sample: usize) -> f64 {
        let through = (0..inputs.ncols()).map(|j| self.system.system.d()[(output, j)] * inputs[(sample, j)]);
        c.dot(&self.x) + through.sum::<f64>()
    }

    /// Computes the effect of a sample on the covariance with this number, with these outputs measured.
    fn covariances(
        &mut self,
        before: &[f64],
        c: &[SparseRow],
        a: &[SparseRow],
        measured: &[usize],
        number: usize,
    ) -> Result<Sample, IdentError> {
        self.p = before.to_vec();
        let mut made = Sample { number, variances: Vec::new(), gains: Vec::new(), next: Vec::new() };
        for output in measured {
            made.variances.push(self.update(&c[*output], self.system.measurement_variance[*output])?);
            made.gains.extend_from_slice(&self.column);
        }
        self.predict(a);
        made.next = std::mem::take(&mut self.p);
        Ok(made)
    }

    /// Takes up one measurement of variance r and returns the variance of its innovation; `column` is then its gain.
    fn update(&mut self, c: &SparseRow, r: f64) -> Result<f64, IdentError> {
        let n = self.x.len();
        for i in 0..n {
            self.column[i] = c.dot(&self.p[i * n..(i + 1) * n]);
        }
        let variance = c.dot(&self.column) + r;
        if !(variance > 0.0 && variance.is_finite()) {
            return Err(CERTAIN);
        }
        self.column.iter_mut().for_each(|gain| *gain /= variance);
        self.joseph(c, r);
        Ok(variance)
    }

    /// P ← L P Lᵀ + r K Kᵀ with L = I − K cᵀ and K in `column`: Joseph's form, positive where P is far above r.
    fn joseph(&mut self, c: &SparseRow, r: f64) {
        let n = self.x.len();
        let Filter { p, product, column, seen, .. } = self;
        p.chunks_exact(n.max(1)).zip(seen.iter_mut()).for_each(|(row, seen)| *seen = c.dot(row));
        // r K − P Lᵀ c, which each row of P Lᵀ takes up by its gain.
        let more = &mut product[..n];
        c.times(p, n, more);
        let shown = c.dot(seen);
        more.iter_mut().zip(&*column).for_each(|(more, gain)| *more = r * gain - (*more - shown * gain));
        for ((row, seen), gain) in p.chunks_exact_mut(n.max(1)).zip(&*seen).zip(&*column) {
            let entries = row.iter_mut().zip(&*column).zip(&*more);
            entries.for_each(|((entry, column), more)| *entry = (*entry - seen * column) + gain * more);
        }
    }

    /// One sample on: A x + B u, A by columns.
    fn advance(&mut self, by_columns: &[f64], inputs: MatRef<'_, f64>, sample: usize) {
        let b = self.system.system.b();
        add_columns(by_columns, &self.x, &mut self.column);
        for (i, next) in self.column.iter_mut().enumerate() {
            *next += (0..inputs.ncols()).map(|j| b[(i, j)] * inputs[(sample, j)]).sum::<f64>();
        }
        self.x.copy_from_slice(&self.column);
    }

    /// One sample on: A P Aᵀ + Q.
    fn predict(&mut self, a: &[SparseRow]) {
        let n = self.x.len();
        for (row, product) in a.iter().zip(self.product.chunks_exact_mut(n.max(1))) {
            row.times(&self.p, n, product);
        }
        // P is symmetric: A P Aᵀ is A (A P)ᵀ.
        for i in 0..n {
            for j in 0..n {
                self.p[j * n + i] = self.product[i * n + j];
            }
        }
        for (i, (row, product)) in a.iter().zip(self.product.chunks_exact_mut(n.max(1))).enumerate() {
            row.times(&self.p, n, &mut product[..=i]);
        }
        let noise = &self.system.process_covariance;
        for i in 0..n {
            for j in 0..=i {
                let value = self.product[i * n + j] + 0.5 * (noise[(i, j)] + noise[(j, i)]);
                self.p[i * n + j] = value;
                self.p[j * n + i] = value;
            }
        }
    }
}

fn check(
    system: &NoisySystem,
    start: &Belief,
    inputs: MatRef<'_, f64>,
    outputs: MatRef<'_, f64>,
) -> Result<(), IdentError> {
    let n = system.system.states();
    check_length("states at the start", n, start.mean.len())?;
    check_square("covariance at the start", n, start.covariance.as_ref())?;
    check_length("inputs", system.system.inputs(), inputs.ncols())?;
    check_length("outputs", system.system.outputs(), outputs.ncols())?;
    check_length("samples of the inputs", outputs.nrows(), inputs.nrows())?;
    let is_finite = |k: &usize| (0..inputs.ncols()).all(|j| inputs[(*k, j)].is_finite());
    match (0..inputs.nrows()).find(|k| !is_finite(k)) {
        Some(index) => Err(IdentError::NotFinite { what: "the input", index }),
        None => Ok(()),
    }
}

/// The product of a square matrix, by columns, and a vector.
pub(super) fn add_columns(by_columns: &[f64], x: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    for (column, x) in by_columns.chunks_exact(product.len().max(1)).zip(x) {
        product.iter_mut().zip(column).for_each(|(sum, a)| *sum += a * x);
    }
}

fn by_rows(m: MatRef<'_, f64>) -> Vec<f64> {
    (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)])).collect()
}
