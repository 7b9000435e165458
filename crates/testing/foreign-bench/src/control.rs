//! The controllers of dynamometer and engine.

use std::collections::VecDeque;

use crate::bench;

/// Time between updates of the dynamometer's controller, s.
const UPDATE_S: f64 = 1e-3;
/// Updates of the dynamometer's controller from one of the engine's to the next.
const ENGINE_UPDATES: usize = 10;
/// The engine's speed control demands no more, Nm.
const ENGINE_LIMIT_NM: f64 = 500.0;

/// Speed control of the dynamometer.
pub(crate) struct DynoSpeedControl {
    parameters: bench::Controller,
    limit_nm: f64,
    integral_nm: f64,
    last_demand_rad_s: f64,
    /// Speeds that are still to act, the oldest first.
    late: VecDeque<f64>,
}

impl DynoSpeedControl {
    /// At rest at a speed and a torque.
    pub(crate) fn new(parameters: &bench::Controller, limit_nm: f64, speed_rad_s: f64, torque_nm: f64) -> Self {
        let feed_forward_nm = parameters.speed_gain_nm_s_per_rad * speed_rad_s + parameters.constant_nm;
        // What is late is the error where the demand is late too, else the speed.
        let at_rest = if parameters.delays_demand { 0.0 } else { speed_rad_s };
        DynoSpeedControl {
            limit_nm,
            integral_nm: torque_nm - feed_forward_nm,
            last_demand_rad_s: speed_rad_s,
            late: VecDeque::from(vec![at_rest; parameters.delay_ms]),
            parameters: parameters.clone(),
        }
    }

    /// T_d* of an update, Nm. The integrator rests where it would go further beyond the limit.
    pub(crate) fn update(&mut self, speed_rad_s: f64, demand_rad_s: f64) -> f64 {
        let parameters = &self.parameters;
        let acts_later = if parameters.delays_demand { speed_rad_s - demand_rad_s } else { speed_rad_s };
        self.late.push_back(acts_later);
        let acts_now = self.late.pop_front().unwrap_or(acts_later);
        let error_rad_s = if parameters.delays_demand { acts_now } else { acts_now - demand_rad_s };
        let acceleration_rad_s2 = (demand_rad_s - self.last_demand_rad_s) / UPDATE_S;
        self.last_demand_rad_s = demand_rad_s;
        let torque_nm = parameters.proportional_nm_s_per_rad * error_rad_s
            + self.integral_nm
            + parameters.speed_gain_nm_s_per_rad * demand_rad_s
            + parameters.constant_nm
            + parameters.acceleration_gain_nm_s2_per_rad * acceleration_rad_s2;
        let change_nm = parameters.integral_nm_per_rad * UPDATE_S * error_rad_s;
        if torque_nm.abs() <= self.limit_nm || change_nm * torque_nm < 0.0 {
            self.integral_nm += change_nm;
        }
        torque_nm.clamp(-self.limit_nm, self.limit_nm)
    }
}

/// Speed control of the engine: PI every 10 ms on the mean speed since the last time.
pub(crate) struct EngineSpeedControl {
    proportional_nm_s_per_rad: f64,
    integral_nm_per_rad: f64,
    integral_nm: f64,
    sum_rad_s: f64,
    count: usize,
    torque_nm: f64,
}

impl EngineSpeedControl {
    /// At rest at a torque.
    pub(crate) fn new(engine: &bench::Engine, torque_nm: f64) -> Self {
        EngineSpeedControl {
            proportional_nm_s_per_rad: engine.speed_proportional_nm_s_per_rad,
            integral_nm_per_rad: engine.speed_integral_nm_per_rad,
            integral_nm: torque_nm,
            sum_rad_s: 0.0,
            count: 0,
            torque_nm,
        }
    }

    /// The torque demanded of the engine, each millisecond, Nm.
    pub(crate) fn update(&mut self, speed_rad_s: f64, demand_rad_s: f64) -> f64 {
        self.sum_rad_s += demand_rad_s - speed_rad_s;
        self.count += 1;
        if self.count == ENGINE_UPDATES {
            let error_rad_s = self.sum_rad_s / ENGINE_UPDATES as f64;
            self.integral_nm += self.integral_nm_per_rad * UPDATE_S * self.sum_rad_s;
            self.torque_nm = (self.proportional_nm_s_per_rad * error_rad_s + self.integral_nm).min(ENGINE_LIMIT_NM);
            (self.sum_rad_s, self.count) = (0.0, 0);
        }
        self.torque_nm
    }
}
