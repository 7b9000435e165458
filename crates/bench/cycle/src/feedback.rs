//! Speed and torque of a bench in a cycle, and their means over each second.

use crate::error::CycleError;
use crate::reference::Reference;

/// How much of a second at either end of a cycle may be without feedback, s.
const MISSING_S: f64 = 1.5;

/// Speed and torque on one clock, which counts as the cycle does.
#[derive(Debug, Clone, PartialEq)]
pub struct Feedback {
    /// Time of the first sample on the clock of the cycle, s.
    pub start_s: f64,
    /// Time between samples, s.
    pub sample_time_s: f64,
    /// Speed, rad/s.
    pub speed_rad_s: Vec<f64>,
    /// Torque at the engine's flywheel, Nm.
    pub torque_nm: Vec<f64>,
    /// The operator's demand, 0 … 1 from least to most, if it was recorded.
    pub demand: Option<Vec<f64>>,
}

/// Means over the seconds of a cycle beside what it asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// Seconds, on the clock of the cycle.
    pub time_s: Vec<f64>,
    /// Reference speed, rad/s.
    pub speed_reference_rad_s: Vec<f64>,
    /// Reference torque, Nm.
    pub torque_reference_nm: Vec<f64>,
    /// Speed, rad/s.
    pub speed_rad_s: Vec<f64>,
    /// Torque, Nm.
    pub torque_nm: Vec<f64>,
    /// Operator's demand, 0 … 1; empty if it was not recorded.
    pub demand: Vec<f64>,
}

/// Sums of a series up to each sample, from which means over any time follow.
struct Sums(Vec<f64>);

impl Sums {
    fn of(values: &[f64]) -> Self {
        let mut sum = 0.0;
        let sums = values.iter().map(|value| {
            sum += value;
            sum
        });
        Sums(std::iter::once(0.0).chain(sums).collect())
    }

    /// Mean from `from` to `to`, in samples; a sample counts from half before to half after itself.
    fn mean(&self, from: f64, to: f64) -> f64 {
        (self.up_to(to) - self.up_to(from)) / (to - from)
    }

    fn up_to(&self, place: f64) -> f64 {
        let place = (place + 0.5).clamp(0.0, (self.0.len() - 1) as f64);
        let (below, share) = (place.floor() as usize, place.fract());
        let above = (below + 1).min(self.0.len() - 1);
        self.0[below] + share * (self.0[above] - self.0[below])
    }
}

/// A series that is straight between its values, with its integral up to each.
struct Line<'a> {
    values: &'a [f64],
    sums: Vec<f64>,
}

impl<'a> Line<'a> {
    fn of(values: &'a [f64]) -> Self {
        let mut sum = 0.0;
        let sums = values.windows(2).map(|pair| {
            sum += 0.5 * (pair[0] + pair[1]);
            sum
        });
        Line { values, sums: std::iter::once(0.0).chain(sums).collect() }
    }

    /// Mean from one place to another, in values; at one place the value there.
    fn mean(&self, from: f64, to: f64) -> f64 {
        if to > from { (self.up_to(to) - self.up_to(from)) / (to - from) } else { self.at(from) }
    }

    fn up_to(&self, place: f64) -> f64 {
        let (below, share) = (place.floor() as usize, place.fract());
        self.sums[below] + 0.5 * share * (self.values[below] + self.at(place))
    }

    fn at(&self, place: f64) -> f64 {
        let (below, share) = (place.floor() as usize, place.fract());
        self.values[below] + share * (self.values[(below + 1).min(self.values.len() - 1)] - self.values[below])
    }
}

/// The means of a feedback, ready for any shift.
pub(crate) struct Seconds<'a> {
    feedback: &'a Feedback,
    speed: Sums,
    torque: Sums,
    demand: Option<Sums>,
}

impl<'a> Seconds<'a> {
    pub(crate) fn of(feedback: &'a Feedback) -> Result<Self, CycleError> {
        feedback.check()?;
        Ok(Seconds {
            feedback,
            speed: Sums::of(&feedback.speed_rad_s),
            torque: Sums::of(&feedback.torque_nm),
            demand: feedback.demand.as_deref().map(Sums::of),
        })
    }

    /// The points where the feedback is moved forward by `shift_s`: the second around t of the reference meets the mean
    /// of the feedback over the second around t + shift. The first and the last second of the cycle have one half each.
    pub(crate) fn points(&self, reference: &Reference, has_means: bool, shift_s: f64) -> Result<Points, CycleError> {
        let Feedback { start_s, sample_time_s, .. } = *self.feedback;
        let end_s = start_s + (self.feedback.speed_rad_s.len() as f64 - 1.0) * sample_time_s;
        let (speed, torque) = (Line::of(&reference.speed_rad_s), Line::of(&reference.torque_nm));
        let mut points = Points::empty();
        for time_s in reference.seconds() {
            let middle_s = time_s + shift_s;
            if middle_s < start_s - 0.5 * sample_time_s || middle_s > end_s + 0.5 * sample_time_s {
                continue;
            }
            let (first_s, last_s) = ((time_s - 0.5).max(reference.start_s), (time_s + 0.5).min(reference.end_s()));
            let asked = |line: &Line<'_>, at: f64| match has_means {
                true => line.mean(reference.place(first_s), reference.place(last_s)),
                false => at,
            };
            let from = (first_s + shift_s - start_s).max(-0.5 * sample_time_s) / sample_time_s;
            let to = (last_s + shift_s - start_s).min(end_s - start_s + 0.5 * sample_time_s) / sample_time_s;
            points.time_s.push(time_s);
            points.speed_reference_rad_s.push(asked(&speed, reference.speed_at(time_s)));
            points.torque_reference_nm.push(asked(&torque, reference.torque_at(time_s)));
            points.speed_rad_s.push(self.speed.mean(from, to));
            points.torque_nm.push(self.torque.mean(from, to));
            points.demand.extend(self.demand.as_ref().map(|demand| demand.mean(from, to)));
        }
        points.check_cover(reference, (start_s, end_s))?;
        Ok(points)
    }
}

impl Feedback {
    fn check(&self) -> Result<(), CycleError> {
        let expected = self.speed_rad_s.len();
        let demand = self.demand.as_deref().unwrap_or(&self.speed_rad_s);
        for (what, values) in
            [("speed", &self.speed_rad_s[..]), ("torque", &self.torque_nm), ("operator demand", demand)]
        {
            if values.len() != expected || expected == 0 {
                return Err(CycleError::Length { what, expected: expected.max(1), found: values.len() });
            }
            if let Some(sample) = values.iter().position(|value| !value.is_finite()) {
                return Err(CycleError::NotFinite { what, sample });
            }
        }
        Ok(())
    }
}

impl Points {
    fn empty() -> Self {
        Points {
            time_s: Vec::new(),
            speed_reference_rad_s: Vec::new(),
            torque_reference_nm: Vec::new(),
            speed_rad_s: Vec::new(),
            torque_nm: Vec::new(),
            demand: Vec::new(),
        }
    }

    fn check_cover(&self, reference: &Reference, (first_s, last_s): (f64, f64)) -> Result<(), CycleError> {
        let (start_s, end_s) = (reference.start_s, reference.end_s());
        let begins = self.time_s.first().is_some_and(|first| first - start_s <= MISSING_S);
        let ends = self.time_s.last().is_some_and(|last| end_s - last <= MISSING_S);
        if begins && ends { Ok(()) } else { Err(CycleError::NotCovered { first_s, last_s, start_s, end_s }) }
    }
}
