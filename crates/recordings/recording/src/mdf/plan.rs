//! Which channels of an MDF file are taken over, and what becomes of them.

use std::cmp::Ordering;

use ::mdf::{Address, Kind, Mdf, Quantity, Source, Values};
use work::Context;

use super::failure::failure;
use crate::heading::{seconds, unbracketed};
use crate::{Channel, ChannelInfo, Finding, Raster, RasterInfo, RecordingError, Selection, SkipReason};

/// Bytes of names, units and comments beyond which a file says the same thing over and over.
const MOST_TEXT: usize = 1 << 28;

/// A channel group, ready to be read.
pub(super) struct Group<'f> {
    index: usize,
    name: Option<String>,
    /// Samples as the file announces them; none where it was not closed and announces nothing.
    announced: Option<u64>,
    /// Samples that its data can hold, at most.
    pub(super) at_most: u64,
    /// Size of its data after decompression, with that of the groups stored between them.
    pub(super) stream_bytes: u64,
    time: Result<Clock, SkipReason>,
    /// The unit of its clock, where it is not the second.
    odd_unit: Option<&'f str>,
    pub(super) channels: Vec<Item<'f>>,
}

/// Source of the time of a group.
#[derive(Clone, Copy)]
enum Clock {
    Master(Address),
    /// Samples that are so far apart, s.
    Counted(f64),
}

/// A channel other than the clock of its group.
pub(super) struct Item<'f> {
    pub(super) name: &'f str,
    unit: &'f str,
    comment: &'f str,
    address: Address,
    obstacle: Option<SkipReason>,
}

/// The groups of a file that have channels.
pub(super) fn groups<'f, S: Source>(
    name: &str,
    file: &'f Mdf<S>,
    row_distance_s: Option<f64>,
) -> Result<Vec<Group<'f>>, RecordingError> {
    let groups = file.groups().iter().enumerate();
    let groups: Vec<_> = groups.map(|(index, group)| of(file, index, group, row_distance_s)).collect();
    let items = groups.iter().flat_map(|g| &g.channels);
    let text = items.fold(0_usize, |sum, i| sum.saturating_add(i.name.len() + i.unit.len() + i.comment.len()));
    if text <= MOST_TEXT {
        return Ok(groups);
    }
    let detail = format!("the names and comments of the channels are {text} bytes long");
    Err(RecordingError::Damaged { file: name.into(), offset: None, detail })
}

/// The unit of a clock of which the format says that it is in seconds, and the file something else.
fn odd_unit<S: Source>(file: &Mdf<S>, master: ::mdf::Master) -> Option<&str> {
    let Address { group, channel } = master.address;
    let unit = &file.groups().get(group)?.channels.get(channel)?.unit;
    Some(unit.as_ref()).filter(|unit| seconds(unbracketed(unit)) != Some((1.0, 1.0)))
}

fn of<'f, S: Source>(
    file: &'f Mdf<S>,
    index: usize,
    group: &'f ::mdf::Group,
    row_distance_s: Option<f64>,
) -> Group<'f> {
    let is_closed = !file.findings().contains(&::mdf::Finding::NotFinalised);
    let channels = group.channels.iter().enumerate().filter(|(_, c)| !c.is_master);
    Group {
        index,
        name: some_text(&group.name).or_else(|| some_text(&group.comment)),
        announced: Some(group.announced).filter(|&announced| is_closed || announced > 0),
        at_most: group.at_most,
        stream_bytes: group.stream_bytes,
        time: match group.master {
            Some(master) if master.quantity == Quantity::Time => Ok(Clock::Master(master.address)),
            Some(_) => Err(SkipReason::NotOverTime),
            None => row_distance_s.map(Clock::Counted).ok_or(SkipReason::NoTime),
        },
        odd_unit: group.master.and_then(|master| odd_unit(file, master)),
        channels: channels
            .map(|(place, c)| Item {
                name: c.name.trim(),
                unit: &c.unit,
                comment: &c.comment,
                address: Address { group: index, channel: place },
                obstacle: obstacle(c),
            })
            .collect(),
    }
}

/// Why a channel is left out, as far as it is known without reading.
fn obstacle(channel: &::mdf::Channel) -> Option<SkipReason> {
    if let Some(obstacle) = &channel.obstacle {
        return Some(SkipReason::Unsupported { detail: obstacle.to_string() });
    }
    let kind = match channel.kind {
        Kind::Number => return None,
        Kind::Text => "text",
        Kind::Bytes => "bytes",
    };
    Some(SkipReason::NotNumeric { kind: kind.into() })
}

/// Rasters, channels and findings under construction.
pub(super) struct Assembly<'a> {
    file: &'a str,
    selection: &'a Selection,
    pub(super) rasters: Vec<Raster>,
    pub(super) channels: Vec<Channel>,
    pub(super) findings: Vec<Finding>,
    /// Channels whose integers were rounded.
    rounded: Vec<Address>,
}

impl<'a> Assembly<'a> {
    /// Reads the selected channels of all groups.
    pub(super) fn build<S: Source>(
        name: &'a str,
        file: &Mdf<S>,
        selection: &'a Selection,
        groups: &[Group<'_>],
        context: &Context,
    ) -> Result<Self, RecordingError> {
        let mut assembly =
            Self { file: name, selection, rasters: vec![], channels: vec![], findings: vec![], rounded: vec![] };
        // Everything is read in one go, so that groups stored between each other are gone through once.
        let mut addresses = Vec::new();
        let mut chosen = Vec::new();
        for group in groups {
            let before = assembly.findings.len();
            let items = assembly.usable(group)?;
            let skipped = assembly.findings.split_off(before);
            if let (Ok(time), false) = (&group.time, items.is_empty()) {
                plausible(name, group, items.len() + 1)?;
                if let Clock::Master(address) = time {
                    addresses.push(*address);
                }
                addresses.extend(items.iter().map(|i| i.address));
            }
            chosen.push((group, items, skipped));
        }
        let mut values = file.read(&addresses, context).map_err(|e| failure(name, e))?.into_iter();
        assembly.rounded = file.rounded();
        for (group, items, skipped) in chosen {
            assembly.findings.extend(skipped);
            if let (Ok(clock), false) = (group.time.as_ref(), items.is_empty()) {
                assembly.group(group, *clock, &items, &mut values)?;
            }
        }
        Ok(assembly)
    }

    fn group(
        &mut self,
        group: &Group<'_>,
        clock: Clock,
        items: &[&Item<'_>],
        values: &mut impl Iterator<Item = Values>,
    ) -> Result<(), RecordingError> {
        let (mut time_s, master, distance_s) = match clock {
            Clock::Master(address) => (Some(self.numbers("time", values.next())?), Some(address), 0.0),
            Clock::Counted(distance_s) => (None, None, distance_s),
        };
        let master = master.iter().map(|address| ("time", address));
        for (channel, address) in master.chain(items.iter().map(|item| (item.name, &item.address))) {
            if self.rounded.contains(address) {
                self.findings.push(Finding::RoundedIntegers { channel: channel.into() });
            }
        }
        for item in items {
            let samples = self.numbers(item.name, values.next())?;
            let time_s = time_s.get_or_insert_with(|| (0..samples.len()).map(|row| row as f64 * distance_s).collect());
            if samples.len() != time_s.len() {
                let detail = format!("it has {} samples, its clock {}", samples.len(), time_s.len());
                return Err(self.damaged(item.name, detail));
            }
            self.channels.push(Channel {
                name: item.name.to_owned(),
                unit: item.unit.to_owned(),
                comment: item.comment.to_owned(),
                raster: self.rasters.len(),
                samples,
            });
        }
        let time_s = time_s.unwrap_or_default();
        self.findings.extend(group.findings(self.rasters.len(), time_s.len() as u64));
        self.rasters.push(Raster { time_s, name: group.name.clone() });
        Ok(())
    }

    fn numbers(&self, channel: &str, values: Option<Values>) -> Result<Vec<f64>, RecordingError> {
        match values {
            Some(Values::Numbers(numbers)) => Ok(numbers),
            _ => Err(self.damaged(channel, "it holds no numbers".into())),
        }
    }

    fn damaged(&self, channel: &str, detail: String) -> RecordingError {
        RecordingError::DamagedChannel { file: self.file.into(), channel: channel.into(), detail }
    }

    /// The selected channels that nothing is known against.
    fn usable<'g>(&mut self, group: &'g Group<'g>) -> Result<Vec<&'g Item<'g>>, RecordingError> {
        let mut usable = Vec::new();
        for item in &group.channels {
            if !self.selection.takes(item.name) {
                continue;
            }
            match item.obstacle.as_ref().or(group.time.as_ref().err()) {
                None => usable.push(item),
                Some(reason) => self.skip(item, reason.clone())?,
            }
        }
        Ok(usable)
    }

    fn skip(&mut self, item: &Item<'_>, reason: SkipReason) -> Result<(), RecordingError> {
        if self.selection.insists_on(item.name) {
            let (file, channel) = (self.file.into(), item.name.into());
            return Err(RecordingError::UnusableChannel { file, channel, reason });
        }
        self.findings.push(Finding::SkippedChannel { channel: item.name.into(), reason });
        Ok(())
    }
}

type Listed = (Vec<RasterInfo>, Vec<ChannelInfo>, Vec<Finding>);

/// The rasters and channels of all groups. Samples are read only where records of several groups have to be counted.
pub(super) fn list<S: Source>(name: &str, file: &Mdf<S>, groups: &[Group<'_>]) -> Result<Listed, RecordingError> {
    let (mut rasters, mut channels, mut findings) = (Vec::new(), Vec::new(), Vec::new());
    for group in groups {
        let first = channels.len();
        for item in &group.channels {
            match item.obstacle.as_ref().or(group.time.as_ref().err()) {
                Some(reason) => {
                    findings.push(Finding::SkippedChannel { channel: item.name.into(), reason: reason.clone() });
                }
                None => channels.push(ChannelInfo {
                    name: item.name.into(),
                    unit: item.unit.into(),
                    comment: item.comment.into(),
                    raster: rasters.len(),
                }),
            }
        }
        if channels.len() > first {
            let found = file.count(group.index).map_err(|e| failure(name, e))?;
            findings.extend(group.findings(rasters.len(), found));
            let samples = usize::try_from(found).ok();
            rasters.push(RasterInfo { name: group.name.clone(), samples });
        }
    }
    Ok((rasters, channels, findings))
}

impl Group<'_> {
    /// Findings about its clock, which has become a raster of so many samples.
    fn findings(&self, raster: usize, found: u64) -> impl Iterator<Item = Finding> + use<> {
        let count = self.announced.and_then(|announced| match announced.cmp(&found) {
            Ordering::Equal => None,
            Ordering::Greater => Some(Finding::MissingSamples { raster, announced, found }),
            Ordering::Less => Some(Finding::UnannouncedSamples { raster, announced, found }),
        });
        let unit = self.odd_unit.map(|unit| Finding::IgnoredTimeUnit { raster, unit: unit.to_owned() });
        count.into_iter().chain(unit)
    }
}

/// `None` for text that is empty or blank.
pub(crate) fn some_text(text: &str) -> Option<String> {
    let text = text.trim();
    (!text.is_empty()).then(|| text.to_owned())
}

/// Guards against files whose channels overlap so much that decoding would need memory out of proportion: a sample
/// takes at least one bit of a record, and records are seldom described more than a few times over.
fn plausible(file: &str, group: &Group<'_>, channels: usize) -> Result<(), RecordingError> {
    let (samples, stream_bytes) = (group.at_most, group.stream_bytes);
    let decoded = (channels as u64).saturating_mul(samples);
    if decoded <= stream_bytes.saturating_mul(32).saturating_add(4096) {
        return Ok(());
    }
    Err(RecordingError::Damaged {
        file: file.into(),
        offset: None,
        detail: format!("{channels} channels of {samples} samples are described on {stream_bytes} bytes of data"),
    })
}
