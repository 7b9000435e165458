//! Scale of the torques. K, B, both inertias and the gains of the speed controller are in the unit of the recorded
//! torques: no recording shows a factor that all of them have. J_d of the bench file is not in that unit, so the two
//! values of J_d show the factor as well as the stated one is known.

use rig::results::{Estimate, Parameter, Quantity};
use serde::{Deserialize, Serialize};

use crate::Study;

/// By which factor all torques may be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueScale {
    /// J_d of the recordings over J_d of the bench file.
    pub factor: f64,
    /// Half of its 95 % interval, which contains the uncertainties of both.
    pub half_width: f64,
}

/// The scale of a study's torques; `None` where no J_d is estimated, as behind a torque flange.
pub fn torque_scale(study: &Study) -> Option<TorqueScale> {
    let shaft = study.shaft.estimated()?;
    let both = shaft.inertias.as_ref().map(|(_, both)| both);
    let of = |estimate: &'_ Estimate| estimate.parameter(Quantity::DynoInertia).cloned();
    let seen = [Some(&shaft.estimate), both].into_iter().flatten().filter_map(of);
    let best = seen.min_by(|a, b| a.standard_error.total_cmp(&b.standard_error))?;
    let stated = study.bench.dynamometer_inertia();
    let error = best.standard_error.hypot(stated.standard_uncertainty_kg_m2());
    let (low, high) = Parameter::new(Quantity::DynoInertia, best.value, error, f64::INFINITY).interval;
    Some(TorqueScale { factor: best.value / stated.kg_m2, half_width: 0.5 * (high - low) / stated.kg_m2 })
}
