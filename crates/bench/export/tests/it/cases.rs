//! Simulations that the exports must repeat.

use bench_model::model::BenchModel;
use bench_model::simulate::{
    DynoInput, EngineSpeedControl, InitialState, Inputs, Response, simulate, simulate_governed,
};
use serde_json::{Value, json};

/// Samples of a case.
pub(crate) const SAMPLES: usize = 3000;
pub(crate) const TICK_S: f64 = 1e-3;

/// Input that drives the dynamometer of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Drive {
    Speed,
    Torque,
    AirGap,
    /// Torque control with the engine in speed control.
    Governed,
}

/// Demands and engine torque that move everything; the limit of the torque is met in speed control.
pub(crate) struct Case {
    pub(crate) drive: Drive,
    pub(crate) engine: Vec<f64>,
    pub(crate) demand: Vec<f64>,
    pub(crate) start: InitialState,
}

impl Case {
    pub(crate) fn about(model: &BenchModel, drive: Drive) -> Self {
        let wave = |k: usize, period: f64| (k as f64 / period).sin();
        let step = |k: usize, at: usize, size: f64| if k >= at { size } else { 0.0 };
        let engine = (0..SAMPLES).map(|k| 38.0 + 9.0 * wave(k, 5.3) + step(k, 700, 25.0)).collect();
        let speed = |k: usize| 125.0 + 3.0 * wave(k, 240.0) + step(k, 1200, 60.0) - step(k, 2200, 45.0);
        let torque = |k: usize| 40.0 + 20.0 * wave(k / 10, 3.1) + step(k, 900, 15.0);
        let demand = (0..SAMPLES).map(|k| if drive == Drive::Speed { speed(k) } else { torque(k) }).collect();
        let start = InitialState { twist_rad: 0.017, ..InitialState::steady(model, 124.0, 37.0) };
        Case { drive, engine, demand, start }
    }

    /// From rest, and small: the linear forms start at zero.
    pub(crate) fn from_rest(model: &BenchModel, drive: Drive) -> Self {
        let Case { engine, demand, .. } = Case::about(model, drive);
        let from_zero = |series: Vec<f64>, scale: f64| {
            let first = series[0];
            series.iter().map(|value| scale * (value - first)).collect::<Vec<f64>>()
        };
        let start = InitialState::steady(model, 0.0, 0.0);
        let scale = if drive == Drive::Speed { 0.1 } else { 1.0 };
        Case { drive, engine: from_zero(engine, 1.0), demand: from_zero(demand, scale), start }
    }

    pub(crate) fn response(&self, model: &BenchModel) -> Response {
        let dyno = match self.drive {
            Drive::Speed => DynoInput::SpeedDemand(&self.demand),
            Drive::Torque | Drive::Governed => DynoInput::TorqueDemand(&self.demand),
            Drive::AirGap => DynoInput::AirGapTorque(&self.demand),
        };
        let inputs = Inputs { sample_time_s: TICK_S, engine_torque_nm: &self.engine, dyno };
        match self.drive {
            Drive::Governed => simulate_governed(model, &inputs, &governor(&self.governed_speed()), &self.start),
            _ => simulate(model, &inputs, &self.start),
        }
        .expect("a model that can be simulated")
    }

    /// The speed that the engine is held at.
    pub(crate) fn governed_speed(&self) -> Vec<f64> {
        (0..self.engine.len()).map(|k| 124.0 + if k > 500 { 6.0 } else { 0.0 }).collect()
    }

    /// The case and what comes of it, for other programs.
    pub(crate) fn json(&self, model: &BenchModel) -> Value {
        let response = self.response(model);
        let start = &self.start;
        json!({
            "drive": format!("{:?}", self.drive),
            "engine": self.engine,
            "demand": self.demand,
            "governed_speed": self.governed_speed(),
            "start": [
                start.dyno_speed_rad_s, start.engine_speed_rad_s, start.twist_rad, start.air_gap_torque_nm, start.integrator_nm
            ],
            "expected": {
                "w_d": response.dyno_speed_rad_s,
                "w_e": response.engine_speed_rad_s,
                "T_d": response.air_gap_torque_nm,
                "T_shaft": response.shaft_torque_nm,
                "T_d_demand": response.torque_demand_nm,
            },
            "limited_share": response.limited_share,
        })
    }
}

/// The engine's speed control of a case.
fn governor(demand_rad_s: &[f64]) -> EngineSpeedControl<'_> {
    EngineSpeedControl {
        demand_rad_s,
        proportional_nm_s_per_rad: 2.0,
        integral_nm_per_rad: 3.0,
        start_nm: 1.5,
        air: None,
    }
}
