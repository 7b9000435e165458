//! Check that the engine's pulses pass the shaft as K, B and J_d let them through.
//!
//! T_shaft moves the dynamometer, and in speed control the torque G ω_d by which the controller answers: ω_d/ω_e = (K +
//! B s)/(J_d s² + (B + G) s + K) at the frequency of the pulses, which both speeds show far above their noise. A filter
//! on one of the speeds changes that ratio at once, while K and B make up for most of it at the lower frequencies that
//! they are estimated from.

use std::f64::consts::TAU;
use std::ops::Range;

use part_controller::speed_controller::SpeedControllerFit;
use part_torque::torque_control::{OF_MAINS_HZ, TorqueControlFit};
use rig::results::{Quantity, Shaft};
use rig::{ControlMode, Experiment, Role};
use signal::{Complex64, Signal};

use crate::orders::{SEEN, Seen, middle};

/// The ratio of the speeds over what the shaft makes of it, where nothing is wrong. On 29 simulated benches it is 0.92
/// to 1.17, the latter with a loss factor in place of B; a mean of 6 ms on N_e makes 1.6 of it, a lag of 2 ms on N_d
/// 0.66.
const AS_IT_SHOULD: Range<f64> = 0.8..1.25;
/// A line is seen where its power is so many times that beside it.
const CLEAR: f64 = 400.0;
/// Where the noise beside a line is taken, as a part of what separates two orders over the recording.
const BESIDE: [f64; 8] = [-20.0, -16.0, -12.0, -8.0, 8.0, 12.0, 16.0, 20.0];
/// A speed that varies by more than this part of itself is at many frequencies.
const CONSTANT: f64 = 0.03;
/// Pulses this near to the ripple of the drive, in parts of what separates two lines of the recording, cannot be
/// separated from it: the ripple moves N_d too.
const BESIDE_RIPPLE: f64 = 20.0;

/// Answer of the speed controller to N_d: T_d/ω_d = F(s) (K_p + K_i/s) e^{−sτ}, F being the torque control.
#[derive(Debug, Clone, Copy)]
pub struct Answer {
    proportional: f64,
    integral: f64,
    delay_s: f64,
    lag_rad_s: f64,
}

impl Answer {
    /// Of the controller and the torque control that were estimated; none without both.
    pub fn of(controller: Option<&SpeedControllerFit>, drive: Option<&TorqueControlFit>) -> Option<Self> {
        let value = |quantity| controller?.result.estimate.parameter(quantity).map(|found| found.value);
        let model = &drive?.model;
        Some(Answer {
            proportional: value(Quantity::ProportionalGain)?,
            integral: value(Quantity::IntegralGain)?,
            delay_s: value(Quantity::ControllerDelay)? + model.delay_s,
            lag_rad_s: model.lag_rad_s,
        })
    }

    fn at(&self, s: Complex64) -> Complex64 {
        (self.proportional + self.integral / s) * (-s * self.delay_s).exp() / (1.0 + s / self.lag_rad_s)
    }
}

/// The frequency of the pulses, Hz, that pass farthest from how K and B let them through, and their strength in N_d
/// over that in N_e as a part of what the shaft makes of it. Nothing where all pass as they should, or are not seen.
pub fn off_shaft(
    experiment: &Experiment,
    shaft: &Shaft,
    answer: Option<Answer>,
    inertia_kg_m2: f64,
    firings_per_turn: f64,
) -> Option<(f64, f64)> {
    let of = |order| passed(experiment, shaft, answer, inertia_kg_m2, order);
    let found = [firings_per_turn, 2.0 * firings_per_turn].into_iter().filter_map(of);
    let farthest = found.max_by(|a, b| a.1.ln().abs().total_cmp(&b.1.ln().abs()));
    farthest.filter(|(_, ratio)| !AS_IT_SHOULD.contains(ratio))
}

/// The frequency of an order, and its strength in N_d over that in N_e as a part of what the shaft makes of it; nothing
/// where either does not show it, or where a controller that is not known answers to it.
fn passed(
    experiment: &Experiment,
    shaft: &Shaft,
    answer: Option<Answer>,
    inertia_kg_m2: f64,
    order: f64,
) -> Option<(f64, f64)> {
    let [dyno, engine] = [experiment.signal(Role::DynoSpeed)?, experiment.signal(Role::EngineSpeed)?].map(middle);
    let mean = dyno.mean()?.abs();
    let is_constant = |speed: &Signal| speed.samples.iter().all(|x| (x.abs() - mean).abs() < 5.0 * CONSTANT * mean);
    let highest = SEEN * TAU / (dyno.sample_time_s.max(engine.sample_time_s) * mean);
    let distance_hz = BESIDE_RIPPLE / (dyno.sample_time_s * dyno.samples.len() as f64);
    let is_ripple = OF_MAINS_HZ.into_iter().any(|hz| (order * mean / TAU - hz).abs() < distance_hz);
    if order == 0.0 || order > highest || is_ripple || !is_constant(&dyno) {
        return None;
    }
    let value = |quantity| shaft.estimate.parameter(quantity).map(|found| found.value);
    let (k, b) = (value(Quantity::Stiffness)?, value(Quantity::Damping)?);
    let s = Complex64::new(0.0, order * mean);
    let braking = match experiment.label.mode {
        ControlMode::Nt => answer?.at(s),
        ControlMode::Tn => Complex64::ZERO,
    };
    let expected = ((k + b * s) / (inertia_kg_m2 * s * s + (b + braking) * s + k)).norm();
    let of = |speed: &Signal| strength(&Seen::over_angle_of(speed, &dyno, mean), order);
    let found = (of(&dyno)? / of(&engine)?).sqrt();
    Some((order * mean / TAU, found / expected))
}

/// The power of an order in a speed, where it is clear.
fn strength(seen: &Seen, order: f64) -> Option<f64> {
    let step = TAU / seen.turned();
    let power = seen.power(order);
    let mut beside: Vec<f64> = BESIDE.iter().map(|places| seen.power(order + places * step)).collect();
    let noise = numerics::order::lower_median(&mut beside)?;
    (power > CLEAR * noise).then_some(power)
}
