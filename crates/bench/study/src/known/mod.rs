//! Grades of every quantity of the model: by its interval and by what speaks for and against it in the study. Nothing
//! is estimated here.

mod control;
mod grade;
mod graded;
mod result;
mod shaft;
mod signals;
mod whole;
mod why;

use crate::{Analyses, Study};

pub use grade::{FRICTION_NM, Grade, TIME_WIDTHS, WIDTHS, Widths};
pub use result::{Known, Subject, Value};
pub use whole::REPLAY_FITS;
pub use why::{FoundInertia, SineTests, Source, Why};

/// Every quantity that matters, in the order of the report.
pub fn known(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    let parts = [
        signals::delays(study),
        control::speed_controller(study, analyses),
        control::feed_forward(study, analyses),
        control::torque_control(study, analyses),
        shaft::shaft(study, analyses),
        shaft::inertias(study, analyses),
        shaft::skews(study),
        vec![signals::friction(study, analyses), signals::engine_torque(study, analyses)],
        whole::resonance(study),
        vec![whole::replays(study)],
    ];
    let numbered = parts.into_iter().enumerate();
    numbered.flat_map(|(part, of_part)| of_part.into_iter().map(move |one| Known { part, ..one })).collect()
}
