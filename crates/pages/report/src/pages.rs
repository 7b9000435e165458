//! One analysis as a page of its own: what its command shows, writes and what its section of the report holds.

use page::{Blocks, Page};
use part_controller::noise_test::NoiseTest;
use part_controller::speed_controller::SpeedControl;
use part_engine::EngineTorque;
use part_friction::Friction;
use part_lines::lines::{OverSpeed, RecordingLines};
use part_shaft::shaft_analysis::ShaftAnalysis;
use part_torque::model_comparison::ModelComparison;
use part_torque::torque_signals::TorqueSignals;
use study::NextExperiments;

use crate::{controller, engine, friction, lines, next, shaft, torque, torque_control};
use rig::facts::StatedInertia;

fn titled(title: &str, blocks: Blocks) -> Page {
    Page::new(title, blocks.into_vec())
}

/// The shaft of every recording and of all together.
pub fn shaft(found: &ShaftAnalysis) -> Page {
    titled("Shaft", shaft::analysis(found))
}

/// Friction and inertia of the dynamometer.
pub fn friction(found: &Friction, stated: StatedInertia) -> Page {
    titled("Friction of the dynamometer", friction::analysis_of(found, stated))
}

/// The torque signals compared with one another.
pub fn torque_signals(found: &TorqueSignals) -> Page {
    titled("Torque signals", torque::analysis(found))
}

/// Models of the torque control compared with a delay of one sample.
pub fn torque_control(studied: &ModelComparison) -> Page {
    titled("Torque control", torque_control::analysis(studied))
}

/// The engine's torque.
pub fn engine(found: &EngineTorque) -> Page {
    titled("Engine torque", engine::analysis(found))
}

/// Speed controller and feed-forward.
pub fn controller(found: &SpeedControl) -> Page {
    let mut all = controller::analysis(found, None);
    all.push(controller::feed_forward_analysis(found));
    titled("Speed controller", all)
}

/// Page on the effect of noise on the estimate of a PI that is known.
pub fn controller_noise(found: &NoiseTest) -> Page {
    titled("What noise does to the estimate of a PI", controller::pi_study(found))
}

/// Page on the gain from each further experiment.
pub fn next(found: &NextExperiments) -> Page {
    titled("What to record next", next::analysis_of(found))
}

/// The lines of recordings, `most` a signal; zero counts all. The lines of several recordings are summed up in one
/// table; `each` shows those of each recording.
pub fn lines(looks: &[RecordingLines], signals: &[OverSpeed], (most, each): (usize, bool)) -> Page {
    let tables = if each || looks.len() <= 1 { lines::every_line(looks, most) } else { lines::summed_up(looks, most) };
    titled("Lines of the recordings", lines::with_figures(tables, looks, signals))
}
