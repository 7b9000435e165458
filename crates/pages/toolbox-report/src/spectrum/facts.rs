//! Spectra in numbers.

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

/// Numbers of a [`super::Spectrum`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpectrumFacts {
    /// Names of the channels and of the recording.
    pub channel: String,
    /// Unit of the magnitude.
    pub unit: String,
    /// Frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    /// Magnitude at each; NaN where the input has next to no power.
    #[serde(deserialize_with = "nan_if_null")]
    pub magnitude: Vec<f64>,
    /// Phase of a response at each, degrees; none of a power spectrum.
    #[serde(deserialize_with = "nan_if_null")]
    pub phase_deg: Option<Vec<f64>>,
    /// The 95 % interval of each magnitude.
    #[serde(deserialize_with = "nan_if_null")]
    pub interval_95: Vec<(f64, f64)>,
    /// Peaks that stand out.
    pub peaks: Vec<PeakFacts>,
    /// Coherence of the output with its only input.
    pub coherence: Option<CoherenceFacts>,
    /// The periods that were averaged, where the inputs repeat.
    pub periodic: Option<PeriodicFacts>,
    /// Ranges of frequencies without a value, Hz.
    pub without_value_hz: Vec<(f64, f64)>,
}

/// A peak of a spectrum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PeakFacts {
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// The 95 % interval of its frequency, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub frequency_interval_95_hz: (f64, f64),
    /// Its magnitude.
    pub magnitude: f64,
    /// The 95 % interval of its magnitude.
    #[serde(deserialize_with = "nan_if_null")]
    pub interval_95: (f64, f64),
    /// By how much it stands out of what is around it, dB.
    #[serde(deserialize_with = "nan_if_null")]
    pub excess_db: f64,
    /// How wide it is.
    #[serde(flatten)]
    pub width: PeakWidth,
}

/// How wide a peak is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum PeakWidth {
    /// Of a response at lines.
    AtLines {
        /// True if a resonance was found between the lines; else the peak is the highest line.
        is_between_lines: bool,
        /// Its width 3 dB below the top, Hz.
        bandwidth_hz: Option<f64>,
        /// The 95 % interval of its width, Hz.
        #[serde(deserialize_with = "nan_if_null")]
        bandwidth_interval_95_hz: Option<(f64, f64)>,
    },
    /// Of a curve.
    OfCurve {
        /// Half the width within which peaks cannot be separated, Hz.
        resolution_hz: f64,
    },
}

/// How much of an output goes with its only input.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CoherenceFacts {
    /// Frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    /// Coherence at each.
    #[serde(deserialize_with = "nan_if_null")]
    pub coherence: Vec<f64>,
    /// The 95 % interval of each.
    #[serde(deserialize_with = "nan_if_null")]
    pub interval_95: Vec<[f64; 2]>,
    /// Coherence that chance alone exceeds at one frequency of twenty.
    pub chance_exceeds_at_1_in_20: f64,
}

/// Periods of inputs that repeat.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PeriodicFacts {
    /// Length of a period, s.
    pub period_s: f64,
    /// Number of periods that were averaged.
    pub periods: usize,
    /// Time of the first of them, s.
    pub from_s: f64,
    /// Periods before, in which the output had not settled.
    pub periods_left_out: usize,
    /// True if the output still changes from period to period.
    pub still_settling: bool,
    /// Lines that several inputs excite and that are left out, Hz.
    pub lines_shared_by_inputs_hz: Vec<f64>,
}
