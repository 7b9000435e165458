//! Inventory of a recording: its clocks, its channels, and what is odd about them.

mod apart;
mod start_time;
mod stretch;

use std::borrow::Cow;
use std::ops::Range;

use recording::{Catalogue, Channel, ChannelInfo, Event, Extras, Quantity, Raster, Recording};
use serde::{Deserialize, Serialize};
use signal::clock::{ClockCheck, check_clock};
use signal::quality::{Quality, QualityOptions, check_quality};

pub use apart::Apart;
pub use stretch::{Gathered, Stretch};

/// A recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct File {
    /// Its name.
    pub file: String,
    /// Of all that the file holds; for it the whole file is read, so only where it is shown.
    pub sha256: Option<String>,
    /// The format and its version.
    pub format: String,
    /// Comment that was written with it.
    pub comment: Option<String>,
    /// When the measurement started.
    pub start: Option<String>,
    /// The experiment's label in the file's name.
    pub label: Option<String>,
    /// Its clocks.
    pub rasters: Vec<Clock>,
    /// Contents beside its channels.
    #[serde(flatten)]
    pub extras: Beside,
    /// Findings of the reader.
    pub findings: Vec<String>,
}

/// Inventory of a recording without its samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Listing {
    /// Its name.
    pub file: String,
    /// The format and its version.
    pub format: String,
    /// Comment that was written with it.
    pub comment: Option<String>,
    /// When the measurement started.
    pub start: Option<String>,
    /// The experiment that its name says.
    pub label: Option<String>,
    /// Its clocks.
    pub rasters: Vec<ListedRaster>,
    /// Contents beside its channels.
    #[serde(flatten)]
    pub extras: Beside,
    /// Findings of the reader.
    pub findings: Vec<String>,
}

/// A clock and its channels by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ListedRaster {
    /// Its name.
    pub name: Option<String>,
    /// None where only reading all of them would say.
    pub samples: Option<usize>,
    /// The channels on it.
    pub channels: Vec<ListedChannel>,
}

/// A channel by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ListedChannel {
    /// Its name.
    pub name: String,
    /// The unit as it is spelled.
    pub unit: String,
    /// Comment that was written with it.
    pub comment: String,
}

/// Contents of a file beside its channels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Beside {
    /// Files carried with the measurement.
    pub attachments: Vec<Attached>,
    /// Events during the measurement.
    pub events: Vec<Happened>,
}

/// A file carried with the measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Attached {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Comment that was written with it.
    pub comment: String,
    /// 0 where the file is only referred to.
    pub embedded_bytes: u64,
}

/// Event during the measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Happened {
    /// Its kind.
    pub kind: Cow<'static, str>,
    /// Its name.
    pub name: String,
    /// Comment that was written with it.
    pub comment: String,
    /// Where on the axis of the measurement.
    pub at: f64,
    /// The unit of `at`.
    pub unit: Cow<'static, str>,
}

/// One clock with its channels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Clock {
    /// Its name.
    pub name: Option<String>,
    /// How many samples it has.
    pub samples: usize,
    /// Its first time stamp.
    pub from_s: Option<f64>,
    /// Its last time stamp.
    pub to_s: Option<f64>,
    /// The usual time from stamp to stamp.
    pub sample_time_s: Option<f64>,
    /// How far a stamp lies off an even clock at most.
    pub worst_jitter_s: Option<f64>,
    /// How many gaps it has.
    pub gaps: usize,
    /// How many samples are missing in them.
    pub missing_samples: usize,
    /// The longest of them.
    pub longest_gap: Option<LongestGap>,
    /// Stamps that go back or repeat.
    pub stamps_not_later_than_the_one_before: usize,
    /// Stamps that are not a number.
    pub stamps_not_a_number: usize,
    /// From another clock of the recording.
    pub runs_apart: Option<Apart>,
    /// The channels on it.
    pub channels: Vec<Values>,
}

/// The longest gap of a clock.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LongestGap {
    /// Where it begins.
    pub at_s: f64,
    /// How long it lasts.
    pub duration_s: f64,
}

/// A channel and its samples' values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Values {
    /// Its name.
    pub name: String,
    /// The unit as it is spelled.
    pub unit: String,
    /// Comment that was written with it.
    pub comment: String,
    /// The smallest value.
    pub minimum: Option<f64>,
    /// The largest value.
    pub maximum: Option<f64>,
    /// The mean of all that are numbers.
    pub mean: Option<f64>,
    /// Values that are not a number.
    pub not_a_number: usize,
    /// True if all values are the same.
    pub is_constant: bool,
    /// Share of the samples in runs at the smallest value.
    pub share_at_minimum: f64,
    /// Share of the samples in runs at the largest value.
    pub share_at_maximum: f64,
    /// How many single values lie far off.
    pub spikes: usize,
}

impl Beside {
    fn of(extras: &Extras) -> Self {
        let attached = |a: &recording::Attachment| Attached {
            name: a.file_name.to_string(),
            kind: a.mime_type.to_string(),
            comment: a.comment.to_string(),
            embedded_bytes: a.embedded_bytes,
        };
        Beside {
            attachments: extras.attachments.iter().map(attached).collect(),
            events: extras.events.iter().map(happened).collect(),
        }
    }
}

fn happened(event: &Event) -> Happened {
    Happened {
        kind: Cow::from(match event.kind {
            0 => "recording",
            1 => "recording interrupt",
            2 => "acquisition interrupt",
            3 => "start trigger",
            4 => "stop trigger",
            5 => "trigger",
            6 => "marker",
            _ => "event",
        }),
        name: event.name.to_string(),
        comment: event.comment.to_string(),
        at: event.at,
        unit: Cow::from(match event.quantity {
            Some(Quantity::Time) => "s",
            Some(Quantity::Angle) => "rad",
            Some(Quantity::Distance) => "m",
            Some(Quantity::Index) | None => "",
        }),
    }
}

impl Listing {
    /// Of a recording by its name, with the label of the experiment that it is of.
    pub fn of(name: &str, label: Option<String>, catalogue: &Catalogue, extras: &Extras) -> Self {
        let channel =
            |c: &ChannelInfo| ListedChannel { name: c.name.clone(), unit: c.unit.clone(), comment: c.comment.clone() };
        let raster = |(index, raster): (usize, &recording::RasterInfo)| ListedRaster {
            name: raster.name.clone().filter(|name| !name.trim().is_empty()),
            samples: raster.samples,
            channels: catalogue.channels.iter().filter(|c| c.raster == index).map(channel).collect(),
        };
        Listing {
            file: name.to_owned(),
            format: catalogue.format.to_string(),
            comment: catalogue.comment.clone(),
            start: catalogue.start_time.map(|start| start_time::words(&start)),
            label,
            rasters: catalogue.rasters.iter().enumerate().map(raster).collect(),
            extras: Beside::of(extras),
            findings: catalogue.findings.iter().map(ToString::to_string).collect(),
        }
    }
}

impl File {
    /// Of a recording by its name, with the label of the experiment that it is of. The hash of the file is not known
    /// here.
    pub fn of(name: &str, label: Option<String>, recording: &Recording, extras: &Extras) -> Self {
        let mut apart = apart::check(recording);
        let clocks = recording.rasters.iter().enumerate().map(|(index, raster)| {
            let channels = recording.channels.iter().filter(|channel| channel.raster == index);
            Clock::of(raster, apart.remove(&index), channels.map(Values::of).collect())
        });
        File {
            file: name.to_owned(),
            sha256: None,
            format: recording.format.to_string(),
            comment: recording.comment.clone(),
            start: recording.start_time.map(|start| start_time::words(&start)),
            label,
            rasters: clocks.collect(),
            extras: Beside::of(extras),
            findings: recording.findings.iter().map(ToString::to_string).collect(),
        }
    }
}

impl Clock {
    fn of(raster: &Raster, runs_apart: Option<Apart>, channels: Vec<Values>) -> Self {
        let finite = || raster.time_s.iter().copied().filter(|time| time.is_finite());
        let finite_stamps: Cow<'_, [f64]> = match raster.time_s.iter().all(|time| time.is_finite()) {
            true => raster.time_s.as_slice().into(),
            false => finite().collect(),
        };
        let check: Option<ClockCheck> = check_clock(&finite_stamps).ok();
        let longest = check.iter().flat_map(|c| &c.gaps).max_by(|a, b| a.duration_s.total_cmp(&b.duration_s));
        Clock {
            name: raster.name.clone().filter(|name| !name.trim().is_empty()),
            samples: raster.time_s.len(),
            from_s: finite().reduce(f64::min),
            to_s: finite().reduce(f64::max),
            sample_time_s: check.as_ref().map(|check| check.sample_time_s),
            worst_jitter_s: check.as_ref().map(|check| check.worst_jitter_s),
            gaps: check.as_ref().map_or(0, |check| check.gaps.len()),
            missing_samples: check.as_ref().map_or(0, |check| check.missing_samples),
            longest_gap: longest
                .map(|gap| LongestGap { at_s: finite_stamps[gap.between.start], duration_s: gap.duration_s }),
            stamps_not_later_than_the_one_before: finite_stamps.windows(2).filter(|pair| pair[1] <= pair[0]).count(),
            stamps_not_a_number: raster.time_s.len() - finite_stamps.len(),
            runs_apart,
            channels,
        }
    }
}

impl Values {
    fn of(channel: &Channel) -> Self {
        let finite = || channel.samples.iter().copied().filter(|value| value.is_finite());
        let count = finite().count();
        let quality = check_quality(&channel.samples, &QualityOptions::default()).ok();
        let share = |runs: fn(&Quality) -> &[Range<usize>]| {
            let samples: usize = quality.iter().flat_map(runs).map(ExactSizeIterator::len).sum();
            samples as f64 / channel.samples.len().max(1) as f64
        };
        Values {
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            comment: channel.comment.clone(),
            minimum: finite().reduce(f64::min),
            maximum: finite().reduce(f64::max),
            // From the first value on, so that of equal values it is exactly that.
            mean: finite().next().map(|first| {
                let share = |value: f64| value / count as f64;
                first + finite().map(|value| share(value) - share(first)).sum::<f64>()
            }),
            not_a_number: channel.samples.len() - count,
            is_constant: count > 0 && quality.as_ref().is_some_and(|quality| quality.constant),
            share_at_minimum: share(|quality| &quality.clipped_low),
            share_at_maximum: share(|quality| &quality.clipped_high),
            spikes: quality.as_ref().map_or(0, |quality| quality.spikes.len()),
        }
    }
}
