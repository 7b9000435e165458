//! From roles to the channels of a recording.

use recording::Recording;
use recording::names::closest;
use units::{self, Unit};

use crate::bench_file::{BenchFile, ChannelMapping};
use crate::diagnostics::{Finding, Severity};
use crate::experiment::ExperimentLabel;
use crate::prepare::log::Log;
use crate::prepare::source::Source;
use crate::role::{Role, parse_unit_of_role};

/// Channel names suggested in place of a missing one.
const SUGGESTIONS: usize = 3;

/// The channels of the roles that are there and have a fitting unit.
pub(super) fn sources<'r>(
    recording: &'r Recording,
    bench_file: &BenchFile,
    label: &ExperimentLabel,
    log: &mut Log,
) -> Vec<Source<'r>> {
    let roles = bench_file.channels.iter();
    let is_absent = |role: &Role, mapping: &ChannelMapping| {
        label.is_without_shaft() && is_beyond_shaft(*role) && recording.channel(&mapping.name).is_none()
    };
    roles
        .filter(|(role, mapping)| !is_absent(role, mapping))
        .filter_map(|(role, mapping)| source(recording, *role, mapping, log))
        .collect()
}

/// The channel of a role, if it is there and has a fitting unit.
pub(super) fn source<'r>(
    recording: &'r Recording,
    role: Role,
    mapping: &ChannelMapping,
    log: &mut Log,
) -> Option<Source<'r>> {
    let Some(channel) = recording.channel(&mapping.name) else {
        let names = recording.channels.iter().map(|channel| channel.name.as_str());
        let finding = Finding::MissingChannel { role, closest: closest(&mapping.name, names, SUGGESTIONS) };
        let severity = if role == Role::Throttle { Severity::Note } else { Severity::Warning };
        log.channel(severity, &mapping.name, None, finding);
        return None;
    };
    let unit = unit(role, mapping, &channel.unit, log)?;
    Some(Source {
        role,
        channel: &channel.name,
        raster: channel.raster,
        time_s: recording.time_s(channel).unwrap_or(&[]),
        samples: &channel.samples,
        unit,
        factor: unit.factor * mapping.signed_factor(),
    })
}

/// Tells whether a role is of the engine's side of the shaft: with the shaft off there is nothing to measure.
fn is_beyond_shaft(role: Role) -> bool {
    matches!(role, Role::EngineSpeed | Role::SystemShaftTorque | Role::FlangeTorque)
}

fn unit(role: Role, mapping: &ChannelMapping, recorded: &str, log: &mut Log) -> Option<Unit> {
    if let Some(unit) = mapping.unit {
        return Some(unit);
    }
    match parse_unit_of_role(recorded, role) {
        Ok(unit) => Some(unit),
        Err(_) => {
            let finding = Finding::UnfitUnit { role, unit: recorded.to_owned() };
            log.channel(Severity::Error, &mapping.name, None, finding);
            None
        }
    }
}
