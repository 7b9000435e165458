//! The largest gradient of the speed, over speed and torque.

use bench_model::model::Mechanics;
use bench_model::simulate::LoopMode;
use numerics::null::{infinite_if_null, nan_if_null};
use numerics::parallel;
use rig::bench_file::Limits;
use serde::{Deserialize, Serialize};

use crate::added::Added;
use crate::error::CapabilityError;
use crate::extremes::LimitOf;
use crate::map::{self, Braked, MapInputs, benches, quantiles};
use crate::pulses::Pulses;

/// The largest gradients of one bench.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gradient {
    /// The speed, rad/s.
    pub speed_rad_s: f64,
    /// Torque of the engine, Nm.
    pub torque_nm: f64,
    /// Largest gradient upwards, rad/s².
    pub up_rad_s2: f64,
    /// Largest gradient downwards, rad/s².
    pub down_rad_s2: f64,
    /// The limits that bind.
    pub binds: [Option<LimitOf>; 2],
}

/// The largest gradients at one speed and torque.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GradientPlace {
    /// The speed, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: f64,
    /// Torque of the engine, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_nm: f64,
    /// Gradient upwards that 95 %, 50 % and 5 % of the benches can do, rad/s²; infinite where no limit is stated.
    #[serde(deserialize_with = "infinite_if_null")]
    pub up_rad_s2: [f64; 3],
    /// The same downwards.
    #[serde(deserialize_with = "infinite_if_null")]
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
    let all: Vec<Vec<Gradient>> =
        parallel::map(&benches(inputs)?, |bench| of_bench(inputs, bench, speed_rad_s, torque_nm));
    let nominal = of_bench(inputs, &map::nominal(inputs), speed_rad_s, torque_nm);
    let place = |(k, nominal): (usize, &Gradient)| GradientPlace {
        speed_rad_s: nominal.speed_rad_s,
        torque_nm: nominal.torque_nm,
        up_rad_s2: quantiles(all.iter().map(|bench| bench[k].up_rad_s2).collect()),
        down_rad_s2: quantiles(all.iter().map(|bench| bench[k].down_rad_s2).collect()),
        binds: nominal.binds,
    };
    Ok(nominal.iter().enumerate().map(place).collect())
}

/// The largest gradients of one bench, torque by torque, in each speed by speed.
pub(crate) fn of_bench(
    inputs: &MapInputs<'_>,
    Braked { model, engine, friction }: &Braked,
    speed_rad_s: &[f64],
    torque_nm: &[f64],
) -> Vec<Gradient> {
    let range = speed_rad_s.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), w| (low.min(*w), high.max(*w)));
    let most_nm = torque_nm.iter().fold(0.0_f64, |most, torque| most.max(torque.abs()));
    let pulses = Pulses::of(model, engine, LoopMode::Speed, range, most_nm);
    let place = |torque: f64, speed: f64| {
        let friction_nm = friction.torque_nm(speed);
        gradient(&model.mechanics, &inputs.limits, torque, speed, friction_nm, &pulses.at(torque, speed))
    };
    torque_nm.iter().flat_map(|torque| speed_rad_s.iter().map(|speed| place(*torque, *speed))).collect()
}

/// The largest gradients of the speed while the engine gives a constant torque: T_d = T_e − T_fric − (J_d + J_e) α and
/// T_shaft = T_e − J_e α keep their limits, with what pulses add to them.
fn gradient(
    mechanics: &Mechanics,
    limits: &Limits,
    engine_nm: f64,
    speed_rad_s: f64,
    friction_nm: f64,
    added: &Added,
) -> Gradient {
    let both = mechanics.dyno_inertia_kg_m2 + mechanics.engine_inertia_kg_m2;
    let power_nm = limits.power_w.map(|power| power / (speed_rad_s.abs() + added.dyno_speed_rad_s).max(1e-9));
    let bounds = |sign: f64, shaft_nm: f64| {
        let torque = |limit: Option<f64>, driving_nm: f64, added_nm: f64, inertia: f64, of| {
            Some((((limit? - added_nm + sign * driving_nm) / inertia).max(0.0), Some(of)))
        };
        let driving_nm = engine_nm - friction_nm;
        let rooms = [
            torque(limits.torque_nm, driving_nm, added.demand_nm, both, LimitOf::TorqueDemand),
            torque(limits.shaft_torque_nm, engine_nm, shaft_nm, mechanics.engine_inertia_kg_m2, LimitOf::ShaftTorque),
            torque(power_nm, driving_nm, added.demand_nm, both, LimitOf::Power),
            limits
                .speed_gradient_rad_s2
                .map(|limit| ((limit - added.speed_gradient_rad_s2).max(0.0), Some(LimitOf::SpeedGradient))),
        ];
        rooms.into_iter().flatten().fold((f64::INFINITY, None), |least, one| if one.0 < least.0 { one } else { least })
    };
    let (up, down) = (bounds(1.0, added.shaft_below_nm), bounds(-1.0, added.shaft_above_nm));
    Gradient { speed_rad_s, torque_nm: engine_nm, up_rad_s2: up.0, down_rad_s2: down.0, binds: [up.1, down.1] }
}
