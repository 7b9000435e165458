//! What the speed-controller fit learns of the dynamometer's encoder.

use rig::estimation::noise_floor;
use signal::Signal;

/// Relative standard uncertainty of a gate that is assumed to last one sample time.
const ASSUMED_GATE_DOUBT: f64 = 0.1;
/// Relative standard uncertainty of a gate that the bench file states.
const STATED_GATE_DOUBT: f64 = 0.01;
/// The fit has seen the encoder if its residual is at least this part of the noise floor of the logged speed; otherwise
/// the controller reads the very samples that are logged, and the fit says nothing of their errors.
const SEEN_PART: f64 = 0.3;

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
    /// The encoder as the speed controller's fit found it, and where that cannot say: noise from the top of the logged
    /// speed's spectrum, gate as stated, or one sample time.
    pub fn known_or_assumed(fitted: Option<Encoder>, speed: &Signal, stated_gate_s: Option<f64>) -> Encoder {
        let floor = noise_floor(speed);
        let sample_time = speed.sample_time_s;
        let seen = fitted.filter(|e| e.noise_rad_s > SEEN_PART * floor);
        let (gate_s, gate_standard_error_s) = match (stated_gate_s, seen) {
            (Some(gate), _) => (gate, STATED_GATE_DOUBT * gate),
            (None, Some(e)) if e.gate_standard_error_s < ASSUMED_GATE_DOUBT * sample_time && e.gate_s > 0.0 => {
                (e.gate_s, e.gate_standard_error_s)
            }
            _ => (sample_time, ASSUMED_GATE_DOUBT * sample_time),
        };
        Encoder {
            gate_s,
            gate_standard_error_s,
            noise_rad_s: seen.map_or(floor, |e| e.noise_rad_s),
            once_a_turn: seen.map_or((0.0, 0.0), |e| e.once_a_turn),
        }
    }

    /// Amplitude of the once-a-turn error as a fraction of the speed.
    pub fn eccentricity(&self) -> f64 {
        self.once_a_turn.0.hypot(self.once_a_turn.1)
    }
}
