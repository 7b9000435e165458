//! A speed controller written down here, with terms that a recording has to betray: it computes T_d* anew from the
//! speeds of a recording, or from the speeds at which it would have demanded the recorded T_d*; then the speed is
//! logged with noise of its own.

use part_controller::speed_controller::AntiWindup;
use rig::{Experiment, Role};
use signal::excitation::Random;
use units::RPM_RAD_S;

const T: f64 = 1e-3;

#[derive(Debug, Clone)]
pub(super) struct Hidden {
    /// Nm/rpm and Nm/(rpm s).
    pub(super) k_p: f64,
    pub(super) k_i: f64,
    pub(super) delay_updates: usize,
    /// First-order filter on the measured speed: n_f += T/(T_f + T) (n − n_f).
    pub(super) filter_s: f64,
    /// Nm/(rpm/s).
    pub(super) k_d: f64,
    /// Nm/(rpm s²).
    pub(super) k_ii: f64,
    pub(super) offset_rpm: f64,
    /// Height of a hump of the static feed-forward at 2100 rpm, Nm.
    pub(super) bend_nm: f64,
    /// Half of what the feed-forward is more after rising than after falling N_d*.
    pub(super) hysteresis_nm: f64,
    /// With the sign of dN_d*/dt.
    pub(super) friction_nm: f64,
    pub(super) limit_nm: f64,
    pub(super) law: AntiWindup,
    /// Of the logged speed, white.
    pub(super) noise_rad_s: f64,
    /// Seed of that noise.
    pub(super) noise_seed: u64,
    /// T_d* is logged in multiples of this.
    pub(super) demand_step_nm: f64,
}

impl Default for Hidden {
    fn default() -> Self {
        Hidden {
            k_p: 0.9385,
            k_i: 1.865,
            delay_updates: 1,
            filter_s: 0.0,
            k_d: 0.0,
            k_ii: 0.0,
            offset_rpm: 0.0,
            bend_nm: 0.0,
            hysteresis_nm: 0.0,
            friction_nm: 0.0,
            limit_nm: f64::INFINITY,
            law: AntiWindup::None,
            noise_rad_s: 0.003,
            noise_seed: 77,
            demand_step_nm: 0.01,
        }
    }
}

impl Hidden {
    /// k N_d* and the hump, Nm.
    pub(super) fn static_nm(&self, speed_rad_s: f64) -> f64 {
        let rpm = speed_rad_s / RPM_RAD_S;
        0.012 * rpm + self.bend_nm * (-((rpm - 2100.0) / 500.0).powi(2)).exp()
    }

    /// The recording with this controller's T_d* for its speeds.
    pub(super) fn rewrite(&self, experiment: &Experiment) -> Experiment {
        let speed = experiment.signals[&Role::DynoSpeed].samples.clone();
        let reference = &experiment.signals[&Role::DynoSpeedDemand].samples;
        let first_nm = experiment.signals[&Role::DynoTorqueDemand].samples[0] - self.static_nm(reference[0]);
        self.logged(experiment, &speed, first_nm)
    }

    /// The recording, with constant N_d*, with the speeds at which this controller demands its T_d*: in a loop that is
    /// closed, the torque is what the engine makes it, whatever the controller.
    pub(super) fn in_the_loop(&self, experiment: &Experiment) -> Experiment {
        let torque = &experiment.signals[&Role::DynoTorqueDemand].samples;
        let start = experiment.signals[&Role::DynoSpeed].samples[0];
        let reference = experiment.signals[&Role::DynoSpeedDemand].samples[0];
        let (k_p, k_i, k_d, k_ii) = self.gains();
        let keep = T / (self.filter_s + T);
        let first_error = start + self.offset_rpm * RPM_RAD_S - reference;
        let output = |k: usize| torque[(k + self.delay_updates).min(torque.len() - 1)] - self.static_nm(reference);
        let first_nm = output(0) - k_p * first_error - k_d * (first_error - (start - reference)) / T;
        let (mut integral, mut second) = (first_nm, 0.0);
        let (mut last_error, mut filtered) = (start - reference, start);
        let mut speed = Vec::with_capacity(torque.len());
        for k in 0..torque.len() {
            let error = (output(k) - integral + k_d / T * last_error) / (k_p + k_d / T);
            integral += k_i * T * error + T * second;
            second += k_ii * T * error;
            last_error = error;
            let passed = error - self.offset_rpm * RPM_RAD_S + reference;
            speed.push(filtered + (passed - filtered) / keep);
            filtered = passed;
        }
        self.logged(experiment, &speed, first_nm)
    }

    /// Logged signals where the controller sees a speed and starts from a state of its integrator.
    fn logged(&self, experiment: &Experiment, speed: &[f64], first_nm: f64) -> Experiment {
        let mut logged = experiment.clone();
        let clock = &experiment.signals[&Role::DynoSpeed];
        let reference = &experiment.signals[&Role::DynoSpeedDemand].samples;
        let mut random = Random::new(self.noise_seed);
        let noisy = speed.iter().map(|w| w + self.noise_rad_s * random.normal()).collect();
        let demand = self.demand_nm(speed, reference, first_nm);
        logged.signals.insert(Role::DynoTorqueDemand, clock.with_samples(demand));
        logged.signals.insert(Role::DynoSpeed, clock.with_samples(noisy));
        logged
    }

    /// K_p, K_i, K_d and K_ii per rad/s.
    fn gains(&self) -> (f64, f64, f64, f64) {
        (self.k_p / RPM_RAD_S, self.k_i / RPM_RAD_S, self.k_d / RPM_RAD_S, self.k_ii / RPM_RAD_S)
    }

    fn demand_nm(&self, speed: &[f64], reference: &[f64], first_nm: f64) -> Vec<f64> {
        let (k_p, k_i, k_d, k_ii) = self.gains();
        let keep = T / (self.filter_s + T);
        let (mut filtered, mut last_error, mut direction) = (speed[0], speed[0] - reference[0], 0.0);
        let (mut second, mut integral) = (0.0, first_nm);
        let mut delayed = std::collections::VecDeque::from(vec![integral; self.delay_updates]);
        let mut all = Vec::with_capacity(speed.len());
        for k in 0..speed.len() {
            filtered += keep * (speed[k] - filtered);
            let error = filtered + self.offset_rpm * RPM_RAD_S - reference[k];
            let change = if k == 0 { 0.0 } else { reference[k] - reference[k - 1] };
            direction = if change == 0.0 { direction } else { change.signum() };
            let moving = if change == 0.0 { 0.0 } else { direction };
            let feed = self.static_nm(reference[k]) - 0.085 / RPM_RAD_S * change / T
                + self.hysteresis_nm * direction
                + self.friction_nm * moving;
            let output = k_p * error + integral + k_d * (error - last_error) / T;
            integral += self.change_nm(k_i * T * error, output + feed) + T * second;
            second += k_ii * T * error;
            last_error = error;
            delayed.push_back(output);
            let torque = delayed.pop_front().unwrap() + feed;
            let limited = torque.clamp(-self.limit_nm, self.limit_nm);
            let step = self.demand_step_nm;
            all.push(if step > 0.0 { (limited / step).round() * step } else { limited });
        }
        all
    }

    /// Change that the integrator takes at the limit.
    fn change_nm(&self, change: f64, wanted: f64) -> f64 {
        let exceeds = wanted.abs() > self.limit_nm;
        match self.law {
            AntiWindup::Clamping if exceeds => 0.0,
            AntiWindup::ConditionalIntegration if exceeds && change * wanted > 0.0 => 0.0,
            AntiWindup::BackCalculation { tracking_s } => {
                change + (wanted.clamp(-self.limit_nm, self.limit_nm) - wanted) * T / tracking_s
            }
            _ => change,
        }
    }
}
