//! A bench of a simulator that shares no code with the project, as its folder has it: recordings, bench file and truth.

use std::path::Path;

use recording::Recording;
use rig::results::{Estimate, Parameter, Quantity};
use rig::{BenchFile, Diagnostic, Severity};
use study::Study;
use units::RPM_RAD_S;

use bench_testkit::benches::bench_file;
use bench_testkit::recordings::{BENCH_A, recordings};

/// The bench of a folder of recordings.
pub(crate) struct RecordedBench {
    pub(crate) name: String,
    pub(crate) file: BenchFile,
    pub(crate) recordings: Vec<(String, Recording)>,
    truth: serde_json::Value,
}

impl RecordedBench {
    /// None, and the test counts as skipped, where the recordings are absent. Inertias are stated to four digits.
    pub(crate) fn of(name: &str) -> Option<Self> {
        let recordings = recordings(name);
        let folder = testdata::shared(&format!("recordings/{name}")).filter(|_| !recordings.is_empty())?;
        let text = std::fs::read_to_string(Path::new(&folder).join("truth.json")).unwrap();
        let truth: serde_json::Value = serde_json::from_str(&text).unwrap();
        let rounded = |key: &str| format!("{:.4}", truth[key].as_f64().unwrap());
        let limit = format!("{} Nm", truth["T_max"].as_f64().unwrap_or(400.0));
        let mut file = bench_file(&rounded("J_d"), &rounded("J_e"), &limit, BENCH_A);
        file.cylinders = truth["imbalance"].as_array().map_or(4, Vec::len) as u32;
        Some(RecordedBench { name: name.to_owned(), file, recordings, truth })
    }

    /// The true value, SI.
    pub(crate) fn truth(&self, quantity: Quantity) -> f64 {
        let (key, factor) = match quantity {
            Quantity::Stiffness => ("K", 1.0),
            Quantity::Damping => ("B", 1.0),
            Quantity::ProportionalGain => ("Kp", 1.0 / RPM_RAD_S),
            Quantity::IntegralGain => ("Ki", 1.0 / RPM_RAD_S),
            Quantity::ControllerDelay => ("delay", 1.0),
            Quantity::SpeedFeedForward => ("ff_speed", 1.0 / RPM_RAD_S),
            Quantity::AccelerationFeedForward => ("ff_accel", 1.0 / RPM_RAD_S),
            Quantity::TorqueControlDelay => ("foc_delay", 1.0),
            Quantity::TorqueControlBandwidth => ("foc_bw", 1.0),
            _ => panic!("{quantity} has no truth"),
        };
        factor * self.truth[key].as_f64().unwrap()
    }

    /// By how many half widths of its interval a value is beside the truth.
    pub(crate) fn half_widths_off(&self, found: &Parameter) -> f64 {
        (found.value - self.truth(found.quantity)) / (0.5 * (found.interval.1 - found.interval.0))
    }
}

/// Finding of a study on a quantity.
pub(crate) fn found(study: &Study, quantity: Quantity) -> Option<&Parameter> {
    let estimates: [Option<&Estimate>; 4] = [
        study.shaft.estimated().map(|part| &part.estimate),
        study.speed_controller.estimated().map(|part| &part.estimate),
        study.feed_forward.estimated().map(|part| &part.estimate),
        study.torque_control.estimated().map(|part| &part.delay_and_lag),
    ];
    estimates.into_iter().flatten().find_map(|estimate| estimate.parameter(quantity))
}

/// Kinds of the warnings and errors, each once.
pub(crate) fn kinds_of_alarms(found: &[Diagnostic]) -> Vec<String> {
    let raised = found.iter().filter(|one| one.severity != Severity::Note);
    let kind = |one: &Diagnostic| format!("{:?}", one.finding).split([' ', '{', '(']).next().unwrap_or("").to_owned();
    let mut kinds: Vec<String> = raised.map(kind).collect();
    kinds.sort();
    kinds.dedup();
    kinds
}
