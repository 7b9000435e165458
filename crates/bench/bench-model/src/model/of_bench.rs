//! The linear model of a bench whose parameters are known.

use rig::bench_parameters::BenchParameters;
use rig::experiment::UPDATE_S;

use super::{BenchModel, FeedForwardGains, Mechanics, PiController, TorqueControlModel};

impl BenchModel {
    /// The linear model of a virtual bench, as an exact study would assemble it: two masses, PI with feed-forward,
    /// delay and lag. Ripple, play, friction, a flywheel of two masses and the machine's inside are no part of it.
    #[must_use]
    pub fn of(bench: &BenchParameters) -> BenchModel {
        let bandwidth = bench.drive.machine.map_or(bench.drive.bandwidth_rad_s, |m| m.current_bandwidth_rad_s);
        BenchModel {
            mechanics: Mechanics {
                dyno_inertia_kg_m2: bench.mechanics.dyno_inertia_kg_m2,
                engine_inertia_kg_m2: bench.mechanics.engine_inertia_kg_m2,
                stiffness_nm_per_rad: bench.mechanics.shaft_stiffness_nm_per_rad,
                damping_nm_s_per_rad: bench.mechanics.shaft_damping_nm_s_per_rad,
            },
            speed_controller: Some(PiController {
                proportional_nm_s_per_rad: bench.controller.proportional_nm_s_per_rad,
                integral_nm_per_rad: bench.controller.integral_nm_per_rad,
                delay_s: bench.controller.delay_s,
                demand_delay_s: bench.controller.delay_s,
                sample_time_s: UPDATE_S,
            }),
            feed_forward: Some(FeedForwardGains {
                speed_nm_s_per_rad: bench.controller.speed_feed_forward_nm_s_per_rad,
                acceleration_nm_s2_per_rad: bench.controller.acceleration_feed_forward_nm_s2_per_rad,
                delay_s: 0.0,
            }),
            torque_control: Some(TorqueControlModel { delay_s: bench.drive.delay_s, bandwidth_rad_s: Some(bandwidth) }),
            torque_limit_nm: Some(bench.drive.torque_limit_nm),
            encoder_gate_s: bench.sensors.gate_s,
        }
    }
}
