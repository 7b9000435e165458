//! Why friction cannot be estimated.

use rig::{ExperimentLabel, Role};
use units::RPM_RAD_S;

/// Why friction cannot be estimated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FrictionError {
    /// There is no recording.
    #[error(
        "there is no recording without shaft; take the shaft off and run NoShaft_N_NT (steps of speed), or a run-out from the \
         highest speed with T_d* at zero (NoShaft_T_TN)"
    )]
    NoRecording,
    /// The shaft is on.
    #[error(
        "{file}: {label} is an experiment with the shaft on, so friction cannot be separated from engine torque; take the \
         shaft off and run NoShaft_N_NT"
    )]
    ShaftOn {
        /// File.
        file: String,
        /// Its label.
        label: ExperimentLabel,
    },
    /// A signal is missing.
    #[error(
        "{file}: friction needs {} ({}), and none can be used; record it, or correct its channel if a warning names \
         it",
        .role.symbol(), .role.key()
    )]
    MissingSignal {
        /// File.
        file: String,
        /// Role.
        role: Role,
    },
    /// The dynamometer hardly turns, or not for long enough.
    #[error(
        "{file}: the dynamometer turns faster than {:.0} rpm for {turning_s:.1} s only, {needed_s} s are needed; run it faster \
         or record longer",
        .slowest_rad_s / RPM_RAD_S
    )]
    HardlyTurns {
        /// File.
        file: String,
        /// How long it turns, s.
        turning_s: f64,
        /// Needed, s.
        needed_s: f64,
        /// Slower is left out, rad/s.
        slowest_rad_s: f64,
    },
    /// The speed is too steady to separate terms of friction.
    #[error(
        "{file}: the speed stays between {:.0} and {:.0} rpm, which shows neither how friction grows with speed nor J_d; step \
         N_d* between levels far apart (NoShaft_N_NT), or let it run out",
        .from_rad_s / RPM_RAD_S, .to_rad_s / RPM_RAD_S
    )]
    SteadySpeed {
        /// File.
        file: String,
        /// Lowest speed, rad/s.
        from_rad_s: f64,
        /// Highest speed, rad/s.
        to_rad_s: f64,
    },
    /// A torque has the wrong sign.
    #[error(
        "{file}: {} is negative when it brakes, as its effect on the speed shows; write sign = -1 for {} in the bench file",
        .role.symbol(), .role.key()
    )]
    WrongSign {
        /// File.
        file: String,
        /// Role.
        role: Role,
    },
    /// Friction that drives.
    #[error(
        "{files}: friction comes out at {torque_nm:.1} Nm at {:.0} rpm, and would drive the dynamometer, which no friction does. \
         Was the shaft on, or the engine coupled (then the label is wrong)? Does T_d have the right sign, and no offset?",
        .speed_rad_s / RPM_RAD_S
    )]
    Drives {
        /// Files.
        files: String,
        /// Friction as it comes out, Nm.
        torque_nm: f64,
        /// Where, rad/s.
        speed_rad_s: f64,
    },
    /// Friction that is not known to within any torque that acted.
    #[error(
        "{files}: friction comes out at {torque_nm:.3e} ± {half_width_nm:.2e} Nm at {:.0} rpm, while T_d and the change of speed \
         come to {largest_nm:.0} Nm at most: these recordings do not show it. Was the shaft on (then the label is wrong)? If it \
         was off, step N_d* between levels far apart (NoShaft_N_NT)",
        .speed_rad_s / RPM_RAD_S
    )]
    BeyondTorques {
        /// Files.
        files: String,
        /// Friction as it comes out, Nm.
        torque_nm: f64,
        /// Half of its 95 % interval, Nm.
        half_width_nm: f64,
        /// Where, rad/s.
        speed_rad_s: f64,
        /// The largest torque that acted, Nm.
        largest_nm: f64,
    },
    /// Numbers do not allow an estimate.
    #[error("{file}: {source}")]
    Ident {
        /// File.
        file: String,
        /// The estimator's reason.
        source: fitting::IdentError,
    },
}
