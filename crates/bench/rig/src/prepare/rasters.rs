//! Check that the rasters of a recording share one clock: time stamps that begin apart, and clocks that run apart.

use std::collections::BTreeMap;

use signal::Signal;
use signal::drift::{Drift, relative_drift};

use crate::diagnostics::{Finding, Severity};
use crate::prepare::log::Log;
use crate::prepare::source::Source;
use crate::role::Role;

/// Rasters whose time stamps begin and end this far apart, in the same direction, are offset, s.
const OFFSET_S: f64 = 0.1;
/// An offset and a difference in length are separated by this ratio.
const OFFSET_OVER_STRETCH: f64 = 10.0;
/// Rasters whose lengths differ by more than this may have clocks that run apart by as much: small drifts are searched
/// for anyway.
const STRETCHED: f64 = 1.5e-3;
/// A drift must exceed its standard error by this factor.
const SIGNIFICANCE: f64 = 5.0;
/// A drift must add up to this share of the fastest sample time over the recording; time stamps are not trusted
/// further.
const TRUSTED_SHARE: f64 = 0.05;

pub(super) fn check(sources: &[Source<'_>], signals: &BTreeMap<Role, Signal>, log: &mut Log) {
    let there = |source: &&Source<'_>| signals.contains_key(&source.role);
    let Some(first) = sources.iter().filter(there).find(|source| source.role == Role::DynoSpeed) else { return };
    let mut others: BTreeMap<usize, Vec<&Source<'_>>> = BTreeMap::new();
    for source in sources.iter().filter(there).filter(|source| source.raster != first.raster) {
        others.entry(source.raster).or_default().push(source);
    }
    let is_reference = |source: &&Source<'_>| {
        source.raster == first.raster && matches!(source.role, Role::DynoSpeed | Role::DynoTorqueDemand)
    };
    let references: Vec<&Source<'_>> = sources.iter().filter(there).filter(is_reference).collect();
    for raster in others.values() {
        check_offset(first, raster[0], log);
        check_drift(&references, raster, signals, log);
    }
}

/// Time stamps that begin and end equally far apart: the rasters may count from different instants.
fn check_offset(first: &Source<'_>, other: &Source<'_>, log: &mut Log) {
    let (Some(a), Some(b)) = (ends(first.time_s), ends(other.time_s)) else { return };
    let (begin_s, end_s) = (b.0 - a.0, b.1 - a.1);
    let (offset_s, stretch_s) = (0.5 * (begin_s + end_s), (end_s - begin_s).abs());
    if begin_s.abs().min(end_s.abs()) > OFFSET_S && offset_s.abs() > OFFSET_OVER_STRETCH * stretch_s {
        let finding = Finding::ClockOffset { against: first.channel.to_owned(), offset_s };
        log.channel(Severity::Warning, other.channel, None, finding);
    }
}

fn ends(time_s: &[f64]) -> Option<(f64, f64)> {
    Some((*time_s.first()?, *time_s.last()?))
}

/// The drift of a signal against a reference: a small one, or one that makes both rasters equally long, if the signals
/// confirm it.
fn drift(reference: &Signal, signal: &Signal) -> Option<Drift> {
    let stretch = signal.duration_s() / reference.duration_s();
    let as_stamped = relative_drift(reference, signal).ok();
    if (stretch - 1.0).abs() < STRETCHED {
        return as_stamped;
    }
    let step_s = signal.sample_time_s / stretch;
    let start_s = reference.start_s + (signal.start_s - reference.start_s) / stretch;
    let shrunk = Signal { start_s, sample_time_s: step_s, samples: signal.samples.clone() };
    let of_shrunk = relative_drift(reference, &shrunk).ok().map(|Drift { rate, standard_error }| Drift {
        rate: (1.0 + rate) * stretch - 1.0,
        standard_error: standard_error * stretch,
    });
    as_stamped.into_iter().chain(of_shrunk).min_by(|a, b| a.standard_error.total_cmp(&b.standard_error))
}

/// A clock that runs apart, by the channels of two rasters that show it best. T_d* is the cause of the torques, so
/// their relation is that of one input; N_d has the engine as a second one.
fn check_drift(references: &[&Source<'_>], raster: &[&Source<'_>], signals: &BTreeMap<Role, Signal>, log: &mut Log) {
    let pairs = references.iter().flat_map(|first| raster.iter().map(move |source| (first, source)));
    let drifts = pairs.filter_map(|(first, source)| {
        let (reference, signal) = (&signals[&first.role], &signals[&source.role]);
        Some((first, source, drift(reference, signal)?))
    });
    let best = drifts.min_by(|a, b| a.2.standard_error.total_cmp(&b.2.standard_error));
    let Some((first, source, Drift { rate, standard_error })) = best else { return };
    let (reference, signal) = (&signals[&first.role], &signals[&source.role]);
    let duration_s = signal.end_s().min(reference.end_s()) - signal.start_s.max(reference.start_s);
    let fastest_s = reference.sample_time_s.min(signal.sample_time_s);
    if rate.abs() > SIGNIFICANCE * standard_error && rate.abs() * duration_s > TRUSTED_SHARE * fastest_s {
        let against = first.channel.to_owned();
        let finding = Finding::ClockDrift { against, rate, standard_error, apart_s: rate * duration_s };
        log.channel(Severity::Warning, source.channel, None, finding);
    }
}
