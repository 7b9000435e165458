//! Pulses of the engine that the sampling of a speed folds to frequency zero.
//!
//! All multiples of the firing frequency grow and shrink together from one firing to the next. One that folds to zero,
//! or nearly so, therefore does not add noise to slow changes of the speed, but a part of these changes themselves: the
//! shaft's equation holds as well as before, with another K.

use std::f64::consts::TAU;

use signal::Signal;

/// Higher multiples hardly move a speed.
const HIGHEST: u32 = 8;
/// As near to zero (root mean square), Hz. On virtual benches, K scatters twice as far as its interval says at 0 Hz,
/// and a quarter further at 8 Hz.
const NEAR_HZ: f64 = 5.0;

/// A multiple of the firing frequency that is sampled once a period, or once in a few.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Folded {
    /// Mean firing frequency, Hz.
    pub firing_hz: f64,
    /// Its multiple.
    pub multiple: u32,
}

impl Folded {
    /// The lowest multiple that folds to zero in a speed (rad/s).
    pub fn of(speed: &Signal, firings_per_turn: f64) -> Option<Self> {
        let firing_hz = firings_per_turn * speed.mean()?.abs() / TAU;
        let rate_hz = 1.0 / speed.sample_time_s;
        let rests = |multiple: &u32| {
            let multiple = f64::from(*multiple);
            let periods = (multiple * firing_hz / rate_hz).round();
            let off_hz = |v: &f64| multiple * firings_per_turn * v.abs() / TAU - periods * rate_hz;
            let square = speed.samples.iter().map(|v| off_hz(v).powi(2)).sum::<f64>() / speed.len() as f64;
            periods >= 1.0 && square.sqrt() < NEAR_HZ
        };
        (1..=HIGHEST).find(rests).map(|multiple| Folded { firing_hz, multiple })
    }
}
