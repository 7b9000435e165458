//! Sources of randomness.

use numerics::random::Stream;

/// What random numbers are for: each source has a stream of its own, so that changing one leaves the others alone.
#[derive(Debug, Clone, Copy)]
pub enum Source {
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

impl Source {
    /// The random numbers of this source under a seed.
    pub fn stream(self, seed: u64) -> Stream {
        Stream::new(seed, self as u64)
    }
}
