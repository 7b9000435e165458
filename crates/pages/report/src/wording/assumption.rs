//! Words for assumptions about a bench, the peaks of a prediction, and the quantities of a safety check.

use std::f64::consts::TAU;

use bench_model::model::ModelParameter;
use bench_model::prediction::PeakOf;
use design::excitation_design::LimitedQuantity;
use design::safety::{Quantity, Safety};
use rig::engine_pulses::KnownPulses;
use rig::results::Notation;
use units::RPM_RAD_S;
use virtual_bench::Assumption;

use super::number::significant_with_unit;

/// Assumption where nobody stated a value.
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
        Assumption::TorqueLimit { torque_nm } => format!("the torque limit: {}", number(torque_nm, "Nm")),
        Assumption::Flywheel => "the dual-mass flywheel: that of a passenger car".to_owned(),
        Assumption::Engine => {
            "the engine: motored torque and speed control of a two-litre engine".to_owned()
        }
        Assumption::Pulses => {
            "the engine's firing pulses: a two-litre engine's in the nominal run, drawn for the class of engines otherwise"
                .to_owned()
        }
    }
}

/// Where the firing pulses of an answer are from.
pub fn engine_pulses(pulses: &KnownPulses) -> String {
    match pulses {
        KnownPulses::Stated => "Engine pulses: stated in the bench file, and taken as exact.".to_owned(),
        KnownPulses::Estimated(pulses) => {
            let count = pulses.recordings.len();
            let plural = if count == 1 { "" } else { "s" };
            format!("Engine pulses: estimated from {count} recording{plural}, and drawn with their covariance.")
        }
        KnownPulses::Assumed(_) => {
            "Engine pulses: assumed. No recording of the study shows them, so they are drawn as wide as the class of \
                                    engines has them."
                .to_owned()
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

/// A parameter of the model, by its symbol, with the unit it is reported in and SI per unit.
pub fn model_parameter(of: ModelParameter) -> (&'static str, &'static str, f64) {
    let Notation { unit, per_si, .. } = of.quantity().notation();
    match unit {
        "s" => (of.symbol(), "ms", 1e-3),
        _ => (of.symbol(), unit, 1.0 / per_si),
    }
}

/// Quantity that a designed excitation drives to its limit, by its symbol.
pub fn limited(of: LimitedQuantity) -> &'static str {
    match of {
        LimitedQuantity::ShaftTorque => "T_shaft",
        LimitedQuantity::AirGapTorque => "T_d",
        LimitedQuantity::Speed => "N_d",
        LimitedQuantity::Demand => "the demand",
    }
}

/// Quantity of a safety check, in words, with its unit and SI per unit.
pub fn quantity(of: Quantity) -> (&'static str, &'static str, f64) {
    match of {
        Quantity::ShaftTorque => ("peak |T_shaft|", "Nm", 1.0),
        Quantity::ShaftTorqueSlew => ("slew of T_shaft", "Nm/s", 1.0),
        Quantity::TorqueDemand => ("peak |T_d*|", "Nm", 1.0),
        Quantity::TorqueSlew => ("slew of T_d*", "Nm/s", 1.0),
        Quantity::Speed => ("highest speed", "rpm", RPM_RAD_S),
        Quantity::SpeedGradient => ("speed gradient", "rpm/s", RPM_RAD_S),
        Quantity::Power => ("power of the dynamometer", "kW", 1e3),
        Quantity::TimeAtResonance => ("time at resonance", "s", 1.0),
        Quantity::LowestSpeed => ("lowest speed", "rpm", RPM_RAD_S),
        Quantity::LimitedShare => ("T_d* at its limit", "% of time", 0.01),
    }
}

/// The verdict of a safety check.
pub fn safety(safety: Safety) -> &'static str {
    match safety {
        Safety::Safe => "safe",
        Safety::Risky => "risky",
        Safety::Unsafe => "unsafe",
        Safety::NotChecked => "not checked",
    }
}
