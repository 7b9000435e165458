//! Random numbers that depend on the seed and on nothing else: the same on every machine and in every version. Not for
//! secrets.

use std::f64::consts::TAU;

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_xoshiro::Xoshiro256PlusPlus;

/// A small fast generator, xoshiro256++ seeded by splitmix64.
///
/// # Example
/// ```
/// let mut random = numerics::random::Random::new(7);
/// let first = random.uniform();
/// assert!((0.0..1.0).contains(&first));
/// assert_eq!(first, numerics::random::Random::new(7).uniform());
/// ```
///
/// # Source
/// Blackman, D. and Vigna, S. (2021), ACM Trans. Math. Softw. 47(4), 36.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Random {
    generator: Xoshiro256PlusPlus,
}

impl Random {
    /// A generator whose numbers depend on the seed alone.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { generator: Xoshiro256PlusPlus::seed_from_u64(seed) }
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.generator.next_u64()
    }

    /// Uniform in 0 ..< 1, with 53 random bits.
    pub fn uniform(&mut self) -> f64 {
        uniform(&mut self.generator)
    }

    /// Normal with mean 0 and standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        let [normal, _] = normal_pair(&mut self.generator);
        normal
    }
}

/// One of 2⁶⁴ independent streams of the same seed, from ChaCha with 8 rounds.
///
/// Give each source of randomness its own stream: what one draws then leaves the others alone.
///
/// # Example
/// ```
/// use numerics::random::Stream;
/// assert_eq!(Stream::new(7, 1).uniform(), Stream::new(7, 1).uniform());
/// assert_ne!(Stream::new(7, 1).uniform(), Stream::new(7, 2).uniform());
/// ```
///
/// # Source
/// Bernstein, D. J. (2008), *ChaCha, a variant of Salsa20*.
#[derive(Debug, Clone)]
pub struct Stream {
    generator: ChaCha8Rng,
    /// The second of the last pair of normal numbers, unless it has been given out.
    spare_normal: Option<f64>,
}

impl Stream {
    /// The stream of this number among those of the seed.
    #[must_use]
    pub fn new(seed: u64, number: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(number);
        Self { generator, spare_normal: None }
    }

    /// Uniform in 0 ..< 1, with 53 random bits.
    pub fn uniform(&mut self) -> f64 {
        uniform(&mut self.generator)
    }

    /// Uniform between two values.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Either of two values with equal chance.
    pub fn either(&mut self, first: f64, second: f64) -> f64 {
        if self.generator.next_u64() >> 63 == 0 { first } else { second }
    }

    /// Normal with mean 0 and standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare_normal.take() {
            return spare;
        }
        let [first, second] = normal_pair(&mut self.generator);
        self.spare_normal = Some(second);
        first
    }
}

fn uniform(generator: &mut impl Rng) -> f64 {
    (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Two independent standard normal numbers.
///
/// # Source
/// Box, G. E. P. and Muller, M. E. (1958), Ann. Math. Statist. 29(2), 610.
fn normal_pair(generator: &mut impl Rng) -> [f64; 2] {
    let radius = (-2.0 * (1.0 - uniform(generator)).ln()).sqrt();
    let (sine, cosine) = (TAU * uniform(generator)).sin_cos();
    [radius * cosine, radius * sine]
}
