//! Field-oriented control of the induction machine at 4 kHz.

use lti::Complex64;
use rig::bench_parameters::InductionMachine;

use super::machine::{Electrical, Machine};

/// Part of the voltage limit at which the flux is reduced: the rest is for the currents to change.
const VOLTAGE_RESERVE: f64 = 0.9;
/// Gain of the flux control, in magnetising currents a flux.
const FLUX_GAIN: f64 = 5.0;

/// Flux and slip by the current model, currents by PI with decoupling (internal model control), limits.
#[derive(Debug, Clone)]
pub(super) struct FieldOrientedControl {
    machine: Machine,
    rated_flux_vs: f64,
    voltage_limit_v: f64,
    current_limit_a: f64,
    bandwidth: f64,
    sample_s: f64,
    flux_vs: f64,
    integral_v: Complex64,
    /// Speed of the frame, rad/s.
    pub(super) frame_rad_s: f64,
    /// Voltage for the next sample.
    next_v: Complex64,
}

impl FieldOrientedControl {
    /// The control and the machine at rest at a torque and a speed; also the voltage there.
    pub(super) fn at_rest(
        parameters: &InductionMachine,
        machine: Machine,
        sample_s: f64,
        braking_nm: f64,
        speed_rad_s: f64,
    ) -> (Self, Electrical, Complex64) {
        let mut control = Self {
            machine,
            rated_flux_vs: parameters.rated_flux_vs,
            voltage_limit_v: parameters.voltage_limit_v,
            current_limit_a: parameters.current_limit_a,
            bandwidth: parameters.current_bandwidth_rad_s,
            sample_s,
            flux_vs: parameters.rated_flux_vs,
            integral_v: Complex64::new(0.0, 0.0),
            frame_rad_s: machine.pole_pairs * speed_rad_s,
            next_v: Complex64::new(0.0, 0.0),
        };
        control.flux_vs = control.flux_demand_vs();
        let current_a = control.current_demand_a(braking_nm);
        control.frame_rad_s += control.slip_rad_s(current_a.im);
        control.integral_v = current_a * machine.stator_resistance;
        control.next_v = control.integral_v + control.decoupling_v(current_a);
        let state = Electrical { current_a, flux_vs: Complex64::new(control.flux_vs, 0.0) };
        let voltage_v = control.next_v;
        (control, state, voltage_v)
    }

    /// One sample: measures currents and speed, and returns the voltage to apply from now on, V.
    pub(super) fn sample(&mut self, current_a: Complex64, speed_rad_s: f64, braking_nm: f64) -> Complex64 {
        let applied_v = self.next_v;
        let flux_towards = self.machine.magnetising * current_a.re;
        self.flux_vs += (1.0 - (-self.machine.rotor_rate * self.sample_s).exp()) * (flux_towards - self.flux_vs);
        self.frame_rad_s = self.machine.pole_pairs * speed_rad_s + self.slip_rad_s(current_a.im);
        let error_a = self.current_demand_a(braking_nm) - current_a;
        let proportional = self.bandwidth * self.machine.leakage;
        let wanted_v = error_a * proportional + self.integral_v + self.decoupling_v(current_a);
        let size = wanted_v.norm();
        let limited_v = if size > self.voltage_limit_v { wanted_v * (self.voltage_limit_v / size) } else { wanted_v };
        let integral_gain = self.bandwidth * self.machine.resistance * self.sample_s;
        self.integral_v += (error_a + (limited_v - wanted_v) / proportional) * integral_gain;
        self.next_v = limited_v;
        applied_v
    }

    fn slip_rad_s(&self, torque_current_a: f64) -> f64 {
        self.machine.magnetising * self.machine.rotor_rate * torque_current_a
            / self.flux_vs.max(0.05 * self.rated_flux_vs)
    }

    /// The rated flux, or less where the voltage would not suffice.
    fn flux_demand_vs(&self) -> f64 {
        let stator_flux_ratio = 1.0 / self.machine.coupling;
        let base_rad_s = VOLTAGE_RESERVE * self.voltage_limit_v / (self.rated_flux_vs * stator_flux_ratio);
        self.rated_flux_vs * (base_rad_s / self.frame_rad_s.abs().max(base_rad_s))
    }

    /// i_d* for the flux, i_q* for the torque, within the limit.
    fn current_demand_a(&self, braking_nm: f64) -> Complex64 {
        let flux_demand = self.flux_demand_vs();
        let magnetising_a = (flux_demand + FLUX_GAIN * (flux_demand - self.flux_vs)) / self.machine.magnetising;
        let direct_a = magnetising_a.clamp(0.0, 0.9 * self.current_limit_a);
        let most_a = (self.current_limit_a * self.current_limit_a - direct_a * direct_a).sqrt();
        let flux = self.flux_vs.max(0.05 * self.rated_flux_vs);
        let torque_a = -braking_nm / (self.machine.torque_constant() * flux);
        Complex64::new(direct_a, torque_a.clamp(-most_a, most_a))
    }

    /// jω_k (σL_s i + (L_m/L_r) ψ).
    fn decoupling_v(&self, current_a: Complex64) -> Complex64 {
        let linked = current_a * self.machine.leakage + self.machine.coupling * self.flux_vs;
        Complex64::new(0.0, self.frame_rad_s) * linked
    }
}
