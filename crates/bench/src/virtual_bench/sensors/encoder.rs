//! Speed from an incremental encoder.

use super::{Rotation, rounded};
use crate::virtual_bench::noise::Random;
use crate::virtual_bench::parameters::SensorParameters;

/// Speed from an encoder: N = (θ̃(t) − θ̃(t − gate))/gate with θ̃ = θ + ε sin θ, plus noise, rounded.
#[derive(Debug, Clone)]
pub(crate) struct Encoder {
    gate_s: f64,
    eccentricity: f64,
    noise_rad_s: f64,
    resolution_rad_s: f64,
    random: Random,
}

impl Encoder {
    pub(crate) fn new(parameters: &SensorParameters, eccentricity: f64, random: Random) -> Self {
        Self {
            gate_s: parameters.gate_s,
            eccentricity,
            noise_rad_s: parameters.speed_noise_rad_s,
            resolution_rad_s: parameters.speed_resolution_rad_s,
            random,
        }
    }

    /// The reading now, rad/s.
    pub(crate) fn read_rad_s(&mut self, rotation: &Rotation) -> f64 {
        let start_rad = rotation.angle_before_rad(self.gate_s);
        let end_rad = rotation.angle_before_rad(0.0);
        let error_rad = self.eccentricity * (end_rad.sin() - start_rad.sin());
        let mean_rad_s = (end_rad - start_rad + error_rad) / self.gate_s;
        let reading_rad_s = mean_rad_s + self.noise_rad_s * self.random.normal();
        rounded(reading_rad_s, self.resolution_rad_s)
    }
}
