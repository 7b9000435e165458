//! Friction of the dynamometer from the recordings without shaft.

use part_friction::{Friction, FrictionError, FrictionOptions, estimate};
use rig::dyno_friction::EstimatedFriction;
use rig::{BenchFile, Experiment};

/// Friction and inertia of the dynamometer that all of them show together.
///
/// # Errors
/// No recording that shows them.
pub fn friction_of(experiments: &[&Experiment], bench: &BenchFile) -> Result<Friction, FrictionError> {
    let is_without_shaft = |experiment: &&Experiment| experiment.label.is_without_shaft();
    let without_shaft: Vec<&Experiment> = experiments.iter().copied().filter(is_without_shaft).collect();
    estimate(&without_shaft, FrictionOptions::of(bench))
}

/// The friction of the bench model; none where the recordings do not show it.
pub(crate) fn of_model(found: &Result<Friction, FrictionError>, bench: &BenchFile) -> Option<EstimatedFriction> {
    found.as_ref().ok()?.linear(bench.dynamometer_inertia())
}
