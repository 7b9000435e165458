//! Two inertias, a shaft, bearings and the load cell, by the classical Runge–Kutta method.

use super::engine::Engine;
use crate::bench;

/// Speed about which the friction of the bearings changes its sign, rad/s.
const CHANGE_RAD_S: f64 = 0.5;

/// Where the bench is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct State {
    /// ω_d, rad/s.
    pub(crate) dyno_rad_s: f64,
    /// ω_e, rad/s.
    pub(crate) engine_rad_s: f64,
    /// Crank angle, rad.
    pub(crate) angle_rad: f64,
    /// By how much the engine is ahead of the dynamometer, rad.
    pub(crate) twist_rad: f64,
    /// Reading of the load cell, before its delay, Nm.
    pub(crate) cell_nm: f64,
    /// Its rate, Nm/s.
    pub(crate) cell_nm_per_s: f64,
}

/// The mechanics.
pub(crate) struct Train {
    parameters: bench::Train,
    /// J_e without the pistons, kg m².
    crank_kg_m2: f64,
    /// Natural frequency, rad/s, and damping ratio of the load cell.
    cell: (f64, f64),
}

impl Train {
    pub(crate) fn new(bench: &bench::Bench, engine: &Engine) -> Self {
        Train {
            parameters: bench.train.clone(),
            crank_kg_m2: bench.train.engine_inertia_kg_m2 - engine.mean_pistons_kg_m2(),
            cell: (bench.sensors.cell_rad_s, bench.sensors.cell_damping_ratio),
        }
    }

    /// T_shaft, Nm.
    pub(crate) fn shaft_nm(&self, state: &State) -> f64 {
        self.parameters.stiffness_nm_per_rad * state.twist_rad
            + self.parameters.damping_nm_s_per_rad * (state.engine_rad_s - state.dyno_rad_s)
    }

    /// Friction of the bearings, Nm.
    pub(crate) fn friction_nm(&self, speed_rad_s: f64) -> f64 {
        self.parameters.coulomb_nm * (speed_rad_s / CHANGE_RAD_S).tanh()
            + self.parameters.viscous_nm_s_per_rad * speed_rad_s
    }

    /// One step with T_d at its begin, middle and end.
    pub(crate) fn step(&self, state: &State, engine: &Engine, air_gap_nm: [f64; 3], step_s: f64) -> State {
        let first = self.rates(state, engine, air_gap_nm[0]);
        let second = self.rates(&state.plus(&first, 0.5 * step_s), engine, air_gap_nm[1]);
        let third = self.rates(&state.plus(&second, 0.5 * step_s), engine, air_gap_nm[1]);
        let fourth = self.rates(&state.plus(&third, step_s), engine, air_gap_nm[2]);
        let sixth_s = step_s / 6.0;
        state.plus(&first, sixth_s).plus(&second, 2.0 * sixth_s).plus(&third, 2.0 * sixth_s).plus(&fourth, sixth_s)
    }

    /// J_d dω_d/dt = T_shaft − T_d − friction, J_e dω_e/dt = T_e − T_shaft.
    fn rates(&self, state: &State, engine: &Engine, air_gap_nm: f64) -> State {
        let shaft_nm = self.shaft_nm(state);
        let motion = engine.motion(state.angle_rad, state.engine_rad_s);
        let (natural_rad_s, ratio) = self.cell;
        let braked_nm = shaft_nm - air_gap_nm - self.friction_nm(state.dyno_rad_s);
        State {
            dyno_rad_s: braked_nm / self.parameters.dyno_inertia_kg_m2,
            engine_rad_s: (motion.torque_nm - shaft_nm) / (self.crank_kg_m2 + motion.pistons_kg_m2),
            angle_rad: state.engine_rad_s,
            twist_rad: state.engine_rad_s - state.dyno_rad_s,
            cell_nm: state.cell_nm_per_s,
            cell_nm_per_s: natural_rad_s
                * (natural_rad_s * (air_gap_nm - state.cell_nm) - 2.0 * ratio * state.cell_nm_per_s),
        }
    }

    /// Torque of the engine at the crank, Nm, and kinetic energy of the pistons with the rest of J_e, J.
    pub(crate) fn engine(&self, state: &State, engine: &Engine) -> (f64, f64) {
        let motion = engine.motion(state.angle_rad, state.engine_rad_s);
        let pistons = engine.motion(state.angle_rad, 0.0);
        let energy_j = 0.5 * (self.crank_kg_m2 + motion.pistons_kg_m2) * state.engine_rad_s.powi(2);
        (pistons.torque_nm, energy_j)
    }
}

impl State {
    fn plus(&self, rates: &State, time_s: f64) -> State {
        State {
            dyno_rad_s: self.dyno_rad_s + time_s * rates.dyno_rad_s,
            engine_rad_s: self.engine_rad_s + time_s * rates.engine_rad_s,
            angle_rad: self.angle_rad + time_s * rates.angle_rad,
            twist_rad: self.twist_rad + time_s * rates.twist_rad,
            cell_nm: self.cell_nm + time_s * rates.cell_nm,
            cell_nm_per_s: self.cell_nm_per_s + time_s * rates.cell_nm_per_s,
        }
    }
}
