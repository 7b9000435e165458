//! A long ARX model of all data: what no model of the family predicts much better than.

use faer::Mat;

use super::orders::Orders;
use super::segment::Segment;
use crate::distributions::chi_squared_quantile;
use fitting::gram;

/// Order of the long model.
const ORDER: usize = 36;
/// Rows of data a coefficient that it takes at least.
const ROWS: usize = 25;
/// Orders beyond the memory of the model it is to judge.
const BEYOND: usize = 8;
/// Smallest diagonal of the Cholesky factor of the Gram matrix with unit diagonal at which the long model is trusted.
const WELL_CONDITIONED: f64 = 1e-5;
/// A loss is put down to chance where chance makes a larger one with this probability.
const CHANCE: f64 = 0.05;

/// The long model `y(t) = −Σ a_l y(t−l) + Σ_k Σ_l b_kl u_k(t − nk_k − l + 1) + e(t)`, l = 1 … n, and its loss.
pub(super) struct HighOrderArx {
    pub(super) order: usize,
    /// Coefficients of the past outputs, then of each input.
    pub(super) theta: Vec<f64>,
    /// Sums of squares that the models of order 0 … n leave.
    left: Vec<f64>,
    rows: usize,
    channels: usize,
}

impl HighOrderArx {
    /// `None` where the data are too few, too broken or too little excited.
    pub(super) fn new(orders: &Orders, segments: &[Segment<'_>]) -> Option<Self> {
        let rows: usize = segments.iter().map(Segment::len).sum();
        let channels = orders.inputs() + 1;
        let order = ORDER.min(rows / (ROWS * channels));
        let delay = orders.nk.iter().copied().max().unwrap_or(0);
        let lost = segments.len() * (order + delay);
        if order < orders.memory() + BEYOND || 20 * lost > rows || segments.iter().any(|s| !s.missing.is_empty()) {
            return None;
        }
        let gram = Self::gram(orders, segments, order, delay);
        let factor = gram::cholesky(&gram, WELL_CONDITIONED)?;
        let last = factor.ncols() - 1;
        let tail = |from: usize| (from..=last).map(|i| factor[(i, last)].powi(2)).sum::<f64>();
        Some(HighOrderArx {
            order,
            theta: sorted(&solved(&factor), order, channels),
            left: (0..=order).map(|l| tail(l * channels)).collect(),
            rows: rows - lost,
            channels,
        })
    }

    /// Gram matrix of the regressors, those of order one first, and the output.
    fn gram(orders: &Orders, segments: &[Segment<'_>], order: usize, delay: usize) -> Mat<f64> {
        let inputs = orders.inputs();
        let place = |block: usize, channel: usize| block * (inputs + 1) + channel;
        let of_order = |l: usize| (0..=inputs).map(move |c| place(order - l + usize::from(c < inputs), c));
        let list: Vec<usize> = (1..=order).flat_map(of_order).chain([place(order, inputs)]).collect();
        let mut gram = Mat::zeros(list.len(), list.len());
        for segment in segments.iter().filter(|s| s.len() > order + delay) {
            let end = segment.len();
            let shifted = |k: usize| &segment.inputs[k][delay - orders.nk[k]..end - orders.nk[k]];
            let channels: Vec<&[f64]> = (0..inputs).map(shifted).chain([&segment.output[delay..]]).collect();
            let windows = gram::of_windows(&channels, order + 1);
            gram += Mat::from_fn(list.len(), list.len(), |i, j| windows[(list[i], list[j])]);
        }
        gram
    }

    /// Returns true if the long model is long enough: its last third of coefficients explains no more than chance.
    pub(super) fn is_settled(&self) -> bool {
        let shorter = 2 * self.order / 3;
        let gain = (self.left[shorter] - self.left[self.order]) / self.variance();
        gain <= chi_squared_quantile(1.0 - CHANCE, ((self.order - shorter) * self.channels) as f64)
    }

    /// Returns true if a model is as good as the long one, but for chance. The model has so many free coefficients and
    /// leaves this sum of squares in so many residuals.
    pub(super) fn is_met(&self, cost: f64, residuals: usize, free: usize) -> bool {
        let more = (self.order * self.channels).saturating_sub(free).max(1) as f64;
        let rows = self.rows as f64;
        let excess = (rows / residuals as f64 * cost - self.left[self.order]) / self.variance();
        excess <= chi_squared_quantile(1.0 - CHANCE, more)
    }

    fn variance(&self) -> f64 {
        self.left[self.order] / (self.rows - self.order * self.channels) as f64
    }
}

/// The last column of a triangular factor in terms of the others.
fn solved(factor: &Mat<f64>) -> Vec<f64> {
    let n = factor.ncols() - 1;
    let mut theta = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| factor[(i, j)] * theta[j]).sum();
        theta[i] = (factor[(i, n)] - known) / factor[(i, i)];
    }
    theta
}

/// Coefficients by order, the inputs' before the output's, as those of the output and then of each input.
fn sorted(theta: &[f64], order: usize, channels: usize) -> Vec<f64> {
    let of = |c: usize| (0..order).map(move |l| theta[l * channels + c]);
    of(channels - 1).chain((0..channels - 1).flat_map(of)).collect()
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;

    use super::*;

    /// `y(t) = 1.5 y(t−1) − 0.7 y(t−2) + u(t−2) + 0.5 e(t)` in two stretches, and `Σ (0.5 e)²`.
    fn segments() -> (Vec<Segment<'static>>, f64) {
        let mut random = signal::excitation::Random::new(5);
        let mut energy = 0.0;
        let mut one = |rows: usize| {
            let u: Vec<f64> = (0..rows).map(|_| random.normal()).collect();
            let mut y = vec![0.0; rows];
            for t in 2..rows {
                let e = 0.5 * random.normal();
                energy += e * e;
                y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + u[t - 2] + e;
            }
            Segment {
                inputs: vec![Cow::Owned(u)],
                output: Cow::Owned(y),
                missing: vec![],
                impulse: None,
                experiment: 0,
                first: 0,
            }
        };
        (vec![one(3000), one(5000)], energy)
    }

    const DELAY: usize = 2;

    fn orders() -> Orders {
        Orders { na: 2, nb: vec![1], nc: 1, nd: 0, nf: vec![0], nk: vec![DELAY] }
    }

    #[test]
    fn stat_long_model_finds_the_coefficients_and_is_met_by_the_truth_alone() {
        let (segments, energy) = segments();
        let high_order = HighOrderArx::new(&orders(), &segments).unwrap();
        assert!(high_order.is_settled());
        let expected = |j: usize| match j {
            0 => 1.5,
            1 => -0.7,
            j if j == high_order.order => 1.0,
            _ => 0.0,
        };
        for (j, value) in high_order.theta.iter().enumerate() {
            assert!((value - expected(j)).abs() < 0.06, "{j}: {value}");
        }
        assert!(high_order.is_met(energy, 8000, 4));
        assert!(!high_order.is_met(1.03 * energy, 8000, 4));
    }

    #[test]
    fn regress_data_that_cannot_tell_give_none() {
        let (segments, _) = segments();
        assert!(HighOrderArx::new(&orders(), &[segments[0].part(0, 300)]).is_none());
        let still = Segment { inputs: vec![Cow::Owned(vec![1.0; 3000])], ..segments[0].clone() };
        assert!(HighOrderArx::new(&orders(), &[still]).is_none());
        let broken = Segment { missing: vec![7], ..segments[0].clone() };
        assert!(HighOrderArx::new(&orders(), &[broken]).is_none());
    }
}
