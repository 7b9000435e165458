//! Frequency responses of the blocks and of the connected model, at s = jω; delays are exact.
//!
//! The controller and the holds are taken as they run, sampled: PI by its difference equation at z = e^{sT}, the held
//! demand by (1 − e^{−sT})/(sT). What sampling folds about half the update rate is neglected, so the responses hold
//! below it (500 Hz at 1 ms).

use signal::Complex64;

use super::{BenchModel, FeedForwardGains, Mechanics, PiController, TorqueControlModel};

const ONE: Complex64 = Complex64::new(1.0, 0.0);

/// s = jω.
fn laplace(omega_rad_s: f64) -> Complex64 {
    Complex64::new(0.0, omega_rad_s)
}

impl Mechanics {
    /// T_d → T_shaft with both sides free, H_d H_s/(1 + H_s (H_d + H_e)) (7.2).
    pub fn torque_to_shaft(&self, omega_rad_s: f64) -> Complex64 {
        self.shaft_numerator(omega_rad_s) / self.dyno_inertia_kg_m2 / self.denominator(omega_rad_s)
    }

    /// T_e → T_shaft with both sides free, H_e H_s/(1 + H_s (H_d + H_e)).
    pub fn engine_to_shaft(&self, omega_rad_s: f64) -> Complex64 {
        self.shaft_numerator(omega_rad_s) / self.engine_inertia_kg_m2 / self.denominator(omega_rad_s)
    }

    /// T_e → ω_d with both sides free, rad/s per Nm: H_d times T_e → T_shaft.
    pub fn engine_to_speed(&self, omega_rad_s: f64) -> Complex64 {
        self.engine_to_shaft(omega_rad_s) / (laplace(omega_rad_s) * self.dyno_inertia_kg_m2)
    }

    /// T_d → ω_d with both sides free, rad/s per Nm: H_d times (T_d → T_shaft less one).
    pub fn torque_to_speed(&self, omega_rad_s: f64) -> Complex64 {
        (self.torque_to_shaft(omega_rad_s) - 1.0) / (laplace(omega_rad_s) * self.dyno_inertia_kg_m2)
    }

    fn shaft_numerator(&self, omega_rad_s: f64) -> Complex64 {
        laplace(omega_rad_s) * self.damping_nm_s_per_rad + self.stiffness_nm_per_rad
    }

    /// s² + (K + B s)(1/J_d + 1/J_e).
    fn denominator(&self, omega_rad_s: f64) -> Complex64 {
        self.shaft_numerator(omega_rad_s) * self.mobility() - omega_rad_s * omega_rad_s
    }
}

impl PiController {
    /// ω_d → T_d*, Nm s/rad: the difference equation at e^{jωT}, and e^{−jωτ}.
    pub fn response(&self, omega_rad_s: f64) -> Complex64 {
        self.immediate_response(omega_rad_s) * Complex64::cis(-omega_rad_s * self.delay_s)
    }

    /// −ω_d* → T_d*, Nm s/rad: the same with the delay of the demand.
    pub fn demand_response(&self, omega_rad_s: f64) -> Complex64 {
        self.immediate_response(omega_rad_s) * Complex64::cis(-omega_rad_s * self.demand_delay_s)
    }

    fn immediate_response(&self, omega_rad_s: f64) -> Complex64 {
        let back = Complex64::cis(-omega_rad_s * self.sample_time_s);
        let integral = self.integral_nm_per_rad * self.sample_time_s * back / (ONE - back);
        integral + self.proportional_nm_s_per_rad
    }

    /// Sample and hold, (1 − e^{−sT})/(sT).
    pub fn hold(&self, omega_rad_s: f64) -> Complex64 {
        mean_over(self.sample_time_s, omega_rad_s)
    }
}

impl FeedForwardGains {
    /// ω_d* → T_d*, Nm s/rad; the derivative is the controller's backward difference.
    pub fn response(&self, omega_rad_s: f64, sample_time_s: f64) -> Complex64 {
        let difference = (ONE - Complex64::cis(-omega_rad_s * sample_time_s)) / sample_time_s;
        let immediate = difference * self.acceleration_nm_s2_per_rad + self.speed_nm_s_per_rad;
        immediate * Complex64::cis(-omega_rad_s * self.delay_s)
    }
}

impl TorqueControlModel {
    /// T_d* → T_d, e^{−jωd} a/(jω + a).
    pub fn response(&self, omega_rad_s: f64) -> Complex64 {
        let lag = self.bandwidth_rad_s.map_or(ONE, |a| a / (laplace(omega_rad_s) + a));
        lag * Complex64::cis(-omega_rad_s * self.delay_s)
    }
}

/// The mean over the last `time_s`: (1 − e^{−sT})/(sT) at s = jω.
pub fn mean_over(time_s: f64, omega_rad_s: f64) -> Complex64 {
    let half = 0.5 * omega_rad_s * time_s;
    let magnitude = if half == 0.0 { 1.0 } else { half.sin() / half };
    magnitude * Complex64::cis(-half)
}

impl BenchModel {
    /// Speed loop, opened at T_d*: PI, hold, torque control, mechanics with the engine at constant torque, encoder
    /// gate. Its sign is that of a negative feedback: closed, 1 + L is the denominator. `None` without controller or
    /// torque control.
    pub fn open_loop(&self, omega_rad_s: f64) -> Option<Complex64> {
        let pi = self.speed_controller.as_ref()?;
        let gate = mean_over(self.encoder_gate_s, omega_rad_s);
        Some(-self.demand_to_speed(omega_rad_s)? * gate * pi.response(omega_rad_s))
    }

    /// ω_d* → ω_d in speed control: P (FF − PI)/(1 + L), P being T_d* → ω_d. `None` without controller or torque
    /// control.
    pub fn speed_demand_to_speed(&self, omega_rad_s: f64) -> Option<Complex64> {
        let pi = self.speed_controller.as_ref()?;
        let zero = Complex64::new(0.0, 0.0);
        let feed_forward = self.feed_forward.map_or(zero, |f| f.response(omega_rad_s, pi.sample_time_s));
        let forward = self.demand_to_speed(omega_rad_s)? * (feed_forward - pi.demand_response(omega_rad_s));
        Some(forward / (self.open_loop(omega_rad_s)? + 1.0))
    }

    /// T_e → ω_d in speed control, rad/s per Nm. `None` without controller or torque control.
    pub fn engine_to_speed_controlled(&self, omega_rad_s: f64) -> Option<Complex64> {
        Some(self.mechanics.engine_to_speed(omega_rad_s) / (self.open_loop(omega_rad_s)? + 1.0))
    }

    /// T_d* → T_shaft in torque control, for a demand that is not held. `None` without torque control.
    pub fn demand_to_shaft(&self, omega_rad_s: f64) -> Option<Complex64> {
        Some(self.torque_control?.response(omega_rad_s) * self.mechanics.torque_to_shaft(omega_rad_s))
    }

    /// T_d* → ω_d with the demand held between updates.
    fn demand_to_speed(&self, omega_rad_s: f64) -> Option<Complex64> {
        let held = self.speed_controller.as_ref()?.hold(omega_rad_s);
        Some(held * self.torque_control?.response(omega_rad_s) * self.mechanics.torque_to_speed(omega_rad_s))
    }
}
