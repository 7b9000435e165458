//! The Kalman filter, one measurement after the other.

use faer::MatRef;
use numerics::vector::dot;

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

/// What the filter leaves behind: innovations, and where it is asked for, what the way back needs. Matrices are by rows.
pub(super) struct Forward {
    pub(super) states: usize,
    pub(super) transition: Vec<f64>,
    pub(super) output: Vec<f64>,
    pub(super) innovations: Vec<Innovation>,
    /// Gain of each innovation.
    pub(super) gains: Vec<f64>,
    /// x(k) given the measurements before sample k.
    pub(super) predicted: Vec<f64>,
    /// Its covariance.
    pub(super) covariances: Vec<f64>,
    /// Equal where gains, variances and covariances are.
    pub(super) settled: Vec<usize>,
}

/// What one sample makes of a covariance.
#[derive(Clone)]
struct Sample {
    /// Number of the step that is settled upon.
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
            transition: by_rows(system.system.a()),
            output: by_rows(system.system.c()),
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
        };
        for sample in 0..samples {
            if keep {
                forward.predicted.extend_from_slice(&filter.x);
                forward.covariances.extend_from_slice(&filter.p);
            }
            measured.clear();
            measured.extend((0..outputs.ncols()).filter(|i| !outputs[(sample, *i)].is_nan()));
            let p = std::mem::take(&mut filter.p);
            let made = memory.step(&measured, &p, || {
                filter.covariances(&p, (&forward.output, &forward.transition), &measured, sample)
            })?;
            for (i, output) in measured.iter().enumerate() {
                let expected = filter.expected(&forward.output, *output, inputs, sample);
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

    pub(super) fn log_likelihood(&self) -> f64 {
        let each = |one: &Innovation| (std::f64::consts::TAU * one.variance).ln() + one.value.powi(2) / one.variance;
        -0.5 * self.innovations.iter().map(each).sum::<f64>()
    }
}

impl Filter<'_> {
    /// What an output is expected to be.
    fn expected(&self, c: &[f64], output: usize, inputs: MatRef<'_, f64>, sample: usize) -> f64 {
        let n = self.x.len();
        let through = (0..inputs.ncols()).map(|j| self.system.system.d()[(output, j)] * inputs[(sample, j)]);
        dot(&c[output * n..(output + 1) * n], &self.x) + through.sum::<f64>()
    }

    /// What the sample with this number makes of the covariance, with these outputs measured.
    fn covariances(
        &mut self,
        before: &[f64],
        (c, a): (&[f64], &[f64]),
        measured: &[usize],
        number: usize,
    ) -> Result<Sample, IdentError> {
        let n = self.x.len();
        self.p = before.to_vec();
        let mut made = Sample { number, variances: Vec::new(), gains: Vec::new(), next: Vec::new() };
        for output in measured {
            made.variances.push(self.update(&c[output * n..(output + 1) * n], *output)?);
            made.gains.extend_from_slice(&self.column);
        }
        self.predict(a);
        made.next = std::mem::take(&mut self.p);
        Ok(made)
    }

    /// Takes up one measurement and returns the variance of its innovation; `column` is then its gain.
    fn update(&mut self, c: &[f64], output: usize) -> Result<f64, IdentError> {
        let n = self.x.len();
        for i in 0..n {
            self.column[i] = dot(&self.p[i * n..(i + 1) * n], c);
        }
        let variance = dot(c, &self.column) + self.system.measurement_variance[output];
        if !(variance > 0.0 && variance.is_finite()) {
            return Err(CERTAIN);
        }
        self.column.iter_mut().for_each(|gain| *gain /= variance);
        self.joseph(c, self.system.measurement_variance[output]);
        Ok(variance)
    }

    /// P ← L P Lᵀ + r K Kᵀ with L = I − K cᵀ and K in `column`: Joseph's form, positive where P is far above r.
    fn joseph(&mut self, c: &[f64], r: f64) {
        let n = self.x.len();
        for i in 0..n {
            let (row, gain) = (&mut self.p[i * n..(i + 1) * n], &self.column);
            // Row i of P Lᵀ.
            let seen = dot(row, c);
            row.iter_mut().zip(gain).for_each(|(p, gain)| *p -= seen * gain);
        }
        for j in 0..n {
            let seen: f64 = (0..n).map(|i| c[i] * self.p[i * n + j]).sum();
            for i in 0..n {
                self.p[i * n + j] += (r * self.column[j] - seen) * self.column[i];
            }
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
    fn predict(&mut self, a: &[f64]) {
        let n = self.x.len();
        for i in 0..n {
            for j in 0..n {
                // P is symmetric: its rows are its columns.
                self.product[i * n + j] = dot(&a[i * n..(i + 1) * n], &self.p[j * n..(j + 1) * n]);
            }
        }
        for i in 0..n {
            for j in 0..=i {
                let sum = dot(&self.product[i * n..(i + 1) * n], &a[j * n..(j + 1) * n]);
                let value =
                    sum + 0.5 * (self.system.process_covariance[(i, j)] + self.system.process_covariance[(j, i)]);
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
