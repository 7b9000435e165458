//! The bench in motion: all parts connected, update by update.

use crate::ControlMode;

use super::controller::SpeedController;
use super::engine::{Combustion, Engine, EngineSpeedControl};
use super::error::VirtualBenchError;
use super::inverter::{Inverter, TimedDemand};
use super::mechanics::{DrivingTorques, MechanicalState, TwoMasses};
use super::noise::{Random, Source};
use super::parameters::BenchParameters;
use super::plan::ExperimentPlan;
use super::sensors::{Encoder, LoadCell, Rotation, SystemShaftTorque, rounded};
use super::waveform::hold;
use super::{HiddenTruth, Numerics, UPDATE_S};

/// Demands at every update of the recording.
struct Demands {
    speed_rad_s: Vec<f64>,
    dyno_torque_nm: Vec<f64>,
    engine_torque_nm: Vec<f64>,
}

impl Demands {
    fn new(parameters: &BenchParameters, plan: &ExperimentPlan, seed: u64, updates: usize) -> Self {
        let mut random = Random::new(seed, Source::Plan);
        let mut held = Vec::from([Vec::new(), Vec::new()]);
        let held_updates = (parameters.controller.demand_hold_s / UPDATE_S).round() as usize;
        for (values, waveform) in held.iter_mut().zip([&plan.dyno_torque_nm, &plan.engine_torque_nm]) {
            *values = waveform.sample(&mut random, UPDATE_S, updates);
            hold(values, held_updates);
        }
        let speed_rad_s = plan.speed_rad_s.sample(&mut random, UPDATE_S, updates);
        let engine_torque_nm = held.pop().unwrap_or_default();
        let dyno_torque_nm = held.pop().unwrap_or_default();
        Self { speed_rad_s, dyno_torque_nm, engine_torque_nm }
    }
}

/// What the automation system holds in its registers at every update of the recording. SI.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Registers {
    pub(super) dyno_speed_rad_s: Vec<f64>,
    pub(super) engine_speed_rad_s: Vec<f64>,
    pub(super) dyno_speed_demand_rad_s: Vec<f64>,
    pub(super) dyno_torque_demand_nm: Vec<f64>,
    pub(super) dyno_torque_calc_nm: Vec<f64>,
    pub(super) dyno_torque_meas_nm: Vec<f64>,
    pub(super) shaft_torque_calc_nm: Vec<f64>,
}

/// What the sensors read at one update.
struct Readings {
    dyno_speed_rad_s: f64,
    engine_speed_rad_s: f64,
    calc_torque_nm: f64,
    cell_torque_nm: f64,
    shaft_torque_nm: f64,
}

/// Runs a plan on a bench.
pub(super) fn run(
    parameters: &BenchParameters,
    plan: &ExperimentPlan,
    seed: u64,
    numerics: &Numerics,
) -> Result<(Registers, HiddenTruth), VirtualBenchError> {
    let updates = ((plan.duration_s / UPDATE_S).round() as usize).max(1);
    let settling = (plan.settling_s / UPDATE_S).round() as usize;
    let demands = Demands::new(parameters, plan, seed, updates);
    let mut bench = Bench::new(parameters, plan, seed, numerics, &demands, settling)?;
    for update in 0..settling + updates {
        bench.update(&demands, update.checked_sub(settling));
        bench.advance(numerics, update >= settling);
        if !bench.state.is_finite() {
            return Err(VirtualBenchError::Diverged { time_s: bench.time_s() });
        }
    }
    Ok((bench.registers, bench.hidden))
}

/// All parts, and where they are.
struct Bench {
    mode: ControlMode,
    masses: TwoMasses,
    state: MechanicalState,
    inverter: Inverter,
    controller: SpeedController,
    engine: Engine,
    engine_control: EngineSpeedControl,
    engine_is_controlled: bool,
    engine_level_nm: f64,
    air_gap_torque_nm: f64,
    step_s: f64,
    /// Steps from the start of the recording, negative while settling.
    step: i64,
    sensors: Sensors,
    registers: Registers,
    /// The recorded T_d* is rounded to this.
    demand_resolution_nm: f64,
    hidden: HiddenTruth,
}

struct Sensors {
    dyno_rotation: Rotation,
    engine_rotation: Rotation,
    dyno_encoder: Encoder,
    engine_encoder: Encoder,
    calc_noise_nm: f64,
    calc_random: Random,
    cell: LoadCell,
    cell_noise_nm: f64,
    cell_random: Random,
    system_shaft: SystemShaftTorque,
}

impl Bench {
    /// The bench at rest at the plan's first demands.
    fn new(
        parameters: &BenchParameters,
        plan: &ExperimentPlan,
        seed: u64,
        numerics: &Numerics,
        demands: &Demands,
        settling: usize,
    ) -> Result<Self, VirtualBenchError> {
        let step_s = UPDATE_S / numerics.steps_per_update as f64;
        let masses = TwoMasses::new(&parameters.mechanics, plan.has_shaft, step_s)?;
        let speed = demands.speed_rad_s[0];
        let (air_gap_nm, engine_nm) = torques_at_rest(parameters, plan, demands, masses.friction_nm(speed));
        let angle = Random::new(seed, Source::StartAngle).between(0.0, 2.0 * std::f64::consts::TAU);
        let state = MechanicalState {
            dyno_speed_rad_s: speed,
            engine_speed_rad_s: speed,
            twist_rad: masses.twist_at_rad(engine_nm),
            dyno_angle_rad: angle,
            engine_angle_rad: angle,
        };
        let is_fired = plan.has_shaft && !plan.is_motored;
        let combustion = if is_fired { Combustion::Fired } else { Combustion::Motored };
        let limit_nm = parameters.inverter.torque_limit_nm;
        Ok(Self {
            mode: plan.label.mode,
            masses,
            state,
            inverter: Inverter::new(&parameters.inverter, air_gap_nm),
            controller: SpeedController::new(&parameters.controller, limit_nm, UPDATE_S, speed, air_gap_nm),
            engine: Engine::new(&parameters.engine, combustion, seed, angle, engine_nm),
            engine_control: EngineSpeedControl::new(&parameters.engine, engine_nm),
            engine_is_controlled: is_fired,
            engine_level_nm: engine_nm,
            air_gap_torque_nm: air_gap_nm,
            step_s,
            step: -((settling * numerics.steps_per_update) as i64),
            sensors: Sensors::new(parameters, &state, air_gap_nm, step_s, seed)?,
            registers: Registers::default(),
            demand_resolution_nm: parameters.sensors.demand_resolution_nm,
            hidden: HiddenTruth::new(numerics.steps_per_hidden_sample as f64 * step_s),
        })
    }

    fn time_s(&self) -> f64 {
        self.step as f64 * self.step_s
    }

    /// One update of sensors, controllers and registers; `k` counts from the recording's start on.
    fn update(&mut self, demands: &Demands, k: Option<usize>) {
        let at = k.unwrap_or(0);
        let (time_s, speed_demand_rad_s) = (self.time_s(), demands.speed_rad_s[at]);
        let readings = self.sensors.read(self.air_gap_torque_nm);
        let torque_demand_nm = match self.mode {
            ControlMode::Nt => self.control_speed(time_s, readings.dyno_speed_rad_s, speed_demand_rad_s),
            ControlMode::Tn => {
                let demand = TimedDemand { time_s, torque_nm: demands.dyno_torque_nm[at] };
                self.inverter.demand(demand);
                demand.torque_nm
            }
        };
        if self.engine_is_controlled {
            self.engine_level_nm = match self.mode {
                ControlMode::Nt => demands.engine_torque_nm[at],
                ControlMode::Tn => {
                    self.engine_control.update(speed_demand_rad_s - readings.engine_speed_rad_s, UPDATE_S)
                }
            };
        }
        if k.is_some() {
            let recorded_nm = rounded(torque_demand_nm, self.demand_resolution_nm);
            self.registers.push(&readings, speed_demand_rad_s, recorded_nm);
        }
    }

    fn control_speed(&mut self, time_s: f64, speed_rad_s: f64, demand_rad_s: f64) -> f64 {
        let update = self.controller.update(time_s, speed_rad_s, demand_rad_s);
        self.inverter.demand(update.now);
        if let Some(later) = update.later {
            self.inverter.demand(later);
        }
        update.now.torque_nm
    }

    /// From one update to the next, step by step.
    fn advance(&mut self, numerics: &Numerics, is_recorded: bool) {
        for _ in 0..numerics.steps_per_update {
            if is_recorded && (self.step as usize).is_multiple_of(numerics.steps_per_hidden_sample) {
                self.show();
            }
            self.advance_one_step();
        }
    }

    fn advance_one_step(&mut self) {
        let (start_s, end_s) = (self.time_s(), (self.step + 1) as f64 * self.step_s);
        let coulomb_nm = self.masses.coulomb_nm(self.state.dyno_speed_rad_s);
        let torque_nm = self.inverter.advance(start_s, end_s);
        let end_air_gap_nm = self.inverter.with_ripple_nm(torque_nm, end_s);
        let engine = self.engine.step(&self.masses, &self.state, self.step_s, self.engine_level_nm);
        let start = DrivingTorques { braking_nm: self.air_gap_torque_nm + coulomb_nm, engine_nm: engine.start_nm };
        let end = DrivingTorques { braking_nm: end_air_gap_nm + coulomb_nm, engine_nm: engine.end_nm };
        self.state = self.masses.advance(&self.state, start, end);
        if let Some(firing) = engine.firing {
            self.masses.add_engine_jump(&mut self.state, firing.jump_nm, firing.remaining_s);
        }
        self.air_gap_torque_nm = end_air_gap_nm;
        self.step += 1;
        self.sensors.advance(&self.state, end_air_gap_nm);
    }

    fn show(&mut self) {
        let (state, hidden) = (&self.state, &mut self.hidden);
        hidden.dyno_speed_rad_s.push(state.dyno_speed_rad_s);
        hidden.engine_speed_rad_s.push(state.engine_speed_rad_s);
        hidden.shaft_torque_nm.push(self.masses.shaft_torque_nm(state));
        hidden.engine_torque_nm.push(self.engine.torque_nm(state.engine_angle_rad));
        hidden.air_gap_torque_nm.push(self.air_gap_torque_nm);
        hidden.friction_torque_nm.push(self.masses.friction_nm(state.dyno_speed_rad_s));
    }
}

/// (T_d, T_e) that keep the bench at its first speed.
fn torques_at_rest(
    parameters: &BenchParameters,
    plan: &ExperimentPlan,
    demands: &Demands,
    friction_nm: f64,
) -> (f64, f64) {
    if !plan.has_shaft {
        return (-friction_nm, 0.0);
    }
    if plan.is_motored {
        let engine_nm = parameters.engine.motored_torque_nm;
        return (engine_nm - friction_nm, engine_nm);
    }
    match plan.label.mode {
        ControlMode::Nt => (demands.engine_torque_nm[0] - friction_nm, demands.engine_torque_nm[0]),
        ControlMode::Tn => (demands.dyno_torque_nm[0], demands.dyno_torque_nm[0] + friction_nm),
    }
}

impl Sensors {
    fn new(
        parameters: &BenchParameters,
        state: &MechanicalState,
        air_gap_nm: f64,
        step_s: f64,
        seed: u64,
    ) -> Result<Self, VirtualBenchError> {
        let sensors = &parameters.sensors;
        let rotation = |angle_rad, speed_rad_s| Rotation::new(sensors.gate_s, step_s, angle_rad, speed_rad_s);
        let encoder = |eccentricity, source| Encoder::new(sensors, eccentricity, Random::new(seed, source));
        let inertia = parameters.mechanics.dyno_inertia_kg_m2;
        Ok(Self {
            dyno_rotation: rotation(state.dyno_angle_rad, state.dyno_speed_rad_s),
            engine_rotation: rotation(state.engine_angle_rad, state.engine_speed_rad_s),
            dyno_encoder: encoder(sensors.dyno_eccentricity, Source::DynoEncoder),
            engine_encoder: encoder(sensors.engine_eccentricity, Source::EngineEncoder),
            calc_noise_nm: sensors.calc_noise_nm,
            calc_random: Random::new(seed, Source::CalcTorque),
            cell: LoadCell::new(sensors, step_s, air_gap_nm)?,
            cell_noise_nm: sensors.cell_noise_nm,
            cell_random: Random::new(seed, Source::LoadCell),
            system_shaft: SystemShaftTorque::new(inertia, UPDATE_S, sensors.moving_average, state.dyno_speed_rad_s),
        })
    }

    fn advance(&mut self, state: &MechanicalState, air_gap_nm: f64) {
        self.dyno_rotation.advance(state.dyno_angle_rad, state.dyno_speed_rad_s);
        self.engine_rotation.advance(state.engine_angle_rad, state.engine_speed_rad_s);
        self.cell.advance(air_gap_nm);
    }

    fn read(&mut self, air_gap_nm: f64) -> Readings {
        let dyno_speed_rad_s = self.dyno_encoder.read_rad_s(&self.dyno_rotation);
        let calc_torque_nm = air_gap_nm + self.calc_noise_nm * self.calc_random.normal();
        Readings {
            dyno_speed_rad_s,
            engine_speed_rad_s: self.engine_encoder.read_rad_s(&self.engine_rotation),
            calc_torque_nm,
            cell_torque_nm: self.cell.reading_nm() + self.cell_noise_nm * self.cell_random.normal(),
            shaft_torque_nm: self.system_shaft.update(dyno_speed_rad_s, calc_torque_nm),
        }
    }
}

impl Registers {
    fn push(&mut self, readings: &Readings, speed_demand_rad_s: f64, torque_demand_nm: f64) {
        self.dyno_speed_rad_s.push(readings.dyno_speed_rad_s);
        self.engine_speed_rad_s.push(readings.engine_speed_rad_s);
        self.dyno_speed_demand_rad_s.push(speed_demand_rad_s);
        self.dyno_torque_demand_nm.push(torque_demand_nm);
        self.dyno_torque_calc_nm.push(readings.calc_torque_nm);
        self.dyno_torque_meas_nm.push(readings.cell_torque_nm);
        self.shaft_torque_calc_nm.push(readings.shaft_torque_nm);
    }
}
