//! The regression of `B`, `D` and initial states from correlations alone.

use faer::{Mat, MatRef};
use lti::{Complex64, polynomial};
use numerics::linalg;

use super::lineariser::Linearised;
use super::predictor::Predictor;
use crate::Dataset;
use crate::data::Experiment;
use crate::dense::spectral_radius;
use fitting::{Triangle, gram};

/// Smallest diagonal of the Cholesky factor of a Gram matrix with unit diagonal at which the factor is still used.
const WELL_CONDITIONED: f64 = 1e-4;
/// Most that sums may cancel on the way to that Gram matrix: with the bound above rounding stays below 1e-4 of the
/// smallest direction.
const CANCELLING: f64 = 1e4;
/// An initial state is over when this part of it is left.
const DECAYED: f64 = 1e-14;
/// Least distance of the predictor's poles from the unit circle.
const INSIDE: f64 = 1e-3;

/// The factor of `[Ψ₀, Ψ, ε]` for `B`, and `D` where there is feed-through, of a predictor in which both are zero.
///
/// With `χ` the characteristic polynomial of `Ã = A − K C`, `ŷ = adj(…)/χ · u`, so that every column of `Ψ` is a sum of
/// few shifts of `w = u/χ`: one filter an input, and the correlations of w and ε over n lags, hold all there is to
/// know. `None` where outputs are missing, or where that would lose accuracy.
pub(super) fn factor(
    data: &Dataset,
    predictor: &Predictor,
    closed: MatRef<'_, f64>,
    feedthrough: bool,
    whitening: MatRef<'_, f64>,
) -> Option<Linearised> {
    if spectral_radius(closed).ok()? > 1.0 - INSIDE {
        return None;
    }
    let poles: Vec<Complex64> = linalg::eigenvalues(closed).ok()?;
    let shape = Shape { predictor, closed, feedthrough, whitening, denominator: polynomial::from_roots(&poles) };
    let columns = shape.columns();
    let width = columns.first()?.ncols();
    let mut whole = Triangle::for_rows(width, data.experiments().len() * width);
    let (mut tops, mut rows) = (Vec::new(), 0);
    for experiment in data.experiments() {
        let factor = gram::cholesky(&shape.gram(experiment, &columns)?, WELL_CONDITIONED)?;
        tops.push(factor.subrows(0, predictor.n).to_owned());
        for i in predictor.n..factor.nrows() {
            whole.push_row(&(0..width).map(|j| factor[(i, predictor.n + j)]).collect::<Vec<_>>());
        }
        rows += predictor.p * experiment.len();
    }
    Some(Linearised { factor: whole.finish(), rows, tops })
}

struct Shape<'a> {
    predictor: &'a Predictor,
    closed: MatRef<'a, f64>,
    feedthrough: bool,
    whitening: MatRef<'a, f64>,
    /// `χ`, its leading coefficient one first.
    denominator: Vec<f64>,
}

impl Shape<'_> {
    /// For each whitened output the columns `[Ψ, ε]` in terms of w and ε at the lags n … 0: (lags · channels) ×
    /// columns.
    fn columns(&self) -> Vec<Mat<f64>> {
        let Predictor { n, m, p, .. } = *self.predictor;
        let (channels, direct) = (m + p, if self.feedthrough { p * m } else { 0 });
        let place = |lag: usize, channel: usize| (n - lag) * channels + channel;
        let numerators = self.numerators();
        let mut plain = vec![Mat::zeros((n + 1) * channels, n * m + direct + 1); p];
        for (l, columns) in plain.iter_mut().enumerate() {
            for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
                (1..=n).for_each(|lag| columns[(place(lag, j), i * m + j)] = numerators[lag - 1][(l, i)]);
            }
            for (i, j) in (0..direct / m.max(1)).flat_map(|i| (0..m).map(move |j| (i, j))) {
                let column = n * m + i * m + j;
                for lag in 0..=n {
                    let own = if i == l { self.denominator[lag] } else { 0.0 };
                    let through = if lag == 0 { 0.0 } else { self.gain_of(&numerators[lag - 1], l, i) };
                    columns[(place(lag, j), column)] = own - through;
                }
            }
            columns[(place(0, m + l), n * m + direct)] = 1.0;
        }
        let whitened = |l: usize| {
            let zero = Mat::zeros(plain[0].nrows(), plain[0].ncols());
            (0..p).fold(zero, |sum, i| sum + faer::Scale(self.whitening[(l, i)]) * &plain[i])
        };
        (0..p).map(whitened).collect()
    }

    /// `[N K]_{l,i}` of a coefficient N of the numerators.
    fn gain_of(&self, numerator: &Mat<f64>, l: usize, i: usize) -> f64 {
        let p = self.predictor.p;
        (0..self.predictor.n).map(|s| numerator[(l, s)] * self.predictor.k[s * p + i]).sum()
    }

    /// The coefficients `N_1 … N_n` of `C (q − Ã)⁻¹ χ(q)` in powers of `q⁻¹`, outputs × states each.
    fn numerators(&self) -> Vec<Mat<f64>> {
        let Predictor { n, p, .. } = *self.predictor;
        let mut responses = vec![Mat::from_fn(p, n, |l, i| self.predictor.c[l * n + i])];
        (1..n).for_each(|t| responses.push(&responses[t - 1] * self.closed));
        let coefficient = |lag: usize| {
            let sum = Mat::zeros(p, n);
            (0..lag).fold(sum, |sum, s| sum + faer::Scale(self.denominator[s]) * &responses[lag - 1 - s])
        };
        (1..=n).map(coefficient).collect()
    }

    /// The Gram matrix of `[Ψ₀, Ψ, ε]` over an experiment; `None` where an output is missing or sums cancel.
    fn gram(&self, experiment: &Experiment, columns: &[Mat<f64>]) -> Option<Mat<f64>> {
        let (n, signals) = (self.predictor.n, self.signals(experiment)?);
        let channels: Vec<&[f64]> = signals.iter().map(Vec::as_slice).collect();
        let windows = gram::of_windows(&channels, n + 1);
        let sizes = Mat::from_fn(windows.nrows(), windows.ncols(), |i, j| windows[(i, j)].abs());
        let width = columns[0].ncols();
        let (mut whole, mut bounds) = (Mat::zeros(n + width, n + width), vec![0.0; width]);
        for of in columns {
            let inner = of.transpose() * &windows * of;
            let magnitudes = Mat::from_fn(of.nrows(), width, |i, j| of[(i, j)].abs());
            let bound = &sizes * &magnitudes;
            for j in 0..width {
                bounds[j] += (0..of.nrows()).map(|i| magnitudes[(i, j)] * bound[(i, j)]).sum::<f64>();
                (0..width).for_each(|i| whole[(n + i, n + j)] += inner[(i, j)]);
            }
        }
        if (0..width).any(|j| bounds[j].is_nan() || bounds[j] > CANCELLING * whole[(n + j, n + j)]) {
            return None;
        }
        self.add_initial(&channels, columns, &mut whole);
        Some(whole)
    }

    /// w of each input and ε of each output, with n zeros before the first sample.
    fn signals(&self, experiment: &Experiment) -> Option<Vec<Vec<f64>>> {
        let Predictor { n, m, p, .. } = *self.predictor;
        let mut all = vec![vec![0.0; n]; m + p];
        all.iter_mut().for_each(|signal| signal.reserve(experiment.len()));
        for (j, w) in all[..m].iter_mut().enumerate() {
            for (t, u) in work::checked(experiment.input(j)).enumerate() {
                let past = w[t..t + n].iter().rev().zip(&self.denominator[1..]);
                w.push(u - past.map(|(w, a)| w * a).sum::<f64>());
            }
        }
        let mut whole = true;
        self.predictor.walk(experiment, &vec![0.0; n], |now| {
            whole &= now.complete;
            all[m..].iter_mut().zip(now.e).for_each(|(signal, e)| signal.push(*e));
        });
        whole.then_some(all)
    }

    /// The rows and columns of the initial state, whose influence is followed until it has decayed.
    fn add_initial(&self, channels: &[&[f64]], columns: &[Mat<f64>], whole: &mut Mat<f64>) {
        let Predictor { n, p, .. } = *self.predictor;
        let width = columns[0].ncols();
        let c = Mat::from_fn(p, n, |l, i| self.predictor.c[l * n + i]);
        let mut state = self.whitening * c;
        let least = DECAYED * state.norm_max();
        let mut row = vec![0.0; n + width];
        for t in work::checked(0..channels[0].len() - n) {
            if state.norm_max() <= least {
                return;
            }
            for (l, of) in columns.iter().enumerate() {
                (0..n).for_each(|i| row[i] = state[(l, i)]);
                for j in 0..width {
                    let blocks = of.col_as_slice(j).chunks_exact(channels.len()).enumerate();
                    row[n + j] =
                        blocks.map(|(b, w)| w.iter().zip(channels).map(|(w, s)| w * s[t + b]).sum::<f64>()).sum();
                }
                for i in 0..n {
                    (0..n + width).for_each(|j| whole[(i, j)] += row[i] * row[j]);
                    (n..n + width).for_each(|j| whole[(j, i)] += row[i] * row[j]);
                }
            }
            state = &state * self.closed;
        }
    }
}
