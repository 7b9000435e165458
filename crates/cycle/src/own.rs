//! Requirements of one's own.

use std::str::FromStr;

use serde::Serialize;
use units::{Quantity, parse_value};

use crate::error::CycleError;
use crate::requirement::Signal;

/// Ten and ninety per cent of a step.
const RISE: (f64, f64) = (0.1, 0.9);

/// A requirement, from a text such as `speed within 10 rpm for 95 %`, `torque rise below 50 ms`, `speed overshoot below 5 %`,
/// `torque settling within 2 % below 0.5 s`.
///
/// # Example
/// ```
/// let own: cycle::Own = "torque rise below 50 ms".parse()?;
/// assert_eq!(own, cycle::Own::Rise { signal: cycle::Signal::Torque, most_s: 0.05 });
/// # Ok::<(), cycle::CycleError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
}

/// A demand and what came of it, on one clock.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    /// Time between samples, s.
    pub sample_time_s: f64,
    /// The demand, rad/s or Nm.
    pub demand: &'a [f64],
    /// What came of it.
    pub value: &'a [f64],
}

/// A number against its limit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Judged {
    /// The number: the error that the share of the time stays below (rad/s, Nm), a time (s), or a part of the step.
    pub value: f64,
    /// The limit, in the same unit.
    pub limit: f64,
    /// When the worst happens, s.
    pub time_s: f64,
}

impl Judged {
    /// Whether the limit is kept.
    pub fn passes(&self) -> bool {
        self.value <= self.limit
    }
}

impl Own {
    /// Which signal it is about.
    pub fn signal(&self) -> Signal {
        match *self {
            Own::Within { signal, .. } | Own::Rise { signal, .. } => signal,
            Own::Overshoot { signal, .. } | Own::Settling { signal, .. } => signal,
        }
    }

    /// Judges a course; a step goes from the first value of the demand to its last.
    pub fn judge(&self, course: &Course<'_>) -> Judged {
        match *self {
            Own::Within { error, share, .. } => course.within(error, share),
            Own::Rise { most_s, .. } => {
                let (from, to) = (course.first_beyond(RISE.0), course.first_beyond(RISE.1));
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
        }
    }
}

impl Course<'_> {
    fn time_s(&self, sample: usize) -> f64 {
        sample as f64 * self.sample_time_s
    }

    fn within(&self, limit: f64, share: f64) -> Judged {
        let errors: Vec<f64> =
            self.demand.iter().zip(self.value).map(|(demand, value)| (value - demand).abs()).collect();
        let (at, _) = largest(errors.iter().copied());
        let mut sorted = errors;
        sorted.sort_by(f64::total_cmp);
        // So many samples stay at or below the value; a share such as 95 % is not exact.
        let place = ((share * sorted.len() as f64 - 1e-9).ceil() as usize).clamp(1, sorted.len().max(1)) - 1;
        Judged { value: sorted.get(place).copied().unwrap_or(f64::NAN), limit, time_s: self.time_s(at) }
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

impl FromStr for Own {
    type Err = CycleError;

    fn from_str(text: &str) -> Result<Self, CycleError> {
        let fault = |problem: &str| CycleError::Own { text: text.to_owned(), problem: problem.to_owned() };
        let words = text.trim();
        let (signal, rest) = words.split_once(' ').ok_or_else(|| fault("it has one word only"))?;
        let (signal, quantity) = match signal.to_ascii_lowercase().as_str() {
            "speed" => (Signal::Speed, Quantity::AngularSpeed),
            "torque" => (Signal::Torque, Quantity::Torque),
            _ => return Err(fault("it must begin with `speed` or `torque`")),
        };
        let value =
            |text: &str, quantity| parse_value(text.trim(), quantity).map_err(|error| fault(&error.to_string()));
        let share = |text: &str| value(text, Quantity::Ratio);
        let time = |text: &str| value(text, Quantity::Time);
        let (what, rest) = rest.trim().split_once(' ').ok_or_else(|| fault("the limit is missing"))?;
        let below = |rest: &str| {
            rest.trim().strip_prefix("below ").map(str::to_owned).ok_or_else(|| fault("`below` is missing"))
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
            _ => return Err(fault("after the signal comes `within`, `rise`, `overshoot` or `settling`")),
        };
        match own {
            Own::Within { share, .. } if !(0.0..=1.0).contains(&share) => {
                Err(fault("the share of the time is not within 0 … 100 %"))
            }
            own => Ok(own),
        }
    }
}
