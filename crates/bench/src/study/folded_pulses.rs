//! Pulses of the engine that the sampling of a speed folds to frequency zero.
//!
//! All multiples of the firing frequency grow and shrink together from one firing to the next. One that folds to zero therefore
//! does not add noise to slow changes of the speed, but a part of these changes themselves, by a factor that stays what it is for the
//! whole of a recording: the shaft's equation holds as well as before, with another K. At other speeds it turns, and is noise.

use std::f64::consts::TAU;

use signal::{Complex64, Signal};

/// Higher multiples hardly move a speed.
const HIGHEST: u32 = 8;
/// What is left of a factor whose phase turns with what folds, as its mean over a recording: a speed that is held keeps much of
/// it, one that wanders does not.
const KEPT: f64 = 0.3;

/// A multiple of the firing frequency that is sampled once a period, or once in a few.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Folded {
    /// Mean firing frequency, Hz.
    pub(super) firing_hz: f64,
    /// Its multiple.
    pub(super) multiple: u32,
}

impl Folded {
    /// The lowest multiple that folds to zero in a speed (rad/s).
    pub(super) fn of(speed: &Signal, firings_per_turn: f64) -> Option<Self> {
        let firing_hz = firings_per_turn * speed.mean()?.abs() / TAU;
        let rate_hz = 1.0 / speed.sample_time_s;
        let rests = |multiple: &u32| {
            let multiple = f64::from(*multiple);
            if (multiple * firing_hz / rate_hz).round() < 1.0 {
                return false;
            }
            let mut phase_rad = 0.0;
            let turns = speed.samples.iter().map(|v| {
                // Whole turns from one sample to the next do not show.
                phase_rad = (phase_rad + multiple * firings_per_turn * v.abs() * speed.sample_time_s) % TAU;
                Complex64::cis(phase_rad)
            });
            turns.sum::<Complex64>().norm() > KEPT * speed.len() as f64
        };
        (1..=HIGHEST).find(rests).map(|multiple| Folded { firing_hz, multiple })
    }
}
