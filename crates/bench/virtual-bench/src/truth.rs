//! True values that an exact study of a virtual bench would find.

use numerics::null::nan_if_null;
use rig::bench_parameters::BenchParameters;
use rig::experiment::UPDATE_S;
use serde::{Deserialize, Serialize};

use super::drive::SAMPLES_PER_UPDATE;
use super::train::resonance_hz;

/// The true values of what a study estimates, in the study's units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// K, Nm/rad.
    #[serde(deserialize_with = "nan_if_null")]
    pub stiffness_nm_per_rad: f64,
    /// B, Nm s/rad.
    #[serde(deserialize_with = "nan_if_null")]
    pub damping_nm_s_per_rad: f64,
    /// K_p, Nm s/rad.
    #[serde(deserialize_with = "nan_if_null")]
    pub proportional_nm_s_per_rad: f64,
    /// K_i, Nm/rad.
    #[serde(deserialize_with = "nan_if_null")]
    pub integral_nm_per_rad: f64,
    /// τ of the speed controller, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub controller_delay_s: f64,
    /// k, Nm s/rad.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_feed_forward_nm_s_per_rad: f64,
    /// k_a, Nm s²/rad.
    #[serde(deserialize_with = "nan_if_null")]
    pub acceleration_feed_forward_nm_s2_per_rad: f64,
    /// Delay and lag of the torque control together, d + 1/a, s; with a machine, d, a sample of its control, and 1 over
    /// the bandwidth of its currents.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_control_delay_s: f64,
    /// Frequency of the largest gain of T_d → T_shaft in torque control, Hz; without play and stiffening.
    #[serde(deserialize_with = "nan_if_null")]
    pub resonance_hz: f64,
}

impl Truth {
    /// Returns the values that an exact study of a virtual bench would find.
    ///
    /// # Example
    /// ```
    /// let truth = virtual_bench::Truth::of(&Default::default());
    /// assert!((truth.proportional_nm_s_per_rad - 0.9385 / units::RPM_RAD_S).abs() < 1e-12);
    /// assert!((truth.resonance_hz - 17.68).abs() < 0.01);
    /// ```
    #[must_use]
    pub fn of(bench: &BenchParameters) -> Truth {
        let (mechanics, controller) = (&bench.mechanics, &bench.controller);
        let lag_s = match bench.drive.machine {
            None => 1.0 / bench.drive.bandwidth_rad_s,
            Some(machine) => UPDATE_S / SAMPLES_PER_UPDATE as f64 + 1.0 / machine.current_bandwidth_rad_s,
        };
        Truth {
            stiffness_nm_per_rad: mechanics.shaft_stiffness_nm_per_rad,
            damping_nm_s_per_rad: mechanics.shaft_damping_nm_s_per_rad,
            proportional_nm_s_per_rad: controller.proportional_nm_s_per_rad,
            integral_nm_per_rad: controller.integral_nm_per_rad,
            controller_delay_s: controller.delay_s,
            speed_feed_forward_nm_s_per_rad: controller.speed_feed_forward_nm_s_per_rad,
            acceleration_feed_forward_nm_s2_per_rad: controller.acceleration_feed_forward_nm_s2_per_rad,
            torque_control_delay_s: bench.drive.delay_s + lag_s,
            resonance_hz: resonance_hz(mechanics),
        }
    }
}
