//! A line as it shows in one signal.

use rig::Role;
use signal::Signal;

use super::resonance::BroadPeak;
use super::search::Lines;
use crate::lines::track::OrderTrack;

/// A signal of a part with what was found in it.
pub(super) struct Shown {
    pub(super) role: Role,
    pub(super) signal: Signal,
    pub(super) lines: Lines,
    pub(super) broad: Vec<BroadPeak>,
    /// Orders, where the speed changes.
    pub(super) tracks: Vec<OrderTrack>,
}
