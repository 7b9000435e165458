//! Findings of the speed-controller fit on the dynamometer's encoder.

use rig::estimation::noise_floor;
use signal::Signal;

/// Relative standard uncertainty of a gate that is assumed to last one sample time.
const ASSUMED_GATE_DOUBT: f64 = 0.1;
/// Relative standard uncertainty of a gate that the bench file states.
const STATED_GATE_DOUBT: f64 = 0.01;
/// An encoder that is read each time has a gate of one sample. One of more than so many samples, ...
const LONGEST_GATE_SAMPLES: f64 = 2.5;
/// ... and of more than so many s, ...
const LONGEST_GATE_S: f64 = 2.5e-3;
/// ... which by this many standard errors is no accident, is that of a mean or a filter behind the encoder.
const CERTAIN: f64 = 4.0;
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
            // Whether the mean or filter is in other recordings too, nothing shows.
            (None, Some(e)) if e.is_behind_a_filter(sample_time) => {
                let beyond_s = e.gate_s - sample_time;
                (sample_time + 0.5 * beyond_s, e.gate_standard_error_s.hypot(beyond_s / 12f64.sqrt()))
            }
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

    /// Tells whether N_d, with a sample time in s, is smoother than any encoder makes it, beside what the controller
    /// sees.
    pub fn is_behind_a_filter(&self, sample_time_s: f64) -> bool {
        let longest_s = f64::max(LONGEST_GATE_SAMPLES * sample_time_s, LONGEST_GATE_S);
        self.gate_s - CERTAIN * self.gate_standard_error_s > longest_s
    }

    /// Amplitude of the once-a-turn error as a fraction of the speed.
    pub fn eccentricity(&self) -> f64 {
        self.once_a_turn.0.hypot(self.once_a_turn.1)
    }
}
