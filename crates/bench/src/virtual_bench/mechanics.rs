//! Two masses and a shaft, discretised exactly for torques that vary linearly over a step.

use std::array;

use faer::{Mat, mat};
use lti::StateSpace;

use super::error::VirtualBenchError;
use super::parameters::MechanicsParameters;

/// Speed below which Coulomb friction falls linearly to zero, rad/s; it keeps the friction law single-valued.
const COULOMB_TRANSITION_RAD_S: f64 = 0.1;

const STATES: usize = 5;
const INPUTS: usize = 2;

/// State of the two masses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MechanicalState {
    pub(super) dyno_speed_rad_s: f64,
    pub(super) engine_speed_rad_s: f64,
    /// φ, angle of the engine's end of the shaft minus that of the dynamometer's, zero without torque.
    pub(super) twist_rad: f64,
    pub(super) dyno_angle_rad: f64,
    pub(super) engine_angle_rad: f64,
}

/// Torques that drive the masses: T_d + T_Coulomb on the dynamometer, T_e on the engine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DrivingTorques {
    pub(super) braking_nm: f64,
    pub(super) engine_nm: f64,
}

/// x_{k+1} = Φ x_k + Γ_0 u_k + Γ_1 u_{k+1} for u linear within the step, exact up to rounding.
///
/// # Source
///
/// Franklin, Powell & Workman, *Digital Control of Dynamic Systems*, 3rd ed. 1998, §6.3.2 (triangle hold).
#[derive(Debug, Clone)]
pub(super) struct TwoMasses {
    transition: [[f64; STATES]; STATES],
    from_start: [[f64; INPUTS]; STATES],
    from_end: [[f64; INPUTS]; STATES],
    stiffness: f64,
    damping: f64,
    dyno_inertia: f64,
    engine_inertia: f64,
    coulomb_nm: f64,
    viscous: f64,
}

impl TwoMasses {
    /// The masses, connected by the shaft or not, at a step size.
    ///
    /// # Errors
    ///
    /// [`VirtualBenchError::Discretisation`] where the matrix exponential overflows.
    pub(super) fn new(
        parameters: &MechanicsParameters,
        is_connected: bool,
        step_s: f64,
    ) -> Result<Self, VirtualBenchError> {
        let connection = if is_connected { 1.0 } else { 0.0 };
        let mut masses = Self {
            transition: [[0.0; STATES]; STATES],
            from_start: [[0.0; INPUTS]; STATES],
            from_end: [[0.0; INPUTS]; STATES],
            stiffness: connection * parameters.shaft_stiffness_nm_per_rad,
            damping: connection * parameters.shaft_damping_nm_s_per_rad,
            dyno_inertia: parameters.dyno_inertia_kg_m2,
            engine_inertia: parameters.engine_inertia_kg_m2,
            coulomb_nm: parameters.coulomb_friction_nm,
            viscous: parameters.viscous_friction_nm_s_per_rad,
        };
        masses.discretise(step_s)?;
        Ok(masses)
    }

    fn discretise(&mut self, step_s: f64) -> Result<(), VirtualBenchError> {
        let hold = self.state_space()?.to_discrete_foh(step_s)?;
        self.transition = array::from_fn(|i| array::from_fn(|j| hold.a()[(i, j)]));
        self.from_start = array::from_fn(|i| array::from_fn(|j| hold.b0()[(i, j)]));
        self.from_end = array::from_fn(|i| array::from_fn(|j| hold.b1()[(i, j)]));
        Ok(())
    }

    /// ẋ = A x + B u with x = (ω_d, ω_e, φ, θ_d, θ_e), u = (T_d + T_Coulomb, T_e).
    fn state_space(&self) -> Result<StateSpace, lti::LtiError> {
        let (k, b, jd, je) = (self.stiffness, self.damping, self.dyno_inertia, self.engine_inertia);
        let a = mat![
            [-(b + self.viscous) / jd, b / jd, k / jd, 0.0, 0.0],
            [b / je, -b / je, -k / je, 0.0, 0.0],
            [-1.0, 1.0, 0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0, 0.0_f64],
        ];
        let b = Mat::from_fn(STATES, INPUTS, |i, j| match (i, j) {
            (0, 0) => -1.0 / jd,
            (1, 1) => 1.0 / je,
            _ => 0.0,
        });
        StateSpace::new(a, b, Mat::identity(STATES, STATES), Mat::zeros(STATES, INPUTS), None)
    }

    /// One step with torques linear from `start` to `end`.
    pub(super) fn advance(
        &self,
        state: &MechanicalState,
        start: DrivingTorques,
        end: DrivingTorques,
    ) -> MechanicalState {
        let x = state.to_array();
        let mut next = [0.0; STATES];
        for row in 0..STATES {
            let free: f64 = self.transition[row].iter().zip(&x).map(|(m, x)| m * x).sum();
            let [start_braking, start_engine] = self.from_start[row];
            let [end_braking, end_engine] = self.from_end[row];
            next[row] = free
                + start_braking * start.braking_nm
                + start_engine * start.engine_nm
                + end_braking * end.braking_nm
                + end_engine * end.engine_nm;
        }
        MechanicalState::from_array(next)
    }

    /// Adds what a jump of the engine's torque does in the rest of a step after it, up to terms of third order in
    /// the remaining time.
    pub(super) fn add_engine_jump(&self, state: &mut MechanicalState, jump_nm: f64, remaining_s: f64) {
        let speed = jump_nm * remaining_s / self.engine_inertia;
        let angle = 0.5 * speed * remaining_s;
        state.engine_speed_rad_s += speed * (1.0 - 0.5 * self.damping * remaining_s / self.engine_inertia);
        state.dyno_speed_rad_s += self.damping * angle / self.dyno_inertia;
        state.twist_rad += angle;
        state.engine_angle_rad += angle;
    }

    /// T_shaft = K φ + B (ω_e − ω_d), Nm (thesis 2.7).
    pub(super) fn shaft_torque_nm(&self, state: &MechanicalState) -> f64 {
        self.stiffness * state.twist_rad + self.damping * (state.engine_speed_rad_s - state.dyno_speed_rad_s)
    }

    /// Twist that carries a torque at rest, rad; zero without a shaft.
    pub(super) fn twist_at_rad(&self, torque_nm: f64) -> f64 {
        if self.stiffness > 0.0 { torque_nm / self.stiffness } else { 0.0 }
    }

    /// Coulomb friction at a speed, Nm.
    pub(super) fn coulomb_nm(&self, dyno_speed_rad_s: f64) -> f64 {
        self.coulomb_nm * (dyno_speed_rad_s / COULOMB_TRANSITION_RAD_S).clamp(-1.0, 1.0)
    }

    /// All friction at a speed, Nm.
    pub(super) fn friction_nm(&self, dyno_speed_rad_s: f64) -> f64 {
        self.coulomb_nm(dyno_speed_rad_s) + self.viscous * dyno_speed_rad_s
    }

    /// Acceleration of the engine, rad/s².
    pub(super) fn engine_acceleration_rad_s2(&self, state: &MechanicalState, engine_nm: f64) -> f64 {
        (engine_nm - self.shaft_torque_nm(state)) / self.engine_inertia
    }
}

impl MechanicalState {
    fn to_array(self) -> [f64; STATES] {
        [self.dyno_speed_rad_s, self.engine_speed_rad_s, self.twist_rad, self.dyno_angle_rad, self.engine_angle_rad]
    }

    fn from_array(x: [f64; STATES]) -> Self {
        Self {
            dyno_speed_rad_s: x[0],
            engine_speed_rad_s: x[1],
            twist_rad: x[2],
            dyno_angle_rad: x[3],
            engine_angle_rad: x[4],
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.to_array().iter().all(|x| x.is_finite())
    }
}
