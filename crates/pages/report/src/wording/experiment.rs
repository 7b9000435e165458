//! The experiments in plain words.

use rig::ExperimentLabel;
use rig::experiment::Test;

/// Description of an experiment (`BS_T_NT` → `engine torque switched between two ignition angles, …`); `None` for a
/// test that is not one of the method's.
pub fn experiment(label: &ExperimentLabel) -> Option<&'static str> {
    match label.test {
        Test::Bs => {
            Some("engine torque switched between two ignition angles, dynamometer holding a constant speed demand")
        }
        Test::WhiteNoise => Some("white torque demand to the dynamometer, a new value every 10 ms"),
        Test::Step => Some("steps of the torque demand to the dynamometer"),
        Test::Ramp => Some("ramps of the speed demand between two levels"),
        Test::Levels => Some("speed demand over many levels and slopes"),
        Test::Unfired => Some("motored engine, speed demand moved about one speed"),
        Test::Sine => Some("torque demand in sines of 1, 2, … 20 Hz, one after another"),
        Test::NoShaft => Some("shaft taken off, steps of the speed demand"),
        _ => None,
    }
}
