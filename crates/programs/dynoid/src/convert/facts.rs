//! Converted recordings in numbers.

use recording::{Channel, Raster, Recording};
use serde::{Deserialize, Serialize};

/// Numbers of [`super::Converted`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ConvertedFacts {
    /// It was written.
    Written(WrittenFacts),
    /// It has none of the channels.
    Left {
        /// Name of the recording.
        file: String,
        /// The reason.
        notes: Vec<String>,
    },
    /// It cannot be converted.
    Failed {
        /// Name of the recording.
        file: String,
        /// The reason.
        error: String,
    },
}

/// A recording that was written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WrittenFacts {
    /// Name of the recording that was read.
    pub file: String,
    /// SHA-256 of that file; none where it was not asked for.
    pub sha256: Option<String>,
    /// The file that was written.
    pub out: String,
    /// Its clocks.
    pub rasters: Vec<RasterFacts>,
    /// Its channels.
    pub channels: Vec<ChannelFacts>,
    /// Steps on the way, and losses.
    pub notes: Vec<String>,
}

/// A clock.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RasterFacts {
    /// Its name.
    pub name: Option<String>,
    /// Number of its samples.
    pub samples: usize,
    /// Its first time, s.
    pub from_s: Option<f64>,
    /// Its last time, s.
    pub to_s: Option<f64>,
}

/// A channel.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChannelFacts {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Which of the clocks it has.
    pub raster: usize,
}

impl WrittenFacts {
    pub(super) fn of(
        file: &str,
        sha256: Option<String>,
        out: String,
        recording: &Recording,
        notes: Vec<String>,
    ) -> Self {
        let rasters = recording.rasters.iter().map(RasterFacts::of).collect();
        let channels = recording.channels.iter().map(ChannelFacts::of).collect();
        WrittenFacts { file: file.to_owned(), sha256, out, rasters, channels, notes }
    }
}

impl RasterFacts {
    fn of(raster: &Raster) -> Self {
        let finite = || raster.time_s.iter().copied().filter(|t| t.is_finite());
        RasterFacts {
            name: raster.name.clone(),
            samples: raster.time_s.len(),
            from_s: finite().reduce(f64::min),
            to_s: finite().reduce(f64::max),
        }
    }
}

impl ChannelFacts {
    fn of(channel: &Channel) -> Self {
        ChannelFacts { name: channel.name.clone(), unit: channel.unit.clone(), raster: channel.raster }
    }
}
