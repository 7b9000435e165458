//! A quantity with its grade.

use rig::Role;
use rig::results::{Parameter, Part, Quantity, Reason};
use serde::Serialize;

use super::grade::Grade;
use super::why::Why;

/// One quantity, how well it is known, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Known {
    /// Place of the part of the model it belongs to, in the order of the report.
    pub part: usize,
    /// The quantity.
    pub subject: Subject,
    /// How well it is known.
    pub grade: Grade,
    /// Its value with its uncertainty, or why there is none.
    pub value: Value,
    /// Reasons for the grade.
    pub why: Vec<Why>,
}

/// A quantity, or several, of which a grade is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Subject {
    /// A quantity that an estimate has under its own name.
    Quantity(Quantity),
    /// The same of the torque control.
    OfTorqueControl(Quantity),
    /// A quantity of the bench file, as the recordings alone show it.
    ByRecordings(Quantity),
    /// The quantities of a part that is not estimated.
    Part(Part),
    /// The constant part of the feed-forward.
    FeedForwardConstant,
    /// Delay of a torque signal.
    SignalDelay(Role),
    /// Friction of the dynamometer.
    Friction,
    /// Torque of the engine.
    EngineTorque,
    /// The bench as a whole, by replays.
    Replays,
}

/// A value with its uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Value {
    /// There is none.
    None,
    /// It was not looked for in this study.
    NotSought,
    /// An estimate.
    Estimated(Parameter),
    /// An inertia that the bench file states, kg m².
    Stated(f64),
    /// A torque of friction.
    Friction {
        /// The torque, Nm.
        torque_nm: f64,
        /// Half of its 95 % interval, Nm.
        half_width_nm: f64,
        /// At this speed, rad/s.
        speed_rad_s: f64,
    },
    /// A course that was rebuilt in so many recordings.
    Rebuilt(usize),
    /// The median fit of replayed signals, %.
    MedianFit(f64),
}

impl Known {
    pub(super) fn new(subject: Subject, grade: Grade, value: Value, why: Vec<Why>) -> Self {
        Known { part: 0, subject, grade, value, why }
    }

    pub(super) fn of(parameter: &Parameter, grade: Grade, why: Vec<Why>) -> Self {
        Known::new(Subject::Quantity(parameter.quantity), grade, Value::Estimated(parameter.clone()), why)
    }

    /// Something that is not known, for one reason.
    pub(super) fn not_at_all(subject: Subject, why: Why) -> Self {
        Known::new(subject, Grade::NotAtAll, Value::None, vec![why])
    }

    /// A part that was not estimated, for want of what it needs.
    pub(super) fn missing(part: Part, needs: &[Reason]) -> Self {
        Known::not_at_all(Subject::Part(part), Why::Needs(needs.to_vec()))
    }
}
