//! From the schema to clocks and channels.

use std::collections::{BTreeSet, HashMap};

use arrow_schema::{DataType, Field, Metadata, Schema, TimeUnit};

use super::key;
use super::values::{is_numeric, is_wide};
use crate::heading::{clock_and_unit, name_and_unit, seconds, time_word};
use crate::mat::start_time;
use crate::required::require_names;
use crate::{Catalogue, ChannelInfo, Finding, Format, RasterInfo, RecordingError, Selection, SkipReason, StartTime};

/// Plan of the columns to read, and their uses.
#[derive(Clone)]
pub(super) struct Plan {
    /// The columns of the file that are read, in order.
    pub(super) columns: Vec<usize>,
    pub(super) groups: Vec<Group>,
    pub(super) findings: Vec<Finding>,
    pub(super) comment: Option<String>,
    pub(super) start_time: Option<StartTime>,
}

/// Channels that share a clock; columns are counted among those that are read.
#[derive(Clone)]
pub(super) struct Group {
    pub(super) clock: Option<(usize, Clock)>,
    pub(super) channels: Vec<Heading>,
    /// The column that is null in rows of others, and its name; none where all rows are the group's.
    pub(super) mark: Option<(usize, String)>,
    pub(super) name: Option<String>,
}

/// How a column gives the time.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Clock {
    /// Numbers, with seconds per unit as a fraction, and the name of one without a unit.
    Numbers((f64, f64), Option<String>),
    Duration(TimeUnit),
    TimeOfDay(TimeUnit),
    /// With the zone, where it is known.
    Stamps(TimeUnit, Option<String>),
}

/// A channel.
#[derive(Clone)]
pub(super) struct Heading {
    pub(super) column: usize,
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) comment: String,
    /// True of integers of 64 bits.
    pub(super) is_wide: bool,
}

/// The name of clocks in messages.
pub(super) const TIME: &str = "time";

impl Group {
    /// The columns that it takes.
    fn places(&mut self) -> impl Iterator<Item = &mut usize> {
        let clock = self.clock.iter_mut().map(|(column, _)| column);
        let mark = self.mark.iter_mut().map(|(column, _)| column);
        clock.chain(mark).chain(self.channels.iter_mut().map(|heading| &mut heading.column))
    }
}

/// The column of a clock, the number of a raster, and the channels that share them.
type Sharing = (Option<usize>, Option<u64>, Vec<Heading>);

impl Plan {
    pub(super) fn new(
        file: &str,
        schema: &Schema,
        selection: &Selection,
        row_distance_s: Option<f64>,
    ) -> Result<Self, RecordingError> {
        let fields = schema.fields();
        let clocks = clocks(fields.iter().map(AsRef::as_ref));
        if clocks.is_empty() && row_distance_s.is_none() {
            let first = fields.first().map(|field| field.name().clone()).unwrap_or_default();
            return Err(RecordingError::NoTimeColumn { file: file.into(), first });
        }
        let names: Vec<String> = fields.iter().map(|field| label(field).0).collect();
        let candidates = names.iter().enumerate().filter(|(index, _)| !clocks.contains_key(index));
        require_names(file, selection, candidates.map(|(_, name)| name.as_str()))?;
        let metadata = schema.metadata();
        let mut plan = Self {
            columns: Vec::new(),
            groups: Vec::new(),
            findings: Vec::new(),
            comment: metadata.get(key::COMMENT).cloned(),
            start_time: metadata.get(key::START_TIME).and_then(|text| start_time(text)),
        };
        let groups = plan.groups(file, fields, &clocks, selection)?;
        plan.place(groups, clocks, metadata);
        Ok(plan)
    }

    /// The selected channels, by clock and raster.
    fn groups(
        &mut self,
        file: &str,
        fields: &arrow_schema::Fields,
        clocks: &HashMap<usize, Clock>,
        selection: &Selection,
    ) -> Result<Vec<Sharing>, RecordingError> {
        let mut groups: Vec<Sharing> = Vec::new();
        // What stands before the first clock is its too.
        let mut clock = clocks.keys().min().copied();
        for (column, field) in fields.iter().enumerate() {
            if clocks.contains_key(&column) {
                clock = Some(column);
                continue;
            }
            let (name, unit, comment) = label(field);
            if !selection.takes(&name) {
                continue;
            }
            if let Err(kind) = is_numeric(field.data_type()) {
                let reason = SkipReason::NotNumeric { kind: kind.into() };
                if selection.insists_on(&name) {
                    return Err(RecordingError::UnusableChannel { file: file.into(), channel: name, reason });
                }
                self.findings.push(Finding::SkippedChannel { channel: name, reason });
                continue;
            }
            let raster = field.metadata().get(key::RASTER).and_then(|raster| raster.parse().ok());
            let heading = Heading { column, name, unit, comment, is_wide: is_wide(field.data_type()) };
            match groups.iter_mut().find(|(c, r, _)| (*c, *r) == (clock, raster)) {
                Some((.., headings)) => headings.push(heading),
                None => groups.push((clock, raster, vec![heading])),
            }
        }
        groups.sort_by_key(|(clock, raster, _)| (*clock, *raster));
        Ok(groups)
    }

    /// For each group the column, among those that are read, that is null in rows of others; `None` where all rows are
    /// the group's.
    pub(super) fn marks(&self) -> impl Iterator<Item = Option<usize>> {
        self.groups.iter().map(|group| group.mark.as_ref().map(|(column, _)| *column))
    }

    /// The plan for the clocks alone.
    pub(super) fn of_clocks(&self) -> Self {
        self.only(self.groups.iter().map(|group| Group { channels: Vec::new(), ..group.clone() }).collect())
    }

    /// The plan for the channels of a group, without their clock.
    pub(super) fn of_channels(&self, group: usize) -> Self {
        let group = self.groups.get(group).map(|group| Group { clock: None, ..group.clone() });
        self.only(group.into_iter().collect())
    }

    /// The plan for these groups, which takes as few columns as they need.
    fn only(&self, mut groups: Vec<Group>) -> Self {
        let places: BTreeSet<usize> = groups.iter_mut().flat_map(Group::places).map(|place| *place).collect();
        let places: Vec<usize> = places.into_iter().collect();
        for place in groups.iter_mut().flat_map(Group::places) {
            *place = places.binary_search(place).unwrap_or(0);
        }
        Self {
            columns: places.iter().filter_map(|&place| self.columns.get(place).copied()).collect(),
            groups,
            findings: Vec::new(),
            comment: self.comment.clone(),
            start_time: self.start_time,
        }
    }

    /// How many columns are gone through to read all groups.
    pub(super) fn reads(&self) -> usize {
        let columns = |group: &Group| usize::from(group.clock.is_some()) + group.channels.len();
        self.marks().flatten().count() + self.groups.iter().map(columns).sum::<usize>()
    }

    /// The first clock of dates, and its column among those that are read.
    pub(super) fn dates(&self) -> Option<&(usize, Clock)> {
        self.groups
            .iter()
            .filter_map(|group| group.clock.as_ref())
            .find(|(_, clock)| matches!(clock, Clock::Stamps(..)))
    }

    /// A list of the channels, whose groups have so many samples.
    pub(super) fn into_catalogue(
        self,
        format: Format,
        samples: &[Option<usize>],
        start_time: Option<StartTime>,
    ) -> Catalogue {
        let mut channels: Vec<(usize, ChannelInfo)> = Vec::new();
        let mut rasters = Vec::new();
        for (raster, (group, samples)) in self.groups.into_iter().zip(samples).enumerate() {
            rasters.push(RasterInfo { name: group.name, samples: *samples });
            let channel = |Heading { column, name, unit, comment, .. }: Heading| {
                (column, ChannelInfo { name, unit, comment, raster })
            };
            channels.extend(group.channels.into_iter().map(channel));
        }
        channels.sort_by_key(|(column, _)| *column);
        Catalogue {
            format,
            comment: self.comment,
            start_time: start_time.or(self.start_time),
            rasters,
            channels: channels.into_iter().map(|(_, channel)| channel).collect(),
            findings: self.findings,
        }
    }

    /// Counts the columns among those that are read.
    fn place(&mut self, groups: Vec<Sharing>, clocks: HashMap<usize, Clock>, metadata: &Metadata) {
        let clock_columns = groups.iter().filter_map(|(clock, ..)| *clock);
        let channels = groups.iter().flat_map(|(.., headings)| headings.iter().map(|h| h.column));
        let columns: BTreeSet<usize> = clock_columns.chain(channels).collect();
        self.columns = columns.into_iter().collect();
        let place = |column: usize| self.columns.binary_search(&column).unwrap_or(0);
        let group = |(clock, raster, mut channels): Sharing| {
            channels.iter_mut().for_each(|heading| heading.column = place(heading.column));
            let first = channels.first().filter(|_| raster.is_some()).map(|first| (first.column, first.name.clone()));
            Group {
                clock: clock.and_then(|column| Some((place(column), clocks.get(&column)?.clone()))),
                mark: first.or_else(|| clock.map(|column| (place(column), TIME.to_owned()))),
                channels,
                name: raster.and_then(|raster| metadata.get(&format!("raster {raster}")).cloned()),
            }
        };
        self.groups = groups.into_iter().map(group).collect();
    }
}

/// Name, unit and comment of a column.
fn label(field: &Field) -> (String, String, String) {
    let metadata = field.metadata();
    let text = |names: &[&str]| names.iter().find_map(|name| metadata.get(name)).cloned();
    let comment = text(&[key::COMMENT, "description", "Description"]).unwrap_or_default();
    let unit = text(&[key::UNIT, "units", "Unit", "UNIT"]);
    match (text(&[key::NAME]), unit) {
        (Some(name), unit) => (name, unit.unwrap_or_default(), comment),
        (None, Some(unit)) => (field.name().clone(), unit, comment),
        (None, None) => {
            let (name, unit) = name_and_unit(field.name());
            let unit = if unit.is_empty() && matches!(field.data_type(), DataType::Duration(_)) { "s" } else { unit };
            (name.into(), unit.into(), comment)
        }
    }
}

/// The columns that are clocks: those named as time, alike where there are several; else the only one that holds times
/// or dates; else the first, if its unit is one of time.
fn clocks<'a>(fields: impl Iterator<Item = &'a Field>) -> HashMap<usize, Clock> {
    let fields: Vec<&Field> = fields.collect();
    let word = |field: &Field| time_word(clock_and_unit(field.name()).0);
    let named = |(column, field): &(usize, &&Field)| {
        let is_letter = word(field) == Some("t") && *column > 0;
        !field.metadata().contains_key(key::RASTER) && word(field).is_some() && !is_letter && clock(field).is_some()
    };
    let stands = |column: usize| fields.get(column).and_then(|field| Some((column, clock(field)?)));
    if let Some((first, field)) = fields.iter().enumerate().find(named) {
        let is_like_first = |f: &Field| word(f) == word(field) && !f.metadata().contains_key(key::RASTER);
        return (first..fields.len()).filter(|&c| is_like_first(fields[c])).filter_map(stands).collect();
    }
    let is_temporal =
        |field: &Field| matches!(clock(field), Some(Clock::Stamps(..) | Clock::Duration(_) | Clock::TimeOfDay(_)));
    let temporal: Vec<usize> = (0..fields.len()).filter(|&column| is_temporal(fields[column])).collect();
    let is_first = |field: &&Field| {
        let unit = label(field).1;
        !unit.is_empty() && seconds(&unit).is_some()
    };
    match (temporal.as_slice(), fields.first().copied().filter(is_first)) {
        ([only], _) => stands(*only).into_iter().collect(),
        (_, Some(_)) => stands(0).into_iter().collect(),
        _ => HashMap::new(),
    }
}

/// How this column gives the time, if it does.
fn clock(field: &Field) -> Option<Clock> {
    match field.data_type() {
        DataType::Timestamp(unit, zone) => Some(Clock::Stamps(*unit, zone.as_ref().map(ToString::to_string))),
        DataType::Duration(unit) => Some(Clock::Duration(*unit)),
        DataType::Time32(unit) | DataType::Time64(unit) => Some(Clock::TimeOfDay(*unit)),
        kind if kind.is_numeric() => {
            let unit = field.metadata().get(key::UNIT).map(String::as_str);
            let unit = unit.unwrap_or(clock_and_unit(field.name()).1);
            let unitless = unit.is_empty().then(|| field.name().clone());
            seconds(unit).map(|factor| Clock::Numbers(factor, unitless))
        }
        _ => None,
    }
}
