//! The signals that a smoother needs.

use rig::estimation::EstimateError;
use rig::{Experiment, Role};
use signal::Signal;

/// Instants at which T_d is read within a sample of N_d.
pub(super) const WITHIN: usize = 4;

/// A signal that is long enough.
///
/// # Errors
/// It is missing or too short.
pub fn needed(experiment: &Experiment, role: Role) -> Result<&Signal, EstimateError> {
    let file = || experiment.file.clone();
    let signal = experiment.signal(role).ok_or_else(|| EstimateError::MissingSignal { file: file(), role })?;
    if signal.duration_s() < SHORTEST_S {
        return Err(EstimateError::TooShort { file: file(), duration_s: signal.duration_s(), needed_s: SHORTEST_S });
    }
    Ok(signal)
}

/// Shortest recording, s.
pub(super) const SHORTEST_S: f64 = 2.0;
