//! What the speed-controller fit learns of the dynamometer's encoder.

/// The encoder of the dynamometer, relative to the speed the controller sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoder {
    /// Length of the gate over which the logged speed is averaged, s.
    pub gate_s: f64,
    /// Standard error of the gate, s.
    pub gate_standard_error_s: f64,
    /// Standard deviation of the encoder's noise, rad/s.
    pub noise_rad_s: f64,
    /// Once-a-turn error as a fraction of the speed: coefficients of cos φ and sin φ, φ = ∫ω_d dt from the first
    /// sample of the recording.
    pub once_a_turn: (f64, f64),
}

impl Encoder {
    /// Amplitude of the once-a-turn error as a fraction of the speed.
    pub fn eccentricity(&self) -> f64 {
        self.once_a_turn.0.hypot(self.once_a_turn.1)
    }
}
