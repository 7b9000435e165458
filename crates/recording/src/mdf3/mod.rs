//! MDF 2.x and 3.x: samples through falcon_mdf, texts and record counts through [`layout`].

mod layout;

use std::sync::Arc;

use falcon_mdf::io::memory::MemorySource;
use falcon_mdf::mdf3::Mdf3File;

use crate::mdf::plan::{Assembly, Group, Item, Key, ReadFailure, list};
use crate::mdf::{failure, numbers, version};
use crate::{Catalogue, Format, Recording, RecordingError, Selection, SkipReason};
use layout::{DataGroup, Layout};

pub(crate) fn decode(
    name: &str,
    bytes: &[u8],
    selection: &Selection,
) -> Result<Recording, RecordingError> {
    let version = version(name, bytes)?;
    let mut layout = Layout::read(name, bytes)?;
    let mut copy = bytes.to_vec();
    layout.limit_counts(name, &mut copy)?;
    let file =
        Mdf3File::from_source(Arc::new(MemorySource::new(copy))).map_err(|e| failure(name, e))?;
    let groups = groups(&layout);
    let read = |key| read(&file, key);
    let built = Assembly::build(name, selection, &groups, read)?;
    Ok(Recording {
        format: Format::Mdf { version },
        comment: layout.comment,
        start_time: layout.start_time,
        rasters: built.rasters,
        channels: built.channels,
        findings: built.findings,
    })
}

pub(crate) fn catalogue(name: &str, bytes: &[u8]) -> Result<Catalogue, RecordingError> {
    let version = version(name, bytes)?;
    let mut layout = Layout::read(name, bytes)?;
    layout.limit_counts(name, &mut bytes.to_vec())?;
    let (rasters, channels, findings) = list(&groups(&layout));
    Ok(Catalogue {
        format: Format::Mdf { version },
        comment: layout.comment,
        start_time: layout.start_time,
        rasters,
        channels,
        findings,
    })
}

fn read(file: &Mdf3File, (dg, cg, channel): Key) -> Result<Vec<f64>, ReadFailure> {
    let values = file.channel_physical(dg, cg, channel)?;
    numbers(values).map_err(ReadFailure::Skip)
}

fn groups(layout: &Layout) -> Vec<Group> {
    let all = layout.groups.iter().enumerate();
    all.flat_map(|(index, dg)| (0..dg.groups.len()).map(move |cg| group(dg, (index, cg))))
        .collect()
}

fn group(dg: &DataGroup, (index, cg): (usize, usize)) -> Group {
    let group = &dg.groups[cg];
    let channels = group.channels.iter().enumerate();
    let time = channels.clone().find(|(_, c)| c.is_time);
    let data = channels.filter(|(_, c)| !c.is_time);
    Group {
        name: group.comment.clone(),
        announced: group.announced,
        found: group.cycles,
        stream_bytes: dg.size(),
        time: time.map(|(i, _)| (index, cg, i)).ok_or(SkipReason::NoTime),
        channels: data
            .map(|(i, c)| Item {
                name: c.name.clone(),
                unit: c.unit.clone(),
                comment: c.comment.clone(),
                key: (index, cg, i),
                obstacle: c.obstacle(),
            })
            .collect(),
    }
}
