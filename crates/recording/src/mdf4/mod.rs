//! MDF 4.x: decoding on top of falcon_mdf, encoding of our own ([`write`]).
//!
//! falcon_mdf corrects announced sample counts without saying so, drops the flags of the start time, and knows no
//! clock in another group; [`layout`] reads those from the blocks themselves.

mod layout;
mod write;

use falcon_mdf::blocks::{ChannelType, SyncType};
use falcon_mdf::{ChannelGroup, DataGroup, Mf4Error, Mf4File, OpenOptions};

use crate::mdf::plan::{Assembly, Group, Item, Key, ReadFailure, list, some_text};
use crate::mdf::{failure, numbers, version};
use crate::{Catalogue, Finding, Format, Recording, RecordingError, Selection, SkipReason};
use layout::Layout;
pub use write::encode_mdf4;

/// Deflate cannot expand more than this.
const MAX_EXPANSION: u64 = 1032;

pub(crate) fn decode(
    name: &str,
    bytes: &[u8],
    selection: &Selection,
) -> Result<Recording, RecordingError> {
    let source = Source::open(name, bytes)?;
    let groups = source.groups();
    let built = Assembly::build(name, selection, &groups, |key| source.read(key))?;
    let mut findings = source.findings();
    findings.extend(built.findings);
    Ok(Recording {
        format: source.format,
        comment: some_text(source.file.comment()),
        start_time: source.layout.start_time,
        rasters: built.rasters,
        channels: built.channels,
        findings,
    })
}

pub(crate) fn catalogue(name: &str, bytes: &[u8]) -> Result<Catalogue, RecordingError> {
    let source = Source::open(name, bytes)?;
    let (rasters, channels, counted) = list(&source.groups());
    let mut findings = source.findings();
    findings.extend(counted);
    Ok(Catalogue {
        format: source.format,
        comment: some_text(source.file.comment()),
        start_time: source.layout.start_time,
        rasters,
        channels,
        findings,
    })
}

/// An opened file.
struct Source {
    file: Mf4File,
    layout: Layout,
    format: Format,
}

impl Source {
    fn open(name: &str, bytes: &[u8]) -> Result<Self, RecordingError> {
        let version = version(name, bytes)?;
        let layout = Layout::read(name, bytes)?;
        let mut copy = bytes.to_vec();
        layout.shorten_cut_blocks(&mut copy);
        let options = OpenOptions {
            max_decompressed: (bytes.len() as u64).saturating_mul(MAX_EXPANSION),
            max_alloc: copy.len().saturating_mul(4),
            ..OpenOptions::default()
        };
        let file = Mf4File::from_bytes_with_options(copy, options).map_err(|e| failure(name, e))?;
        refuse_repeated_blocks(name, &file, bytes.len() as u64)?;
        Ok(Self {
            file,
            layout,
            format: Format::Mdf { version },
        })
    }

    fn findings(&self) -> Vec<Finding> {
        let unfinalised = self.file.unfinalized().map(|_| Finding::NotFinalised);
        unfinalised.into_iter().collect()
    }

    fn groups(&self) -> Vec<Group> {
        let all = self.file.data_groups().iter();
        all.flat_map(|dg| dg.channel_groups.iter().map(move |cg| (dg, cg)))
            .filter(|(_, cg)| !cg.is_vlsd())
            .map(|(dg, cg)| self.group(dg, cg))
            .collect()
    }

    fn group(&self, dg: &DataGroup, cg: &ChannelGroup) -> Group {
        let declared = self.layout.group(cg.block_offset());
        let channels = cg.channels.iter().filter(|c| !c.is_master());
        Group {
            name: some_text(&cg.acquisition_name).or_else(|| some_text(&cg.comment)),
            // Files that were not closed announce nothing.
            announced: match declared.map_or(0, |d| d.cycles) {
                0 => cg.sample_count,
                cycles => cycles,
            },
            found: cg.sample_count,
            stream_bytes: dg.block_index().total_size(),
            time: self.time(dg, cg),
            channels: channels
                .map(|c| item(c, (dg.index, cg.index, c.index)))
                .collect(),
        }
    }

    /// The clock of a group: a channel of its own, or that of the group it refers to.
    fn time(&self, dg: &DataGroup, cg: &ChannelGroup) -> Result<Key, SkipReason> {
        let remote = self
            .layout
            .group(cg.block_offset())
            .and_then(|g| g.remote_master);
        let (dg, cg) = match remote {
            None => (dg, cg),
            Some(offset) => self.group_at(offset).ok_or(SkipReason::NoTime)?,
        };
        let master = cg.master_channel().ok_or(SkipReason::NoTime)?;
        match master.sync_type {
            SyncType::Time => Ok((dg.index, cg.index, master.index)),
            _ => Err(SkipReason::NotOverTime),
        }
    }

    fn group_at(&self, offset: u64) -> Option<(&DataGroup, &ChannelGroup)> {
        let all = self.file.data_groups().iter();
        all.flat_map(|dg| dg.channel_groups.iter().map(move |cg| (dg, cg)))
            .find(|(_, cg)| cg.block_offset() == offset)
    }

    fn read(&self, (dg, cg, channel): Key) -> Result<Vec<f64>, ReadFailure> {
        let groups = self.file.data_groups();
        let group = groups.get(dg).and_then(|g| g.channel_groups.get(cg));
        let channel = group
            .and_then(|g| g.channels.get(channel))
            .ok_or_else(|| Mf4Error::parse_error("a channel that was listed is not there"))?;
        let signal = self.file.signal(channel)?;
        let mut samples = numbers(signal.values()?).map_err(ReadFailure::Skip)?;
        let validity = signal.validity().unwrap_or_default();
        for (sample, _) in samples.iter_mut().zip(validity).filter(|(_, valid)| !valid) {
            *sample = f64::NAN;
        }
        Ok(samples)
    }
}

/// Data blocks that together are larger than the file are the same block over and over.
fn refuse_repeated_blocks(name: &str, file: &Mf4File, length: u64) -> Result<(), RecordingError> {
    let stored = |dg: &DataGroup| {
        let sizes = dg
            .block_index()
            .iter()
            .map(|(_, block)| block.compressed_size);
        sizes.fold(0, u64::saturating_add)
    };
    let groups = file.data_groups();
    match groups.iter().find(|dg| stored(dg) > length) {
        None => Ok(()),
        Some(dg) => Err(RecordingError::Damaged {
            file: name.into(),
            offset: Some(dg.data_block_offset()),
            detail: "a list of data names the same blocks repeatedly".into(),
        }),
    }
}

fn item(channel: &falcon_mdf::Channel, key: Key) -> Item {
    Item {
        name: channel.name.clone(),
        unit: channel.unit.clone(),
        comment: channel.comment.clone(),
        key,
        obstacle: obstacle(channel),
    }
}

/// What can be told against a channel without reading it.
fn obstacle(channel: &falcon_mdf::Channel) -> Option<SkipReason> {
    if let Some(reason) = channel.unreadable() {
        return Some(SkipReason::Unsupported {
            detail: reason.detail().into(),
        });
    }
    let kind = channel.value_kind();
    let kind = match channel.channel_type {
        ChannelType::VariableLength | ChannelType::MaxLength => "values of varying length",
        _ if channel.is_array() => "arrays",
        _ if !kind.is_numeric() => kind.name(),
        _ => return None,
    };
    Some(SkipReason::NotNumeric { kind: kind.into() })
}
