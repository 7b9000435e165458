//! Random numbers that depend on the seed and on nothing else.

use std::f64::consts::TAU;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What a stream of random numbers is for: each source has its own, so that changing one leaves the others alone.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Source {
    DynoTorque = 1,
    Firing = 2,
    StartAngle = 3,
    DynoEncoder = 4,
    EngineEncoder = 5,
    CalcTorque = 6,
    LoadCell = 7,
    Flange = 8,
    EngineTorque = 9,
    Throttle = 10,
    Ignition = 11,
    Speed = 12,
    DynoEdges = 13,
    EngineEdges = 14,
    DynoSlits = 15,
    EngineSlits = 16,
    Safety = 17,
    PiStudy = 18,
}

/// Uniform and normal numbers from one ChaCha stream.
#[derive(Debug, Clone)]
pub(crate) struct Random {
    generator: ChaCha8Rng,
    spare_normal: Option<f64>,
}

impl Random {
    pub(crate) fn new(seed: u64, source: Source) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(source as u64);
        Self { generator, spare_normal: None }
    }

    /// Uniform in [0, 1), with 53 bits.
    pub(crate) fn uniform(&mut self) -> f64 {
        (self.generator.next_u64() >> 11) as f64 * 2f64.powi(-53)
    }

    /// Uniform between two values.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Either of two values with equal chance.
    pub(crate) fn either(&mut self, first: f64, second: f64) -> f64 {
        if self.generator.next_u64() >> 63 == 0 { first } else { second }
    }

    /// Normal with mean zero and variance one (Box & Muller, 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare_normal.take() {
            return spare;
        }
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        let (sine, cosine) = (TAU * self.uniform()).sin_cos();
        self.spare_normal = Some(radius * sine);
        radius * cosine
    }
}
