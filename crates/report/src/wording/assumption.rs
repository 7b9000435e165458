//! What was assumed of a bench, and the peaks of a prediction.

use std::f64::consts::TAU;

use bench::prediction::PeakOf;
use bench::units::RPM_RAD_S;
use bench::virtual_bench::Assumption;

use super::number::significant_with_unit;

/// What stands in for something that nobody stated.
pub fn assumption(assumption: &Assumption) -> String {
    let number = |value: f64, unit: &str| significant_with_unit(value, 4, unit);
    match *assumption {
        Assumption::Shaft { stiffness_nm_per_rad, damping_nm_s_per_rad } => format!(
            "the shaft: K = {}, B = {}",
            number(stiffness_nm_per_rad, "Nm/rad"),
            number(damping_nm_s_per_rad, "Nm s/rad")
        ),
        Assumption::Damping { ratio, damping_nm_s_per_rad } => format!(
            "the shaft's damping: B = {} (damping ratio {})",
            number(damping_nm_s_per_rad, "Nm s/rad"),
            number(ratio, "")
        ),
        Assumption::SpeedController { proportional_nm_s_per_rad, integral_nm_per_rad } => format!(
            "the speed controller: K_p = {}, K_i = {}",
            number(proportional_nm_s_per_rad * RPM_RAD_S, "Nm/rpm"),
            number(integral_nm_per_rad * RPM_RAD_S, "Nm/(rpm s)")
        ),
        Assumption::FeedForward => "the controller's feed-forward: that of the default virtual bench".to_owned(),
        Assumption::TorqueControl { delay_s, bandwidth_rad_s } => format!(
            "the torque control: delay {}, lag with a corner at {}",
            number(1e3 * delay_s, "ms"),
            number(bandwidth_rad_s / TAU, "Hz")
        ),
        Assumption::TorqueLimit { torque_nm } => format!("the inverter's limit: {}", number(torque_nm, "Nm")),
        Assumption::Flywheel => "the dual-mass flywheel: that of a passenger car".to_owned(),
        Assumption::Engine => {
            "the engine: firing pulses, motored torque and speed control of a two-litre engine".to_owned()
        }
    }
}

/// The signal of a peak, by its symbol, with its unit and SI per unit.
pub fn peak(of: PeakOf) -> (&'static str, &'static str, f64) {
    match of {
        PeakOf::DynoSpeed => ("N_d", "rpm", RPM_RAD_S),
        PeakOf::TorqueDemand => ("T_d*", "Nm", 1.0),
        PeakOf::AirGapTorque => ("T_d", "Nm", 1.0),
        PeakOf::ShaftTorque => ("T_shaft", "Nm", 1.0),
    }
}
