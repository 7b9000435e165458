//! A cycle on one bench.

use bench_model::model::BenchModel;
use bench_model::prediction::{PredictionError, check_engine_speeds};
use bench_model::simulate::{
    Acting, CourseInputs, DynoInput, FiringEngine, InitialState, Inputs, simulate_acted_on, simulate_course,
};
use rig::random::Source;

use crate::demand::CycleDemand;
use crate::error::CapabilityError;
use crate::filter;
use crate::outcome::Drawn;
use crate::trace::Trace;

/// Time from point to point at most, s: a resonance of 20 Hz is seen ten times a period.
const STEP_S: f64 = 0.005;
/// A bench that is simulated firing by firing runs so long before, until its answer to the begin has died away, s.
const SETTLING_S: f64 = 1.0;

/// The demands of a cycle on a grid, the same for every bench drawn.
pub(crate) struct CycleGrid {
    step_samples: usize,
    step_s: f64,
    start_s: f64,
    speed_rad_s: Vec<f64>,
    torque_nm: Vec<f64>,
    /// The speed that the bench is asked for: that of the cycle, or what a filter makes of it, rad/s.
    command_rad_s: Vec<f64>,
    /// The torque that is demanded of the engine, Nm.
    asked_nm: Vec<f64>,
}

impl CycleGrid {
    /// The engine is asked for the torque demanded at its flywheel and what its own inertia needs, as far as its map
    /// allows.
    pub(crate) fn of(demand: &CycleDemand<'_>, model: &BenchModel, filter_hz: Option<f64>) -> Self {
        let sample_s = model.speed_controller.map_or(1e-3, |controller| controller.sample_time_s);
        let step_samples = ((STEP_S / sample_s).floor() as usize).max(1);
        let step_s = step_samples as f64 * sample_s;
        let reference = demand.reference;
        let points = ((reference.end_s() - reference.start_s) / step_s).round() as usize + 1;
        let time = |k: usize| reference.start_s + k as f64 * step_s;
        let speed_rad_s: Vec<f64> = (0..points).map(|k| reference.speed_at(time(k))).collect();
        let torque_nm: Vec<f64> = (0..points).map(|k| reference.torque_at(time(k))).collect();
        let filtered = |values: &[f64]| filter_hz.map_or(values.to_vec(), |hz| filter::low_pass(values, step_s, hz));
        let (command_rad_s, flywheel_nm) = (filtered(&speed_rad_s), filtered(&torque_nm));
        let inertia = model.mechanics.engine_inertia_kg_m2;
        let asked = |k: usize| {
            let speed = command_rad_s[k];
            let acceleration = (command_rad_s[(k + 1).min(points - 1)] - speed) / step_s;
            let torque = flywheel_nm[k] + inertia * acceleration;
            demand.map.map_or(torque, |map| torque.clamp(map.motoring_nm(speed), map.full_load_nm(speed)))
        };
        let asked_nm = (0..points).map(asked).collect();
        CycleGrid { step_samples, step_s, start_s: reference.start_s, speed_rad_s, torque_nm, command_rad_s, asked_nm }
    }

    /// The mean torque that a bench's engine gives, through its intake, Nm.
    pub(crate) fn given_nm(&self, bench: &Drawn) -> Vec<f64> {
        let lag_s = bench.engine.intake_lag_s;
        let stays = if lag_s > 0.0 { (-self.step_s / lag_s).exp() } else { 0.0 };
        let wanted = self.asked_nm.iter().map(|torque_nm| bench.following.given_nm(*torque_nm));
        let held = wanted.scan(None, |held, wanted_nm| {
            let before = held.unwrap_or(wanted_nm);
            *held = Some(wanted_nm + (before - wanted_nm) * stays);
            *held
        });
        held.collect()
    }

    /// The same firing by firing, without the pulses: each takes up the torque of its begin, and varies.
    fn of_firings_nm(&self, bench: &Drawn, given_nm: &[f64]) -> Vec<f64> {
        let Some(seed) = bench.firing_seed else { return given_nm.to_vec() };
        let mut random = Source::Firing.stream(seed);
        let interval_rad = bench.engine.cycle_rad() / bench.engine.cylinder_factors.len().max(1) as f64;
        let mut turned_rad = interval_rad * random.between(0.0, 1.0);
        let mut held_nm = given_nm.first().copied().unwrap_or(0.0);
        let fire = |(given_nm, speed): (&f64, &f64)| {
            turned_rad += speed.abs() * self.step_s;
            let firings = (turned_rad / interval_rad).floor();
            if firings > 0.0 {
                turned_rad -= firings * interval_rad;
                held_nm = given_nm * (1.0 + bench.engine.cycle_variation / firings.sqrt() * random.normal());
            }
            held_nm
        };
        given_nm.iter().zip(&self.command_rad_s).map(fire).collect()
    }

    /// Runs the test on a bench, without the pulses of its engine.
    ///
    /// # Errors
    /// A part that the model lacks, a speed that no engine has.
    pub(crate) fn run(&self, bench: &Drawn) -> Result<Trace, CapabilityError> {
        check_engine_speeds(&self.speed_rad_s, self.step_s)?;
        let engine_nm = self.of_firings_nm(bench, &self.given_nm(bench));
        let start = self.start(bench, 0, engine_nm[0]);
        let inputs = CourseInputs {
            step_samples: self.step_samples,
            speed_demand_rad_s: &self.command_rad_s,
            engine_torque_nm: &engine_nm,
            friction: bench.friction,
        };
        let course = simulate_course(&bench.model, &inputs, &start)?;
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

    /// Runs a bench from one point of the grid to another, with each firing of its engine.
    ///
    /// # Errors
    /// A part that the model lacks, a run that grows without bound.
    pub(crate) fn fired(&self, bench: &Drawn, from: usize, to: usize) -> Result<Trace, CapabilityError> {
        let sample_s = self.step_s / self.step_samples as f64;
        let before = (SETTLING_S / self.step_s).round() as usize;
        let samples = (to + 1 + before).saturating_sub(from) * self.step_samples;
        // Before the first point the bench runs at its demands.
        let along = |values: &[f64]| -> Vec<f64> {
            let at = |k: usize| {
                let (point, part) = (k / self.step_samples, (k % self.step_samples) as f64 / self.step_samples as f64);
                let value = |point: usize| values[(from + point).saturating_sub(before).min(values.len() - 1)];
                value(point) + part * (value(point + 1) - value(point))
            };
            (0..samples).map(at).collect()
        };
        let (speed_demand_rad_s, engine_torque_nm) = (along(&self.command_rad_s), along(&self.given_nm(bench)));
        let inputs = Inputs {
            sample_time_s: sample_s,
            engine_torque_nm: &engine_torque_nm,
            dyno: DynoInput::SpeedDemand(&speed_demand_rad_s),
        };
        let seed = bench.firing_seed.unwrap_or(0).wrapping_add(from as u64);
        let fires = FiringEngine { engine: &bench.engine, seed, is_motored: false };
        let disturbances = Some((bench.disturbances, seed));
        let acting = Acting { fires: Some(&fires), control: None, friction: bench.friction, disturbances };
        let start = self.start(bench, from.saturating_sub(before), engine_torque_nm[0]);
        let response = simulate_acted_on(&bench.model, &inputs, &acting, &start)?;
        let settled = before * self.step_samples;
        let after = |values: Vec<f64>| values.get(settled..).unwrap_or_default().to_vec();
        let trace = Trace {
            start_s: self.start_s + from as f64 * self.step_s,
            step_s: sample_s,
            is_demand_held: false,
            dyno_speed_rad_s: after(response.dyno_speed_rad_s),
            engine_speed_rad_s: after(response.engine_speed_rad_s),
            shaft_torque_nm: after(response.shaft_torque_nm),
            dyno_demand_nm: after(response.torque_demand_nm),
            ..Trace::default()
        };
        if trace.is_bounded() { Ok(trace) } else { Err(PredictionError::Unstable.into()) }
    }

    /// At rest at a point of the grid.
    fn start(&self, bench: &Drawn, point: usize, engine_nm: f64) -> InitialState {
        let speed_rad_s = self.command_rad_s[point];
        InitialState::steady(&bench.model, speed_rad_s, engine_nm).with_friction(bench.friction.torque_nm(speed_rad_s))
    }

    /// Lowest and highest speed demanded, rad/s.
    pub(crate) fn range_rad_s(&self) -> (f64, f64) {
        self.speed_rad_s.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), speed| (speed.min(low), speed.max(high)))
    }
}
