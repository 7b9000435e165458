//! Findings of a regression of friction.

use faer::Mat;
use fitting::LinearFit;
use rig::results::{Estimate, Parameter, Quantity, Stretch};
use signal::distributions::{interval, student_t_quantile};

use crate::options::{CurvePoint, POINTS, Term};

/// An estimate: [1/J_d, shift of T_d over J_d] where T_d drives freely, then c_i/J_d.
pub(crate) struct Fitted {
    pub(crate) terms: Vec<Term>,
    pub(crate) delay_s: f64,
    pub(crate) bic: f64,
    pub(super) drive: Drive,
    pub(super) linear: LinearFit,
    pub(super) covariance: Mat<f64>,
    pub(super) freedom: f64,
}

impl Fitted {
    /// 1/J_d where it was free.
    pub(super) fn per_torque(&self) -> Option<f64> {
        (self.drive == Drive::Free).then(|| self.linear.parameters.first().copied()).flatten()
    }

    /// J_d, estimated or known.
    pub(crate) fn inertia_kg_m2(&self) -> f64 {
        match self.drive {
            Drive::Known { inertia_kg_m2 } => inertia_kg_m2,
            Drive::Free => self.per_torque().map_or(f64::NAN, |rate| 1.0 / rate),
        }
    }

    pub(super) fn shift_s(&self) -> f64 {
        self.linear.parameters[1] / self.linear.parameters[0]
    }

    /// Relative standard error of 1/J_d.
    pub(crate) fn inertia_error(&self) -> f64 {
        match self.per_torque() {
            Some(rate) if rate > 0.0 => self.covariance[(0, 0)].sqrt() / rate,
            _ => f64::INFINITY,
        }
    }

    pub(crate) fn inertia(&self) -> Option<Parameter> {
        let rate = self.per_torque()?;
        Some(Parameter::new(Quantity::DynoInertia, 1.0 / rate, self.inertia_error() / rate, self.freedom))
    }

    /// Tells whether the term of highest order is separated from zero.
    pub(crate) fn is_last_significant(&self, level: f64) -> bool {
        self.terms.last().is_some_and(|last| self.is_significant(*last, level))
    }

    /// Tells whether a term is there and differs from zero.
    pub(crate) fn is_significant(&self, term: Term, level: f64) -> bool {
        let Some(place) = self.terms.iter().position(|own| *own == term) else { return false };
        let at = self.first_term() + place;
        let (low, high) = interval(self.linear.parameters[at], self.covariance[(at, at)].sqrt(), self.freedom, level);
        low > 0.0 || high < 0.0
    }

    /// Σ c_i/J_d …, rad/s².
    pub(crate) fn deceleration(&self, speed: f64) -> f64 {
        let first = self.first_term();
        self.terms.iter().enumerate().map(|(i, term)| self.linear.parameters[first + i] * term.at(speed)).sum()
    }

    pub(super) fn first_term(&self) -> usize {
        self.linear.parameters.len() - self.terms.len()
    }

    pub(crate) fn per_inertia(&self, stretches: &[Stretch]) -> Estimate {
        let first = self.first_term();
        let rows = (0..self.terms.len()).map(|i| self.unit_row(first + i));
        self.read(&rows.collect::<Vec<_>>(), |i| self.linear.parameters[first + i], Term::deceleration, stretches)
    }

    /// Coefficients as torques: times J_d, that of the estimate or the stated one.
    pub(crate) fn friction(&self, stretches: &[Stretch]) -> Estimate {
        let first = self.first_term();
        let value = |i: usize| self.inertia_kg_m2() * self.linear.parameters[first + i];
        let rows: Vec<Vec<f64>> = (0..self.terms.len()).map(|i| self.torque_row(i)).collect();
        self.read(&rows, value, Term::torque, stretches)
    }

    pub(super) fn unit_row(&self, at: usize) -> Vec<f64> {
        (0..self.linear.parameters.len()).map(|j| f64::from(u8::from(j == at))).collect()
    }

    /// The gradient of c_i = J_d (c_i/J_d) by the parameters.
    pub(super) fn torque_row(&self, i: usize) -> Vec<f64> {
        let first = self.first_term();
        let inertia = self.inertia_kg_m2();
        let mut row: Vec<f64> = self.unit_row(first + i).iter().map(|u| inertia * u).collect();
        if self.per_torque().is_some() {
            row[0] = -inertia * inertia * self.linear.parameters[first + i];
        }
        row
    }

    pub(super) fn joint(&self, a: &[f64], b: &[f64]) -> f64 {
        let n = a.len();
        (0..n).map(|i| (0..n).map(|j| a[i] * self.covariance[(i, j)] * b[j]).sum::<f64>()).sum()
    }

    pub(super) fn read(
        &self,
        rows: &[Vec<f64>],
        value: impl Fn(usize) -> f64,
        quantity: impl Fn(Term) -> Quantity,
        stretches: &[Stretch],
    ) -> Estimate {
        let covariance: Vec<Vec<f64>> = rows.iter().map(|a| rows.iter().map(|b| self.joint(a, b)).collect()).collect();
        let parameter = |(i, term): (usize, &Term)| {
            Parameter::new(quantity(*term), value(i), covariance[i][i].max(0.0).sqrt(), self.freedom)
        };
        Estimate {
            parameters: self.terms.iter().enumerate().map(parameter).collect(),
            covariance,
            stretches: stretches.to_vec(),
            iterations: 0,
            condition: self.linear.condition,
        }
    }

    /// Sum of those of its terms over a range of speeds.
    pub(crate) fn curve(&self, (from, to): (f64, f64), is_part: impl Fn(Term) -> bool) -> Vec<CurvePoint> {
        let first = self.first_term();
        let parts: Vec<(usize, Term)> = self.terms.iter().copied().enumerate().filter(|(_, t)| is_part(*t)).collect();
        let width = student_t_quantile(0.5 + 0.5 * LEVEL, self.freedom);
        let point = |k: usize| {
            let speed_rad_s = from + (to - from) * k as f64 / (POINTS - 1) as f64;
            let mut row = vec![0.0; self.linear.parameters.len()];
            for (i, term) in &parts {
                let own = self.torque_row(*i);
                row.iter_mut().zip(&own).for_each(|(sum, own)| *sum += term.at(speed_rad_s) * own);
            }
            let of_term = |(i, term): &(usize, Term)| self.linear.parameters[first + i] * term.at(speed_rad_s);
            CurvePoint {
                speed_rad_s,
                torque_nm: self.inertia_kg_m2() * parts.iter().map(of_term).sum::<f64>(),
                half_width_nm: width * self.joint(&row, &row).max(0.0).sqrt(),
            }
        };
        (0..POINTS).map(point).collect()
    }
}

/// Level of the intervals.
pub(super) const LEVEL: f64 = 0.95;

/// How T_d acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Drive {
    /// 1/J_d and the delay are parameters.
    Free,
    /// J_d is known.
    Known { inertia_kg_m2: f64 },
}
