//! One shaft from several recordings.
//!
//! K and B are the bench's and the same in every recording; gate and skews are each recording's own. With K̂_i, B̂_i of
//! recording i and their covariance P_i, the estimate of all together is (Σ P_i⁻¹)⁻¹ Σ P_i⁻¹ (K̂_i, B̂_i).
//!
//! An error of prior knowledge, such as that of J_d, is the same in every recording. With g_i the errors of (K̂_i,
//! B̂_i) if it is wrong by a standard uncertainty, two recordings have the covariance g_i g_jᵀ. That part of the
//! variance does not become smaller with more recordings; the covariance of the mean contains it. What the model of the
//! signals does not hold is taken as the same in all recordings too.
//!
//! The statistic rᵀ V⁻¹ r shows if the recordings are of one shaft; r is what the best mean leaves, and V the
//! covariance of all values. It is χ² distributed with 2 (n − 1) degrees of freedom. Errors of the model count as those
//! of each recording there.
//!
//! # Source
//! Rao, *Linear Statistical Inference and its Applications*, 2nd ed., §4a.2 and §6a.2; Birge, *The calculation of
//! errors by the method of least squares*, Phys. Rev. 40, 1932 (recordings that disagree).

use faer::{Mat, MatRef};
use ident::distributions::chi_squared_tail;
use numerics::linalg::{Cholesky, Qr, solve_lower};
use numerics::null::nan_if_null;
use rig::results::{Parameter, Quantity, Shaft, SharedError};
use serde::{Deserialize, Serialize};

use crate::shaft::model_errors;
use crate::shaft_analysis::recording::ShaftRecording;

/// Below this probability recordings are not of one shaft.
const APART: f64 = 0.01;
/// Degrees of freedom of a weighted mean whose errors are known: as good as normal.
const MANY: f64 = 1e6;

/// K and B of several recordings together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Together {
    /// K, Nm/rad.
    pub stiffness: CommonValue,
    /// B, Nm s/rad.
    pub damping: CommonValue,
    /// How far the recordings are apart, in terms of their own errors: χ² with these degrees of freedom.
    #[serde(deserialize_with = "nan_if_null")]
    pub chi_squared: f64,
    /// They.
    pub degrees_of_freedom: usize,
    /// How likely recordings of one shaft are so far apart.
    #[serde(deserialize_with = "nan_if_null")]
    pub p_value: f64,
    /// True where they are too far apart to be of one shaft by their own errors; intervals are then wider by
    /// √(χ²/degrees of freedom).
    pub apart: bool,
}

/// A value common to several recordings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CommonValue {
    /// It.
    pub parameter: Parameter,
    /// Its values and standard errors by recording.
    #[serde(deserialize_with = "nan_if_null")]
    pub by_recording: Vec<(String, f64, f64)>,
}

/// Pair of values, with the recording that it is from.
struct Shown<'a> {
    file: &'a str,
    values: [f64; 2],
    covariance: [[f64; 2]; 2],
    shared: &'a [SharedError],
}

impl<'a> Shown<'a> {
    fn of(file: &'a str, shaft: &'a Shaft) -> Option<Self> {
        let estimate = &shaft.estimate;
        let at = [estimate.place(Quantity::Stiffness)?, estimate.place(Quantity::Damping)?];
        Some(Shown {
            file,
            values: at.map(|i| estimate.parameters[i].value),
            covariance: at.map(|i| at.map(|j| estimate.covariance[i][j])),
            shared: &shaft.shared_errors,
        })
    }

    /// The covariance of its value `i` and value `j` of another recording, by what is known beforehand in both.
    fn shared_with(&self, other: &Shown<'_>, i: usize, j: usize) -> f64 {
        let product = |own: &SharedError| {
            let theirs = other.shared.iter().find(|their| their.known == own.known);
            theirs.map_or(0.0, |their| own.of_shaft[i] * their.of_shaft[j])
        };
        self.shared.iter().map(product).sum()
    }
}

/// `None` with fewer than two recordings that show the shaft.
pub(super) fn of(recordings: &[ShaftRecording]) -> Option<Together> {
    let shown: Vec<Shown<'_>> = recordings.iter().filter_map(|r| Shown::of(&r.file, r.shaft.estimated()?)).collect();
    if shown.len() < 2 { None } else { combined(&shown) }
}

fn combined(shown: &[Shown<'_>]) -> Option<Together> {
    let joint = |between: &dyn Fn(&Shown<'_>, &Shown<'_>, usize, usize) -> f64| {
        Mat::from_fn(2 * shown.len(), 2 * shown.len(), |row, column| {
            let (one, other, i, j) = (row / 2, column / 2, row % 2, column % 2);
            if one == other { shown[one].covariance[i][j] } else { between(&shown[one], &shown[other], i, j) }
        })
    };
    let values: Vec<f64> = shown.iter().flat_map(|one| one.values).collect();
    let mean = WeightedMean::new(joint(&|_, _, _, _| 0.0).as_ref(), &values)?;
    let common = mean.value(&values);
    let model = model_errors(common[0], common[1]);
    let whole =
        joint(&|one, other, i, j| one.shared_with(other, i, j) + if i == j { model[i] * model[j] } else { 0.0 });
    let covariance = &mean.weights * whole * mean.weights.transpose();
    let apart_by = joint(&|one, other, i, j| one.shared_with(other, i, j));
    let chi_squared = WeightedMean::new(apart_by.as_ref(), &values)?.chi_squared;
    let degrees_of_freedom = 2 * (shown.len() - 1);
    let p_value = chi_squared_tail(chi_squared, degrees_of_freedom as f64);
    let apart = p_value < APART;
    let wider = if apart { (chi_squared / degrees_of_freedom as f64).sqrt() } else { 1.0 };
    let value = |quantity: Quantity, i: usize| CommonValue {
        parameter: Parameter::new(quantity, common[i], wider * covariance[(i, i)].sqrt(), MANY),
        by_recording: shown
            .iter()
            .map(|one| (one.file.to_owned(), one.values[i], one.covariance[i][i].sqrt()))
            .collect(),
    };
    Some(Together {
        stiffness: value(Quantity::Stiffness, 0),
        damping: value(Quantity::Damping, 1),
        chi_squared,
        degrees_of_freedom,
        p_value,
        apart,
    })
}

/// The mean of pairs of values by weighted least squares.
struct WeightedMean {
    /// 2 × values.
    weights: Mat<f64>,
    /// The weighted squares of what it leaves.
    chi_squared: f64,
}

impl WeightedMean {
    /// For pairs, one after the other, with this covariance; `None` where it is singular.
    fn new(covariance: MatRef<'_, f64>, values: &[f64]) -> Option<Self> {
        let n = values.len();
        // Rows and columns by their standard deviations, so that units do not matter.
        let size: Vec<f64> = (0..n).map(|i| covariance[(i, i)].sqrt()).collect();
        let scaled = Mat::from_fn(n, n, |i, j| covariance[(i, j)] / (size[i] * size[j]));
        let factor = Cholesky::new(scaled.as_ref()).ok()?;
        let whitened = |mut m: Mat<f64>| {
            solve_lower(factor.lower(), m.as_mut());
            m
        };
        let pairs = whitened(Mat::from_fn(n, 2, |i, j| if i % 2 == j { 1.0 / size[i] } else { 0.0 }));
        let whitening = whitened(Mat::from_fn(n, n, |i, j| if i == j { 1.0 / size[i] } else { 0.0 }));
        let weights = Qr::new(pairs.as_ref()).least_squares(whitening.as_ref());
        let all = Mat::from_fn(n, 1, |i, _| values[i]);
        let left = &whitening * &all - &pairs * (&weights * &all);
        Some(WeightedMean { weights, chi_squared: left.squared_norm_l2() })
    }

    fn value(&self, values: &[f64]) -> [f64; 2] {
        [0, 1].map(|i| values.iter().enumerate().map(|(j, value)| self.weights[(i, j)] * value).sum())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use faer::mat;
    use signal::excitation::Random;

    use super::*;

    const TRUTH: [f64; 3] = [2440.0, 6.0, 0.6];
    /// Prior of J_d: 1 %.
    const INERTIA_UNCERTAINTY: f64 = 0.006;
    /// K and B are proportional to J_d where nothing else shows it.
    const BY_INERTIA: [f64; 2] = [4000.0, 10.0];

    /// K and B of a recording, their covariance, and the error they share with other recordings.
    type Recorded = ([f64; 2], [[f64; 2]; 2], SharedError);

    /// Estimates of the recordings of one bench: `of_noise` is the standard deviation of K and B by a recording's own
    /// noise, as parts of K and B.
    fn campaign(random: &mut Random, recordings: usize, of_noise: f64) -> Vec<Recorded> {
        let inertia_error = INERTIA_UNCERTAINTY * random.normal();
        let own = [of_noise * TRUTH[0], of_noise * TRUTH[1]];
        let model = model_errors(TRUTH[0], TRUTH[1]);
        let of_model = model.map(|error| error * random.normal());
        (0..recordings)
            .map(|_| {
                let shared = BY_INERTIA.map(|slope| slope * INERTIA_UNCERTAINTY);
                let mut value =
                    |i: usize| TRUTH[i] + BY_INERTIA[i] * inertia_error + own[i] * random.normal() + of_model[i];
                let values = [value(0), value(1)];
                let entry = |i: usize, j: usize| {
                    let alone = if i == j { own[i] * own[i] + model[i] * model[i] } else { 0.0 };
                    alone + shared[i] * shared[j]
                };
                let covariance = [0, 1].map(|i| [0, 1].map(|j| entry(i, j)));
                (values, covariance, SharedError { known: Quantity::DynoInertia, of_shaft: shared })
            })
            .collect()
    }

    fn joined(campaign: &[Recorded]) -> Together {
        let shown = |(values, covariance, shared): &Recorded| (*values, *covariance, [*shared]);
        let owned: Vec<_> = campaign.iter().map(shown).collect();
        let all: Vec<Shown<'_>> = owned
            .iter()
            .map(|(values, covariance, shared)| Shown { file: "a", values: *values, covariance: *covariance, shared })
            .collect();
        combined(&all).unwrap()
    }

    #[test]
    fn exact_the_part_of_a_common_prior_stays_however_many_recordings_there_are() {
        let of = |count: usize| joined(&campaign(&mut Random::new(1), count, 0.01));
        let by_inertia = BY_INERTIA[0] * INERTIA_UNCERTAINTY;
        let model = model_errors(TRUTH[0], 0.0)[0];
        for count in [2, 8, 50] {
            let expected = (by_inertia.powi(2) + (0.01 * TRUTH[0]).powi(2) / count as f64 + model * model).sqrt();
            let found = of(count).stiffness.parameter.standard_error;
            assert!((found / expected - 1.0).abs() < 0.01, "{count}: {found} {expected}");
        }
    }

    #[test]
    fn stat_joint_intervals_hold_the_truth_with_a_common_prior() {
        let mut random = Random::new(2);
        let (runs, mut inside, mut apart) = (2000, [0; 2], 0);
        for _ in 0..runs {
            let found = joined(&campaign(&mut random, 6, 0.005));
            for (i, one) in [&found.stiffness, &found.damping].into_iter().enumerate() {
                let (low, high) = one.parameter.interval;
                inside[i] += usize::from(low < TRUTH[i] && TRUTH[i] < high);
            }
            apart += usize::from(found.apart);
        }
        for held in inside {
            let share = held as f64 / f64::from(runs);
            assert!((0.925..=0.975).contains(&share), "{share}");
        }
        // Errors of the model are the same in all recordings here, so fewer than 1 % are found apart.
        assert!(apart <= 30, "{apart}");
    }

    #[test]
    fn exact_a_weighted_mean_of_independent_values_is_that_of_their_variances() {
        let covariance = mat![[1.0, 0.0, 0.0, 0.0], [0.0, 4.0, 0.0, 0.0], [0.0, 0.0, 3.0, 0.0], [0.0, 0.0, 0.0, 4.0]];
        let values = [1.0, 10.0, 5.0, 20.0];
        let mean = WeightedMean::new(covariance.as_ref(), &values).unwrap();
        let [first, second] = mean.value(&values);
        assert!((first - 2.0).abs() < 1e-12 && (second - 15.0).abs() < 1e-12);
        assert!((mean.chi_squared - (1.0 + 9.0 / 3.0 + 2.0 * 25.0 / 4.0)).abs() < 1e-12);
    }
}
