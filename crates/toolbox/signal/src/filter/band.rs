//! Band that a filter lets through.

use crate::error::SignalError;

/// Band that is let through, with edges in hertz.
#[derive(Clone, Copy)]
pub(super) enum Band {
    Low(f64),
    High(f64),
    Pass(f64, f64),
    Stop(f64, f64),
}

impl Band {
    /// The edges must ascend strictly between zero and half the sample rate.
    pub(super) fn check(self, sample_time_s: f64) -> Result<(), SignalError> {
        let high_hz = 0.5 / sample_time_s;
        let edge = |cutoff_hz: f64, low_hz: f64| {
            let inside = cutoff_hz > low_hz && cutoff_hz < high_hz;
            if inside { Ok(()) } else { Err(SignalError::Cutoff { cutoff_hz, low_hz, high_hz }) }
        };
        match self {
            Band::Low(cutoff) | Band::High(cutoff) => edge(cutoff, 0.0),
            Band::Pass(low, high) | Band::Stop(low, high) => edge(low, 0.0).and_then(|()| edge(high, low)),
        }
    }
}
