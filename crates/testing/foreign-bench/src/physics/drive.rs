//! Inverter and machine, solved exactly between their demands.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use crate::bench;

pub(crate) struct Drive {
    parameters: bench::Drive,
    /// Phase of the ripple at time zero, rad.
    phase_rad: f64,
    /// Demands to come, each with its time.
    coming: VecDeque<(f64, f64)>,
    now_s: f64,
    /// Torque without ripple towards which the drive goes, Nm.
    towards_nm: f64,
    torque_nm: f64,
}

impl Drive {
    pub(crate) fn new(parameters: &bench::Drive, torque_nm: f64, start_s: f64, phase_rad: f64) -> Self {
        let parameters = parameters.clone();
        Drive { parameters, phase_rad, coming: VecDeque::new(), now_s: start_s, towards_nm: torque_nm, torque_nm }
    }

    /// A demand at a time, which acts later.
    pub(crate) fn demand(&mut self, time_s: f64, torque_nm: f64) {
        self.coming.push_back((time_s + self.parameters.delay_s, torque_nm));
    }

    /// T_d at a time not before the last one, Nm.
    pub(crate) fn air_gap_nm(&mut self, time_s: f64) -> f64 {
        while let Some((_, torque_nm)) = self.coming.front().copied().filter(|(begins_s, _)| *begins_s <= time_s) {
            let (begins_s, _) = self.coming.pop_front().unwrap_or((time_s, torque_nm));
            self.follow_to(begins_s);
            self.towards_nm = torque_nm;
        }
        self.follow_to(time_s);
        let wave = (TAU * self.parameters.ripple_hz * time_s + self.phase_rad).sin();
        self.torque_nm * (1.0 + self.parameters.multiplied_ripple * wave) + self.parameters.added_ripple_nm * wave
    }

    fn follow_to(&mut self, time_s: f64) {
        let stays = (-self.parameters.bandwidth_rad_s * (time_s - self.now_s)).exp();
        self.torque_nm = self.towards_nm + (self.torque_nm - self.towards_nm) * stays;
        self.now_s = time_s;
    }
}
