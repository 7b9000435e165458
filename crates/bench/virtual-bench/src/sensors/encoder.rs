//! Speed from an incremental encoder.

use numerics::random::Stream;
use rig::bench_parameters::SensorParameters;
use rig::random::Source;

use super::Rotation;
use super::pulses::Pulses;
use crate::sensors::rounding::rounded;

/// Speed from an encoder: N = (θ̃(t) − θ̃(t − gate))/gate with θ̃ = θ + ε sin θ, or from the disk's pulses; plus noise,
/// rounded.
#[derive(Debug, Clone)]
pub(super) struct Encoder {
    gate_s: f64,
    eccentricity: f64,
    noise_rad_s: f64,
    resolution_rad_s: f64,
    random: Stream,
    pulses: Option<Pulses>,
}

/// Which random streams an encoder draws from: noise, edges, and the places of its slits.
#[derive(Debug, Clone, Copy)]
pub(super) struct EncoderStreams {
    pub(super) noise: Source,
    pub(super) edges: Source,
    pub(super) slits: Source,
}

impl Encoder {
    /// The encoder of a shaft end at an angle and a speed.
    pub(super) fn new(
        parameters: &SensorParameters,
        eccentricity: f64,
        streams: EncoderStreams,
        seed: u64,
        angle_rad: f64,
        speed_rad_s: f64,
    ) -> Self {
        let random = |source: Source| source.stream(seed);
        let pulses = parameters.pulses.as_ref().map(|pulses| {
            let (pattern, edges) = (random(streams.slits), random(streams.edges));
            Pulses::new(pulses, parameters.gate_s, eccentricity, pattern, edges, angle_rad, speed_rad_s)
        });
        Self {
            gate_s: parameters.gate_s,
            eccentricity,
            noise_rad_s: parameters.speed_noise_rad_s,
            resolution_rad_s: parameters.speed_resolution_rad_s,
            random: random(streams.noise),
            pulses,
        }
    }

    /// The reading now, rad/s.
    pub(super) fn read_rad_s(&mut self, rotation: &Rotation) -> f64 {
        let mean_rad_s = match &mut self.pulses {
            Some(pulses) => pulses.read_rad_s(rotation),
            None => self.mean_rad_s(rotation),
        };
        let reading_rad_s = mean_rad_s + self.noise_rad_s * self.random.normal();
        rounded(reading_rad_s, self.resolution_rad_s)
    }

    fn mean_rad_s(&self, rotation: &Rotation) -> f64 {
        let start_rad = rotation.angle_before_rad(self.gate_s);
        let end_rad = rotation.angle_before_rad(0.0);
        let error_rad = self.eccentricity * (end_rad.sin() - start_rad.sin());
        (end_rad - start_rad + error_rad) / self.gate_s
    }
}
