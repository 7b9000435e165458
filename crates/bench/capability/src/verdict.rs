//! Joint verdict of all benches.

use cycle::{Judged, Own, RequirementSet, Signal, Statistic, Validation};
use design::safety::reaches;
use numerics::null::{infinite_if_null, nan_if_null};
use numerics::order;
use serde::{Deserialize, Serialize};
use signal::proportion::Proportion;

use crate::beyond::Beyond;
use crate::doubt::Doubt;
use crate::extremes::LimitOf;
use crate::outcome::Outcome;
use crate::trace::Trace;

/// Times at which the spread of a course is kept.
const BAND_POINTS: usize = 400;
/// From this share of the benches on the answer is yes.
const YES: f64 = 0.95;
/// Up to this share it is no.
const NO: f64 = 0.5;

/// The answer in a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// 95 % of the benches keep everything.
    Yes,
    /// More than half of them do.
    Perhaps,
    /// No more than half of them do.
    No,
    /// 95 % of the benches keep everything, but the test goes beyond what the model or the engine's map is known for.
    NotShown,
    /// No limit is stated, and nothing is required.
    NotJudged,
}

/// One limit of the bench.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LimitVerdict {
    /// Of what.
    pub of: LimitOf,
    /// The limit stated, SI.
    pub limit: Option<f64>,
    /// The largest value on every bench, SI.
    pub values: Spread,
    /// How often the limit is reached; `None` without one.
    pub reached: Option<Proportion>,
    /// When the largest value comes on the nominal bench, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub time_s: f64,
}

/// One number of a requirement set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StatisticVerdict {
    /// Of which signal.
    pub signal: Signal,
    /// Which number.
    pub statistic: Statistic,
    /// Its limits, SI.
    pub low: Option<f64>,
    /// Upper limit, SI.
    pub high: Option<f64>,
    /// Its value on every bench, SI.
    pub values: Spread,
    /// How many benches keep the limit.
    pub kept: Proportion,
}

/// One requirement set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SetVerdict {
    /// Its name.
    pub name: String,
    /// How many benches meet it.
    pub kept: Proportion,
    /// Its numbers.
    pub statistics: Vec<StatisticVerdict>,
    /// The nominal bench.
    pub nominal: Option<Validation>,
}

/// One requirement of one's own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OwnVerdict {
    /// The requirement.
    pub own: Own,
    /// How many benches meet it.
    pub kept: Proportion,
    /// Its number on every bench.
    pub values: Spread,
    /// Its limit.
    #[serde(deserialize_with = "nan_if_null")]
    pub limit: f64,
    /// When the worst comes on the nominal bench, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub time_s: f64,
}

/// Where 90 % of the benches are.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bands {
    /// Times, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub time_s: Vec<f64>,
    /// 5 % and 95 % of the speed, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: [Vec<f64>; 2],
    /// 5 % and 95 % of the torque that follows the demand, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_nm: [Vec<f64>; 2],
}

/// Verdict on a test on a bench.
///
/// JSON has no curves: what is read has none in `nominal` and `bands`. A number that is null is not known, or infinite
/// where a bench may not be stable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Verdict {
    /// In a word.
    pub answer: Answer,
    /// Why a yes is not shown.
    pub beyond: Vec<Beyond>,
    /// How many benches keep every limit and every requirement.
    pub kept: Proportion,
    /// How many are not stable.
    pub unstable: Proportion,
    /// The limits.
    pub limits: Vec<LimitVerdict>,
    /// Limits that are not stated.
    pub unchecked: Vec<LimitOf>,
    /// The requirement sets.
    pub sets: Vec<SetVerdict>,
    /// Requirements of one's own.
    pub own: Vec<OwnVerdict>,
    /// For an answer that is no yes and no no: what of the model decides it, the most first.
    pub doubts: Vec<Doubt>,
    /// The nominal bench.
    #[serde(skip)]
    pub nominal: Trace,
    /// How the others spread.
    #[serde(skip)]
    pub bands: Bands,
}

/// A number on every bench drawn; null in JSON is read as infinite, as on a bench that is not stable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(transparent)]
pub struct Spread(#[serde(deserialize_with = "infinite_if_null")] Vec<f64>);

impl Spread {
    pub(crate) fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        Spread(values)
    }

    /// The value that a bench stays below with a probability.
    pub fn quantile(&self, probability: f64) -> f64 {
        order::quantile_of_sorted(&self.0, probability).unwrap_or(f64::NAN)
    }

    /// The values, growing.
    pub fn as_slice(&self) -> &[f64] {
        &self.0
    }
}

impl Verdict {
    /// The stated limit that most benches reach; of several, the one that 95 % of the benches come nearest to.
    pub fn binding(&self) -> Option<LimitOf> {
        let of = |one: &LimitVerdict| Some((one.of, one.reached?.count, one.values.quantile(0.95) / one.limit?));
        let stated = self.limits.iter().filter_map(of);
        stated.max_by(|a, b| a.1.cmp(&b.1).then(a.2.total_cmp(&b.2))).map(|(of, ..)| of)
    }
}

/// The answer of benches of which so many keep everything.
pub(crate) fn answer_of(kept: &Proportion, is_judged: bool, is_beyond: bool) -> Answer {
    match kept.estimate {
        _ if is_share_of_yes(kept.count, kept.of) && !is_judged => Answer::NotJudged,
        _ if is_share_of_yes(kept.count, kept.of) && !is_beyond => Answer::Yes,
        _ if is_share_of_yes(kept.count, kept.of) => Answer::NotShown,
        share if share > NO => Answer::Perhaps,
        _ => Answer::No,
    }
}

/// Tells whether so many benches of so many make a yes.
pub(crate) fn is_share_of_yes(kept: usize, of: usize) -> bool {
    kept as f64 / of as f64 >= YES
}

/// How many benches of so many may miss something in a yes.
pub(crate) fn most_misses(of: usize) -> usize {
    (0..=of).rev().find(|misses| is_share_of_yes(of - misses, of)).unwrap_or(0)
}

pub(crate) fn proportion(outcomes: &[Outcome], is: impl Fn(&Outcome) -> bool) -> Proportion {
    Proportion::new(outcomes.iter().filter(|outcome| is(outcome)).count(), outcomes.len())
}

pub(crate) fn limit_verdict(of: LimitOf, limit: Option<f64>, outcomes: &[Outcome], nominal: &Outcome) -> LimitVerdict {
    let value = |outcome: &Outcome| outcome.peaks[of as usize].value;
    LimitVerdict {
        of,
        limit,
        values: Spread::of(outcomes.iter().map(value).collect()),
        reached: limit.map(|limit| proportion(outcomes, |one| reaches(value(one), limit))),
        time_s: nominal.peaks[of as usize].time_s,
    }
}

pub(crate) fn set_verdict(place: usize, set: &RequirementSet, outcomes: &[Outcome], nominal: &Outcome) -> SetVerdict {
    let of_nominal = nominal.validations.get(place);
    let statistic = |k: usize| {
        let first = &of_nominal?.checked[k];
        let one = |outcome: &Outcome| outcome.validations.get(place)?.checked.get(k).copied();
        Some(StatisticVerdict {
            signal: first.signal,
            statistic: first.statistic,
            low: first.low,
            high: first.high,
            values: Spread::of(outcomes.iter().filter_map(|outcome| Some(one(outcome)?.value)).collect()),
            kept: proportion(outcomes, |outcome| one(outcome).is_some_and(|one| one.passes)),
        })
    };
    SetVerdict {
        name: set.name.clone(),
        kept: proportion(outcomes, |outcome| outcome.validations.get(place).is_some_and(|one| one.passes)),
        statistics: (0..of_nominal.map_or(0, |one| one.checked.len())).filter_map(statistic).collect(),
        nominal: of_nominal.cloned(),
    }
}

pub(crate) fn own_verdict(place: usize, own: &Own, outcomes: &[Outcome], nominal: &Outcome) -> OwnVerdict {
    let of_nominal = nominal.own.get(place);
    OwnVerdict {
        own: *own,
        kept: proportion(outcomes, |outcome| outcome.own.get(place).is_some_and(Judged::passes)),
        values: Spread::of(outcomes.iter().filter_map(|outcome| Some(outcome.own.get(place)?.value)).collect()),
        limit: of_nominal.map_or(f64::NAN, |one| one.limit),
        time_s: of_nominal.map_or(f64::NAN, |one| one.time_s),
    }
}

pub(crate) fn band_places(trace: &Trace) -> impl Iterator<Item = usize> {
    let count = trace.speed_rad_s.len();
    (0..BAND_POINTS.min(count)).map(move |k| k * count.saturating_sub(1) / (BAND_POINTS.min(count) - 1).max(1))
}

pub(crate) fn bands(trace: &Trace, outcomes: &[Outcome]) -> Bands {
    let places: Vec<usize> = band_places(trace).collect();
    let at = |k: usize, of: fn(&(f64, f64)) -> f64, probability: f64| {
        Spread::of(outcomes.iter().filter_map(|outcome| outcome.course.get(k)).map(of).collect()).quantile(probability)
    };
    let band = |of: fn(&(f64, f64)) -> f64| {
        [0.05, 0.95].map(|probability| (0..places.len()).map(|k| at(k, of, probability)).collect())
    };
    Bands {
        time_s: places.iter().map(|k| trace.time_s(*k)).collect(),
        speed_rad_s: band(|point| point.0),
        torque_nm: band(|point| point.1),
    }
}
