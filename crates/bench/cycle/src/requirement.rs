//! Requirement sets: limits as data, one file each, with paragraph and year.

use serde::{Deserialize, Serialize};

use crate::error::CycleError;
use crate::reference::Scales;

const FILES: [(&str, &str); 7] = [
    ("1065.514", include_str!("../requirements/1065.514.toml")),
    ("1036.545", include_str!("../requirements/1036.545.toml")),
    ("whtc", include_str!("../requirements/whtc.toml")),
    ("nrtc", include_str!("../requirements/nrtc.toml")),
    ("whsc", include_str!("../requirements/whsc.toml")),
    ("modes", include_str!("../requirements/modes.toml")),
    ("1066.425", include_str!("../requirements/1066.425.toml")),
];

/// A signal of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Signal {
    /// Speed, rad/s.
    Speed,
    /// Torque, Nm.
    Torque,
    /// Power, W.
    Power,
}

impl Signal {
    /// All three.
    pub const ALL: [Signal; 3] = [Signal::Speed, Signal::Torque, Signal::Power];
}

/// A number that has a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    /// Slope of the regression.
    Slope,
    /// |a_0|.
    Intercept,
    /// Standard error of estimate.
    StandardError,
    /// r².
    Determination,
    /// Work of the feedback over that of the reference.
    Work,
}

/// Value that a limit in per cent is a part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Of {
    /// Warm idle speed.
    Idle,
    /// Maximum test speed.
    MaximumTestSpeed,
    /// Largest speed of the reference.
    MaximumReferenceSpeed,
    /// Largest torque of the map.
    MaximumTorque,
    /// Largest power of the map.
    MaximumPower,
}

/// A limit in per cent, and the least it is where that is more.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// Per cent.
    pub percent: f64,
    /// Of what.
    pub of: Of,
    /// At least so much, Nm or W.
    #[serde(default)]
    pub at_least: f64,
}

/// The limits of one signal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Criterion {
    /// Lowest and highest slope.
    pub slope: [f64; 2],
    /// Largest |a_0|.
    pub intercept: Limit,
    /// Largest standard error.
    pub standard_error: Limit,
    /// Smallest r².
    pub determination: f64,
}

/// How far modes may be from their set points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModeTolerance {
    /// Speed, % of the maximum test speed.
    pub speed_percent: f64,
    /// Speed, at least so many rpm.
    pub speed_rpm: f64,
    /// Torque, % of the largest at the speed.
    pub torque_percent: f64,
}

/// A band about the speed of a vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BandTolerance {
    /// Above and below the extremes of the trace, mph.
    pub mph: f64,
    /// The extremes are looked for so far around a moment, s.
    pub around_s: f64,
    /// Longest excursion, s.
    pub excursion_s: f64,
}

/// One set of requirements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RequirementSet {
    /// Its name on the command line.
    pub name: String,
    /// Its title.
    pub title: String,
    /// Law and paragraph.
    pub paragraph: String,
    /// Year of the text that the figures are from.
    pub year: u32,
    /// True if the text itself was seen.
    pub seen: bool,
    /// Note about the figures.
    #[serde(default)]
    pub note: String,
    /// Longest shift of the feedback, s.
    #[serde(default)]
    pub shift_s: f64,
    /// True if points may be left out.
    #[serde(default)]
    pub omission: bool,
    /// True if the reference, too, is the mean over each second. It is then that of a demand straight between its
    /// points; otherwise the value at the second.
    #[serde(default)]
    pub reference_means: bool,
    /// Decimals to which slopes and r² are rounded before they are compared; none: they are compared as they are.
    /// Limits in per cent are exact, and what they limit is never rounded.
    #[serde(default)]
    pub decimals: Option<i32>,
    /// Lowest and highest work of the feedback over that of the reference.
    #[serde(default)]
    pub work: Option<[f64; 2]>,
    /// A reference that changes less than this part of its mean is judged by the standard error alone; 0: never.
    #[serde(default)]
    pub narrow_range: f64,
    /// True if seconds at standstill are left out.
    #[serde(default)]
    pub without_standstill: bool,
    /// Limits of the speed.
    #[serde(default)]
    pub speed: Option<Criterion>,
    /// Limits of the torque.
    #[serde(default)]
    pub torque: Option<Criterion>,
    /// Limits of the power.
    #[serde(default)]
    pub power: Option<Criterion>,
    /// Limits of steady modes.
    #[serde(default)]
    pub modes: Option<ModeTolerance>,
    /// Band about a vehicle's speed.
    #[serde(default)]
    pub band: Option<BandTolerance>,
}

/// Every embedded requirement set.
///
/// # Errors
/// Damaged data.
pub fn requirements() -> Result<Vec<RequirementSet>, CycleError> {
    FILES.iter().map(|(name, text)| read(name, text)).collect()
}

/// The requirement set of a name; letter case does not matter.
///
/// # Errors
/// [`CycleError::UnknownRequirement`] with the names there are.
pub fn requirement(name: &str) -> Result<RequirementSet, CycleError> {
    let found = FILES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name.trim()));
    let unknown = || CycleError::UnknownRequirement {
        name: name.to_owned(),
        known: FILES.iter().map(|(known, _)| (*known).to_owned()).collect(),
    };
    found.ok_or_else(unknown).and_then(|(name, text)| read(name, text))
}

fn read(name: &'static str, text: &str) -> Result<RequirementSet, CycleError> {
    toml::from_str(text).map_err(|error| CycleError::Data { name, near: error.to_string() })
}

impl RequirementSet {
    /// The limits of a signal.
    pub fn criterion(&self, signal: Signal) -> Option<&Criterion> {
        match signal {
            Signal::Speed => self.speed.as_ref(),
            Signal::Torque => self.torque.as_ref(),
            Signal::Power => self.power.as_ref(),
        }
    }

    /// Returns true if a number of it depends on this signal: power, work and the rules of omission take both speed and
    /// torque.
    pub fn uses(&self, signal: Signal) -> bool {
        self.criterion(signal).is_some() || self.power.is_some() || self.work.is_some() || self.omission
    }

    /// Returns true if it judges by regressions.
    pub fn has_regressions(&self) -> bool {
        Signal::ALL.into_iter().any(|signal| self.criterion(signal).is_some())
    }
}

impl Limit {
    /// 1 %, SI.
    pub(crate) fn per_cent(&self, scales: &Scales, largest_reference_rad_s: f64) -> f64 {
        0.01 * match self.of {
            Of::Idle => scales.idle_rad_s,
            Of::MaximumTestSpeed => scales.maximum_test_speed_rad_s,
            Of::MaximumReferenceSpeed => largest_reference_rad_s,
            Of::MaximumTorque => scales.maximum_torque_nm,
            Of::MaximumPower => scales.maximum_power_w,
        }
    }
}
