//! Fisher's information of lines, and what it makes of the parameters.

use bench_model::model::BenchModel;
use faer::Mat;
use numerics::linalg::{self, Cholesky};
use signal::Complex64;

use super::signals::{Neighbours, OUTPUTS, disturbances, limited};
use super::task::{Criterion, DesignTask};
use crate::excitation_design::error::DesignError;

/// Condition of the scaled information beyond which it counts as singular.
const SINGULAR: f64 = 1e13;
/// Part of a parameter's information below which the rest that disturbances leave counts as nothing: it is rounding.
const CANCELLED: f64 = 1e-12;

/// Information per unit of power and second of a line at `omega`, as rows after rows: Re(G_θᴴ Λ⁻¹ G_θ).
///
/// Λ = D + Σ v S vᴴ, noise on the samples and disturbances; its inverse one disturbance after the other, which needs
/// 1/S alone: Λ⁻¹ ← Λ⁻¹ − Λ⁻¹v vᴴΛ⁻¹/(1/S + vᴴΛ⁻¹v).
fn of_line(task: &DesignTask, neighbours: &Neighbours, omega: f64) -> Option<Vec<f64>> {
    let measured = &task.measurements;
    let noises = [
        measured.torque_demand.filter(|_| task.excited == super::ExcitedDemand::Speed),
        measured.air_gap_torque,
        measured.shaft_torque,
        measured.dyno_speed,
        measured.engine_speed,
    ];
    let mut weight = [[Complex64::default(); OUTPUTS]; OUTPUTS];
    for (i, noise) in noises.iter().enumerate() {
        weight[i][i] = noise.map_or(0.0, |n| 1.0 / n.density()).into();
    }
    for (direction, inverse_density) in disturbances(task, &neighbours.centre, omega)? {
        let seen = times(&weight, &direction);
        let power = inverse_density + product(&direction, &seen);
        if power > 0.0 {
            for i in 0..OUTPUTS {
                for j in 0..OUTPUTS {
                    weight[i][j] -= seen[i] * seen[j].conj() / power;
                }
            }
        }
    }
    let mut columns = neighbours.derivatives(task, omega)?;
    let weighted = |column: &[Complex64; OUTPUTS]| times(&weight, column);
    for column in &mut columns {
        let alone: f64 = column.iter().zip(noises).filter_map(|(c, n)| Some(c.norm_sqr() / n?.density())).sum();
        if product(column, &weighted(column)) <= CANCELLED * alone {
            column.fill(Complex64::default());
        }
    }
    let weighted: Vec<_> = columns.iter().map(weighted).collect();
    Some(columns.iter().flat_map(|a| weighted.iter().map(|b| product(a, b))).collect())
}

fn times(matrix: &[[Complex64; OUTPUTS]; OUTPUTS], vector: &[Complex64; OUTPUTS]) -> [Complex64; OUTPUTS] {
    std::array::from_fn(|i| (0..OUTPUTS).map(|j| matrix[i][j] * vector[j]).sum())
}

/// Re aᴴb.
fn product(a: &[Complex64; OUTPUTS], b: &[Complex64; OUTPUTS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a.conj() * b).re).sum()
}

/// Information of lines, and their cost.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) frequency_hz: f64,
    /// Information per unit of power and second, for each model.
    pub(super) information: Vec<Vec<f64>>,
    /// The largest |G|²/limit² of any limited quantity under any model: one over the square of the largest amplitude.
    pub(super) cost: f64,
}

/// The lines at multiples of one over `period_s` within a band, for every model. A line the estimator does not use has
/// no information.
pub(super) fn lines(task: &DesignTask, period_s: f64, band_hz: (f64, f64)) -> Option<Vec<Line>> {
    let unknowns = task.unknowns();
    let neighbours: Vec<Neighbours> = task.models.iter().map(|m| Neighbours::new(m, &unknowns)).collect();
    let first = (band_hz.0 * period_s - 1e-9).ceil().max(1.0) as usize;
    let last = (band_hz.1 * period_s + 1e-9).floor() as usize;
    let line = |k: usize| {
        let frequency_hz = k as f64 / period_s;
        let omega = std::f64::consts::TAU * frequency_hz;
        let of_model = |n: &Neighbours| match task.is_used(frequency_hz) {
            true => of_line(task, n, omega),
            false => Some(vec![0.0; unknowns.len() * unknowns.len()]),
        };
        let information = neighbours.iter().map(of_model).collect::<Option<Vec<_>>>()?;
        let costs = task.models.iter().map(|m| cost(task, m, omega)).collect::<Option<Vec<f64>>>()?;
        Some(Line { frequency_hz, information, cost: costs.into_iter().fold(0.0, f64::max) })
    };
    (first..=last).map(line).collect()
}

fn cost(task: &DesignTask, model: &BenchModel, omega: f64) -> Option<f64> {
    let gains = limited(task, model, omega)?;
    let of = |(gain, limit): (&Complex64, Option<f64>)| limit.map_or(0.0, |l| gain.norm_sqr() / (l * l));
    Some(gains.iter().zip(task.limits.in_order()).map(of).fold(0.0, f64::max))
}

impl super::PeakLimits {
    /// In the order of [`limited`].
    pub(super) fn in_order(&self) -> [Option<f64>; super::signals::LIMITED] {
        [self.shaft_torque_nm, self.air_gap_torque_nm, self.speed_rad_s, self.demand]
    }
}

/// The criterion of a task for one model.
#[derive(Debug, Clone)]
pub(super) struct Judge {
    /// Parameters, those of interest first.
    pub(super) count: usize,
    pub(super) of_interest: usize,
    pub(super) criterion: Criterion,
    /// Information known beforehand, of each parameter.
    prior: Vec<f64>,
}

/// Worth of an information.
pub(super) struct Judged {
    /// The sum of relative variances, or the logarithm of the determinant.
    pub(super) value: f64,
    /// Covariance of all parameters over their scales.
    pub(super) covariance: Mat<f64>,
    /// −dΨ/dM, so that more information dM makes the criterion less by its trace with dM.
    pub(super) sensitivity: Mat<f64>,
}

impl Judge {
    pub(super) fn new(task: &DesignTask, model: &BenchModel) -> Self {
        let known = |n: &super::Nuisance| n.standard_uncertainty.map_or(0.0, |u| (n.unknown.scale(model) / u).powi(2));
        let interest = task.of_interest.iter().map(|_| 0.0);
        Judge {
            count: task.of_interest.len() + task.nuisances.len(),
            of_interest: task.of_interest.len(),
            criterion: task.criterion,
            prior: interest.chain(task.nuisances.iter().map(known)).collect(),
        }
    }

    /// The worth of an information; `Err` with the unknown it says least of where it is singular.
    pub(super) fn judge(&self, information: &[f64]) -> Result<Judged, usize> {
        let n = self.count;
        let full = |i: usize, j: usize| information[i * n + j] + if i == j { self.prior[i] } else { 0.0 };
        let blind = (0..n).find(|i| !(full(*i, *i) > 0.0 && full(*i, *i).is_finite()));
        if let Some(blind) = blind {
            return Err(blind);
        }
        let scale: Vec<f64> = (0..n).map(|i| full(i, i).sqrt()).collect();
        let scaled = Mat::from_fn(n, n, |i, j| full(i, j) / (scale[i] * scale[j]));
        let inverse = inverse(&scaled)?;
        let covariance = Mat::from_fn(n, n, |i, j| inverse[(i, j)] / (scale[i] * scale[j]));
        let m = self.of_interest;
        let block = covariance.submatrix(0, 0, m, m).to_owned();
        let columns = covariance.submatrix(0, 0, n, m).to_owned();
        let (value, sensitivity) = match self.criterion {
            Criterion::RelativeVariance => ((0..m).map(|i| block[(i, i)]).sum(), &columns * columns.transpose()),
            Criterion::Determinant => {
                let factor = Cholesky::new(block.as_ref()).map_err(|_| 0_usize)?;
                let determinant = (0..m).map(|i| 2.0 * factor.lower()[(i, i)].ln()).sum();
                (determinant, &columns * factor.inverse() * columns.transpose())
            }
        };
        Ok(Judged { value, covariance, sensitivity })
    }
}

/// Inverse of a matrix with a unit diagonal, or the place it says least of.
fn inverse(scaled: &Mat<f64>) -> Result<Mat<f64>, usize> {
    let n = scaled.nrows();
    if let Ok(factor) = Cholesky::new(scaled.as_ref()) {
        let inverse = factor.inverse();
        let worst = (0..n).max_by(|a, b| inverse[(*a, *a)].total_cmp(&inverse[(*b, *b)])).unwrap_or(0);
        return if inverse[(worst, worst)] < SINGULAR { Ok(inverse) } else { Err(worst) };
    }
    let Ok(eigen) = linalg::symmetric_eigen(scaled.as_ref()) else { return Err(0) };
    let of = |i: usize| eigen.vectors[(i, 0)].abs();
    Err((0..n).max_by(|a, b| of(*a).total_cmp(&of(*b))).unwrap_or(0))
}

/// Judges of every model of a task, and the sum over lines.
pub(super) struct Judges {
    pub(super) each: Vec<Judge>,
}

impl Judges {
    pub(super) fn new(task: &DesignTask) -> Self {
        Judges { each: task.models.iter().map(|m| Judge::new(task, m)).collect() }
    }

    /// Returns how well the parameters would be known after the experiment, for one model; `powers` are those of the
    /// lines.
    pub(super) fn after(
        &self,
        task: &DesignTask,
        model: usize,
        lines: &[Line],
        powers: &[f64],
    ) -> Result<Judged, DesignError> {
        let judge = &self.each[model];
        let mut information = vec![0.0; judge.count * judge.count];
        for (line, power) in lines.iter().zip(powers) {
            add(&mut information, &line.information[model], task.duration_s * power);
        }
        judge.judge(&information).map_err(|i| not_determined(task, i))
    }
}

pub(super) fn add(sum: &mut [f64], matrix: &[f64], factor: f64) {
    sum.iter_mut().zip(matrix).for_each(|(s, m)| *s += factor * m);
}

pub(super) fn not_determined(task: &DesignTask, index: usize) -> DesignError {
    match task.unknowns().get(index) {
        Some(unknown) => DesignError::NotDetermined { unknown: *unknown },
        None => DesignError::Task { requirement: "a parameter of interest is needed" },
    }
}
