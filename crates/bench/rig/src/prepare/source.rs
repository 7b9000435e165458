//! One channel on its way to a signal.

use signal::Signal;

use crate::role::Role;

/// A role's channel as recorded, with the factor that makes it SI with the right sign.
pub(super) struct Source<'r> {
    pub(super) role: Role,
    pub(super) channel: &'r str,
    pub(super) raster: usize,
    pub(super) time_s: &'r [f64],
    pub(super) samples: &'r [f64],
    pub(super) unit: units::Unit,
    pub(super) factor: f64,
}

/// Uniformly sampled stretches of one channel in time order, in SI: several where long gaps interrupt it. At least one.
pub(super) type Stretches = Vec<Signal>;

pub(super) fn longest(stretches: &[Signal]) -> Option<&Signal> {
    stretches.iter().max_by(|a, b| a.duration_s().total_cmp(&b.duration_s()))
}
