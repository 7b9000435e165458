//! Which parts of a study are estimated, and what the others need.

use rig::results::{Part, Reason};

use crate::Study;

impl Study {
    /// Every part, in the order of the report, with what it needs where it is not estimated.
    pub fn parts(&self) -> [(Part, Option<&[Reason]>); 6] {
        [
            (Part::Timing, self.timing.as_ref().err()),
            (Part::SpeedController, self.speed_controller.as_ref().err()),
            (Part::FeedForward, self.feed_forward.as_ref().err()),
            (Part::TorqueControl, self.torque_control.as_ref().err()),
            (Part::Shaft, self.shaft.as_ref().err()),
            (Part::Whole, self.whole.as_ref().err()),
        ]
    }

    /// Every part that is not estimated, with what it needs.
    pub fn not_estimated(&self) -> Vec<(Part, &[Reason])> {
        self.parts().into_iter().filter_map(|(part, needs)| Some((part, needs?))).collect()
    }

    /// Tells whether an error concerns a part, or one that it rests on.
    pub fn is_struck(&self, part: Part) -> bool {
        let needs = self.parts().into_iter().find(|(other, _)| *other == part).and_then(|(_, needs)| needs);
        needs.unwrap_or_default().iter().any(|need| match need {
            Reason::Error { .. } => true,
            Reason::Part { part: other } => *other != part && self.is_struck(*other),
            _ => false,
        })
    }
}
