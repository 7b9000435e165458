//! Sources of randomness.

use numerics::random::Stream;

/// Uses of random numbers: each source has a stream of its own, so that changing one leaves the others alone.
#[derive(Debug, Clone, Copy)]
pub enum Source {
    /// Torque demand of the dynamometer.
    DynoTorque = 1,
    /// Strength of the firings.
    Firing = 2,
    /// Angle at the start.
    StartAngle = 3,
    /// Noise of the dynamometer's encoder.
    DynoEncoder = 4,
    /// Noise of the engine's encoder.
    EngineEncoder = 5,
    /// Noise of T_d,calc.
    CalcTorque = 6,
    /// Noise of the load cell.
    LoadCell = 7,
    /// Noise of the torque flange.
    Flange = 8,
    /// Torque demand of the engine.
    EngineTorque = 9,
    /// Throttle.
    Throttle = 10,
    /// Ignition.
    Ignition = 11,
    /// Speed demand.
    Speed = 12,
    /// Edges of the dynamometer's encoder pulses.
    DynoEdges = 13,
    /// Edges of the engine's encoder pulses.
    EngineEdges = 14,
    /// Slits of the dynamometer's encoder disc.
    DynoSlits = 15,
    /// Slits of the engine's encoder disc.
    EngineSlits = 16,
    /// Benches drawn to check an experiment.
    Safety = 17,
    /// Noise on the controller's speed.
    NoiseTest = 18,
    /// Friction of the dynamometer, of benches drawn to check an experiment.
    Friction = 20,
    /// Errors of the dynamometer's encoder and phase of the drive's ripple, of benches drawn to predict a test.
    Disturbances = 21,
}

impl Source {
    /// The random numbers of this source under a seed.
    pub fn stream(self, seed: u64) -> Stream {
        Stream::new(seed, self as u64)
    }
}
