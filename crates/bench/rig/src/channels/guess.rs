//! A guess of what channels mean, with its reasons.

use std::collections::BTreeMap;
use std::fmt;

use units::{Quantity, Unit};

use crate::channels::ChannelMapping;
use crate::facts::BenchVariant;
use crate::role::Role;

/// A proposal: which channel plays which role.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Guess {
    /// The channel proposed for each role.
    pub choices: BTreeMap<Role, Choice>,
    /// Roles that several channels would fit about equally well, with those channels, best first.
    pub ambiguous: Vec<Ambiguity>,
    /// Roles for which no channel was found.
    pub missing: Vec<Role>,
}

/// A channel proposed for a role.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Name of the channel.
    pub channel: String,
    /// Unit as the recording spells it; may be empty.
    pub recorded_unit: String,
    /// Unit to write in the bench file because the recording's own is absent or unknown.
    pub unit: Option<Unit>,
    /// How sure the choice is, 0…1: the share of the evidence that speaks for this channel and role.
    pub confidence: f64,
    /// Why.
    pub reasons: Vec<Reason>,
}

/// A role that several channels would fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Ambiguity {
    /// The role.
    pub role: Role,
    /// The channels, best first.
    pub channels: Vec<String>,
}

/// One piece of evidence for a choice.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// The name, or the comment, holds a word with this meaning.
    Word {
        /// The word found.
        word: String,
        /// Its meaning.
        meaning: Meaning,
        /// True where it is in the comment rather than the name.
        in_comment: bool,
    },
    /// The unit measures the role's quantity.
    Unit {
        /// The unit.
        unit: String,
        /// Quantity that the unit measures.
        quantity: Quantity,
    },
    /// The samples have this unit's magnitude.
    Magnitude {
        /// The unit assumed.
        unit: &'static str,
    },
    /// The samples lie in a range that the role's quantity allows.
    InRange {
        /// Smallest and largest, in the unit recorded or proposed.
        range: (f64, f64),
        /// That unit.
        unit: &'static str,
    },
    /// The samples are larger than the role's quantity allows at a bench.
    OutOfRange {
        /// The largest magnitude, in the unit recorded or proposed.
        largest: f64,
        /// That unit.
        unit: &'static str,
    },
    /// Recorded faster or slower than another channel, as the dynamometer's speed is beside the engine's.
    Sampled {
        /// Faster rather than slower.
        faster: bool,
        /// The other channel.
        than: String,
    },
    /// The samples are held or move without noise, as a demand does.
    NoiseFree {
        /// Share of the samples, 0…1.
        share: f64,
    },
    /// The samples are noisy, as a measurement's are.
    Noisy,
    /// The mean agrees with another channel's.
    MeanAgrees {
        /// The other channel.
        with: String,
    },
    /// The mean differs from another channel's that should turn equally fast.
    MeanDisagrees {
        /// The other channel.
        with: String,
        /// Difference over the other's mean.
        relative: f64,
    },
    /// Fluctuates more or less than another channel, as the engine's speed does beside the dynamometer's.
    Fluctuates {
        /// More rather than less.
        more: bool,
        /// The other channel.
        than: String,
    },
    /// Follows the torque demand.
    FollowsDemand {
        /// The demand's channel.
        demand: String,
        /// Correlation at the delay.
        correlation: f64,
        /// Delay, s.
        delay_s: f64,
    },
}

/// Meaning of a word in a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Meaning {
    /// Speed.
    Speed,
    /// Torque.
    Torque,
    /// Throttle or pedal.
    Throttle,
    /// Of the dynamometer.
    Dynamometer,
    /// Of the engine.
    Engine,
    /// Of the shaft.
    Shaft,
    /// A demand.
    Demand,
    /// In the air gap, or as the drive computes it.
    AirGap,
    /// Computed, not measured.
    Calculated,
    /// Of a load cell.
    LoadCell,
    /// Measured.
    Measured,
    /// Of a torque flange.
    Flange,
    /// A limit, deviation, temperature or the like: no role at all.
    Other,
}

impl Guess {
    /// The bench variant that the channels speak for.
    pub fn variant(&self) -> BenchVariant {
        if self.choices.contains_key(&Role::FlangeTorque) { BenchVariant::TorqueFlange } else { BenchVariant::LoadCell }
    }

    /// The proposal as the channel table of a bench file.
    pub fn mappings(&self) -> BTreeMap<Role, ChannelMapping> {
        let mapping = |choice: &Choice| ChannelMapping { unit: choice.unit, ..ChannelMapping::named(&choice.channel) };
        self.choices.iter().map(|(role, choice)| (*role, mapping(choice))).collect()
    }
}

impl fmt::Display for Meaning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Meaning::Speed => "speed",
            Meaning::Torque => "torque",
            Meaning::Throttle => "throttle",
            Meaning::Dynamometer => "dynamometer",
            Meaning::Engine => "engine",
            Meaning::Shaft => "shaft",
            Meaning::Demand => "demand",
            Meaning::AirGap => "air gap",
            Meaning::Calculated => "computed",
            Meaning::LoadCell => "load cell",
            Meaning::Measured => "measured",
            Meaning::Flange => "torque flange",
            Meaning::Other => "something else",
        })
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Reason::Word { word, meaning, in_comment: false } => write!(f, "`{word}` in the name means {meaning}"),
            Reason::Word { word, meaning, in_comment: true } => write!(f, "`{word}` in the comment means {meaning}"),
            Reason::Unit { unit, quantity } => write!(f, "{unit} is a unit of {quantity}"),
            Reason::Magnitude { unit } => write!(f, "its values are those of a channel in {unit}"),
            Reason::InRange { range: (from, to), unit } => {
                write!(f, "values from {} to {} {unit} are possible at a bench", rounded(*from), rounded(*to))
            }
            Reason::OutOfRange { largest, unit } => {
                write!(f, "its values reach {} {unit}, more than a bench can do", rounded(*largest))
            }
            Reason::Sampled { faster: true, than } => write!(f, "it is recorded faster than {than}"),
            Reason::Sampled { faster: false, than } => write!(f, "it is recorded more slowly than {than}"),
            Reason::NoiseFree { share } => write!(f, "{:.0} % of its samples are free of noise", 100.0 * share),
            Reason::Noisy => write!(f, "its samples are noisy"),
            Reason::MeanAgrees { with } => write!(f, "its mean agrees with {with}"),
            Reason::MeanDisagrees { with, relative } => {
                write!(f, "its mean differs from {with} by {:.1} %", 100.0 * relative)
            }
            Reason::Fluctuates { more: true, than } => write!(f, "it fluctuates more than {than}"),
            Reason::Fluctuates { more: false, than } => write!(f, "it fluctuates less than {than}"),
            Reason::FollowsDemand { demand, correlation, delay_s } => {
                write!(f, "it follows {demand} {:.0} ms later with correlation {correlation:.2}", 1e3 * delay_s)
            }
        }
    }
}

/// Four significant digits, without an exponent.
pub(super) fn rounded(value: f64) -> f64 {
    let scale = 10f64.powi(3 - value.abs().max(1e-9).log10().floor() as i32);
    (value * scale).round() / scale
}
