//! Two masses and a shaft, discretised exactly for torques that vary linearly over a step.

use super::expm::{Matrix, expm};
use super::parameters::MechanicsParameters;

/// Speed below which Coulomb friction falls linearly to zero, rad/s; it keeps the friction law single-valued.
const COULOMB_TRANSITION_RAD_S: f64 = 0.1;

const STATES: usize = 5;
const INPUTS: usize = 2;
const AUGMENTED: usize = STATES + 2 * INPUTS;

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

/// x_{k+1} = Φ x_k + Γ_0 u_k + Γ_1 (u_{k+1} − u_k) for u linear within the step, exact up to rounding.
///
/// # Source
///
/// Franklin, Powell & Workman, *Digital Control of Dynamic Systems*, 3rd ed. 1998, §6.3.2 (triangle hold); the three
/// matrices from one matrix exponential: Van Loan, IEEE Trans. Automatic Control 23 (1978) 395.
#[derive(Debug, Clone)]
pub(super) struct TwoMasses {
    transition: [[f64; STATES]; STATES],
    hold: [[f64; INPUTS]; STATES],
    slope: [[f64; INPUTS]; STATES],
    stiffness: f64,
    damping: f64,
    dyno_inertia: f64,
    engine_inertia: f64,
    coulomb_nm: f64,
    viscous: f64,
}

impl TwoMasses {
    /// The masses, connected by the shaft or not, at a step size.
    pub(super) fn new(parameters: &MechanicsParameters, is_connected: bool, step_s: f64) -> Self {
        let connection = if is_connected { 1.0 } else { 0.0 };
        let mut masses = Self {
            transition: [[0.0; STATES]; STATES],
            hold: [[0.0; INPUTS]; STATES],
            slope: [[0.0; INPUTS]; STATES],
            stiffness: connection * parameters.shaft_stiffness_nm_per_rad,
            damping: connection * parameters.shaft_damping_nm_s_per_rad,
            dyno_inertia: parameters.dyno_inertia_kg_m2,
            engine_inertia: parameters.engine_inertia_kg_m2,
            coulomb_nm: parameters.coulomb_friction_nm,
            viscous: parameters.viscous_friction_nm_s_per_rad,
        };
        masses.discretise(step_s);
        masses
    }

    fn discretise(&mut self, step_s: f64) {
        let exponential = expm(&self.augmented(step_s));
        for row in 0..STATES {
            for column in 0..STATES {
                self.transition[row][column] = exponential[row][column];
            }
            for input in 0..INPUTS {
                self.hold[row][input] = exponential[row][STATES + input];
                self.slope[row][input] = exponential[row][STATES + INPUTS + input];
            }
        }
    }

    /// [[A h, B h, 0], [0, 0, I], [0, 0, 0]]: state, torques, and the torques' change over the step.
    fn augmented(&self, step_s: f64) -> Matrix<AUGMENTED> {
        let (k, b, jd, je) = (self.stiffness, self.damping, self.dyno_inertia, self.engine_inertia);
        let mut a = [[0.0; AUGMENTED]; AUGMENTED];
        a[0][..3].copy_from_slice(&[-(b + self.viscous) / jd, b / jd, k / jd]);
        a[1][..3].copy_from_slice(&[b / je, -b / je, -k / je]);
        a[2][..2].copy_from_slice(&[-1.0, 1.0]);
        a[3][0] = 1.0;
        a[4][1] = 1.0;
        a[0][STATES] = -1.0 / jd;
        a[1][STATES + 1] = 1.0 / je;
        for value in a.iter_mut().flatten() {
            *value *= step_s;
        }
        for input in 0..INPUTS {
            a[STATES + input][STATES + INPUTS + input] = 1.0;
        }
        a
    }

    /// One step with torques linear from `start` to `end`.
    pub(super) fn advance(
        &self,
        state: &MechanicalState,
        start: DrivingTorques,
        end: DrivingTorques,
    ) -> MechanicalState {
        let x = state.to_array();
        let (braking, engine) = (start.braking_nm, start.engine_nm);
        let (braking_change, engine_change) = (end.braking_nm - braking, end.engine_nm - engine);
        let mut next = [0.0; STATES];
        for row in 0..STATES {
            let free: f64 = self.transition[row].iter().zip(&x).map(|(m, x)| m * x).sum();
            let [hold_braking, hold_engine] = self.hold[row];
            let [slope_braking, slope_engine] = self.slope[row];
            next[row] = free
                + hold_braking * braking
                + hold_engine * engine
                + slope_braking * braking_change
                + slope_engine * engine_change;
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
