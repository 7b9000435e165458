//! The once-a-turn error of an encoder in a recorded speed.

use signal::Signal;

/// Once-a-turn error of the dynamometer's speed as recorded, as far as the speed controller does not answer it (that is
/// how it is separated from a true variation): the recording shows N_d (1 + a cos φ + b sin φ), φ being the angle
/// turned since the recording's start, φ_k = T Σ_{i ≤ k} N_d,i.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EncoderError {
    /// a.
    pub cosine: f64,
    /// b.
    pub sine: f64,
}

/// N_d (a cos φ + b sin φ) with φ_k = T Σ_{i ≤ k} N_d,i from the recording's start.
pub fn encoder_error(dyno: &Signal, error: Option<EncoderError>) -> Vec<f64> {
    let Some(error) = error else { return vec![0.0; dyno.len()] };
    let mut angle = 0.0;
    let at = |speed: &f64| {
        angle += speed * dyno.sample_time_s;
        speed * (error.cosine * f64::cos(angle) + error.sine * f64::sin(angle))
    };
    dyno.samples.iter().map(at).collect()
}
