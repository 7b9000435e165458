//! Inputs of a replay beside the recording and the model.

use signal::Signal;

use super::encoder_error::EncoderError;
use crate::drive_ripple::DriveRipple;
use crate::skews::SignalSkews;

/// Inputs of a replay in addition to the recording and the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayInputs<'a> {
    /// T_d at 1 kHz, on the clock of T_d,calc; T_d,calc itself, band-limited, where `None`.
    pub air_gap_torque: Option<&'a Signal>,
    /// Offset and ripple of T_d as they were in this recording, on the clock of T_d,calc. They are put upon the
    /// modelled T_d; without it the replay has none. Delay and lag are those of the bench model.
    pub ripple: Option<&'a DriveRipple>,
    /// Skews of N_e and T_d against N_d.
    pub skews: SignalSkews,
    /// Once-a-turn error of the recorded N_d. It is taken out of the reconstruction and put onto the modelled N_d
    /// before that is compared.
    pub encoder_error: Option<EncoderError>,
    /// Up to where torques are reconstructed, Hz; above it the reconstruction falls to zero at 1.4 times that.
    pub band_hz: f64,
    /// Part of the recording, s of its clock; all of it where `None`.
    pub stretch_s: Option<(f64, f64)>,
    /// True where any part of the model was estimated from this recording.
    pub seen_in_estimation: bool,
}

impl Default for ReplayInputs<'_> {
    fn default() -> Self {
        ReplayInputs {
            air_gap_torque: None,
            ripple: None,
            skews: SignalSkews::default(),
            encoder_error: None,
            band_hz: 120.0,
            stretch_s: None,
            seen_in_estimation: false,
        }
    }
}
