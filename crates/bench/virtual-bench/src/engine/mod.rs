//! The engine: torque over crank angle, the air it gets, and its speed control.

mod control;
mod cylinder;
mod pulsation;
mod pulse;
mod slider_crank;
mod step;

use rig::bench_parameters::EngineParameters;

use super::train::Train;
pub(super) use bench_model::intake::Air;
pub(super) use control::EngineSpeedControl;
use pulsation::Pulsation;
use slider_crank::CrankEngine;
pub(crate) use step::{Combustion, EngineStep};

/// The engine's torque over crank angle, in two fidelities.
#[derive(Debug, Clone)]
pub(super) enum Engine {
    Pulsation(Box<Pulsation>),
    SliderCrank(Box<CrankEngine>),
}

impl Engine {
    /// The engine at a crank angle, running at a torque level and a speed.
    pub(super) fn new(
        parameters: &EngineParameters,
        combustion: Combustion,
        seed: u64,
        angle_rad: f64,
        level_nm: f64,
        speed_rad_s: f64,
    ) -> Self {
        match &parameters.slider_crank {
            Some(crank) if combustion != Combustion::Stopped => {
                Self::SliderCrank(Box::new(CrankEngine::new(parameters, crank, combustion, seed, angle_rad, level_nm)))
            }
            _ => Self::Pulsation(Box::new(Pulsation::new(
                parameters,
                combustion,
                seed,
                angle_rad,
                level_nm,
                speed_rad_s,
            ))),
        }
    }

    /// The torque over the next step; `level_nm` is used where a cylinder fires within the step.
    pub(super) fn step(&mut self, train: &Train, step_s: f64, level_nm: f64) -> EngineStep {
        match self {
            Self::Pulsation(engine) => engine.step(train, step_s, level_nm),
            Self::SliderCrank(engine) => engine.step(train, step_s, level_nm),
        }
    }

    /// Torque now, Nm.
    pub(super) fn now_nm(&self, train: &Train) -> f64 {
        match self {
            Self::Pulsation(engine) => engine.now_nm(train),
            Self::SliderCrank(engine) => engine.now_nm(train),
        }
    }

    /// How much more torque ends a step than was foreseen, now that its end is known, Nm.
    pub(super) fn unforeseen_nm(&self, train: &Train, foreseen: &EngineStep) -> f64 {
        match self {
            Self::Pulsation(_) => 0.0,
            Self::SliderCrank(engine) => engine.now_nm(train) - foreseen.end_nm,
        }
    }
}
