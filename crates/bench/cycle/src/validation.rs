//! Validation of a run of a cycle: every shift and every choice of omissions is tried, and the run is valid if one of
//! them is.

use numerics::null::{infinite_if_null, nan_if_null};
use serde::{Deserialize, Serialize};

use crate::error::CycleError;
use crate::feedback::{Feedback, Points, Seconds};
use crate::omission::{Omission, Rows};
use crate::reference::{Reference, Scales};
use crate::regression::Regression;
use crate::requirement::{Criterion, Limit, RequirementSet, Signal, Statistic};

/// Shifts are tried in steps of this, s.
const SHIFT_STEP_S: f64 = 0.1;
/// Speeds below this part of the largest are standstill.
const STANDSTILL: f64 = 1e-3;

/// One number against its limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Checked {
    /// Of which signal.
    pub signal: Signal,
    /// Which number.
    pub statistic: Statistic,
    /// The number that is compared, SI: of an intercept its magnitude; rounded where the set rounds it.
    #[serde(deserialize_with = "nan_if_null")]
    pub value: f64,
    /// Lowest that is allowed; none where only a largest is.
    pub low: Option<f64>,
    /// Largest that is allowed, SI.
    pub high: Option<f64>,
    /// True if the number keeps the limit.
    pub passes: bool,
    /// How far it is beyond, as a part of the room that the limit gives: 1 is at the limit, below is better.
    #[serde(deserialize_with = "infinite_if_null")]
    pub use_of_limit: f64,
}

/// How a run of a cycle is judged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Validation {
    /// True if every limit is kept.
    pub passes: bool,
    /// How far the feedback was moved forward, s.
    pub shift_s: f64,
    /// Which omissions were used.
    pub omission: Omission,
    /// Points left out, of speed, torque and power.
    pub omitted: [usize; 3],
    /// Seconds compared.
    pub seconds: usize,
    /// The regressions of speed, torque and power; `None` where one is not asked for, or impossible.
    pub regressions: [Option<Regression>; 3],
    /// Every number with its limit.
    pub checked: Vec<Checked>,
    /// Choices of shift and omission that were tried.
    pub tried: usize,
}

impl Validation {
    /// The number that is furthest beyond its limit, or nearest to it.
    pub fn worst(&self) -> Option<&Checked> {
        self.checked.iter().max_by(|a, b| a.use_of_limit.total_cmp(&b.use_of_limit))
    }

    /// Returns true if fewer numbers are beyond their limits, or the worst of as many is less far beyond.
    fn is_less_bad_than(&self, other: &Validation) -> bool {
        let missed = |one: &Validation| one.checked.iter().filter(|checked| !checked.passes).count();
        let use_of = |one: &Validation| one.worst().map_or(f64::INFINITY, |worst| worst.use_of_limit);
        (missed(self), use_of(self)) < (missed(other), use_of(other))
    }
}

/// Judges a run by a requirement set. The feedback is moved forward by 0 … [`RequirementSet::shift_s`] in steps of 0.1
/// s. The first choice that passes is returned, the one with the shortest shift and the fewest rows of omissions; if
/// none passes, the one with the fewest numbers beyond their limits, and of those the one whose worst number is least
/// bad.
///
/// # Errors
/// A feedback that does not cover the cycle, has a gap, or series of unequal length.
pub fn validate(reference: &Reference, feedback: &Feedback, set: &RequirementSet) -> Result<Validation, CycleError> {
    let seconds = Seconds::of(feedback)?;
    let steps = (set.shift_s / SHIFT_STEP_S).round() as usize;
    let choices = if set.omission { Omission::choices() } else { vec![Omission::NONE] };
    let largest_rad_s = reference.speed_rad_s.iter().copied().fold(0.0, f64::max);
    let mut best: Option<Validation> = None;
    for step in 0..=steps {
        let shift_s = step as f64 * SHIFT_STEP_S;
        let points = seconds.points(reference, set.reference_means, shift_s)?;
        let mut judge = Judge { set, scales: &reference.scales, largest_rad_s, points: &points, known: Vec::new() };
        let rows = points.rows(&reference.scales);
        for choice in &choices {
            let mut found = judge.of(*choice, &rows);
            found.shift_s = shift_s;
            found.tried = (steps + 1) * choices.len();
            if found.passes {
                return Ok(found);
            }
            if best.as_ref().is_none_or(|best| found.is_less_bad_than(best)) {
                best = Some(found);
            }
        }
    }
    best.ok_or(CycleError::Length { what: "reference", expected: 3, found: reference.speed_rad_s.len() })
}

/// The regression of some of the points; `None` where there is none.
struct Known {
    signal: Signal,
    kept: Vec<bool>,
    regression: Option<Regression>,
}

/// One shift, judged with any omissions; regressions of the same points are made once.
struct Judge<'a> {
    set: &'a RequirementSet,
    scales: &'a Scales,
    largest_rad_s: f64,
    points: &'a Points,
    known: Vec<Known>,
}

impl Judge<'_> {
    fn of(&mut self, omission: Omission, rows: &[Rows]) -> Validation {
        let moves = |k: usize| {
            !self.set.without_standstill || self.points.speed_reference_rad_s[k] > STANDSTILL * self.largest_rad_s
        };
        let moving: Vec<bool> = (0..rows.len()).map(moves).collect();
        let mut validation = Validation {
            passes: false,
            shift_s: 0.0,
            omission,
            omitted: [0; 3],
            seconds: rows.len(),
            regressions: [None; 3],
            checked: Vec::new(),
            tried: 0,
        };
        for (place, signal) in Signal::ALL.into_iter().enumerate() {
            let Some(criterion) = self.set.criterion(signal).copied() else { continue };
            let kept: Vec<bool> =
                rows.iter().zip(&moving).map(|(rows, moves)| *moves && keeps(omission, signal, *rows)).collect();
            validation.omitted[place] = kept.iter().filter(|kept| !**kept).count();
            let regression = self.regression(signal, kept);
            validation.regressions[place] = regression;
            let checked = regression.map(|regression| self.checked(signal, &criterion, &regression));
            validation.checked.extend(checked.unwrap_or_else(|| vec![impossible(signal)]));
        }
        validation.checked.extend(self.set.work.map(|[low, high]| self.work((low, high))));
        validation.passes = validation.checked.iter().all(|checked| checked.passes);
        validation
    }

    fn regression(&mut self, signal: Signal, kept: Vec<bool>) -> Option<Regression> {
        if let Some(known) = self.known.iter().find(|known| known.signal == signal && known.kept == kept) {
            return known.regression;
        }
        let points = self.points;
        let pair = |k: usize| match signal {
            Signal::Speed => (points.speed_reference_rad_s[k], points.speed_rad_s[k]),
            Signal::Torque => (points.torque_reference_nm[k], points.torque_nm[k]),
            Signal::Power => (
                points.speed_reference_rad_s[k] * points.torque_reference_nm[k],
                points.speed_rad_s[k] * points.torque_nm[k],
            ),
        };
        let pairs: Vec<(f64, f64)> = (0..kept.len()).filter(|k| kept[*k]).map(pair).collect();
        let regression = Regression::of(&pairs);
        self.known.push(Known { signal, kept, regression });
        regression
    }

    fn checked(&self, signal: Signal, criterion: &Criterion, regression: &Regression) -> Vec<Checked> {
        let most = |statistic, value: f64, limit: &Limit| {
            let per_cent = limit.per_cent(self.scales, self.largest_rad_s);
            let high = (limit.percent * per_cent).max(limit.at_least);
            let (passes, use_of_limit) = (value <= high, value / high);
            Checked { signal, statistic, value, low: None, high: Some(high), passes, use_of_limit }
        };
        let error = most(Statistic::StandardError, regression.standard_error, &criterion.standard_error);
        if self.is_narrow() {
            return vec![error];
        }
        let [low, high] = criterion.slope;
        vec![
            between(signal, Statistic::Slope, self.rounded(regression.slope), (low, high)),
            most(Statistic::Intercept, regression.intercept.abs(), &criterion.intercept),
            error,
            at_least(signal, Statistic::Determination, self.rounded(regression.determination), criterion.determination),
        ]
    }

    /// To the decimals of the set; a number in the middle goes to the even one (ASTM E29).
    fn rounded(&self, value: f64) -> f64 {
        let Some(decimals) = self.set.decimals else { return value };
        let scale = 10_f64.powi(decimals);
        (value * scale).round_ties_even() / scale
    }

    /// Returns true if the reference speed hardly changes.
    fn is_narrow(&self) -> bool {
        let speeds = &self.points.speed_reference_rad_s;
        let (low, high, sum) = speeds.iter().fold((f64::INFINITY, 0.0_f64, 0.0), |(low, high, sum), speed| {
            (speed.min(low), speed.max(high), sum + speed)
        });
        self.set.narrow_range > 0.0 && high - low < self.set.narrow_range * sum / speeds.len() as f64
    }

    fn work(&self, (low, high): (f64, f64)) -> Checked {
        let points = self.points;
        let work =
            |speed: &[f64], torque: &[f64]| -> f64 { speed.iter().zip(torque).map(|(n, t)| (n * t).max(0.0)).sum() };
        let reference = work(&points.speed_reference_rad_s, &points.torque_reference_nm);
        let ratio = work(&points.speed_rad_s, &points.torque_nm) / reference;
        between(Signal::Power, Statistic::Work, self.rounded(ratio), (low, high))
    }
}

fn keeps(omission: Omission, signal: Signal, rows: Rows) -> bool {
    match signal {
        Signal::Speed => omission.keeps_speed(rows),
        Signal::Torque => omission.keeps_torque(rows),
        Signal::Power => omission.keeps_power(rows),
    }
}

fn impossible(signal: Signal) -> Checked {
    Checked {
        signal,
        statistic: Statistic::Determination,
        value: f64::NAN,
        low: None,
        high: None,
        passes: false,
        use_of_limit: f64::INFINITY,
    }
}

fn between(signal: Signal, statistic: Statistic, value: f64, (low, high): (f64, f64)) -> Checked {
    let room = if value < 1.0 { (1.0 - value) / (1.0 - low) } else { (value - 1.0) / (high - 1.0) };
    Checked {
        signal,
        statistic,
        value,
        low: Some(low),
        high: Some(high),
        passes: (low..=high).contains(&value),
        use_of_limit: if room.is_nan() { f64::INFINITY } else { room },
    }
}

fn at_least(signal: Signal, statistic: Statistic, value: f64, low: f64) -> Checked {
    let (passes, use_of_limit) = (value >= low, (1.0 - value) / (1.0 - low));
    Checked { signal, statistic, value, low: Some(low), high: None, passes, use_of_limit }
}
