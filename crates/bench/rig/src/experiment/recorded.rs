//! An experiment as it was recorded.

use std::collections::BTreeMap;

use signal::Signal;

use super::{ExperimentLabel, Test};
use crate::Role;

/// One labelled recording in SI. Every signal is uniformly sampled on its own clock and free of gaps and NaN; what was
/// mended to make it so is in the diagnostics.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// The file the recording came from, as the user knows it.
    pub file: String,
    /// The experiment's label.
    pub label: ExperimentLabel,
    /// Signals by role: rad/s, Nm, 1.
    pub signals: BTreeMap<Role, Signal>,
}

impl Experiment {
    /// The signal of a role, if it was recorded.
    pub fn signal(&self, role: Role) -> Option<&Signal> {
        self.signals.get(&role)
    }

    /// Length of its longest signal, s.
    pub fn duration_s(&self) -> f64 {
        self.signals.values().map(Signal::duration_s).fold(0.0, f64::max)
    }

    /// Tells whether the label's test is `test`.
    pub fn is_test(&self, test: &Test) -> bool {
        self.label.test == *test
    }
}
