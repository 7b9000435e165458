//! The triangular factor of the block Hankel matrix of past and future data.

use faer::Mat;
use numerics::parallel;

use crate::Dataset;
use crate::data::Experiment;
use fitting::{Triangle, gram};

/// Smallest diagonal of the Cholesky factor of a Gram matrix with unit diagonal at which the factor is still used. The
/// Gram matrix squares the condition of the data: at this bound its rounding is a millionth of the smallest direction.
const WELL_CONDITIONED: f64 = 1e-5;

/// Block rows of the past and of the future.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Horizons {
    pub(crate) past: usize,
    pub(crate) future: usize,
}

impl Horizons {
    pub(crate) fn total(self) -> usize {
        self.past + self.future
    }
}

/// Scaled channels of a data set, inputs first, and where each (block row, channel) stands among the columns: future
/// inputs, past of inputs and outputs, future outputs.
pub(crate) struct Hankel<'a> {
    pub(crate) horizons: Horizons,
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    /// Factor on each channel.
    weights: &'a [f64],
    /// The experiments long enough to fill one window.
    experiments: Vec<&'a Experiment>,
}

/// R of the Hankel matrix, windows × (block rows · channels).
pub(crate) struct HankelFactor {
    pub(crate) r: Mat<f64>,
    /// Number of windows.
    pub(crate) windows: usize,
}

impl<'a> Hankel<'a> {
    pub(crate) fn new(data: &'a Dataset, horizons: Horizons, weights: &'a [f64]) -> Self {
        let long_enough = |e: &&Experiment| e.len() >= horizons.total();
        Hankel {
            horizons,
            inputs: data.inputs(),
            outputs: data.outputs(),
            weights,
            experiments: data.experiments().iter().filter(long_enough).collect(),
        }
    }

    pub(crate) fn channels(&self) -> usize {
        self.inputs + self.outputs
    }

    pub(crate) fn columns(&self) -> usize {
        self.channels() * self.horizons.total()
    }

    pub(crate) fn windows(&self) -> usize {
        self.experiments.iter().map(|e| e.len() - self.horizons.total() + 1).sum()
    }

    /// The column of a channel (inputs first) at a block row.
    pub(crate) fn column(&self, block: usize, channel: usize) -> usize {
        let (m, q, Horizons { past, future }) = (self.inputs, self.channels(), self.horizons);
        match (block.checked_sub(past), channel.checked_sub(m)) {
            (None, _) => future * m + block * q + channel,
            (Some(ahead), None) => ahead * m + channel,
            (Some(ahead), Some(output)) => future * m + past * q + ahead * self.outputs + output,
        }
    }

    fn channel<'b>(&self, experiment: &'b Experiment, index: usize) -> &'b [f64] {
        index.checked_sub(self.inputs).map_or_else(|| experiment.input(index), |i| experiment.output(i))
    }

    /// The factor by way of the Gram matrix where that is accurate, by QR where it is not.
    pub(crate) fn factor(&self) -> HankelFactor {
        self.cholesky().unwrap_or_else(|| self.orthogonal())
    }

    /// The factor by Cholesky decomposition of the Gram matrix; `None` where that would lose accuracy.
    pub(crate) fn cholesky(&self) -> Option<HankelFactor> {
        let r = gram::cholesky(&self.gram(), WELL_CONDITIONED)?;
        Some(HankelFactor { r, windows: self.windows() })
    }

    /// The factor by QR of the rows, both halves of each experiment at the same time.
    pub(crate) fn orthogonal(&self) -> HankelFactor {
        let mut whole = Triangle::new(self.columns());
        for experiment in &self.experiments {
            let windows = experiment.len() - self.horizons.total() + 1;
            let half = windows / 2;
            let (first, second) =
                parallel::join(|| self.rows(experiment, 0..half), || self.rows(experiment, half..windows));
            push_matrix(&mut whole, &first);
            push_matrix(&mut whole, &second);
        }
        HankelFactor { r: whole.finish(), windows: self.windows() }
    }

    fn rows(&self, experiment: &Experiment, range: std::ops::Range<usize>) -> Mat<f64> {
        let mut triangle = Triangle::new(self.columns());
        let mut row = vec![0.0; self.columns()];
        for t in work::checked(range) {
            for channel in 0..self.channels() {
                let values = self.channel(experiment, channel);
                for block in 0..self.horizons.total() {
                    row[self.column(block, channel)] = self.weights[channel] * values[t + block];
                }
            }
            triangle.push_row(&row);
        }
        triangle.finish()
    }

    /// The Gram matrix.
    fn gram(&self) -> Mat<f64> {
        let (q, total) = (self.channels(), self.horizons.total());
        let places: Vec<(usize, usize)> = (0..total).flat_map(|b| (0..q).map(move |c| (b, c))).collect();
        let mut gram = Mat::zeros(self.columns(), self.columns());
        for experiment in &self.experiments {
            let channels: Vec<&[f64]> = (0..q).map(|c| self.channel(experiment, c)).collect();
            let windows = gram::of_windows(&channels, total);
            for (j, (to, d)) in places.iter().enumerate() {
                for (i, (from, c)) in places.iter().enumerate() {
                    let weight = self.weights[*c] * self.weights[*d];
                    gram[(self.column(*from, *c), self.column(*to, *d))] += weight * windows[(i, j)];
                }
            }
        }
        gram
    }
}

/// Appends the rows of a matrix.
pub(crate) fn push_matrix(triangle: &mut Triangle, rows: &Mat<f64>) {
    let mut row = vec![0.0; rows.ncols()];
    for i in 0..rows.nrows() {
        row.iter_mut().enumerate().for_each(|(j, v)| *v = rows[(i, j)]);
        triangle.push_row(&row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two inputs and two outputs over two experiments: sums of incommensurate tones and a scrambled sequence.
    fn data(scramble: f64) -> Dataset {
        let experiment = |samples: usize, phase: f64| {
            let mut state = 12345.0 + phase;
            let mut value = |t: usize, j: usize| {
                state = (state * 16807.0) % 2_147_483_647.0;
                scramble * (state / 2_147_483_647.0 - 0.5) + (0.3 * t as f64 + j as f64 + phase).sin()
            };
            let inputs = Mat::from_fn(samples, 2, &mut value);
            let outputs = Mat::from_fn(samples, 2, |t, j| 1e6 * value(t, j));
            Experiment { name: "x".into(), start_s: 0.0, inputs, outputs }
        };
        let first = experiment(20_000, 0.0);
        let data = Dataset::new(1.0, first.inputs, first.outputs).unwrap();
        data.with_experiment(experiment(700, 1.0)).unwrap()
    }

    const HORIZONS: Horizons = Horizons { past: 6, future: 5 };
    const WEIGHTS: [f64; 4] = [1.0, 1.0, 1e-6, 1e-6];

    #[test]
    fn prop_cholesky_and_orthogonal_factors_agree() {
        let data = data(1.0);
        let hankel = Hankel::new(&data, HORIZONS, &WEIGHTS);
        let (fast, slow) = (hankel.cholesky().unwrap(), hankel.orthogonal());
        for j in 0..hankel.columns() {
            for i in 0..=j {
                // The sign of each row of R is free.
                let aligned = slow.r[(i, j)] * slow.r[(i, i)].signum();
                assert!((fast.r[(i, j)] - aligned).abs() < 1e-10 * fast.r[(0, 0)], "{i} {j}");
            }
        }
    }

    #[test]
    fn prop_ill_conditioned_data_fall_back_to_orthogonal() {
        let data = data(1e-7);
        let hankel = Hankel::new(&data, HORIZONS, &WEIGHTS);
        assert!(hankel.cholesky().is_none());
        let (chosen, slow) = (hankel.factor(), hankel.orthogonal());
        assert_eq!(chosen.r, slow.r);
    }
}
