//! Models of known benches.

use std::f64::consts::TAU;

use bench_model::model::{BenchModel, FeedForwardGains, Mechanics, PiController, TorqueControlModel};

/// One revolution a minute, rad/s.
pub const RPM: f64 = TAU / 60.0;

pub fn bench_a() -> BenchModel {
    BenchModel {
        mechanics: Mechanics {
            dyno_inertia_kg_m2: 0.6,
            engine_inertia_kg_m2: 0.28,
            stiffness_nm_per_rad: 2437.7,
            damping_nm_s_per_rad: 5.8,
        },
        speed_controller: Some(PiController {
            proportional_nm_s_per_rad: 0.9385 / RPM,
            integral_nm_per_rad: 1.865 / RPM,
            delay_s: 1e-3,
            demand_delay_s: 1e-3,
            sample_time_s: 1e-3,
        }),
        feed_forward: Some(FeedForwardGains {
            speed_nm_s_per_rad: 0.012 / RPM,
            acceleration_nm_s2_per_rad: -0.085 / RPM,
            delay_s: 0.0,
        }),
        torque_control: Some(TorqueControlModel { delay_s: 1.25e-3, bandwidth_rad_s: Some(565.5) }),
        torque_limit_nm: Some(400.0),
        encoder_gate_s: 1e-3,
    }
}
