//! A cycle on one bench.

use bench_model::friction::DynoFriction;
use bench_model::model::BenchModel;
use bench_model::prediction::check_engine_speeds;
use bench_model::simulate::{CourseInputs, InitialState, simulate_course};
use rig::bench_parameters::EngineParameters;

use crate::demand::CycleDemand;
use crate::error::CapabilityError;
use crate::filter;
use crate::trace::Trace;

/// Time from point to point at most, s: a resonance of 20 Hz is seen ten times a period.
const STEP_S: f64 = 0.005;

/// The demands of a cycle on a grid, the same for every bench drawn.
pub(crate) struct CycleGrid {
    step_samples: usize,
    step_s: f64,
    start_s: f64,
    speed_rad_s: Vec<f64>,
    torque_nm: Vec<f64>,
    /// The speed that the bench is asked for: that of the cycle, or what a filter makes of it, rad/s.
    command_rad_s: Vec<f64>,
    /// The engine's torque, Nm.
    pub(crate) engine_nm: Vec<f64>,
}

impl CycleGrid {
    /// The engine gives the torque demanded at its flywheel and what its own inertia needs, as far as its map allows, through the
    /// intake.
    pub(crate) fn of(
        demand: &CycleDemand<'_>,
        model: &BenchModel,
        engine: &EngineParameters,
        filter_hz: Option<f64>,
    ) -> Self {
        let sample_s = model.speed_controller.map_or(1e-3, |controller| controller.sample_time_s);
        let step_samples = ((STEP_S / sample_s).floor() as usize).max(1);
        let step_s = step_samples as f64 * sample_s;
        let reference = demand.reference;
        let points = ((reference.end_s() - reference.start_s) / step_s).round() as usize + 1;
        let time = |k: usize| reference.start_s + k as f64 * step_s;
        let speed_rad_s: Vec<f64> = (0..points).map(|k| reference.speed_at(time(k))).collect();
        let torque_nm: Vec<f64> = (0..points).map(|k| reference.torque_at(time(k))).collect();
        let filtered = |values: &[f64]| filter_hz.map_or(values.to_vec(), |hz| filter::low_pass(values, step_s, hz));
        let (command_rad_s, asked_nm) = (filtered(&speed_rad_s), filtered(&torque_nm));
        let inertia = model.mechanics.engine_inertia_kg_m2;
        let wanted = |k: usize| {
            let speed = command_rad_s[k];
            let acceleration = (command_rad_s[(k + 1).min(points - 1)] - speed) / step_s;
            let torque = asked_nm[k] + inertia * acceleration;
            demand.map.map_or(torque, |map| torque.clamp(map.motoring_nm(speed), map.full_load_nm(speed)))
        };
        let lag_s = engine.intake_lag_s;
        let stays = if lag_s > 0.0 { (-step_s / lag_s).exp() } else { 0.0 };
        let mut held = wanted(0);
        let engine_nm = (0..points)
            .map(|k| {
                let wanted_nm = wanted(k);
                held = wanted_nm + (held - wanted_nm) * stays;
                held
            })
            .collect();
        CycleGrid { step_samples, step_s, start_s: reference.start_s, speed_rad_s, torque_nm, command_rad_s, engine_nm }
    }

    /// What a bench does.
    ///
    /// # Errors
    /// A part that the model lacks, a speed that no engine has.
    pub(crate) fn run(&self, model: &BenchModel, friction: DynoFriction) -> Result<Trace, CapabilityError> {
        check_engine_speeds(&self.speed_rad_s, self.step_s)?;
        let start = InitialState::steady(model, self.command_rad_s[0], self.engine_nm[0])
            .with_friction(friction.torque_nm(self.command_rad_s[0]));
        let inputs = CourseInputs {
            step_samples: self.step_samples,
            speed_demand_rad_s: &self.command_rad_s,
            engine_torque_nm: &self.engine_nm,
            friction,
        };
        let course = simulate_course(model, &inputs, &start)?;
        Ok(Trace {
            start_s: self.start_s,
            step_s: self.step_s,
            is_demand_held: false,
            speed_demand_rad_s: self.speed_rad_s.clone(),
            speed_rad_s: course.engine_speed_rad_s.clone(),
            torque_demand_nm: self.torque_nm.clone(),
            torque_nm: course.shaft_torque_nm.clone(),
            dyno_speed_rad_s: course.dyno_speed_rad_s,
            engine_speed_rad_s: course.engine_speed_rad_s,
            shaft_torque_nm: course.shaft_torque_nm,
            dyno_demand_nm: course.torque_demand_nm,
        })
    }

    /// Lowest and highest speed demanded, rad/s.
    pub(crate) fn range_rad_s(&self) -> (f64, f64) {
        self.speed_rad_s.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), speed| (speed.min(low), speed.max(high)))
    }
}
