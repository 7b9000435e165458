//! Requirements of one's own.

use std::fmt;
use std::str::FromStr;

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};
use units::{Quantity, RPM_RAD_S, parse_value};

use crate::error::CycleError;
use crate::requirement::Signal;
use crate::tone::{Lag, Samples, lag, largest_sine};

/// A step has begun to rise at this part of it.
const RISE_BEGINS: f64 = 0.1;
/// A step has risen at this part of it.
const RISE_ENDS: f64 = 0.9;
/// A demand has a sine if its amplitude is at least this part of the span of the demand.
const LEAST_SINE: f64 = 0.01;
/// A sine that is this part of what the demand does about it shows a phase by itself: of a step or a ramp it is some
/// per cent.
const LEAST_TONE: f64 = 0.3;
/// A step from the first value of a demand to its last goes beyond neither by more than this part of it.
const BEYOND_STEP: f64 = 0.05;

/// A requirement, from a text such as `speed within 10 rpm for 95 %`, `torque rise below 50 ms`,
/// `speed overshoot below 5 %`, `torque settling within 2 % below 0.5 s`, `speed phase at 2 Hz below 30 deg`,
/// `shaft_torque amplitude at 12 Hz below 80 Nm`.
///
/// # Example
/// ```
/// let own: cycle::Own = "torque rise below 50 ms".parse()?;
/// assert_eq!(own, cycle::Own::Rise { signal: cycle::Signal::Torque, most_s: 0.05 });
/// # Ok::<(), cycle::CycleError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Own {
    /// |error| is at most this for a share of the time.
    Within {
        /// Of which signal.
        signal: Signal,
        /// Largest error, rad/s or Nm.
        error: f64,
        /// Share of the time, 0 … 1.
        share: f64,
    },
    /// From 10 to 90 % of the step in at most this time.
    Rise {
        /// Of which signal.
        signal: Signal,
        /// Longest time, s.
        most_s: f64,
    },
    /// Beyond the step's end by at most this part of it.
    Overshoot {
        /// Of which signal.
        signal: Signal,
        /// Largest part of the step.
        most: f64,
    },
    /// Within a part of the step about its end after at most this time.
    Settling {
        /// Of which signal.
        signal: Signal,
        /// Part of the step.
        band: f64,
        /// Longest time, s.
        most_s: f64,
    },
    /// Behind the demand by at most this angle at a frequency, or ahead of it.
    Phase {
        /// Of which signal.
        signal: Signal,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Largest angle, rad.
        most_rad: f64,
    },
    /// A sine of at most this amplitude at a frequency.
    Amplitude {
        /// At which sensor.
        sensor: Sensor,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Largest amplitude, rad/s or Nm.
        most: f64,
    },
}

/// Where a requirement looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Sensor {
    /// The speed that follows the demand.
    Speed,
    /// The torque that follows the demand.
    Torque,
    /// ω_d.
    DynoSpeed,
    /// ω_e.
    EngineSpeed,
    /// T_shaft.
    ShaftTorque,
    /// T_d*.
    TorqueDemand,
}

/// A demand and what came of it, on one clock.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    /// Time between samples, s.
    pub sample_time_s: f64,
    /// The demand, rad/s or Nm.
    pub demand: &'a [f64],
    /// Response to the demand.
    pub value: &'a [f64],
    /// The demand with times of its own, on a clock that begins with the value, for phases; `None`: it changes between
    /// the samples.
    pub timed_demand: Option<Samples<'a>>,
}

/// A number against its limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// The number: the error that the share of the time stays below (rad/s, Nm), a time (s), or a part of the step.
    #[serde(deserialize_with = "nan_if_null")]
    pub value: f64,
    /// The limit, in the same unit.
    #[serde(deserialize_with = "nan_if_null")]
    pub limit: f64,
    /// When the worst happens, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub time_s: f64,
}

impl Judged {
    /// Returns true if the limit is kept.
    pub fn passes(&self) -> bool {
        self.value <= self.limit
    }
}

impl Own {
    /// By how much the number of a course may be off at 95 % by what does not follow the demand, in its unit; `None`
    /// where the course cannot show it. Only a phase has it.
    pub fn scatter(&self, course: &Course<'_>) -> Option<f64> {
        let Own::Phase { frequency_hz, .. } = *self else { return None };
        course.lag(frequency_hz).scatter_rad
    }

    /// Which signal it is about.
    pub fn signal(&self) -> Signal {
        match *self {
            Own::Within { signal, .. } | Own::Rise { signal, .. } => signal,
            Own::Overshoot { signal, .. } | Own::Settling { signal, .. } | Own::Phase { signal, .. } => signal,
            Own::Amplitude { sensor, .. } => sensor.signal(),
        }
    }

    /// Where it looks.
    pub fn sensor(&self) -> Sensor {
        match *self {
            Own::Amplitude { sensor, .. } => sensor,
            _ if self.signal() == Signal::Speed => Sensor::Speed,
            _ => Sensor::Torque,
        }
    }

    /// Reason why no run could meet the requirement, or every run would.
    fn impossible(&self) -> Option<&'static str> {
        let is_above_zero = |value: f64| value.is_finite() && value > 0.0;
        match *self {
            Own::Within { error, .. } if !is_above_zero(error) => Some("the error is not above 0"),
            Own::Within { share, .. } if !is_above_zero(share) || share > 1.0 => {
                Some("the share of the time is not above 0 and up to 100 %")
            }
            Own::Overshoot { most, .. } if !most.is_finite() || most < 0.0 => Some("the overshoot is below 0"),
            Own::Settling { band, .. } if !is_above_zero(band) => Some("the band is not above 0"),
            Own::Rise { most_s, .. } | Own::Settling { most_s, .. } if !is_above_zero(most_s) => {
                Some("the time is not above 0")
            }
            Own::Phase { most_rad, .. } if !is_above_zero(most_rad) => Some("the angle is not above 0"),
            Own::Amplitude { most, .. } if !is_above_zero(most) => Some("the amplitude is not above 0"),
            _ => None,
        }
    }

    /// Checks that a course can be judged by it.
    ///
    /// # Errors
    /// [`CycleError::NotInTest`]: no such signal, samples too far apart, a demand without a step, without a sine at the
    /// frequency.
    pub fn check(&self, course: &Course<'_>) -> Result<(), CycleError> {
        let fault = |problem: String| Err(CycleError::NotInTest { text: self.to_string(), problem });
        if course.value.is_empty() {
            return fault(format!("it has no {}", self.sensor().name()));
        }
        match *self {
            Own::Within { .. } => Ok(()),
            Own::Rise { .. } | Own::Overshoot { .. } | Own::Settling { .. } => {
                course.no_step().map_or(Ok(()), |problem| fault(problem.to_owned()))
            }
            Own::Phase { frequency_hz, .. } | Own::Amplitude { frequency_hz, .. } => {
                let Some(_) = largest_sine(course.value, course.sample_time_s, frequency_hz) else {
                    let step_ms = 1e3 * course.sample_time_s;
                    return fault(format!(
                        "it needs a period of {frequency_hz} Hz with 5 samples, which are {step_ms:.3} ms apart"
                    ));
                };
                if matches!(self, Own::Phase { .. }) && !course.shows_phase(frequency_hz) {
                    return fault(format!(
                        "its demand has no part at {frequency_hz} Hz that lasts; take a sine or a sweep that has one"
                    ));
                }
                Ok(())
            }
        }
    }

    /// Judges a course; a step goes from the first value of the demand to its last.
    pub fn judge(&self, course: &Course<'_>) -> Judged {
        match *self {
            Own::Within { error, share, .. } => course.within(error, share),
            Own::Rise { most_s, .. } => {
                let (from, to) = (course.first_beyond(RISE_BEGINS), course.first_beyond(RISE_ENDS));
                let value = to.zip(from).map_or(f64::INFINITY, |(to, from)| course.time_s(to) - course.time_s(from));
                Judged { value, limit: most_s, time_s: to.map_or(f64::NAN, |to| course.time_s(to)) }
            }
            Own::Overshoot { most, .. } => {
                let parts = course.value.iter().map(|value| course.part(*value) - 1.0);
                let (at, value) = largest(parts);
                Judged { value: value.max(0.0), limit: most, time_s: course.time_s(at) }
            }
            Own::Settling { band, most_s, .. } => {
                let outside = course.value.iter().rposition(|value| (course.part(*value) - 1.0).abs() > band);
                let settled = outside.map_or(0, |at| at + 1);
                let is_settled = settled < course.value.len();
                let value = (course.time_s(settled) - course.time_s(course.begins())).max(0.0);
                let value = if is_settled { value } else { f64::INFINITY };
                Judged { value, limit: most_s, time_s: course.time_s(settled) }
            }
            Own::Phase { frequency_hz, most_rad, .. } => {
                let value = course.lag(frequency_hz).rad.abs();
                let asked = largest_sine(course.demand, course.sample_time_s, frequency_hz);
                Judged { value, limit: most_rad, time_s: asked.map_or(f64::NAN, |sine| sine.time_s) }
            }
            Own::Amplitude { frequency_hz, most, .. } => {
                let found = largest_sine(course.value, course.sample_time_s, frequency_hz);
                let (value, time_s) = found.map_or((f64::NAN, f64::NAN), |sine| (sine.amplitude, sine.time_s));
                Judged { value, limit: most, time_s }
            }
        }
    }
}

impl Sensor {
    /// All of them.
    pub const ALL: [Sensor; 6] = [
        Sensor::Speed,
        Sensor::Torque,
        Sensor::DynoSpeed,
        Sensor::EngineSpeed,
        Sensor::ShaftTorque,
        Sensor::TorqueDemand,
    ];

    /// Its name in a requirement.
    pub fn name(self) -> &'static str {
        match self {
            Sensor::Speed => "speed",
            Sensor::Torque => "torque",
            Sensor::DynoSpeed => "dyno_speed",
            Sensor::EngineSpeed => "engine_speed",
            Sensor::ShaftTorque => "shaft_torque",
            Sensor::TorqueDemand => "torque_demand",
        }
    }

    /// Signal that it measures.
    pub fn signal(self) -> Signal {
        match self {
            Sensor::Speed | Sensor::DynoSpeed | Sensor::EngineSpeed => Signal::Speed,
            Sensor::Torque | Sensor::ShaftTorque | Sensor::TorqueDemand => Signal::Torque,
        }
    }
}

/// Without the rounding errors of units.
fn short(value: f64) -> f64 {
    (1e6 * value).round() / 1e6
}

/// As it is read.
impl fmt::Display for Own {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.sensor().name();
        let (unit, si) = if self.signal() == Signal::Speed { ("rpm", RPM_RAD_S) } else { ("Nm", 1.0) };
        match *self {
            Own::Within { error, share, .. } => {
                write!(f, "{name} within {} {unit} for {} %", short(error / si), short(100.0 * share))
            }
            Own::Rise { most_s, .. } => write!(f, "{name} rise below {most_s} s"),
            Own::Overshoot { most, .. } => write!(f, "{name} overshoot below {} %", 100.0 * most),
            Own::Settling { band, most_s, .. } => {
                write!(f, "{name} settling within {} % below {most_s} s", 100.0 * band)
            }
            Own::Phase { frequency_hz, most_rad, .. } => {
                write!(f, "{name} phase at {frequency_hz} Hz below {} deg", short(most_rad.to_degrees()))
            }
            Own::Amplitude { frequency_hz, most, .. } => {
                write!(f, "{name} amplitude at {frequency_hz} Hz below {} {unit}", short(most / si))
            }
        }
    }
}

impl Course<'_> {
    fn samples<'a>(&self, values: &'a [f64]) -> Samples<'a> {
        Samples { start_s: 0.0, sample_time_s: self.sample_time_s, values, is_held: false }
    }

    fn lag(&self, frequency_hz: f64) -> Lag {
        let demand = self.timed_demand.unwrap_or_else(|| self.samples(self.demand));
        lag(&demand, &self.samples(self.value), frequency_hz)
    }

    fn time_s(&self, sample: usize) -> f64 {
        sample as f64 * self.sample_time_s
    }

    /// Lowest and highest value of the demand.
    fn range(&self) -> (f64, f64) {
        let wider = |(low, high): (f64, f64), value: &f64| (value.min(low), value.max(high));
        self.demand.iter().fold((f64::INFINITY, f64::NEG_INFINITY), wider)
    }

    /// Why the demand is no step from its first value to its last.
    fn no_step(&self) -> Option<&'static str> {
        let (low, high) = self.range();
        let (Some(first), Some(last)) = (self.demand.first(), self.demand.last()) else {
            return Some("its demand is empty");
        };
        let step = (last - first).abs();
        let is_flat = step <= 1e-9 * high.abs().max(low.abs());
        let is_left = high - low > (1.0 + BEYOND_STEP) * step;
        match (is_flat, is_left) {
            (true, _) => {
                Some("its demand ends where it begins, so it has no step; take a test with a step of this signal")
            }
            (_, true) => Some(
                "its demand goes beyond its first and last value, so it is no step; take a test with a step of this signal",
            ),
            _ => None,
        }
    }

    /// Returns true if the demand has enough at a frequency for a phase: a sine, or as much in many windows.
    fn shows_phase(&self, frequency_hz: f64) -> bool {
        let (low, high) = self.range();
        let moves = high - low > 1e-9 * high.abs().max(low.abs());
        let sine = largest_sine(self.demand, self.sample_time_s, frequency_hz);
        let has_part = moves && sine.is_some_and(|sine| sine.amplitude > LEAST_SINE * (high - low));
        let is_tone = || sine.is_some_and(|sine| sine.share > LEAST_TONE);
        has_part && (is_tone() || self.lag(frequency_hz).scatter_rad.is_some())
    }

    fn within(&self, limit: f64, share: f64) -> Judged {
        let mut errors: Vec<f64> =
            self.demand.iter().zip(self.value).map(|(demand, value)| (value - demand).abs()).collect();
        let (at, _) = largest(errors.iter().copied());
        // So many samples stay at or below the value; a share such as 95 % is not exact.
        let place = ((share * errors.len() as f64 - 1e-9).ceil() as usize).clamp(1, errors.len().max(1)) - 1;
        let is_there = place < errors.len();
        let value = if is_there { *errors.select_nth_unstable_by(place, f64::total_cmp).1 } else { f64::NAN };
        Judged { value, limit, time_s: self.time_s(at) }
    }

    /// Where the demand first differs from its first value.
    fn begins(&self) -> usize {
        self.demand.iter().position(|value| *value != self.demand[0]).unwrap_or(0)
    }

    /// How much of the step is done: 0 at the first value of the demand, 1 at its last.
    fn part(&self, value: f64) -> f64 {
        let (first, last) = (self.demand.first().copied().unwrap_or(0.0), self.demand.last().copied().unwrap_or(0.0));
        (value - first) / (last - first)
    }

    fn first_beyond(&self, part: f64) -> Option<usize> {
        let begins = self.begins();
        self.value.iter().skip(begins).position(|value| self.part(*value) >= part).map(|after| begins + after)
    }
}

fn largest(values: impl Iterator<Item = f64>) -> (usize, f64) {
    values.enumerate().fold((0, f64::NEG_INFINITY), |most, one| if one.1 > most.1 { one } else { most })
}

/// Names that a requirement can begin with.
fn names() -> String {
    Sensor::ALL.map(|sensor| format!("`{}`", sensor.name())).join(", ")
}

impl FromStr for Own {
    type Err = CycleError;

    fn from_str(text: &str) -> Result<Self, CycleError> {
        let fault = |problem: &str| CycleError::Own { text: text.to_owned(), problem: problem.to_owned() };
        let words = text.trim();
        let (name, rest) = words.split_once(' ').ok_or_else(|| fault("it has one word only"))?;
        let sensor = Sensor::ALL.into_iter().find(|sensor| sensor.name().eq_ignore_ascii_case(name));
        let sensor = sensor.ok_or_else(|| fault(&format!("it must begin with one of {}", names())))?;
        let signal = sensor.signal();
        let quantity = if signal == Signal::Speed { Quantity::AngularSpeed } else { Quantity::Torque };
        let value =
            |text: &str, quantity| parse_value(text.trim(), quantity).map_err(|error| fault(&error.to_string()));
        let share = |text: &str| value(text, Quantity::Ratio);
        let time = |text: &str| value(text, Quantity::Time);
        let (what, rest) = rest.trim().split_once(' ').ok_or_else(|| fault("the limit is missing"))?;
        if what != "amplitude" && !matches!(sensor, Sensor::Speed | Sensor::Torque) {
            return Err(fault(
                "only `amplitude` is judged there; the others follow a demand: begin with `speed` or `torque`",
            ));
        }
        let below = |rest: &str| {
            rest.trim().strip_prefix("below ").map(str::to_owned).ok_or_else(|| fault("`below` is missing"))
        };
        // `at 12 Hz below …`: the frequency, and the limit.
        let at = |rest: &str| {
            let at = rest.trim().strip_prefix("at ").ok_or_else(|| fault("`at` and a frequency are missing"))?;
            let (number, limit) = at.split_once("Hz").ok_or_else(|| fault("the frequency needs the unit Hz"))?;
            let frequency_hz = number.trim().parse().ok().filter(|hz: &f64| hz.is_finite() && *hz > 0.0);
            Ok((frequency_hz.ok_or_else(|| fault("the frequency is not above 0 Hz"))?, below(limit)?))
        };
        let own = match what {
            "within" => {
                let (error, rest) =
                    rest.split_once(" for ").ok_or_else(|| fault("`for` and a share of the time are missing"))?;
                Own::Within { signal, error: value(error, quantity)?, share: share(rest)? }
            }
            "rise" => Own::Rise { signal, most_s: time(&below(rest)?)? },
            "overshoot" => Own::Overshoot { signal, most: share(&below(rest)?)? },
            "settling" => {
                let band =
                    rest.trim().strip_prefix("within ").ok_or_else(|| fault("`within` and a band are missing"))?;
                let (band, rest) = band.split_once(" below ").ok_or_else(|| fault("`below` and a time are missing"))?;
                Own::Settling { signal, band: share(band)?, most_s: time(rest)? }
            }
            "phase" => {
                let (frequency_hz, limit) = at(rest)?;
                Own::Phase { signal, frequency_hz, most_rad: value(&limit, Quantity::Angle)? }
            }
            "amplitude" => {
                let (frequency_hz, limit) = at(rest)?;
                Own::Amplitude { sensor, frequency_hz, most: value(&limit, quantity)? }
            }
            _ => {
                let kinds = "after the signal comes `within`, `rise`, `overshoot`, `settling`, `phase` or `amplitude`";
                return Err(fault(kinds));
            }
        };
        match own.impossible() {
            Some(problem) => Err(fault(problem)),
            None => Ok(own),
        }
    }
}
