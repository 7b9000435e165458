//! Samples of a recorded signal.

use recording::Recording;
use rig::experiment::UPDATE_S;

/// A channel and the time between its samples; nothing of one that was not recorded.
pub(super) fn sampled<'a>(recording: &'a Recording, name: &str) -> (&'a [f64], f64) {
    let Some(channel) = recording.channel(name) else { return (&[], UPDATE_S) };
    let sample_time_s = match recording.time_s(channel) {
        Some(&[first, second, ..]) => second - first,
        _ => UPDATE_S,
    };
    (&channel.samples, sample_time_s)
}
