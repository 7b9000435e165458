//! The two masses and the shaft between them, with what is uncertain of them.

use faer::Mat;
use numerics::linalg;
use numerics::null::nan_if_null;
use part_shaft::Parts;
use rig::BenchFile;
use rig::estimation::Chosen;
use rig::results::{Estimate, Quantity, Reason};
use serde::{Deserialize, Serialize};

/// A J_e that is less certain than this is no better than the bench file's.
const CERTAIN: f64 = 0.05;
/// K, B, c_1, δ_e, δ_T and J_d as the shaft's estimate names them.
const OF_SHAFT: [Quantity; 6] = [
    Quantity::Stiffness,
    Quantity::Damping,
    Quantity::FrictionSlope,
    Quantity::EngineSpeedSkew,
    Quantity::AirGapTorqueSkew,
    Quantity::DynoInertia,
];
/// J_e comes after them.
pub(super) const PARAMETERS: usize = OF_SHAFT.len() + 1;

/// Where J_e comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum InertiaSource {
    /// Estimated from this recording.
    Estimated(String),
    /// The bench file states it.
    BenchFile,
}

/// A recording and what it shows.
type Found = (String, Estimate);

/// Two masses with a shaft between them. SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TwoMasses {
    /// The recording that the shaft is from.
    pub shaft_from: String,
    /// Where J_e is from.
    pub inertia_from: InertiaSource,
    /// K, Nm/rad; B, Nm s/rad; c_1, slope of the dynamometer's friction, Nm s/rad; δ_e and δ_T, by how much N_e and T_d
    /// are late, s; J_d and J_e, kg m².
    #[serde(deserialize_with = "nan_if_null")]
    pub values: [f64; PARAMETERS],
    /// Their covariance.
    #[serde(deserialize_with = "nan_if_null")]
    pub covariance: Vec<Vec<f64>>,
}

/// The values by name.
#[derive(Debug, Clone, Copy)]
pub(super) struct Values {
    pub(super) stiffness: f64,
    pub(super) damping: f64,
    pub(super) friction_slope: f64,
    pub(super) engine_late_s: f64,
    pub(super) torque_late_s: f64,
    pub(super) dyno_inertia: f64,
    pub(super) engine_inertia: f64,
}

impl Values {
    pub(super) fn of(values: &[f64; PARAMETERS]) -> Self {
        let [stiffness, damping, friction_slope, engine_late_s, torque_late_s, dyno_inertia, engine_inertia] = *values;
        Values { stiffness, damping, friction_slope, engine_late_s, torque_late_s, dyno_inertia, engine_inertia }
    }
}

impl TwoMasses {
    /// The shaft and J_e of the recordings that are chosen for them; the bench file's J_e where none is certain enough.
    ///
    /// # Errors
    /// No shaft: why the last recording that was tried does not give it, or that there is none to give it.
    pub(super) fn of(parts: &Parts<'_>) -> Result<Self, Vec<Reason>> {
        let shaft = parts.chosen_shaft().map_err(|needs| needs.last().cloned().into_iter().collect::<Vec<_>>())?;
        let certain = |both: &Chosen<'_, Estimate>| uncertainty(&both.fit, Quantity::EngineInertia) < CERTAIN;
        let both = parts.chosen_inertias().ok().filter(certain);
        let both = both.map(|both| (both.experiment.file.clone(), both.fit.as_ref().clone()));
        Ok(Self::assembled(shaft.experiment.file.clone(), &shaft.fit.estimate, both, parts.bench))
    }

    fn assembled(file: String, shaft: &Estimate, both: Option<Found>, bench: &BenchFile) -> Self {
        let mut values = [0.0; PARAMETERS];
        let mut covariance = vec![vec![0.0; PARAMETERS]; PARAMETERS];
        let places = OF_SHAFT.map(|quantity| shaft.place(quantity));
        for (i, at) in places.iter().enumerate() {
            let Some(at) = *at else { continue };
            values[i] = shaft.parameters[at].value;
            for (j, other) in places.iter().enumerate() {
                covariance[i][j] = other.map_or(0.0, |other| shaft.covariance[at][other]);
            }
        }
        let (dyno, engine) = (OF_SHAFT.len() - 1, OF_SHAFT.len());
        if shaft.place(Quantity::DynoInertia).is_none() {
            // Behind a torque flange J_d stands in no equation of the shaft; without one it is exact.
            values[dyno] = bench.dynamometer_inertia_kg_m2;
        }
        let stated = bench.engine_inertia();
        let seen = |found: &Estimate| {
            let seen = found.parameter(Quantity::EngineInertia)?;
            Some(stated.with_seen(seen.value, seen.standard_error))
        };
        let (inertia_from, found) = match both {
            None => (InertiaSource::BenchFile, None),
            Some((file, found)) => (InertiaSource::Estimated(file), seen(&found)),
        };
        let (value, uncertainty) = found.unwrap_or((stated.kg_m2, stated.standard_uncertainty_kg_m2()));
        (values[engine], covariance[engine][engine]) = (value, uncertainty.powi(2));
        TwoMasses { shaft_from: file, inertia_from, values, covariance }
    }

    /// Values one standard deviation away, in as many independent directions as there are: the columns of a square root
    /// of the covariance.
    pub(super) fn apart(&self) -> Vec<[f64; PARAMETERS]> {
        let deviations: Vec<f64> = (0..PARAMETERS).map(|i| self.covariance[i][i].max(0.0).sqrt()).collect();
        let correlation = |i: usize, j: usize| match deviations[i] * deviations[j] {
            0.0 => 0.0,
            scale => self.covariance[i][j] / scale,
        };
        let correlations = Mat::from_fn(PARAMETERS, PARAMETERS, correlation);
        let Ok(eigen) = linalg::symmetric_eigen(correlations.as_ref()) else { return Vec::new() };
        let direction = |k: usize| {
            let length = eigen.values[k].max(0.0).sqrt();
            std::array::from_fn(|i| self.values[i] + length * eigen.vectors[(i, k)] * deviations[i])
        };
        let moves = |values: &[f64; PARAMETERS]| values != &self.values;
        (0..PARAMETERS).map(direction).filter(moves).collect()
    }
}

fn uncertainty(estimate: &Estimate, quantity: Quantity) -> f64 {
    estimate.parameter(quantity).map_or(f64::INFINITY, |p| p.standard_error / p.value.abs())
}
