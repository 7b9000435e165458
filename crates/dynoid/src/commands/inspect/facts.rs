//! The facts about a recording, as they are printed and as JSON.

use std::borrow::Cow;
use std::ops::Range;

use recording::{Catalogue, Channel, ChannelInfo, Event, Extras, Quantity, Raster, Recording};
use rig::ExperimentLabel;
use serde::Serialize;
use signal::clock::{ClockCheck, check_clock};
use signal::quality::{Quality, QualityOptions, check_quality};

use super::apart::{self, Apart};
use super::start_time;

/// A recording.
#[derive(Debug, Serialize)]
pub(super) struct File {
    pub(super) file: String,
    /// Of all that the file holds; for it the whole file is read, so only where it is shown.
    pub(super) sha256: Option<String>,
    pub(super) format: String,
    pub(super) comment: Option<String>,
    pub(super) start: Option<String>,
    /// The experiment's label in the file's name.
    pub(super) label: Option<String>,
    pub(super) rasters: Vec<Clock>,
    #[serde(flatten)]
    pub(super) extras: Beside,
    /// What the reader has to say.
    pub(super) findings: Vec<String>,
}

/// What a recording lists, without its samples.
#[derive(Debug, Serialize)]
pub(super) struct Listing {
    pub(super) file: String,
    pub(super) format: String,
    pub(super) comment: Option<String>,
    pub(super) start: Option<String>,
    pub(super) label: Option<String>,
    pub(super) rasters: Vec<ListedRaster>,
    #[serde(flatten)]
    pub(super) extras: Beside,
    pub(super) findings: Vec<String>,
}

/// A clock and its channels by name.
#[derive(Debug, Serialize)]
pub(super) struct ListedRaster {
    pub(super) name: Option<String>,
    /// None where it takes reading all of them to tell.
    pub(super) samples: Option<usize>,
    pub(super) channels: Vec<ListedChannel>,
}

/// A channel by name.
#[derive(Debug, Serialize)]
pub(super) struct ListedChannel {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) comment: String,
}

/// What a file holds beside its channels.
#[derive(Debug, Serialize)]
pub(super) struct Beside {
    pub(super) attachments: Vec<Attached>,
    pub(super) events: Vec<Happened>,
}

/// A file carried with the measurement.
#[derive(Debug, Serialize)]
pub(super) struct Attached {
    pub(super) name: String,
    pub(super) kind: String,
    pub(super) comment: String,
    /// 0 where the file is only referred to.
    pub(super) embedded_bytes: u64,
}

/// What happened during the measurement.
#[derive(Debug, Serialize)]
pub(super) struct Happened {
    pub(super) kind: &'static str,
    pub(super) name: String,
    pub(super) comment: String,
    pub(super) at: f64,
    /// The unit of `at`.
    pub(super) unit: &'static str,
}

/// One clock with its channels.
#[derive(Debug, Serialize)]
pub(super) struct Clock {
    pub(super) name: Option<String>,
    pub(super) samples: usize,
    pub(super) from_s: Option<f64>,
    pub(super) to_s: Option<f64>,
    pub(super) sample_time_s: Option<f64>,
    pub(super) worst_jitter_s: Option<f64>,
    pub(super) gaps: usize,
    pub(super) missing_samples: usize,
    pub(super) longest_gap: Option<LongestGap>,
    pub(super) stamps_not_later_than_the_one_before: usize,
    pub(super) stamps_not_a_number: usize,
    /// From another clock of the recording.
    pub(super) runs_apart: Option<Apart>,
    pub(super) channels: Vec<Values>,
}

/// The longest gap of a clock.
#[derive(Debug, Serialize)]
pub(super) struct LongestGap {
    pub(super) at_s: f64,
    pub(super) duration_s: f64,
}

/// A channel and its samples' values.
#[derive(Debug, Serialize)]
pub(super) struct Values {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) comment: String,
    pub(super) minimum: Option<f64>,
    pub(super) maximum: Option<f64>,
    pub(super) mean: Option<f64>,
    pub(super) not_a_number: usize,
    pub(super) is_constant: bool,
    /// Share of the samples in runs at the smallest value.
    pub(super) share_at_minimum: f64,
    /// Share of the samples in runs at the largest value.
    pub(super) share_at_maximum: f64,
    pub(super) spikes: usize,
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
        kind: match event.kind {
            0 => "recording",
            1 => "recording interrupt",
            2 => "acquisition interrupt",
            3 => "start trigger",
            4 => "stop trigger",
            5 => "trigger",
            6 => "marker",
            _ => "event",
        },
        name: event.name.to_string(),
        comment: event.comment.to_string(),
        at: event.at,
        unit: match event.quantity {
            Some(Quantity::Time) => "s",
            Some(Quantity::Angle) => "rad",
            Some(Quantity::Distance) => "m",
            Some(Quantity::Index) | None => "",
        },
    }
}

/// The experiment's label in a file's name.
fn label(name: &str) -> Option<String> {
    let file_name = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file_name.parse().ok().map(|label: ExperimentLabel| label.to_string())
}

impl Listing {
    pub(super) fn of(name: &str, catalogue: &Catalogue, extras: &Extras) -> Self {
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
            label: label(name),
            rasters: catalogue.rasters.iter().enumerate().map(raster).collect(),
            extras: Beside::of(extras),
            findings: catalogue.findings.iter().map(ToString::to_string).collect(),
        }
    }
}

impl File {
    pub(super) fn of(name: &str, sha256: Option<String>, recording: &Recording, extras: &Extras) -> Self {
        let mut apart = apart::check(recording);
        let clocks = recording.rasters.iter().enumerate().map(|(index, raster)| {
            let channels = recording.channels.iter().filter(|channel| channel.raster == index);
            Clock::of(raster, apart.remove(&index), channels.map(Values::of).collect())
        });
        File {
            file: name.to_owned(),
            sha256,
            format: recording.format.to_string(),
            comment: recording.comment.clone(),
            start: recording.start_time.map(|start| start_time::words(&start)),
            label: label(name),
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
