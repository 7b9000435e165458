//! MDF: from what the crate `mdf` reads to a recording or a catalogue, and back ([`write`]).

mod failure;
mod plan;
mod write;

use ::mdf::{Attachment, Event, Mdf, Source};
use work::Context;

use crate::required::require_names;
use crate::{Catalogue, Finding, Format, Recording, RecordingError, Selection, StartTime};
use failure::failure;
use plan::Assembly;
pub(crate) use plan::some_text;
pub use write::{encode_mdf4, write_mdf4};

/// Contents of a file beside its channels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Extras {
    /// Files carried with the measurement, or referred to.
    pub attachments: Vec<Attachment>,
    /// Events during the measurement.
    pub events: Vec<Event>,
}

/// Returns true if the first bytes are those of an MDF file.
pub(crate) fn is_mdf(bytes: &[u8]) -> bool {
    bytes.starts_with(b"MDF     ") || bytes.starts_with(b"UnFinMF ")
}

pub(crate) fn decode<S: Source>(
    name: &str,
    source: S,
    selection: &Selection,
    row_distance_s: Option<f64>,
    context: &Context,
) -> Result<Recording, RecordingError> {
    let file = Mdf::open(source).map_err(|e| failure(name, e))?;
    let groups = plan::groups(name, &file, row_distance_s)?;
    let names = groups.iter().flat_map(|g| &g.channels);
    require_names(name, selection, names.map(|c| c.name))?;
    let built = Assembly::build(name, &file, selection, &groups, context)?;
    Ok(Recording {
        format: Format::Mdf { version: file.version() },
        comment: file.comment().map(str::to_owned),
        start_time: start_time(&file),
        rasters: built.rasters,
        channels: built.channels,
        findings: with_findings(&file, built.findings),
    })
}

pub(crate) fn catalogue<S: Source>(name: &str, source: S) -> Result<Catalogue, RecordingError> {
    let file = Mdf::open(source).map_err(|e| failure(name, e))?;
    let groups = plan::groups(name, &file, None)?;
    let (rasters, channels, findings) = plan::list(name, &file, &groups)?;
    Ok(Catalogue {
        format: Format::Mdf { version: file.version() },
        comment: file.comment().map(str::to_owned),
        start_time: start_time(&file),
        rasters,
        channels,
        findings: with_findings(&file, findings),
    })
}

/// Attachments and events.
pub(crate) fn extras<S: Source>(name: &str, source: S) -> Result<Extras, RecordingError> {
    let file = Mdf::open(source).map_err(|e| failure(name, e))?;
    Ok(Extras { attachments: file.attachments().to_vec(), events: file.events().to_vec() })
}

/// Findings about the file, then those about its groups and channels.
fn with_findings<S: Source>(file: &Mdf<S>, of_groups: Vec<Finding>) -> Vec<Finding> {
    let mut findings = Vec::new();
    if file.findings().contains(&::mdf::Finding::NotFinalised) {
        findings.push(Finding::NotFinalised);
    }
    let cut = file.findings().iter().find_map(|f| match f {
        ::mdf::Finding::CutOff { offset } | ::mdf::Finding::ListEndsEarly { offset } => Some(*offset),
        _ => None,
    });
    if let Some(offset) = cut.filter(|_| findings.is_empty()) {
        findings.push(Finding::CutOff { offset });
    }
    findings.extend(of_groups);
    findings
}

fn start_time<S: Source>(file: &Mdf<S>) -> Option<StartTime> {
    let ::mdf::StartTime { nanoseconds, is_local, utc_offset_min } = file.start_time()?;
    Some(StartTime { nanoseconds, is_local, utc_offset_min })
}
