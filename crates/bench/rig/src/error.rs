//! Why a part of the bench cannot be estimated.

use crate::quantity::Quantity;
use crate::role::Role;

/// Why a part of the bench cannot be estimated from a recording.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EstimateError {
    /// A signal the estimate needs was not recorded.
    #[error("{file}: the estimate needs {} ({})", .role.symbol(), .role.key())]
    MissingSignal {
        /// File.
        file: String,
        /// Role.
        role: Role,
    },
    /// The recording is too short.
    #[error("{file}: {duration_s:.3} s are too short, {needed_s} s are needed")]
    TooShort {
        /// File.
        file: String,
        /// Length, s.
        duration_s: f64,
        /// Needed, s.
        needed_s: f64,
    },
    /// A signal does not vary enough.
    #[error("{file}: {} hardly varies, so nothing can be learnt from it", .role.symbol())]
    WeakExcitation {
        /// File.
        file: String,
        /// Role.
        role: Role,
        /// Standard deviation in SI.
        standard_deviation: f64,
    },
    /// Too much of the recording is at a limit.
    #[error("{file}: {} rests at its limit for {:.0} % of the time", .role.symbol(), 100.0 * .share)]
    Saturated {
        /// File.
        file: String,
        /// Role.
        role: Role,
        /// Share of the samples, 0…1.
        share: f64,
    },
    /// A torque brakes with a negative sign, against what it does to the speed.
    #[error("{file}: {} is negative when it brakes, as its effect on the speed shows", .role.symbol())]
    WrongSign {
        /// File.
        file: String,
        /// Role.
        role: Role,
    },
    /// Delay and lag of the torque control cannot be separated.
    #[error(
        "{file}: the samples of T_d,calc are too few between the steps of T_d* to separate delay and lag of the torque control; \
         record T_d,calc at a higher rate, or a T_d* that changes more often"
    )]
    Inseparable {
        /// File.
        file: String,
    },
    /// A fit ended at the limit of what is possible, so the recording does not show the number.
    #[error(
        "{file}: the recording does not show {}: the best fit is at the limit of the search. Check units, channels and clocks \
         of the signals",
        .quantity.notation().symbol
    )]
    AtLimit {
        /// File.
        file: String,
        /// Quantity that ended at a limit.
        quantity: Quantity,
    },
    /// Sampling folds pulses of the engine onto most of the frequencies that show the shaft.
    #[error(
        "{file}: the engine's pulses fold onto most frequencies that show the shaft, as the rate of N_d or N_e is too low at \
         these speeds. Record the speeds at 1 kHz, or at a constant speed"
    )]
    FoldedPulses {
        /// File.
        file: String,
    },
    /// A number that is known from another recording comes out quite different.
    #[error(
        "{file}: {symbol} comes out as {:.4} ± {:.4} {unit}, and another recording gives {:.4} ± {:.4} {unit}; the two contradict each other",
        in_its_unit(.quantity, .here.0), in_its_unit(.quantity, .here.1), in_its_unit(.quantity, .known.0),
        in_its_unit(.quantity, .known.1),
        symbol = .quantity.notation().symbol, unit = .quantity.notation().unit
    )]
    Contradiction {
        /// File.
        file: String,
        /// Quantity that is contradicted.
        quantity: Quantity,
        /// Its value and standard error here, SI.
        here: (f64, f64),
        /// The same from the other recording.
        known: (f64, f64),
    },
    /// A recording that this way to the shaft cannot use.
    #[error("{file}: {reason}")]
    Unsuitable {
        /// File.
        file: String,
        /// Why.
        reason: Unsuitable,
    },
    /// Numbers do not allow an estimate.
    #[error("{file}: {source}")]
    Ident {
        /// File.
        file: String,
        /// The estimator's reason.
        source: fitting::IdentError,
    },
    /// A signal cannot be processed.
    #[error("{file}: {source}")]
    Signal {
        /// File.
        file: String,
        /// The reason.
        source: signal::SignalError,
    },
}

/// A value in SI, in the unit in which people read the quantity.
fn in_its_unit(quantity: &Quantity, value: f64) -> f64 {
    quantity.notation().per_si * value
}

impl EstimateError {
    /// The recording it is about.
    #[must_use]
    pub fn file(&self) -> &str {
        match self {
            EstimateError::MissingSignal { file, .. }
            | EstimateError::TooShort { file, .. }
            | EstimateError::WeakExcitation { file, .. }
            | EstimateError::Saturated { file, .. }
            | EstimateError::WrongSign { file, .. }
            | EstimateError::Inseparable { file }
            | EstimateError::AtLimit { file, .. }
            | EstimateError::FoldedPulses { file }
            | EstimateError::Contradiction { file, .. }
            | EstimateError::Unsuitable { file, .. }
            | EstimateError::Ident { file, .. }
            | EstimateError::Signal { file, .. } => file,
        }
    }
}

/// Why a way to the shaft cannot use a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Unsuitable {
    /// The torque is that of a flange, and T_d is needed.
    #[error("the {route} needs T_d, but the torque is that of a flange")]
    FlangeTorque {
        /// The way to the shaft.
        route: &'static str,
    },
    /// The demand does not repeat.
    #[error(
        "T_d* does not repeat, or too seldom: record Multisine_T_TN with two seconds to settle and, after them, at least \
         {periods} periods of the demand, better ten"
    )]
    NotPeriodic {
        /// Periods that are needed.
        periods: usize,
    },
    /// The excitation does not separate the coefficients of a black box.
    #[error(
        "T_d cannot separate the {poles} poles and {coefficients} coefficients of the black box{}: some of them can change \
         together without an effect on ω_d, because T_d moves at few frequencies{}",
        if *.speed_control { " (the engine's own speed control takes one pole)" } else { "" },
        if *.speed_control {
            "; record it with a wide-band T_d*, or motored in speed control (Unfired_N_NT), or take the shaft from another route"
        } else {
            " or follows ω_d alone; record Unfired_N_NT for longer and with larger steps of N_d*, or take the shaft from \
             another route (BS_T_NT, WhiteNoise_T_TN)"
        }
    )]
    CoefficientsNotSeparated {
        /// Poles of the black box.
        poles: usize,
        /// Its coefficients.
        coefficients: usize,
        /// True where the engine controls its speed.
        speed_control: bool,
    },
    /// The coefficients are not those of two masses.
    #[error(
        "the coefficients are far from those of two masses and a spring, so they show neither K and B nor the inertias; \
         take the shaft from another route, and check the sign and unit of T_d"
    )]
    NotTwoMasses,
}
