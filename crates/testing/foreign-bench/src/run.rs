//! The bench in motion.

use std::f64::consts::TAU;

use crate::bench::Bench;
use crate::control::{DynoSpeedControl, EngineSpeedControl};
use crate::demand::{Demand, Mode};
use crate::physics::{Drive, Engine, State, Train};
use crate::random::Random;
use crate::sensors::{Reading, Sensors};

/// Steps of the integrator in a millisecond.
const STEPS: usize = 50;
/// The bench settles so long at the first demands, ms.
const SETTLING_MS: usize = 2000;

/// Signals of a run, each millisecond from the first demand on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Run {
    /// T_d*, Nm.
    pub torque_demand_nm: Vec<f64>,
    /// N_d as its encoder shows it, rad/s.
    pub dyno_speed_rad_s: Vec<f64>,
    /// N_e as its encoder shows it, rad/s.
    pub engine_speed_rad_s: Vec<f64>,
    /// T_d,calc, Nm.
    pub computed_torque_nm: Vec<f64>,
    /// T_d,meas, Nm.
    pub cell_torque_nm: Vec<f64>,
    /// Signals that no sensor shows.
    pub truth: Truth,
}

/// Signals that no sensor shows, each millisecond.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Truth {
    /// ω_d, rad/s.
    pub dyno_speed_rad_s: Vec<f64>,
    /// ω_e, rad/s.
    pub engine_speed_rad_s: Vec<f64>,
    /// T_shaft, Nm.
    pub shaft_torque_nm: Vec<f64>,
    /// T_d, Nm.
    pub air_gap_torque_nm: Vec<f64>,
    /// Torque of the engine without the pistons' inertia, Nm.
    pub engine_torque_nm: Vec<f64>,
    /// Friction of the dynamometer's bearings, Nm.
    pub friction_nm: Vec<f64>,
    /// Kinetic energy of the engine, its pistons included, J.
    pub engine_energy_j: Vec<f64>,
    /// Twist of the shaft, rad.
    pub twist_rad: Vec<f64>,
    /// Crank angle, rad.
    pub crank_angle_rad: Vec<f64>,
}

/// Runs a demand. The seed draws start angle, noise and cycles of the engine.
pub fn run(bench: &Bench, demand: &Demand, seed: u64) -> Run {
    run_in_steps(bench, demand, seed, STEPS)
}

/// As [`run`], with so many steps of the integrator in a millisecond.
pub fn run_in_steps(bench: &Bench, demand: &Demand, seed: u64, steps: usize) -> Run {
    let mut run = Run::default();
    if demand.speed_rad_s.is_empty() {
        return run;
    }
    let mut moving = Moving::new(bench, demand, seed, steps);
    for _ in 0..SETTLING_MS {
        moving.update(0);
        moving.advance();
    }
    for update in 0..demand.speed_rad_s.len() {
        let (reading, torque_demand_nm) = moving.update(update);
        run.torque_demand_nm.push(torque_demand_nm);
        run.dyno_speed_rad_s.push(reading.dyno_rad_s);
        run.engine_speed_rad_s.push(reading.engine_rad_s);
        run.computed_torque_nm.push(reading.computed_nm);
        run.cell_torque_nm.push(reading.cell_nm);
        moving.show(&mut run.truth);
        moving.advance();
    }
    run
}

/// All parts, connected.
struct Moving<'a> {
    demand: &'a Demand,
    steps: usize,
    /// Milliseconds since the bench began to settle.
    elapsed_ms: usize,
    state: State,
    air_gap_nm: f64,
    train: Train,
    engine: Engine,
    drive: Drive,
    dyno_control: DynoSpeedControl,
    engine_control: EngineSpeedControl,
    torque_error: (f64, f64),
    limit_nm: f64,
    sensors: Sensors,
}

impl<'a> Moving<'a> {
    /// At rest at the first demands.
    fn new(bench: &Bench, demand: &'a Demand, seed: u64, steps: usize) -> Self {
        let mut random = Random::new(seed);
        let angle_rad = random.between(0.0, 2.0 * TAU);
        let ripple_rad = random.between(0.0, TAU);
        let first = |values: &[f64]| values.first().copied().unwrap_or(0.0);
        let (gain, offset_nm) = bench.engine.torque_error;
        let given_nm = |demanded_nm: f64| gain * demanded_nm + offset_nm;
        let (speed_rad_s, torque_nm) = (first(&demand.speed_rad_s), first(&demand.torque_nm));
        let friction_nm =
            bench.train.coulomb_nm * speed_rad_s.signum() + bench.train.viscous_nm_s_per_rad * speed_rad_s;
        let (air_gap_nm, engine_nm) = match demand.mode {
            Mode::Torque => (torque_nm, torque_nm + friction_nm),
            Mode::Speed | Mode::SpeedByIgnition => (given_nm(torque_nm) - friction_nm, given_nm(torque_nm)),
        };
        // Ignition only takes torque away.
        let charged_nm = match demand.mode {
            Mode::SpeedByIgnition => demand.torque_nm.iter().copied().map(given_nm).fold(engine_nm, f64::max),
            Mode::Speed | Mode::Torque => engine_nm,
        };
        let engine = Engine::new(&bench.engine, engine_nm, charged_nm, angle_rad, Random::new(seed ^ 0x5eed_0000_0001));
        let motions = [(angle_rad, speed_rad_s); 2];
        let sensors_random = Random::new(seed ^ 0x5eed_0000_0002);
        Moving {
            demand,
            steps,
            elapsed_ms: 0,
            state: State {
                dyno_rad_s: speed_rad_s,
                engine_rad_s: speed_rad_s,
                angle_rad,
                twist_rad: engine_nm / bench.train.stiffness_nm_per_rad,
                cell_nm: air_gap_nm,
                cell_nm_per_s: 0.0,
            },
            air_gap_nm,
            train: Train::new(bench, &engine),
            engine,
            drive: Drive::new(&bench.drive, air_gap_nm, 0.0, ripple_rad),
            dyno_control: DynoSpeedControl::new(&bench.controller, bench.drive.limit_nm, speed_rad_s, air_gap_nm),
            engine_control: EngineSpeedControl::new(&bench.engine, engine_nm),
            torque_error: bench.engine.torque_error,
            limit_nm: bench.drive.limit_nm,
            sensors: Sensors::new(&bench.sensors, 0.0, motions, air_gap_nm, sensors_random),
        }
    }

    fn time_s(&self) -> f64 {
        1e-3 * self.elapsed_ms as f64
    }

    /// Sensors and controllers; returns the reading and T_d*, Nm.
    fn update(&mut self, place: usize) -> (Reading, f64) {
        let (time_s, state) = (self.time_s(), &self.state);
        let motions = [(state.angle_rad - state.twist_rad, state.dyno_rad_s), (state.angle_rad, state.engine_rad_s)];
        let reading = self.sensors.read(time_s, motions, self.air_gap_nm, state.cell_nm);
        let (speed_rad_s, torque_nm) = (self.demand.speed_rad_s[place], self.demand.torque_nm[place]);
        let torque_demand_nm = match self.demand.mode {
            Mode::Torque => {
                let asked_nm = self.engine_control.update(reading.engine_rad_s, speed_rad_s);
                self.engine.demand(asked_nm, false);
                torque_nm.clamp(-self.limit_nm, self.limit_nm)
            }
            mode => {
                let (gain, offset_nm) = self.torque_error;
                self.engine.demand(gain * torque_nm + offset_nm, mode == Mode::SpeedByIgnition);
                self.dyno_control.update(reading.dyno_rad_s, speed_rad_s)
            }
        };
        self.drive.demand(time_s, torque_demand_nm);
        (reading, torque_demand_nm)
    }

    /// A millisecond.
    fn advance(&mut self) {
        let (start_s, step_s) = (self.time_s(), 1e-3 / self.steps as f64);
        let mut from_nm = self.drive.air_gap_nm(start_s);
        for step in 0..self.steps {
            let half = |halves: usize| start_s + 0.5 * step_s * (2 * step + halves) as f64;
            let middle_nm = self.drive.air_gap_nm(half(1));
            let to_nm = self.drive.air_gap_nm(half(2));
            self.engine.turn_to(self.state.angle_rad);
            self.state = self.train.step(&self.state, &self.engine, [from_nm, middle_nm, to_nm], step_s);
            from_nm = to_nm;
        }
        self.air_gap_nm = from_nm;
        self.elapsed_ms += 1;
    }

    fn show(&self, truth: &mut Truth) {
        let state = &self.state;
        let (engine_nm, energy_j) = self.train.engine(state, &self.engine);
        truth.dyno_speed_rad_s.push(state.dyno_rad_s);
        truth.engine_speed_rad_s.push(state.engine_rad_s);
        truth.shaft_torque_nm.push(self.train.shaft_nm(state));
        truth.air_gap_torque_nm.push(self.air_gap_nm);
        truth.engine_torque_nm.push(engine_nm);
        truth.friction_nm.push(self.train.friction_nm(state.dyno_rad_s));
        truth.engine_energy_j.push(energy_j);
        truth.twist_rad.push(state.twist_rad);
        truth.crank_angle_rad.push(state.angle_rad);
    }
}
