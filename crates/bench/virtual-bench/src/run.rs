//! The bench in motion: all parts connected, update by update.

use std::f64::consts::TAU;

use recording::Recording;
use rig::ControlMode;
use rig::bench_parameters::BenchParameters;
use rig::experiment::{Demands, ExperimentPlan, TorqueTarget, UPDATE_S};
use rig::random::Source;
use work::Context;

use super::control::{ShaftTorqueController, SpeedController};
use super::drive::{Drive, Knowledge, TimedDemand};
use super::engine::{Air, Combustion, Engine, EngineSpeedControl};
use super::error::VirtualBenchError;
use super::sensors::{Readings, Sensors, rounded};
use super::train::{Torques, Train};
use super::write::{Recorder, Registers};
use crate::hidden::HiddenTruth;
use crate::numerics::Numerics;

/// Updates from one word about progress to the next.
const PROGRESS_EVERY: usize = 500;

/// Runs a plan on a bench.
pub(super) fn run(
    parameters: &BenchParameters,
    plan: &ExperimentPlan,
    seed: u64,
    numerics: &Numerics,
    context: &Context,
) -> Result<(Recording, HiddenTruth), VirtualBenchError> {
    let updates = plan.updates();
    let settling = (plan.settling_s / UPDATE_S).round() as usize;
    let demands = Demands::of(plan, seed, parameters.controller.demand_hold_s);
    let mut bench = Bench::new(parameters, plan, seed, numerics, &demands, settling)?;
    let step = context.step(format!("simulating {}", plan.label), (settling + updates) as u64);
    for update in 0..settling + updates {
        if update.is_multiple_of(PROGRESS_EVERY) {
            step.reach(update as u64, (settling + updates) as u64);
        }
        bench.update(&demands, update.checked_sub(settling));
        bench.advance(numerics, update >= settling);
        if !bench.train.is_finite() {
            return Err(VirtualBenchError::Diverged { time_s: bench.time_s() });
        }
    }
    drop(demands);
    Ok((bench.recorder.finish(plan), bench.hidden))
}

/// Control of the dynamometer.
enum DynoControl {
    Speed(SpeedController),
    AirGapTorque,
    ShaftTorque(ShaftTorqueController),
}

/// Source of the engine's torque level.
enum EngineControl {
    /// It turns without fuel.
    Motored,
    /// The plan's torque or throttle.
    Demanded,
    Speed(EngineSpeedControl),
}

/// All parts, and where they are.
struct Bench {
    train: Train,
    drive: Drive,
    knowledge: Knowledge,
    dyno_control: DynoControl,
    engine: Engine,
    engine_control: EngineControl,
    air: Air,
    engine_level_nm: f64,
    air_gap_torque_nm: f64,
    step_s: f64,
    /// Steps from the start of the recording, negative while settling.
    step: i64,
    sensors: Sensors,
    recorder: Recorder,
    /// The recorded T_d* is rounded to this.
    demand_resolution_nm: f64,
    hidden: HiddenTruth,
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
        let speed = demands.speed_rad_s[0];
        let angle = Source::StartAngle.stream(seed).between(0.0, 2.0 * TAU);
        let mut train = Train::new(&parameters.mechanics, plan.has_shaft, step_s)?;
        let rest = Rest::new(parameters, plan, demands, train.friction_nm(speed));
        train.rest_at(speed, angle, rest.engine_nm);
        let is_fired = plan.has_shaft && !plan.is_motored;
        let combustion = match (plan.has_shaft, is_fired) {
            (false, _) => Combustion::Stopped,
            (true, true) => Combustion::Fired,
            (true, false) => Combustion::Motored,
        };
        let knowledge = Knowledge::new(parameters, UPDATE_S);
        let computed_nm = rest.air_gap_nm / knowledge.gain();
        Ok(Self {
            dyno_control: dyno_control(parameters, plan, speed, &rest, computed_nm),
            drive: Drive::new(&parameters.drive, computed_nm, speed, UPDATE_S, numerics.steps_per_update),
            knowledge,
            engine: Engine::new(&parameters.engine, combustion, seed, angle, rest.engine_nm, speed),
            engine_control: match (is_fired, plan.label.mode) {
                (false, _) => EngineControl::Motored,
                (true, ControlMode::Nt) => EngineControl::Demanded,
                (true, ControlMode::Tn) => {
                    EngineControl::Speed(EngineSpeedControl::new(&parameters.engine, rest.best_nm))
                }
            },
            air: Air::new(&parameters.engine, rest.best_nm, UPDATE_S),
            engine_level_nm: rest.engine_nm,
            air_gap_torque_nm: rest.air_gap_nm,
            step_s,
            step: -((settling * numerics.steps_per_update) as i64),
            sensors: Sensors::new(parameters, &train, rest.air_gap_nm, step_s, seed)?,
            recorder: Recorder::new(parameters, plan),
            demand_resolution_nm: parameters.sensors.demand_resolution_nm,
            hidden: HiddenTruth::new(plan.updates(), numerics),
            train,
        })
    }

    fn time_s(&self) -> f64 {
        self.step as f64 * self.step_s
    }

    /// One update of sensors, controllers and recorder; `k` counts from the recording's start on.
    fn update(&mut self, demands: &Demands, k: Option<usize>) {
        let at = k.unwrap_or(0);
        let computed_nm = self.air_gap_torque_nm / self.knowledge.gain();
        let readings = self.sensors.read(computed_nm);
        self.knowledge.update(self.air_gap_torque_nm, computed_nm, readings.cell_torque_nm);
        let torque_demand_nm = self.control_dyno(demands, at, &readings);
        self.control_engine(demands, at, &readings);
        if k.is_some() {
            self.recorder.record(&Registers {
                readings,
                dyno_speed_demand_rad_s: demands.speed_rad_s[at],
                dyno_torque_demand_nm: rounded(torque_demand_nm, self.demand_resolution_nm),
                shaft_torque_demand_nm: demands.dyno_torque_nm[at],
                throttle: demands.throttle.get(at).copied().unwrap_or(0.0),
            });
        }
    }

    /// Gives the drive its demand; returns it, Nm.
    fn control_dyno(&mut self, demands: &Demands, at: usize, readings: &Readings) -> f64 {
        let time_s = self.time_s();
        let (now, later) = match &mut self.dyno_control {
            DynoControl::Speed(controller) => {
                let update = controller.update(time_s, readings.dyno_speed_rad_s, demands.speed_rad_s[at]);
                (update.now, update.later)
            }
            DynoControl::AirGapTorque => (TimedDemand { time_s, torque_nm: demands.dyno_torque_nm[at] }, None),
            DynoControl::ShaftTorque(controller) => {
                let torque_nm = controller.update(demands.dyno_torque_nm[at], readings.shaft_torque_nm);
                (TimedDemand { time_s, torque_nm }, None)
            }
        };
        self.drive.demand(now);
        if let Some(later) = later {
            self.drive.demand(later);
        }
        now.torque_nm
    }

    fn control_engine(&mut self, demands: &Demands, at: usize, readings: &Readings) {
        let speed_rad_s = readings.engine_speed_rad_s;
        let towards_nm = match &mut self.engine_control {
            EngineControl::Motored => return,
            EngineControl::Demanded => match demands.throttle.get(at) {
                Some(throttle) => self.air.mapped_nm(*throttle, speed_rad_s),
                None => demands.engine_torque_nm[at],
            },
            EngineControl::Speed(control) => control.update(demands.speed_rad_s[at] - speed_rad_s, UPDATE_S),
        };
        self.engine_level_nm = self.air.update(towards_nm, demands.ignition_efficiency[at]);
    }

    /// From one update to the next, step by step.
    fn advance(&mut self, numerics: &Numerics, is_recorded: bool) {
        for _ in 0..numerics.steps_per_update {
            if is_recorded && numerics.steps_per_hidden_sample.is_some_and(|n| (self.step as usize).is_multiple_of(n)) {
                self.show();
            }
            self.advance_one_step();
        }
    }

    fn advance_one_step(&mut self) {
        let (start_s, end_s) = (self.time_s(), (self.step + 1) as f64 * self.step_s);
        let torque_nm = self.drive.advance(start_s, end_s, self.train.dyno_speed_rad_s());
        let end_air_gap_nm = self.knowledge.gain() * self.drive.with_ripple_nm(torque_nm, end_s);
        let engine = self.engine.step(&self.train, self.step_s, self.engine_level_nm);
        let start = Torques { air_gap_nm: self.air_gap_torque_nm, engine_nm: engine.start_nm };
        let end = Torques { air_gap_nm: end_air_gap_nm, engine_nm: engine.end_nm };
        self.train.advance(start, end, engine.firing);
        self.train.correct_engine(self.engine.unforeseen_nm(&self.train, &engine));
        self.air_gap_torque_nm = end_air_gap_nm;
        self.step += 1;
        self.sensors.advance(&self.train, end_air_gap_nm);
    }

    fn show(&mut self) {
        let (train, hidden) = (&self.train, &mut self.hidden);
        hidden.dyno_speed_rad_s.push(train.dyno_speed_rad_s());
        hidden.engine_speed_rad_s.push(train.engine_speed_rad_s());
        hidden.shaft_torque_nm.push(train.shaft_torque_nm());
        hidden.engine_torque_nm.push(self.engine.now_nm(train));
        hidden.air_gap_torque_nm.push(self.air_gap_torque_nm);
        hidden.friction_torque_nm.push(train.friction_nm(train.dyno_speed_rad_s()));
    }
}

/// The controller of the plan's mode, holding the bench as it is.
fn dyno_control(
    parameters: &BenchParameters,
    plan: &ExperimentPlan,
    speed_rad_s: f64,
    rest: &Rest,
    computed_nm: f64,
) -> DynoControl {
    let (controller, limit_nm) = (&parameters.controller, parameters.drive.torque_limit_nm);
    match (plan.label.mode, plan.torque_target) {
        (ControlMode::Nt, _) => {
            DynoControl::Speed(SpeedController::new(controller, limit_nm, UPDATE_S, speed_rad_s, computed_nm))
        }
        (ControlMode::Tn, TorqueTarget::AirGap) => DynoControl::AirGapTorque,
        (ControlMode::Tn, TorqueTarget::Shaft) => {
            let shaft_nm = rest.engine_nm;
            DynoControl::ShaftTorque(ShaftTorqueController::new(controller, limit_nm, UPDATE_S, shaft_nm, computed_nm))
        }
    }
}

/// Torques that keep the bench at its first speed.
struct Rest {
    air_gap_nm: f64,
    engine_nm: f64,
    /// The engine's at the best ignition angle.
    best_nm: f64,
}

impl Rest {
    fn new(parameters: &BenchParameters, plan: &ExperimentPlan, demands: &Demands, friction_nm: f64) -> Self {
        if !plan.has_shaft {
            return Self { air_gap_nm: -friction_nm, engine_nm: 0.0, best_nm: 0.0 };
        }
        let motored_nm = parameters.engine.motored_torque_nm;
        if plan.is_motored {
            return Self { air_gap_nm: motored_nm - friction_nm, engine_nm: motored_nm, best_nm: motored_nm };
        }
        let efficiency = demands.ignition_efficiency[0];
        match plan.label.mode {
            ControlMode::Nt => {
                let mut air = Air::new(&parameters.engine, 0.0, UPDATE_S);
                let mapped = |throttle: &f64| air.mapped_nm(*throttle, demands.speed_rad_s[0]);
                let best_nm = demands.throttle.first().map_or(demands.engine_torque_nm[0], mapped);
                air = Air::new(&parameters.engine, best_nm, UPDATE_S);
                let engine_nm = air.update(best_nm, efficiency);
                Self { air_gap_nm: engine_nm - friction_nm, engine_nm, best_nm }
            }
            ControlMode::Tn => {
                let dyno_nm = demands.dyno_torque_nm[0];
                let (air_gap_nm, engine_nm) = match plan.torque_target {
                    TorqueTarget::AirGap => (dyno_nm, dyno_nm + friction_nm),
                    TorqueTarget::Shaft => (dyno_nm - friction_nm, dyno_nm),
                };
                let best_nm =
                    if efficiency > 0.0 { (engine_nm - motored_nm) / efficiency + motored_nm } else { engine_nm };
                Self { air_gap_nm, engine_nm, best_nm }
            }
        }
    }
}
