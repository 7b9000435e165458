//! Which parts of a study are estimated, and what the others need.

use rig::results::{Part, Reason};
use study::Study;

use crate::wording;

/// Every part of a study, in the order of the report, with what it needs where it is not estimated.
pub(crate) fn parts(study: &Study) -> [(Part, Option<&[Reason]>); 6] {
    [
        (Part::Timing, study.timing.as_ref().err()),
        (Part::SpeedController, study.speed_controller.as_ref().err()),
        (Part::FeedForward, study.feed_forward.as_ref().err()),
        (Part::TorqueControl, study.torque_control.as_ref().err()),
        (Part::Shaft, study.shaft.as_ref().err()),
        (Part::Whole, study.whole.as_ref().err()),
    ]
}

/// Every part that is not estimated, in plain words, with what it needs.
pub fn not_estimated(study: &Study) -> Vec<(&'static str, &[Reason])> {
    parts(study).into_iter().filter_map(|(name, needs)| Some((wording::part(name), needs?))).collect()
}

/// Tells whether an error concerns a part, or one that it rests on.
pub(crate) fn is_struck(study: &Study, part: Part) -> bool {
    let needs = parts(study).into_iter().find(|(other, _)| *other == part).and_then(|(_, needs)| needs);
    needs.unwrap_or_default().iter().any(|need| match need {
        Reason::Error { .. } => true,
        Reason::Part { part: other } => *other != part && is_struck(study, *other),
        _ => false,
    })
}
