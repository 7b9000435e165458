//! The rotating train: dynamometer, shaft, flywheel, engine. Linear parts are discretised exactly for torques that run
//! straight over a step; backlash, stiffening and Coulomb friction are torques of a predictor and a corrector.

mod assembly;
mod resonance;
mod shaft_law;

use rig::bench_parameters::MechanicsParameters;

use super::error::VirtualBenchError;
use assembly::{Assembly, BRAKE, ENGINE, INPUTS, ROTOR, SHAFT};
pub(super) use resonance::resonance_hz;
use shaft_law::ShaftLaw;

/// Speed below which Coulomb friction falls linearly to zero, rad/s; it keeps the friction law single-valued.
const COULOMB_TRANSITION_RAD_S: f64 = 0.1;

/// States that a column of the step's matrix has room for; more take further columns.
const LANES: usize = 8;
/// Torques of a step: of brake and engine at its start and at its end, and of what the shaft has beyond linear all
/// along.
const STEP_INPUTS: usize = 2 * 2 + 1;

/// Torques on the train at an instant: T_d on the rotor, T_e on the engine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Torques {
    pub(super) air_gap_nm: f64,
    pub(super) engine_nm: f64,
}

/// A jump of the engine's torque within a step, and how much of the step is left after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Jump {
    pub(super) remaining_s: f64,
    pub(super) jump_nm: f64,
}

/// x_{k+1} = Φ x_k + Γ_0 u_k + Γ_1 u_{k+1}, exact up to rounding for u straight within the step. What depends on the
/// state in a non-linear way is part of u: u_{k+1} is predicted by holding it, then corrected once, which leaves an
/// error of second order in the step.
///
/// # Source
///
/// Franklin, Powell & Workman, *Digital Control of Dynamic Systems*, 3rd ed. 1998, §6.3.2 (triangle hold); Cox &
/// Matthews, *Exponential time differencing for stiff systems*, J. Comput. Phys. 176 (2002), eq. 22 (ETD2RK).
#[derive(Debug, Clone)]
pub(super) struct Train {
    assembly: Assembly,
    law: ShaftLaw,
    is_connected: bool,
    /// True where the shaft is connected and more than K φ + B φ̇.
    is_bent: bool,
    coulomb_nm: f64,
    /// The columns of [Φ Γ], in blocks of as many rows as there are lanes. Γ: Γ_0 and Γ_1 of brake and engine, Γ_0 +
    /// Γ_1 of the shaft.
    step_blocks: Vec<Vec<[f64; LANES]>>,
    /// Γ_1 by columns.
    from_end: [Vec<f64>; INPUTS],
    /// b, A b and A² b of the engine's torque: what a jump does in the rest of a step.
    after_jump: [Vec<f64>; 3],
    /// T_shaft and the torque on the engine: places and weights of states.
    shaft_row: Vec<(usize, f64)>,
    engine_row: Vec<(usize, f64)>,
    /// x and the torques of the step.
    point: Vec<f64>,
    /// x a step later, by blocks.
    next: Vec<[f64; LANES]>,
}

impl Train {
    /// The train at rest at a speed, under a torque of the engine, at a step size.
    ///
    /// # Errors
    ///
    /// [`VirtualBenchError::Discretisation`] where the matrix exponential overflows.
    pub(super) fn new(
        parameters: &MechanicsParameters,
        is_connected: bool,
        step_s: f64,
    ) -> Result<Self, VirtualBenchError> {
        let assembly = Assembly::new(parameters, is_connected);
        let hold = assembly.state_space()?.to_discrete_foh(step_s)?;
        let n = assembly.states();
        let torques = |i: usize| {
            let (start, end) = (|j| hold.b0()[(i, j)], |j| hold.b1()[(i, j)]);
            [start(BRAKE), start(ENGINE), end(BRAKE), end(ENGINE), start(SHAFT) + end(SHAFT)]
        };
        let entry = |i: usize, j: usize| match j.checked_sub(n) {
            _ if i >= n => 0.0,
            None => hold.a()[(i, j)],
            Some(input) => torques(i)[input],
        };
        let column = |block: usize, j: usize| std::array::from_fn(|lane| entry(block * LANES + lane, j));
        let columns = |block: usize| (0..n + STEP_INPUTS).map(|j| column(block, j)).collect();
        let row = |connection: usize| {
            let row = assembly.torque_row(connection).into_iter().enumerate();
            row.filter(|(_, weight)| *weight != 0.0).collect()
        };
        let (a, b) = assembly.matrices();
        let first = b.col(ENGINE).to_owned();
        let second = &a * &first;
        let third = &a * &second;
        let shaft = assembly.connections[assembly.shaft];
        let law = ShaftLaw::new(parameters, shaft.stiffness, shaft.damping);
        Ok(Self {
            is_bent: is_connected && !law.is_linear(),
            law,
            is_connected,
            coulomb_nm: parameters.coulomb_friction_nm,
            step_blocks: (0..n.div_ceil(LANES)).map(columns).collect(),
            from_end: [0, 1, 2].map(|j| (0..n).map(|i| hold.b1()[(i, j)]).collect()),
            after_jump: [first, second, third].map(|column| column.iter().copied().collect()),
            shaft_row: row(assembly.shaft),
            engine_row: row(assembly.connections.len() - 1),
            point: vec![0.0; n + STEP_INPUTS],
            next: vec![[0.0; LANES]; n.div_ceil(LANES)],
            assembly,
        })
    }

    /// Puts the train at rest: one speed, one angle, twists that carry a torque.
    pub(super) fn rest_at(&mut self, speed_rad_s: f64, angle_rad: f64, torque_nm: f64) {
        self.point[..self.assembly.inertias.len()].fill(speed_rad_s);
        let carried_nm = if self.is_connected { torque_nm } else { 0.0 };
        for (connection, linear) in self.assembly.connections.iter().enumerate() {
            let is_shaft = connection == self.assembly.shaft;
            self.point[self.assembly.twist(connection)] = match (is_shaft, self.is_connected) {
                (true, false) => 0.0,
                (true, true) => self.law.twist_at_rad(carried_nm),
                (false, _) => carried_nm / linear.stiffness,
            };
        }
        self.point[self.assembly.rotor_angle()] = angle_rad;
        self.point[self.assembly.engine_angle()] = angle_rad;
    }

    /// One step under torques that run straight from `start` to `end`, but for a jump of the engine's.
    pub(super) fn advance(&mut self, start: Torques, end: Torques, jump: Option<Jump>) {
        let n = self.assembly.states();
        let coulomb_nm = self.coulomb_nm(self.dyno_speed_rad_s());
        let beyond_nm = self.beyond_linear_nm();
        let brakes_nm = [start.air_gap_nm, end.air_gap_nm].map(|torque| torque + coulomb_nm);
        let torques = [brakes_nm[0], start.engine_nm, brakes_nm[1], end.engine_nm, beyond_nm];
        self.point[n..].copy_from_slice(&torques);
        self.multiply();
        if let Some(jump) = jump {
            self.add_jump(jump);
        }
        let friction_change_nm = self.coulomb_nm(self.dyno_speed_rad_s()) - coulomb_nm;
        self.correct(BRAKE, friction_change_nm);
        let beyond_change_nm = self.beyond_linear_nm() - beyond_nm;
        self.correct(SHAFT, beyond_change_nm);
    }

    /// x ← [Φ Γ] (x, torques).
    fn multiply(&mut self) {
        let n = self.assembly.states();
        let used = if self.is_bent { self.point.len() } else { self.point.len() - 1 };
        for (next, columns) in self.next.iter_mut().zip(&self.step_blocks) {
            let mut sums = [0.0; LANES];
            for (x, column) in self.point[..used].iter().zip(columns) {
                sums.iter_mut().zip(column).for_each(|(sum, m)| *sum += m * x);
            }
            *next = sums;
        }
        self.point[..n].copy_from_slice(&self.next.as_flattened()[..n]);
    }

    /// Adds torque of the engine that ended the last step beside what was foreseen.
    pub(super) fn correct_engine(&mut self, change_nm: f64) {
        self.correct(ENGINE, change_nm);
    }

    /// Adds the effect of a torque that ends the step higher than predicted.
    fn correct(&mut self, input: usize, change_nm: f64) {
        if change_nm != 0.0 {
            let effect = &self.from_end[input];
            self.point.iter_mut().zip(effect).for_each(|(x, from_end)| *x += from_end * change_nm);
        }
    }

    /// Adds what a jump of the engine's torque does in the rest of the step after it, up to terms of fourth order in
    /// the time that remains.
    fn add_jump(&mut self, jump: Jump) {
        let t = jump.remaining_s;
        let weights = [t, t * t / 2.0, t * t * t / 6.0].map(|weight| weight * jump.jump_nm);
        for (column, weight) in self.after_jump.iter().zip(weights) {
            self.point.iter_mut().zip(column).for_each(|(x, effect)| *x += effect * weight);
        }
    }

    /// Torque of the shaft beyond K φ + B φ̇, Nm.
    fn beyond_linear_nm(&self) -> f64 {
        if !self.is_bent {
            return 0.0;
        }
        let shaft = self.assembly.shaft;
        let rate_rad_s = self.point[shaft + 1] - self.point[shaft];
        self.law.beyond_linear_nm(self.point[self.assembly.twist(shaft)], rate_rad_s)
    }

    fn row_nm(&self, row: &[(usize, f64)]) -> f64 {
        row.iter().map(|(place, weight)| weight * self.point[*place]).sum()
    }

    /// T_shaft, Nm, at the dynamometer's end.
    pub(super) fn shaft_torque_nm(&self) -> f64 {
        self.row_nm(&self.shaft_row) + self.beyond_linear_nm()
    }

    /// Torque that the engine gives on: to the shaft, or to the flywheel's springs.
    pub(super) fn torque_on_engine_nm(&self) -> f64 {
        let is_shaft = self.assembly.shaft + 1 == self.assembly.connections.len();
        self.row_nm(&self.engine_row) + if is_shaft { self.beyond_linear_nm() } else { 0.0 }
    }

    /// Coulomb friction at a speed, Nm.
    fn coulomb_nm(&self, dyno_speed_rad_s: f64) -> f64 {
        self.coulomb_nm * (dyno_speed_rad_s * (1.0 / COULOMB_TRANSITION_RAD_S)).clamp(-1.0, 1.0)
    }

    /// All friction of the dynamometer's bearings at a speed, Nm.
    pub(super) fn friction_nm(&self, dyno_speed_rad_s: f64) -> f64 {
        self.coulomb_nm(dyno_speed_rad_s) + self.assembly.viscous * dyno_speed_rad_s
    }

    /// Inertia on which T_e acts: J_e, or without the flywheel's secondary, kg m².
    pub(super) fn engine_inertia_kg_m2(&self) -> f64 {
        self.assembly.inertias[self.assembly.engine()]
    }

    /// Acceleration of the engine, rad/s².
    pub(super) fn engine_acceleration_rad_s2(&self, engine_nm: f64) -> f64 {
        (engine_nm - self.torque_on_engine_nm()) / self.engine_inertia_kg_m2()
    }

    /// ω_d of the rotor, on which the encoder sits, rad/s.
    pub(super) fn dyno_speed_rad_s(&self) -> f64 {
        self.point[ROTOR]
    }

    pub(super) fn engine_speed_rad_s(&self) -> f64 {
        self.point[self.assembly.engine()]
    }

    pub(super) fn dyno_angle_rad(&self) -> f64 {
        self.point[self.assembly.rotor_angle()]
    }

    pub(super) fn engine_angle_rad(&self) -> f64 {
        self.point[self.assembly.engine_angle()]
    }

    pub(super) fn is_finite(&self) -> bool {
        self.point.iter().all(|x| x.is_finite())
    }
}
