//! A recorded run that is judged: the channels that the judgement compares, and no others.

use std::collections::BTreeMap;

use recording::Recording;

use super::log::Log;
use super::source::{Source, Stretches, longest};
use super::{PrepareError, clock, cut, left_out, map, samples};
use crate::bench_file::RunChannels;
use crate::diagnostics::Diagnostic;
use crate::experiment::{Experiment, ExperimentLabel};
use crate::role::Role;

/// Samples of a spike at most.
const SPIKE: usize = 3;
/// No engine and no dynamometer changes its speed faster, rad/s²: 15 000 rpm/s.
const FASTEST_RAD_S2: f64 = 1570.0;

/// Maps, converts and mends what a judgement compares: of each list the first role whose channel is there and usable.
///
/// Other channels are not looked at, so that none of them can cost a part of the run. Samples that rest or repeat are
/// values of their time. Only what is no value is left out: what is no number, and spikes of a speed. Gaps are treated
/// as in [`prepare`](super::prepare).
///
/// # Errors
///
/// [`PrepareError`] if no role is usable, or if gaps leave no time that all have in common.
pub fn prepare_run(
    file: &str,
    recording: &Recording,
    run: &RunChannels,
    compared: &[&[Role]],
    label: ExperimentLabel,
) -> Result<(Experiment, Vec<Diagnostic>), PrepareError> {
    let mut log = Log::new(file);
    log.reader_findings(recording);
    let mut mended = BTreeMap::new();
    for roles in compared {
        let chosen = roles.iter().find_map(|role| Some((*role, usable(recording, *role, run, &mut log)?)));
        mended.extend(chosen);
    }
    if mended.is_empty() {
        return Err(PrepareError::NothingUsable { file: file.to_owned(), diagnostics: log.diagnostics });
    }
    let Some(signals) = cut::longest_common(mended, &mut log) else {
        return Err(PrepareError::NoCommonStretch { file: file.to_owned(), diagnostics: log.diagnostics });
    };
    Ok((Experiment { file: file.to_owned(), label, signals }, log.diagnostics))
}

/// The stretches of a role's channel, if it is named, there, and possible.
fn usable(recording: &Recording, role: Role, run: &RunChannels, log: &mut Log) -> Option<Stretches> {
    let source = map::source(recording, role, run.channels.get(&role)?, log)?;
    let left_out = left_out(&source, log);
    let stretches = clock::uniform_stretches(&source, &left_out, log)?;
    samples::is_plausible(&source, longest(&stretches)?, run.speed_limit_rad_s, log).then_some(stretches)
}

/// A torque may have any value. A speed has none from which it would have to change faster than any engine does, to
/// both sides.
fn left_out(source: &Source<'_>, log: &mut Log) -> Vec<bool> {
    if !matches!(source.role, Role::DynoSpeed | Role::EngineSpeed) {
        return Vec::new();
    }
    let changes = |i: usize, j: usize| {
        let [from, to] = [i, j].map(|at| Some((source.time_s.get(at)?, source.factor * source.samples.get(at)?)));
        from.zip(to).is_some_and(|((t, x), (u, y))| (y - x).abs() > FASTEST_RAD_S2 * (u - t).abs())
    };
    // Within a spike of several samples the speed need not change.
    let is_impossible = |i: &usize| {
        (1..=SPIKE).any(|by| changes(*i, i + by))
            && (1..=SPIKE).any(|by| i.checked_sub(by).is_some_and(|before| changes(before, *i)))
    };
    left_out::spikes_if(source, &is_impossible, log)
}
