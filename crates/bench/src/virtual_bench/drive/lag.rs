//! From the torque demand to the real air-gap torque: limit, delay, lag, ripple.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use crate::virtual_bench::parameters::InverterParameters;

/// A demand that takes effect at a time and is held until the next one does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TimedDemand {
    pub(crate) time_s: f64,
    pub(crate) torque_nm: f64,
}

/// T = e^{−s d} a/(s + a) T_d*, exact for a demand that is constant between its changes, whenever these come.
#[derive(Debug, Clone)]
pub(crate) struct Inverter {
    parameters: InverterParameters,
    /// Demands on their way, the oldest first, at the times when they reach the lag.
    on_the_way: VecDeque<TimedDemand>,
    held_nm: f64,
    torque_nm: f64,
}

impl Inverter {
    /// The inverter at rest at a torque.
    pub(crate) fn new(parameters: &InverterParameters, torque_nm: f64) -> Self {
        Self { parameters: parameters.clone(), on_the_way: VecDeque::new(), held_nm: torque_nm, torque_nm }
    }

    /// The demand changes; times must not decrease from call to call.
    pub(crate) fn demand(&mut self, demand: TimedDemand) {
        let limit = self.parameters.torque_limit_nm;
        self.on_the_way.push_back(TimedDemand {
            time_s: demand.time_s + self.parameters.delay_s,
            torque_nm: demand.torque_nm.clamp(-limit, limit),
        });
    }

    /// Torque without ripple at `end_s`, Nm, where the last call ended at `start_s`.
    pub(crate) fn advance(&mut self, start_s: f64, end_s: f64) -> f64 {
        let mut now_s = start_s;
        while let Some(&next) = self.on_the_way.front().filter(|next| next.time_s < end_s) {
            self.on_the_way.pop_front();
            self.relax((next.time_s - now_s).max(0.0));
            now_s = next.time_s.max(now_s);
            self.held_nm = next.torque_nm;
        }
        self.relax(end_s - now_s);
        self.torque_nm
    }

    fn relax(&mut self, duration_s: f64) {
        let decay = (-self.parameters.bandwidth_rad_s * duration_s).exp();
        self.torque_nm = self.held_nm + (self.torque_nm - self.held_nm) * decay;
    }

    /// Real air-gap torque, Nm: T (1 + r_m sin 2πft) + r_a sin 2πft.
    pub(crate) fn with_ripple_nm(&self, torque_nm: f64, time_s: f64) -> f64 {
        let ripple = &self.parameters;
        let sine = (TAU * ripple.ripple_hz * time_s).sin();
        torque_nm + (ripple.multiplicative_ripple * torque_nm + ripple.additive_ripple_nm) * sine
    }
}
