//! From the structure of an MDF file to a recording or a catalogue: the part that does not depend on the version.

use falcon_mdf::Mf4Error;

use super::{failure, plausible};
use crate::{
    Channel, ChannelInfo, Finding, Raster, RasterInfo, RecordingError, Selection, SkipReason,
    error::require_names,
};

/// Where a channel is in the file: data group, channel group, channel.
pub(crate) type Key = (usize, usize, usize);

/// A channel group, ready to be read.
#[derive(Debug)]
pub(crate) struct Group {
    pub name: Option<String>,
    /// Samples as the file announces them.
    pub announced: u64,
    /// Samples that its data can hold.
    pub found: u64,
    /// Size of its data after decompression, with that of the groups stored between them.
    pub stream_bytes: u64,
    pub time: Result<Key, SkipReason>,
    pub channels: Vec<Item>,
}

/// A channel other than the clock of its group.
#[derive(Debug)]
pub(crate) struct Item {
    pub name: String,
    pub unit: String,
    pub comment: String,
    pub key: Key,
    pub obstacle: Option<SkipReason>,
}

/// Why a channel could not be read.
pub(crate) enum ReadFailure {
    Skip(SkipReason),
    Mdf(Mf4Error),
}

impl From<Mf4Error> for ReadFailure {
    fn from(error: Mf4Error) -> Self {
        match error {
            Mf4Error::Unsupported { feature, detail } => Self::Skip(SkipReason::Unsupported {
                detail: format!("{feature} ({detail})"),
            }),
            other => Self::Mdf(other),
        }
    }
}

/// Rasters, channels and findings under construction.
pub(crate) struct Assembly<'a> {
    file: &'a str,
    selection: &'a Selection,
    pub rasters: Vec<Raster>,
    pub channels: Vec<Channel>,
    pub findings: Vec<Finding>,
}

impl<'a> Assembly<'a> {
    /// Reads the selected channels of all groups through `read`.
    pub(crate) fn build(
        file: &'a str,
        selection: &'a Selection,
        groups: &[Group],
        read: impl Fn(Key) -> Result<Vec<f64>, ReadFailure>,
    ) -> Result<Self, RecordingError> {
        let names = groups.iter().flat_map(|g| &g.channels);
        require_names(file, selection, names.map(|c| c.name.as_str()))?;
        let mut assembly = Self {
            file,
            selection,
            rasters: Vec::new(),
            channels: Vec::new(),
            findings: Vec::new(),
        };
        for group in groups {
            assembly.group(group, &read)?;
        }
        Ok(assembly)
    }

    fn group(
        &mut self,
        group: &Group,
        read: &impl Fn(Key) -> Result<Vec<f64>, ReadFailure>,
    ) -> Result<(), RecordingError> {
        let items = self.usable(group)?;
        let (Ok(time), false) = (&group.time, items.is_empty()) else {
            return Ok(());
        };
        plausible(self.file, items.len() + 1, group.found, group.stream_bytes)?;
        let time_s = match read(*time) {
            Ok(time_s) => time_s,
            Err(ReadFailure::Mdf(error)) => return Err(failure(self.file, error)),
            Err(ReadFailure::Skip(reason)) => return self.skip_all(&items, &reason),
        };
        let (count, first) = (time_s.len(), self.channels.len());
        for item in items {
            self.channel(item, count, read)?;
        }
        if self.channels.len() > first {
            self.findings.extend(count_finding(
                self.rasters.len(),
                group.announced,
                count as u64,
            ));
            self.rasters.push(Raster {
                time_s,
                name: group.name.clone(),
            });
        }
        Ok(())
    }

    /// The selected channels that nothing is known against.
    fn usable<'g>(&mut self, group: &'g Group) -> Result<Vec<&'g Item>, RecordingError> {
        let mut usable = Vec::new();
        for item in &group.channels {
            if !self.selection.takes(&item.name) {
                continue;
            }
            match item.obstacle.as_ref().or(group.time.as_ref().err()) {
                None => usable.push(item),
                Some(reason) => self.skip(item, reason.clone())?,
            }
        }
        Ok(usable)
    }

    fn channel(
        &mut self,
        item: &Item,
        count: usize,
        read: &impl Fn(Key) -> Result<Vec<f64>, ReadFailure>,
    ) -> Result<(), RecordingError> {
        let damaged = |detail: String| RecordingError::DamagedChannel {
            file: self.file.into(),
            channel: item.name.clone(),
            detail,
        };
        match read(item.key) {
            Err(ReadFailure::Skip(reason)) => self.skip(item, reason),
            Err(ReadFailure::Mdf(error @ Mf4Error::TruncatedFile { .. })) => {
                Err(failure(self.file, error))
            }
            Err(ReadFailure::Mdf(error)) => Err(damaged(error.to_string())),
            Ok(samples) if samples.len() != count => Err(damaged(format!(
                "it has {} samples, its clock {count}",
                samples.len()
            ))),
            Ok(samples) => {
                self.channels.push(Channel {
                    name: item.name.clone(),
                    unit: item.unit.clone(),
                    comment: item.comment.clone(),
                    raster: self.rasters.len(),
                    samples,
                });
                Ok(())
            }
        }
    }

    fn skip_all(&mut self, items: &[&Item], reason: &SkipReason) -> Result<(), RecordingError> {
        items
            .iter()
            .try_for_each(|item| self.skip(item, reason.clone()))
    }

    fn skip(&mut self, item: &Item, reason: SkipReason) -> Result<(), RecordingError> {
        if let Selection::Names(_) = self.selection {
            return Err(RecordingError::UnusableChannel {
                file: self.file.into(),
                channel: item.name.clone(),
                reason,
            });
        }
        self.findings.push(Finding::SkippedChannel {
            channel: item.name.clone(),
            reason,
        });
        Ok(())
    }
}

/// The rasters and channels of all groups without reading samples.
pub(crate) fn list(groups: &[Group]) -> (Vec<RasterInfo>, Vec<ChannelInfo>, Vec<Finding>) {
    let (mut rasters, mut channels, mut findings) = (Vec::new(), Vec::new(), Vec::new());
    for group in groups {
        let first = channels.len();
        for item in &group.channels {
            match item.obstacle.as_ref().or(group.time.as_ref().err()) {
                Some(reason) => findings.push(Finding::SkippedChannel {
                    channel: item.name.clone(),
                    reason: reason.clone(),
                }),
                None => channels.push(ChannelInfo {
                    name: item.name.clone(),
                    unit: item.unit.clone(),
                    comment: item.comment.clone(),
                    raster: rasters.len(),
                }),
            }
        }
        if channels.len() > first {
            findings.extend(count_finding(rasters.len(), group.announced, group.found));
            rasters.push(RasterInfo {
                name: group.name.clone(),
                samples: usize::try_from(group.found).unwrap_or(usize::MAX),
            });
        }
    }
    (rasters, channels, findings)
}

fn count_finding(raster: usize, announced: u64, found: u64) -> Option<Finding> {
    match announced.cmp(&found) {
        std::cmp::Ordering::Equal => None,
        std::cmp::Ordering::Greater => Some(Finding::MissingSamples {
            raster,
            announced,
            found,
        }),
        std::cmp::Ordering::Less => Some(Finding::UnannouncedSamples {
            raster,
            announced,
            found,
        }),
    }
}

/// `None` for text that is empty or blank.
pub(crate) fn some_text(text: &str) -> Option<String> {
    let text = text.trim();
    (!text.is_empty()).then(|| text.to_owned())
}
