//! Which channels of an MDF file are taken over, and what becomes of them.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::ops::Range;

use ::mdf::{Address, Kind, Mdf, Numbers, Quantity, Source};
use work::Context;

use super::failure::failure;
use crate::heading::{seconds, unbracketed};
use crate::part::{ClockShape, Each, Part, STEP, Series};
use crate::required::require_names;
use crate::source::Shared;
use crate::{
    Channel, ChannelInfo, Finding, Format, Raster, RasterInfo, Recording, RecordingError, Selection, SkipReason,
    StartTime,
};

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

/// A group of which channels are selected.
struct Chosen<'f> {
    group: Group<'f>,
    items: Vec<Item<'f>>,
    /// Findings on selected channels that cannot be taken over.
    skipped: Vec<Finding>,
}

impl<'f> Chosen<'f> {
    /// The clock, where channels of the group are taken over.
    fn clock(&self) -> Option<Clock> {
        self.group.time.as_ref().ok().copied().filter(|_| !self.items.is_empty())
    }

    /// Addresses that are read: the clock, where it is stored, and the channels.
    fn addresses(&self) -> impl Iterator<Item = Address> {
        let master = match self.clock() {
            Some(Clock::Master(address)) => Some(address),
            _ => None,
        };
        let items = self.items.iter().filter(|_| self.clock().is_some());
        master.into_iter().chain(items.map(|item| item.address))
    }

    /// The group whose records are counted for the clock.
    fn counted(&self) -> usize {
        match self.group.time {
            Ok(Clock::Master(address)) => address.group,
            _ => self.group.index,
        }
    }
}

/// The selected channels of a file.
pub(super) struct Choice<'f> {
    name: &'f str,
    file: &'f Mdf<Shared>,
    groups: Vec<Chosen<'f>>,
}

impl<'f> Choice<'f> {
    pub(super) fn new(
        name: &'f str,
        file: &'f Mdf<Shared>,
        selection: &Selection,
        row_distance_s: Option<f64>,
    ) -> Result<Self, RecordingError> {
        let groups = groups(name, file, row_distance_s)?;
        require_names(name, selection, groups.iter().flat_map(|g| &g.channels).map(|c| c.name))?;
        let groups = groups.into_iter().map(|group| chosen(name, group, selection)).collect::<Result<_, _>>()?;
        Ok(Self { name, file, groups })
    }

    /// Reads all samples. Everything is read in one go, so that groups stored between each other are gone through once.
    pub(super) fn whole(&self, context: &Context) -> Result<Recording, RecordingError> {
        for chosen in self.timed() {
            plausible(self.name, &chosen.group, chosen.items.len() + 1)?;
        }
        let addresses: Vec<Address> = self.groups.iter().flat_map(Chosen::addresses).collect();
        let numbers = self.file.numbers(&addresses, context).map_err(|e| failure(self.name, e))?;
        self.recording(numbers, None)
    }

    /// The groups that become rasters.
    fn timed(&self) -> impl Iterator<Item = &Chosen<'f>> {
        self.groups.iter().filter(|chosen| chosen.clock().is_some())
    }

    fn recording(&self, numbers: Numbers, rows: Option<&[Rows]>) -> Result<Recording, RecordingError> {
        let mut assembly = Assembly {
            file: self.name,
            rounded: numbers.rounded,
            rasters: Vec::new(),
            channels: Vec::new(),
            findings: Vec::new(),
        };
        let mut columns = numbers.columns.into_iter();
        for chosen in &self.groups {
            assembly.findings.extend(chosen.skipped.iter().cloned());
            if let Some(clock) = chosen.clock() {
                let rows = rows.and_then(|rows| rows.get(assembly.rasters.len()));
                assembly.group(chosen, clock, rows, &mut columns)?;
            }
        }
        Ok(Recording {
            format: Format::Mdf { version: self.file.version() },
            comment: self.file.comment().map(str::to_owned),
            start_time: start_time(self.file),
            rasters: assembly.rasters,
            channels: assembly.channels,
            findings: with_findings(self.file, assembly.findings),
        })
    }

    fn numbers(
        &self,
        addresses: &[Address],
        rows: &HashMap<usize, Range<u64>>,
        context: &Context,
    ) -> Result<Numbers, RecordingError> {
        let rows = |group: usize| rows.get(&group).cloned().unwrap_or(0..0);
        self.file.read_rows(addresses, &rows, context).map_err(|e| failure(self.name, e))
    }

    /// Records of a group; the first call goes through those that are mixed with others.
    fn count(&self, group: usize) -> Result<u64, RecordingError> {
        self.file.count(group).map_err(|e| failure(self.name, e))
    }
}

/// Some samples of a raster, and how many it has.
struct Rows {
    rows: Range<u64>,
    all: u64,
}

impl Part for Choice<'_> {
    fn clocks(&self) -> Result<Vec<ClockShape>, RecordingError> {
        let clock = |chosen: &Chosen<'_>| {
            let (samples, times) = (self.count(chosen.group.index)?, self.count(chosen.counted())?);
            if let (true, Some(item)) = (samples != times, chosen.items.first()) {
                return Err(unequal(self.name, item.name, samples, times));
            }
            Ok(ClockShape { samples, grain: self.file.grain(chosen.counted()), is_out_of_order: false })
        };
        self.timed().map(clock).collect()
    }

    fn channels(&self) -> Vec<(String, usize)> {
        let names = |(raster, chosen): (usize, &Chosen<'_>)| {
            chosen.items.iter().map(|item| (item.name.to_owned(), raster)).collect::<Vec<_>>()
        };
        self.timed().enumerate().flat_map(names).collect()
    }

    fn stamps(&self, clock: usize, rows: Range<u64>, context: &Context) -> Result<Vec<f64>, RecordingError> {
        match self.timed().nth(clock).and_then(Chosen::clock) {
            Some(Clock::Counted(distance_s)) => Ok(rows.map(|row| row as f64 * distance_s).collect()),
            Some(Clock::Master(address)) => {
                let rows = HashMap::from([(address.group, rows)]);
                Ok(self.numbers(&[address], &rows, context)?.columns.pop().unwrap_or_default())
            }
            None => Ok(Vec::new()),
        }
    }

    fn read(&self, rows: &[Range<u64>], context: &Context) -> Result<Recording, RecordingError> {
        let (mut of_groups, mut of_rasters) = (HashMap::new(), Vec::new());
        for (chosen, rows) in self.timed().zip(rows) {
            of_groups.insert(chosen.group.index, rows.clone());
            of_groups.insert(chosen.counted(), rows.clone());
            of_rasters.push(Rows { rows: rows.clone(), all: self.count(chosen.group.index)? });
        }
        let addresses: Vec<Address> = self.groups.iter().flat_map(Chosen::addresses).collect();
        let numbers = self.numbers(&addresses, &of_groups, context)?;
        self.recording(numbers, Some(&of_rasters))
    }

    fn visit(&self, context: &Context, each: Each<'_>) -> Result<(), RecordingError> {
        let (mut addresses, mut series, mut channels) = (Vec::new(), Vec::new(), 0..);
        for (raster, chosen) in self.timed().enumerate() {
            plausible(self.name, &chosen.group, chosen.items.len() + 1)?;
            match chosen.clock() {
                Some(Clock::Master(_)) => series.push(Series::Clock(raster)),
                _ => counted(self, raster, self.count(chosen.group.index)?, each, context)?,
            }
            series.extend(channels.by_ref().take(chosen.items.len()).map(Series::Channel));
            addresses.extend(chosen.addresses());
        }
        let each = |answer: usize, first: u64, numbers: &[f64]| each(series[answer], first, numbers);
        self.file.visit(&addresses, context, &each).map_err(|e| failure(self.name, e))
    }
}

/// Hands on the stamps of a clock that is not stored.
fn counted(
    choice: &Choice<'_>,
    raster: usize,
    samples: u64,
    each: Each<'_>,
    context: &Context,
) -> Result<(), RecordingError> {
    for first in (0..samples).step_by(STEP) {
        let stamps = choice.stamps(raster, first..samples.min(first + STEP as u64), context)?;
        each(Series::Clock(raster), first, &stamps);
    }
    Ok(())
}

/// The selected channels of a group, of which some may not be there as numbers over time.
fn chosen<'f>(file: &str, mut group: Group<'f>, selection: &Selection) -> Result<Chosen<'f>, RecordingError> {
    let (mut items, mut skipped) = (Vec::new(), Vec::new());
    for item in std::mem::take(&mut group.channels).into_iter().filter(|item| selection.takes(item.name)) {
        match item.obstacle.as_ref().or(group.time.as_ref().err()).cloned() {
            None => items.push(item),
            Some(reason) if selection.insists_on(item.name) => {
                let (file, channel) = (file.into(), item.name.into());
                return Err(RecordingError::UnusableChannel { file, channel, reason });
            }
            Some(reason) => skipped.push(Finding::SkippedChannel { channel: item.name.into(), reason }),
        }
    }
    Ok(Chosen { group, items, skipped })
}

fn unequal(file: &str, channel: &str, samples: u64, times: u64) -> RecordingError {
    let detail = format!("it has {samples} samples, its clock {times}");
    RecordingError::DamagedChannel { file: file.into(), channel: channel.into(), detail }
}

/// Rasters, channels and findings under construction.
struct Assembly<'a> {
    file: &'a str,
    rasters: Vec<Raster>,
    channels: Vec<Channel>,
    findings: Vec<Finding>,
    /// Channels whose integers were rounded.
    rounded: Vec<Address>,
}

impl Assembly<'_> {
    fn group(
        &mut self,
        chosen: &Chosen<'_>,
        clock: Clock,
        rows: Option<&Rows>,
        columns: &mut impl Iterator<Item = Vec<f64>>,
    ) -> Result<(), RecordingError> {
        let first = rows.map_or(0, |rows| rows.rows.start);
        let (mut time_s, master, distance_s) = match clock {
            Clock::Master(address) => (Some(columns.next().unwrap_or_default()), Some(address), 0.0),
            Clock::Counted(distance_s) => (None, None, distance_s),
        };
        let master = master.iter().map(|address| ("time", address));
        for (channel, address) in master.chain(chosen.items.iter().map(|item| (item.name, &item.address))) {
            if self.rounded.contains(address) {
                self.findings.push(Finding::RoundedIntegers { channel: channel.into() });
            }
        }
        for item in &chosen.items {
            let samples = columns.next().unwrap_or_default();
            let counted = |row: u64| (first + row) as f64 * distance_s;
            let time_s = time_s.get_or_insert_with(|| (0..samples.len() as u64).map(counted).collect());
            if samples.len() != time_s.len() {
                return Err(unequal(self.file, item.name, samples.len() as u64, time_s.len() as u64));
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
        let all = rows.map_or(time_s.len() as u64, |rows| rows.all);
        self.findings.extend(chosen.group.findings(self.rasters.len(), all));
        self.rasters.push(Raster { time_s, name: chosen.group.name.clone() });
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

/// Findings about the file, then those about its groups and channels.
pub(super) fn with_findings<S: Source>(file: &Mdf<S>, of_groups: Vec<Finding>) -> Vec<Finding> {
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

pub(super) fn start_time<S: Source>(file: &Mdf<S>) -> Option<StartTime> {
    let ::mdf::StartTime { nanoseconds, is_local, utc_offset_min } = file.start_time()?;
    Some(StartTime { nanoseconds, is_local, utc_offset_min })
}
