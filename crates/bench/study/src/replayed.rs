//! A recording replayed on a bench model: the same for a study and for whoever reads its model.

use bench_model::drive_ripple::RecordedTorque;
use bench_model::model::{BenchModel, PiController};
use bench_model::replay::{EncoderError, Replay, ReplayError, ReplayInputs, replay};
use bench_model::skews::SignalSkews;
use part_controller::speed_controller::{KnownController, once_a_turn};
use part_torque::air_gap_torque::modelled_torque;
use part_torque::torque_control::AirGapTorqueModel;
use rig::{ControlMode, Experiment};

/// The stretch that is replayed, s from the start of a recording: enough to judge, and quick to draw.
pub const REPLAYED_S: f64 = 20.0;

/// Model on which recordings of a bench are replayed.
#[derive(Debug, Clone, Copy)]
pub struct ReplayModel<'a> {
    /// The model.
    pub model: &'a BenchModel,
    /// Skews of the recordings.
    pub skews: SignalSkews,
    /// How the recordings show T_d; without it, T_d,calc is taken as it is recorded.
    pub recorded_torque: Option<&'a RecordedTorque>,
}

impl ReplayModel<'_> {
    /// Replays a stretch of a recording, s of its clock; all of it where `None`. The ripple of the drive and the
    /// once-a-turn error of the encoder are those of the whole recording.
    ///
    /// # Errors
    /// Those of [`replay`].
    pub fn replay(
        &self,
        experiment: &Experiment,
        stretch_s: Option<(f64, f64)>,
        seen_in_estimation: bool,
    ) -> Result<Replay, ReplayError> {
        let (torque, torque_model) = modelled_torque(experiment, self.torque_control().as_ref()).unzip();
        let inputs = ReplayInputs {
            air_gap_torque: torque.as_ref(),
            ripple: torque_model.as_ref().map(|model| &model.ripple),
            skews: self.skews,
            encoder_error: self.encoder_error(experiment),
            stretch_s,
            seen_in_estimation,
            ..ReplayInputs::default()
        };
        replay(experiment, self.model, &inputs)
    }

    /// The torque control on the clocks of the recordings.
    fn torque_control(&self) -> Option<AirGapTorqueModel> {
        let RecordedTorque { delay_s, ripple_hz } = self.recorded_torque?;
        let lag_rad_s = self.model.torque_control?.bandwidth_rad_s?;
        Some(AirGapTorqueModel::known(*delay_s, lag_rad_s, ripple_hz, self.model.torque_limit_nm))
    }

    fn encoder_error(&self, experiment: &Experiment) -> Option<EncoderError> {
        let pi = self.model.speed_controller.filter(|_| experiment.label.mode == ControlMode::Nt)?;
        let PiController { proportional_nm_s_per_rad, integral_nm_per_rad, delay_s, sample_time_s, .. } = pi;
        let gate_s = self.model.encoder_gate_s;
        let known = KnownController { proportional_nm_s_per_rad, integral_nm_per_rad, delay_s, gate_s, sample_time_s };
        let (cosine, sine) = once_a_turn(experiment, &known, self.model.torque_limit_nm)?;
        Some(EncoderError { cosine, sine })
    }
}

/// The stretch of a recording that a study replays, s of its clock.
pub fn replayed_stretch(experiment: &Experiment) -> Option<(f64, f64)> {
    experiment.signals.values().next().map(|signal| (signal.start_s, signal.start_s + REPLAYED_S))
}
