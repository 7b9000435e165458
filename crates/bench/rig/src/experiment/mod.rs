//! Experiments: what they are called, what is demanded in them, and what was recorded.
//!
//! A *plan* ([`ExperimentPlan`]) is what is to be done to a bench, demands as waveforms; plans come from the catalogue
//! ([`catalogue`], the experiments of the method with their parameters) or from demands of one's own ([`free_form`]).
//! Its [`Demands`] are the same numbers wherever they are used: written to a demand file, predicted, or run on the
//! virtual bench. An [`Experiment`] is a labelled recording of one, in SI.

pub mod catalogue;
mod choice;
mod demands;
mod error;
pub mod free_form;
mod label;
mod plan;
mod recorded;
mod spectrum;
mod test;
mod waveform;

pub use choice::{Choice, PassedOver, Sought};
pub use demands::{DemandKind, Demands, NamedDemand};
pub use error::PlanError;
pub use label::{ControlMode, Excitation, ExperimentLabel, LabelError};
pub use plan::{ExperimentPlan, TorqueTarget};
pub use recorded::Experiment;
pub use spectrum::ExcitationSpectrum;
pub use test::Test;
pub use waveform::{Sine, Waveform};

/// Time from one update of the controllers to the next, s: how often a speed demand may change.
pub const UPDATE_S: f64 = 0.001;
/// The automation system's torque demands (and throttle and ignition) change only once in this time, s.
pub const DEMAND_HOLD_S: f64 = 0.01;
