//! The drive's ripple: a sine over the steps of the bench.

use std::f64::consts::TAU;

/// Steps from one sine from scratch to the next: until then rounding errors stay below 10⁻¹³.
const REFRESHED_AFTER: u32 = 100;

/// sin 2πft at equal steps, which the addition theorem carries on.
#[derive(Debug, Clone)]
pub(super) struct Ripple {
    rad_s: f64,
    /// Sine and cosine of a step, and now.
    step: (f64, f64),
    now: (f64, f64),
    /// Since the last sine from scratch.
    steps: u32,
}

impl Ripple {
    pub(super) fn new(frequency_hz: f64, step_s: f64) -> Self {
        let rad_s = TAU * frequency_hz;
        Self { rad_s, step: (rad_s * step_s).sin_cos(), now: (0.0, 1.0), steps: REFRESHED_AFTER }
    }

    /// The sine at `time_s`, a step after the last call.
    pub(super) fn sine(&mut self, time_s: f64) -> f64 {
        if self.steps == REFRESHED_AFTER {
            self.now = (self.rad_s * time_s).sin_cos();
            self.steps = 0;
        } else {
            let ((sine, cosine), (by_sine, by_cosine)) = (self.now, self.step);
            self.now = (sine * by_cosine + cosine * by_sine, cosine * by_cosine - sine * by_sine);
            self.steps += 1;
        }
        self.now.0
    }
}
