//! The largest gradient of the speed, over speed and torque.

use bench_model::model::Mechanics;
use rig::bench_file::Limits;
use serde::Serialize;

use crate::error::CapabilityError;
use crate::extremes::LimitOf;
use crate::map::{MapInputs, benches, quantiles};

/// The largest gradient of the speed at one speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gradient {
    /// The speed, rad/s.
    pub speed_rad_s: f64,
    /// Largest gradient upwards, rad/s².
    pub up_rad_s2: f64,
    /// Largest gradient downwards, rad/s².
    pub down_rad_s2: f64,
    /// The limits that bind.
    pub binds: [Option<LimitOf>; 2],
}

/// The largest gradients at one speed and torque.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GradientPlace {
    /// The speed, rad/s.
    pub speed_rad_s: f64,
    /// Torque of the engine, Nm.
    pub torque_nm: f64,
    /// Gradient upwards that 95 %, 50 % and 5 % of the benches can do, rad/s²; infinite where no limit is stated.
    pub up_rad_s2: [f64; 3],
    /// The same downwards.
    pub down_rad_s2: [f64; 3],
    /// The limits that bind on the nominal bench.
    pub binds: [Option<LimitOf>; 2],
}

/// The largest gradients at these speeds and torques of the engine, torque by torque.
///
/// # Errors
/// An uncertainty without possible benches, no samples.
pub fn gradients(
    inputs: &MapInputs<'_>,
    speed_rad_s: &[f64],
    torque_nm: &[f64],
) -> Result<Vec<GradientPlace>, CapabilityError> {
    let benches = benches(inputs)?;
    let place = |torque_nm: f64, speed_rad_s: f64| {
        let of = |mechanics: &Mechanics| gradient(mechanics, &inputs.limits, torque_nm, speed_rad_s);
        let all: Vec<Gradient> = benches.iter().map(|(model, _)| of(&model.mechanics)).collect();
        GradientPlace {
            speed_rad_s,
            torque_nm,
            up_rad_s2: quantiles(all.iter().map(|one| one.up_rad_s2).collect()),
            down_rad_s2: quantiles(all.iter().map(|one| one.down_rad_s2).collect()),
            binds: of(&inputs.model.mechanics).binds,
        }
    };
    Ok(torque_nm.iter().flat_map(|torque| speed_rad_s.iter().map(|speed| place(*torque, *speed))).collect())
}

/// The largest gradients of the speed while the engine gives a constant torque: T_d = T_e − (J_d + J_e) α and
/// T_shaft = T_e − J_e α keep their limits.
///
/// # Example
/// ```
/// # use bench_model::model::{BenchModel, Mechanics};
/// let mechanics = Mechanics {
///     dyno_inertia_kg_m2: 0.55,
///     engine_inertia_kg_m2: 0.28,
///     stiffness_nm_per_rad: 2400.0,
///     damping_nm_s_per_rad: 6.0,
/// };
/// let limits = rig::bench_file::Limits { torque_nm: Some(400.0), ..Default::default() };
/// let gradient = capability::gradient::gradient(&mechanics, &limits, 0.0, 150.0);
/// assert_eq!((gradient.up_rad_s2 / units::RPM_RAD_S).round(), 4602.0);
/// ```
pub fn gradient(mechanics: &Mechanics, limits: &Limits, engine_nm: f64, speed_rad_s: f64) -> Gradient {
    let both = mechanics.dyno_inertia_kg_m2 + mechanics.engine_inertia_kg_m2;
    let power_nm = limits.power_w.map(|power| power / speed_rad_s.abs().max(1e-9));
    let bounds = |sign: f64| {
        let torque =
            |limit: Option<f64>, inertia: f64, of| Some((((limit? + sign * engine_nm) / inertia).max(0.0), Some(of)));
        let rooms = [
            torque(limits.torque_nm, both, LimitOf::TorqueDemand),
            torque(limits.shaft_torque_nm, mechanics.engine_inertia_kg_m2, LimitOf::ShaftTorque),
            torque(power_nm, both, LimitOf::Power),
            limits.speed_gradient_rad_s2.map(|limit| (limit, Some(LimitOf::SpeedGradient))),
        ];
        rooms.into_iter().flatten().fold((f64::INFINITY, None), |least, one| if one.0 < least.0 { one } else { least })
    };
    let (up, down) = (bounds(1.0), bounds(-1.0));
    Gradient { speed_rad_s, up_rad_s2: up.0, down_rad_s2: down.0, binds: [up.1, down.1] }
}
