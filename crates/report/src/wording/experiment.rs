//! The experiments in plain words.

use bench::ExperimentLabel;

/// What an experiment does, from its label (`BS_T_NT` → `engine torque switched between two ignition angles, …`);
/// `None` for a test that is not one of the method's.
pub fn experiment(label: &str) -> Option<&'static str> {
    let label: ExperimentLabel = label.parse().ok()?;
    match label.test.to_ascii_lowercase().as_str() {
        "bs" => Some("engine torque switched between two ignition angles, dynamometer holding a constant speed demand"),
        "whitenoise" => Some("white torque demand to the dynamometer, a new value every 10 ms"),
        "step" => Some("steps of the torque demand to the dynamometer"),
        "ramp" => Some("ramps of the speed demand between two levels"),
        "levels" => Some("speed demand over many levels and slopes"),
        "unfired" => Some("motored engine, speed demand moved about one speed"),
        "sine" => Some("torque demand in sines of 1, 2, … 20 Hz, one after another"),
        "noshaft" => Some("shaft taken off, steps of the speed demand"),
        _ => None,
    }
}
