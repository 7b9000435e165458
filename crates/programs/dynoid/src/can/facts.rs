//! The results in numbers, as programs read them.

use capability::wanted::WantedAnswer;
use capability::{
    Answer, Beyond, Change, Doubt, Easier, FollowingSpread, LimitOf, LimitVerdict, OwnVerdict, SetVerdict, Spread,
    StatisticVerdict,
};
use capability::{gradient::GradientPlace, map::CapabilityMap};
use cycle::{RequirementSet, Signal, Validation};
use design::safety::FrictionSpread;
use report::can::{JudgedOwn, Referred, limit_of, statistic};
use serde::Serialize;
use signal::proportion::Proportion;
use virtual_bench::Assumption;

use crate::known::PulsesFrom;

/// Quantiles over the benches.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Quantiles {
    quantile_5: f64,
    median: f64,
    quantile_95: f64,
}

impl Quantiles {
    /// In the unit of which one is so many in SI.
    fn of(values: &Spread, si: f64) -> Self {
        let at = |probability| values.quantile(probability) / si;
        Quantiles { quantile_5: at(0.05), median: at(0.5), quantile_95: at(0.95) }
    }
}

/// Numbers of [`super::Predicted`].
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PredictedFacts<'a> {
    pub(super) test: &'a str,
    pub(super) duration_s: f64,
    pub(super) answer: Answer,
    pub(super) sentence: String,
    pub(super) beyond: Vec<BeyondFacts<'a>>,
    pub(super) kept: &'a Proportion,
    pub(super) unstable: &'a Proportion,
    pub(super) samples: usize,
    pub(super) limits: Vec<LimitFacts<'a>>,
    pub(super) unchecked: &'a [LimitOf],
    pub(super) requirements: Vec<SetFacts<'a>>,
    pub(super) own: Vec<OwnFacts<'a>>,
    pub(super) easier: Vec<EasierFacts<'a>>,
    pub(super) doubts: &'a [Doubt],
    pub(super) spread: &'static str,
    pub(super) engine_pulses: PulsesFrom<'a>,
    pub(super) assumptions: &'a [Assumption],
    pub(super) friction: FrictionSpread,
    pub(super) engine_following: Option<FollowingSpread>,
}

/// Part of a test beyond what is known, with its words.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct BeyondFacts<'a> {
    words: String,
    numbers: &'a Beyond,
}

impl<'a> BeyondFacts<'a> {
    pub(super) fn of(beyond: &'a Beyond) -> Self {
        BeyondFacts { words: report::can::beyond(beyond), numbers: beyond }
    }
}

/// A limit of the bench.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct LimitFacts<'a> {
    of: LimitOf,
    name: &'static str,
    unit: &'static str,
    limit: Option<f64>,
    #[serde(flatten)]
    values: Quantiles,
    margin: Option<f64>,
    reached: &'a Option<Proportion>,
    time_s: f64,
}

impl<'a> LimitFacts<'a> {
    pub(super) fn of(one: &'a LimitVerdict) -> Self {
        let (name, unit, si) = limit_of(one.of);
        LimitFacts {
            of: one.of,
            name,
            unit,
            limit: one.limit.map(|limit| limit / si),
            values: Quantiles::of(&one.values, si),
            margin: one.limit.map(|limit| 1.0 - one.values.quantile(0.95) / limit),
            reached: &one.reached,
            time_s: one.time_s,
        }
    }
}

/// A requirement set.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct SetFacts<'a> {
    name: &'a str,
    kept: &'a Proportion,
    statistics: Vec<StatisticFacts<'a>>,
    nominal: &'a Option<Validation>,
}

impl<'a> SetFacts<'a> {
    pub(super) fn of(set: &'a SetVerdict) -> Self {
        let statistics = set.statistics.iter().map(StatisticFacts::of).collect();
        SetFacts { name: &set.name, kept: &set.kept, statistics, nominal: &set.nominal }
    }
}

/// A statistic of a requirement set.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct StatisticFacts<'a> {
    signal: Signal,
    statistic: &'static str,
    low: Option<f64>,
    high: Option<f64>,
    #[serde(flatten)]
    values: Quantiles,
    lowest: Option<f64>,
    highest: Option<f64>,
    kept: &'a Proportion,
}

impl<'a> StatisticFacts<'a> {
    fn of(one: &'a StatisticVerdict) -> Self {
        StatisticFacts {
            signal: one.signal,
            statistic: statistic(one.statistic),
            low: one.low,
            high: one.high,
            values: Quantiles::of(&one.values, 1.0),
            lowest: one.values.as_slice().first().copied(),
            highest: one.values.as_slice().last().copied(),
            kept: &one.kept,
        }
    }
}

/// A requirement of one's own.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct OwnFacts<'a> {
    requirement: String,
    limit: f64,
    #[serde(flatten)]
    values: Quantiles,
    margin: f64,
    kept: &'a Proportion,
    time_s: f64,
}

impl<'a> OwnFacts<'a> {
    pub(super) fn of(one: &'a OwnVerdict) -> Self {
        OwnFacts {
            requirement: report::can::own(&one.own),
            limit: one.limit,
            values: Quantiles::of(&one.values, 1.0),
            margin: 1.0 - one.values.quantile(0.95) / one.limit,
            kept: &one.kept,
            time_s: one.time_s,
        }
    }
}

/// A change that would make a no a yes.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct EasierFacts<'a> {
    change: Change,
    words: String,
    kept: &'a Proportion,
}

impl<'a> EasierFacts<'a> {
    pub(super) fn of(one: &'a Easier) -> Self {
        EasierFacts { change: one.change, words: report::can::change(one.change), kept: &one.kept }
    }
}

/// Numbers of [`super::JudgedRun`].
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunFacts<'a> {
    pub(super) test: &'a str,
    pub(super) file: &'a str,
    pub(super) passes: bool,
    pub(super) start_s: f64,
    pub(super) speed: &'a Option<String>,
    pub(super) torque: &'a Option<String>,
    pub(super) limits_refer_to: Referred,
    pub(super) remarks: &'a [String],
    pub(super) requirements: Vec<JudgedSetFacts<'a>>,
    pub(super) own: Vec<JudgedOwnFacts>,
}

/// A requirement set, judged.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct JudgedSetFacts<'a> {
    name: &'a str,
    paragraph: &'a str,
    year: u32,
    text_seen: bool,
    result: &'a Validation,
}

impl<'a> JudgedSetFacts<'a> {
    pub(super) fn of((set, result): &'a (RequirementSet, Validation)) -> Self {
        JudgedSetFacts { name: &set.name, paragraph: &set.paragraph, year: set.year, text_seen: set.seen, result }
    }
}

/// A requirement of one's own, judged.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct JudgedOwnFacts {
    requirement: String,
    value: f64,
    limit: f64,
    uncertain_by: Option<f64>,
    passes: bool,
    time_s: f64,
}

impl JudgedOwnFacts {
    pub(super) fn of(one: &JudgedOwn) -> Self {
        let judged = one.judged;
        JudgedOwnFacts {
            requirement: report::can::own(&one.own),
            value: judged.value,
            limit: judged.limit,
            uncertain_by: one.uncertain_by,
            passes: judged.passes(),
            time_s: judged.time_s,
        }
    }
}

/// Numbers of [`super::Capability`].
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CapabilityFacts<'a> {
    pub(super) bench: &'a str,
    pub(super) torque_nm: f64,
    pub(super) unchecked: &'a [LimitOf],
    pub(super) beyond: Vec<BeyondFacts<'a>>,
    pub(super) friction: FrictionSpread,
    pub(super) engine_pulses: PulsesFrom<'a>,
    pub(super) wanted: &'a [WantedAnswer],
    pub(super) maps: &'a [CapabilityMap],
    pub(super) gradients: &'a [GradientPlace],
}
