//! N_d without the encoder's error, and T_d as finely as it can be known.

use bench_model::replay::{EncoderError, encoder_error};
use part_controller::speed_controller::Encoder;
use rig::estimation::EstimateError;
use rig::{Experiment, Role};
use serde::{Deserialize, Serialize};
use signal::Signal;

use crate::air_gap_torque::model_of;
use crate::torque_control::TorqueControlFit;
use crate::torque_smoother::needed::{WITHIN, needed};

/// Where T_d comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum TorqueSource {
    /// T_d* through the torque control that was estimated, with the ripple of this recording.
    Modelled,
    /// T_d,calc.
    Calculated,
}

/// N_d and T_d of a recording.
pub struct Prepared {
    /// N_d less the once-a-turn error of its encoder, where that is known.
    pub speed: Signal,
    /// The dynamometer's encoder.
    pub encoder: Encoder,
    /// T_d.
    pub torque: Signal,
    /// Where T_d is from.
    pub source: TorqueSource,
}

impl Prepared {
    /// # Errors
    /// N_d or T_d,calc is missing or too short.
    pub fn new(
        experiment: &Experiment,
        torque_control: Option<&TorqueControlFit>,
        encoder: Option<Encoder>,
        stated_gate_s: Option<f64>,
    ) -> Result<Self, EstimateError> {
        let measured = needed(experiment, Role::DynoSpeed)?;
        let calculated = needed(experiment, Role::AirGapTorque)?;
        let known = Encoder::known_or_assumed(encoder, measured, stated_gate_s);
        let once = encoder.map(|_| EncoderError { cosine: known.once_a_turn.0, sine: known.once_a_turn.1 });
        let error = encoder_error(measured, once);
        let modelled =
            model_of(experiment, torque_control).map(|(demand, model)| model.finer_air_gap_torque(demand, 2 * WITHIN));
        let source = if modelled.is_some() { TorqueSource::Modelled } else { TorqueSource::Calculated };
        Ok(Prepared {
            speed: measured.with_samples(measured.samples.iter().zip(&error).map(|(n, e)| n - e).collect()),
            encoder: known,
            torque: modelled.unwrap_or_else(|| calculated.clone()),
            source,
        })
    }
}
