//! The longest stretch that is uninterrupted in every signal.

use std::collections::BTreeMap;

use signal::Signal;

use crate::align::{cut, window_of};
use crate::diagnostics::{Finding, Severity};
use crate::prepare::log::Log;
use crate::prepare::source::Stretches;
use crate::role::Role;

/// Each role's signal. Without long gaps that is all of it; with them, what lies in the longest common stretch.
pub(super) fn longest_common(mended: BTreeMap<Role, Stretches>, log: &mut Log) -> Option<BTreeMap<Role, Signal>> {
    if mended.values().all(|stretches| stretches.len() == 1) {
        return Some(
            mended.into_iter().filter_map(|(role, stretches)| Some((role, stretches.into_iter().next()?))).collect(),
        );
    }
    let whole = (start_of(&mended)?, end_of(&mended)?);
    let (start_s, end_s) = longest(common(mended.values()))?;
    log.file(
        Severity::Warning,
        Some(start_s),
        Finding::Cut { kept_s: (start_s, end_s), lost_s: (whole.1 - whole.0) - (end_s - start_s) },
    );
    let kept = |stretches: &Stretches| stretches.iter().map(|s| cut(s, start_s, end_s)).find(|s| s.len() >= 2);
    let signals: BTreeMap<Role, Signal> =
        mended.iter().filter_map(|(role, stretches)| Some((*role, kept(stretches)?))).collect();
    (signals.len() == mended.len()).then_some(signals)
}

fn start_of(mended: &BTreeMap<Role, Stretches>) -> Option<f64> {
    mended.values().flatten().map(|stretch| stretch.start_s).min_by(f64::total_cmp)
}

fn end_of(mended: &BTreeMap<Role, Stretches>) -> Option<f64> {
    mended.values().flatten().map(Signal::end_s).max_by(f64::total_cmp)
}

/// The windows in which every channel is uninterrupted.
fn common<'s>(channels: impl Iterator<Item = &'s Stretches>) -> Vec<(f64, f64)> {
    let mut windows = vec![(f64::NEG_INFINITY, f64::INFINITY)];
    for stretches in channels {
        let overlaps = windows.iter().flat_map(|&(from, to)| {
            stretches.iter().map(window_of).map(move |(start, end)| (from.max(start), to.min(end)))
        });
        windows = overlaps.filter(|(from, to)| from < to).collect();
    }
    windows
}

fn longest(windows: Vec<(f64, f64)>) -> Option<(f64, f64)> {
    windows.into_iter().max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)))
}
