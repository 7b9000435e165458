//! Seeded noise for the tests.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub(crate) struct Noise(ChaCha8Rng);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Noise(ChaCha8Rng::seed_from_u64(seed))
    }

    pub(crate) fn uniform(&mut self) -> f64 {
        self.0.random::<f64>()
    }

    /// Standard normal, by Box and Muller.
    pub(crate) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    pub(crate) fn normals(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.normal()).collect()
    }

    /// Noise of this deviation that remembers each sample by a part `memory`.
    pub(crate) fn coloured(&mut self, count: usize, deviation: f64, memory: f64) -> Vec<f64> {
        let fresh = deviation * (1.0 - memory * memory).sqrt();
        let mut value = deviation * self.normal();
        let mut next = || {
            value = memory * value + fresh * self.normal();
            value
        };
        (0..count).map(|_| next()).collect()
    }
}
