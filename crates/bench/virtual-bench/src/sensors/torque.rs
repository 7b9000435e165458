//! Torque sensors: load cell and flange.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use faer::mat;
use lti::StateSpace;

use super::rotation::WHOLE;
use crate::error::VirtualBenchError;

/// Dynamics of a torque sensor before noise and rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SensorDynamics {
    pub delay_s: f64,
    pub resonance_hz: f64,
    pub damping_ratio: f64,
}

/// A mass on a spring, or a filter, and a delay: e^{−s d} ω_0²/(s² + 2ζω_0 s + ω_0²), exact for torques that run
/// straight within a step.
#[derive(Debug, Clone)]
pub(crate) struct TorqueSensor {
    transition: [[f64; 2]; 2],
    from_start: [f64; 2],
    from_end: [f64; 2],
    /// Reading and its derivative, before the delay.
    state: [f64; 2],
    last_torque_nm: f64,
    /// Readings not yet delayed enough, the newest last.
    undelayed_nm: VecDeque<f64>,
    /// Steps in the delay, and the part of one step beyond them.
    delay_steps: usize,
    delay_rest: f64,
}

impl TorqueSensor {
    /// The sensor at rest at a torque.
    pub(crate) fn new(dynamics: SensorDynamics, step_s: f64, torque_nm: f64) -> Result<Self, VirtualBenchError> {
        let natural = TAU * dynamics.resonance_hz;
        let a = mat![[0.0, 1.0], [-natural * natural, -2.0 * dynamics.damping_ratio * natural]];
        let b = mat![[0.0], [natural * natural]];
        let hold = StateSpace::new(a, b, mat![[1.0, 0.0]], mat![[0.0]], None)?.to_discrete_foh(step_s)?;
        let steps = dynamics.delay_s / step_s;
        let whole = (steps + WHOLE).floor();
        Ok(Self {
            transition: [[hold.a()[(0, 0)], hold.a()[(0, 1)]], [hold.a()[(1, 0)], hold.a()[(1, 1)]]],
            from_start: [hold.b0()[(0, 0)], hold.b0()[(1, 0)]],
            from_end: [hold.b1()[(0, 0)], hold.b1()[(1, 0)]],
            state: [torque_nm, 0.0],
            last_torque_nm: torque_nm,
            undelayed_nm: VecDeque::from(vec![torque_nm; whole as usize + 2]),
            delay_steps: whole as usize,
            delay_rest: (steps - whole).max(0.0),
        })
    }

    /// One step, at whose end the air-gap torque is `torque_nm`.
    pub(crate) fn advance(&mut self, torque_nm: f64) {
        let [reading, slope] = self.state;
        self.state = [0, 1].map(|i| {
            self.transition[i][0] * reading
                + self.transition[i][1] * slope
                + self.from_start[i] * self.last_torque_nm
                + self.from_end[i] * torque_nm
        });
        self.last_torque_nm = torque_nm;
        self.undelayed_nm.push_back(self.state[0]);
        self.undelayed_nm.pop_front();
    }

    /// Reading of the sensor now, Nm; between steps of the grid it is linear.
    pub(crate) fn reading_nm(&self) -> f64 {
        let newest = self.undelayed_nm.len() - 1;
        let later = self.undelayed_nm[newest - self.delay_steps];
        let earlier = self.undelayed_nm[newest - self.delay_steps - 1];
        later + (earlier - later) * self.delay_rest
    }
}
