//! One shaft from several recordings.
//!
//! K and B are the bench's and the same in every recording; gate and skews are each recording's own. With K̂_i, B̂_i of
//! recording i and their covariance P_i, the estimate of all together is (Σ P_i⁻¹)⁻¹ Σ P_i⁻¹ (K̂_i, B̂_i), which is what one
//! fit to all recordings tends to, and Σ (·)ᵀ P_i⁻¹ (·) over what is left shows whether they are of one shaft: it is χ²
//! distributed with 2 (n − 1) degrees of freedom.
//!
//! # Source
//! Rao, *Linear Statistical Inference and its Applications*, 2nd ed., §6a.2; Birge, *The calculation of errors by the method
//! of least squares*, Phys. Rev. 40, 1932 (recordings that disagree).

use ident::distributions::chi_squared_tail;
use rig::results::{Estimate, Parameter, Quantity};
use serde::Serialize;

use crate::shaft_analysis::recording::ShaftRecording;

/// Below this probability recordings are not of one shaft.
const APART: f64 = 0.01;
/// Degrees of freedom of a weighted mean whose errors are known: as good as normal.
const MANY: f64 = 1e6;

/// K and B of several recordings together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Together {
    /// K, Nm/rad.
    pub stiffness: CommonValue,
    /// B, Nm s/rad.
    pub damping: CommonValue,
    /// How far the recordings are apart, in terms of their own errors: χ² with these degrees of freedom.
    pub chi_squared: f64,
    /// They.
    pub degrees_of_freedom: usize,
    /// How likely recordings of one shaft are so far apart.
    pub p_value: f64,
    /// Whether they are too far apart to be of one shaft by their own errors; intervals are then wider by √(χ²/degrees of
    /// freedom).
    pub apart: bool,
}

/// A value common to several recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CommonValue {
    /// It.
    pub parameter: Parameter,
    /// Its values and standard errors by recording.
    pub by_recording: Vec<(String, f64, f64)>,
}

type Vector = [f64; 2];
type Matrix = [[f64; 2]; 2];

/// What recording a pair of values is from.
struct Shown<'a> {
    file: &'a str,
    values: Vector,
    covariance: Matrix,
}

/// `None` with fewer than two recordings that show the shaft.
pub(super) fn of(recordings: &[ShaftRecording]) -> Option<Together> {
    let shown: Vec<Shown<'_>> =
        recordings.iter().filter_map(|r| pair(&r.file, &r.shaft.estimated()?.estimate)).collect();
    if shown.len() < 2 {
        return None;
    }
    let (mut information, mut weighted) = ([[0.0; 2]; 2], [0.0; 2]);
    for one in &shown {
        let precision = inverse(one.covariance)?;
        let part = times(precision, one.values);
        for i in 0..2 {
            weighted[i] += part[i];
            (0..2).for_each(|j| information[i][j] += precision[i][j]);
        }
    }
    let covariance = inverse(information)?;
    let common = times(covariance, weighted);
    let distance = |one: &Shown<'_>| {
        let apart = [one.values[0] - common[0], one.values[1] - common[1]];
        inverse(one.covariance).map_or(0.0, |precision| {
            let weighted = times(precision, apart);
            apart[0] * weighted[0] + apart[1] * weighted[1]
        })
    };
    let chi_squared: f64 = shown.iter().map(distance).sum();
    let degrees_of_freedom = 2 * (shown.len() - 1);
    let p_value = chi_squared_tail(chi_squared, degrees_of_freedom as f64);
    let apart = p_value < APART;
    let wider = if apart { (chi_squared / degrees_of_freedom as f64).sqrt() } else { 1.0 };
    let value = |quantity: Quantity, i: usize| CommonValue {
        parameter: Parameter::new(quantity, common[i], wider * covariance[i][i].sqrt(), MANY),
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

fn pair<'a>(file: &'a str, estimate: &Estimate) -> Option<Shown<'a>> {
    let at = [estimate.place(Quantity::Stiffness)?, estimate.place(Quantity::Damping)?];
    Some(Shown {
        file,
        values: at.map(|i| estimate.parameters[i].value),
        covariance: at.map(|i| at.map(|j| estimate.covariance[i][j])),
    })
}

fn times(m: Matrix, v: Vector) -> Vector {
    m.map(|row| row[0] * v[0] + row[1] * v[1])
}

/// Inverse of a covariance; none where it is singular.
fn inverse(m: Matrix) -> Option<Matrix> {
    // Both rows and columns by their standard deviations, so that units do not matter.
    let (a, b) = (m[0][0].sqrt(), m[1][1].sqrt());
    let correlation = m[0][1] / (a * b);
    let determinant = 1.0 - correlation * correlation;
    let usable = a > 0.0 && b > 0.0 && determinant > 1e-9;
    let off = -correlation / (a * b * determinant);
    usable.then(|| [[1.0 / (a * a * determinant), off], [off, 1.0 / (b * b * determinant)]])
}
