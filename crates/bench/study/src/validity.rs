//! The range of the recordings that a model was estimated from.

use bench_model::document::Validity;
use rig::results::{Outcome, Part, Shaft};
use rig::{Experiment, Role};

use crate::RecordingSummary;

/// The parts that a model is made of.
const PARTS: [Part; 4] = [Part::Shaft, Part::SpeedController, Part::FeedForward, Part::TorqueControl];
/// Signals that show T_d, the best first.
const TORQUES: [Role; 3] = [Role::AirGapTorque, Role::LoadCellTorque, Role::DynoTorqueDemand];

/// Speeds and torques of the recordings that parts of the model are from, and the frequencies that the shaft is from.
pub(super) fn of(experiments: &[Experiment], recordings: &[RecordingSummary], shaft: &Outcome<Shaft>) -> Validity {
    let is_used = |file: &str| {
        let mut of_file = recordings.iter().filter(|recording| recording.file == file);
        of_file.any(|recording| recording.used_for.iter().any(|part| PARTS.contains(part)))
    };
    let used: Vec<&Experiment> = experiments.iter().filter(|experiment| is_used(&experiment.file)).collect();
    let range = |roles: &[Role]| {
        let signals = used.iter().filter_map(|experiment| roles.iter().find_map(|role| experiment.signal(*role)));
        Validity::range_of(signals.flat_map(|signal| signal.samples.iter().copied()))
    };
    let frequencies = shaft.estimated().map(|shaft| shaft.residual_spectrum.frequencies_hz.iter().copied());
    Validity {
        dyno_speed_rad_s: range(&[Role::DynoSpeed]),
        air_gap_torque_nm: range(&TORQUES),
        frequency_hz: frequencies.and_then(Validity::range_of),
    }
}
