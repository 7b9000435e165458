//! The speed controller: PI with delay, and its feed-forward.
//!
//! T_d* is computed, hence free of noise; N_d is measured. Regressing T_d* on N_d would therefore be an
//! errors-in-variables problem with biased answers. The controller is inverted instead: from T_d* follows exactly which
//! speed error it must have seen, and the measured speed is compared with that (an output-error fit whose residual is
//! the encoder's noise).
//!
//! Controller, at its own sample time T, with e(k) = N_d(kT − τ) − N_d*(k − l):
//!
//! T_d*(k) = K_p e(k) + I(k) + k N_d*(k − f) + k_a (N_d*(k − f) − N_d*(k − f − 1))/T,  I(k + 1) = I(k) + K_i T e(k).
//!
//! Lags l and f show where the delay acts: on the measured speed, the speed error or the whole output.
//!
//! Integrating by backward or trapezoidal rule gives the same sequence with K_p less by K_i T or K_i T/2: the rule
//! cannot be determined from data, so forward Euler, which is also the exact discretisation of (6.5) under a held
//! input, is the convention here.
//!
//! # Source
//! Thesis (6.2), (6.5)–(6.7); Ljung 1999, §4.3 (output error), §9.4.

mod analysis;
mod data;
mod demand_lags;
mod discrete;
mod encoder;
mod feed_forward;
mod fit;
mod forward;
mod inverse;
mod lag;
mod limit;
mod recordings;
mod terms;
mod variance;

pub use analysis::{
    Controller, ControllerRecording, FeedForwardFound, FeedForwardRecording, LimitRecording, SpeedControl,
    speed_control,
};
pub use discrete::{Discrete, IntegrationRule};
pub use encoder::Encoder;
pub use feed_forward::{GAINS_APART_STANDARD_ERRORS, estimate_feed_forward};
pub use fit::estimate_alone;
pub use fit::{KnownController, SpeedControllerFit, estimate, once_a_turn};
pub use forward::estimate_forward;
pub use limit::{AntiWindup, LawTest, Limit, LimitReached, limit};
pub use recordings::SpeedControllers;
pub use terms::{
    FeedForwardTerms, LEVEL, MATTERS, MapPoint, Round, Structure, Term, TermTest, Verdict, feed_forward_terms,
    structure,
};
