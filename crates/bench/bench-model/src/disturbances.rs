//! Disturbances of a bench: errors of the dynamometer's encoder, which the speed controller answers, and the ripple of
//! the drive.

use numerics::random::Stream;
use rig::bench_parameters::{ONCE_A_TURN, SensorParameters};
use rig::random::Source;
use serde::{Deserialize, Serialize};

use crate::drive_ripple::RippleLine;

/// Disturbances of a bench; none by default.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Disturbances {
    /// Standard deviation of the noise of N_d from sample to sample, rad/s.
    pub speed_noise_rad_s: f64,
    /// Amplitude of the once-a-turn error of N_d, in parts of the speed. Between benches this is its root mean square.
    pub once_a_turn: f64,
    /// The strongest line of the drive's ripple.
    pub ripple: Option<RippleLine>,
}

impl Disturbances {
    /// Those of a bench of which no recording shows more.
    #[must_use]
    pub fn assumed() -> Self {
        let speed_noise_rad_s = SensorParameters::default().speed_noise_rad_s;
        Disturbances { speed_noise_rad_s, once_a_turn: ONCE_A_TURN, ripple: None }
    }

    /// Those of one bench. A disc runs out in two directions, each as much as the other: its amplitude has Rayleigh's
    /// distribution.
    #[must_use]
    pub fn draw(&self, random: &mut Stream) -> Self {
        let (one, other) = (random.normal(), random.normal());
        Disturbances { once_a_turn: self.once_a_turn * (0.5 * (one * one + other * other)).sqrt(), ..*self }
    }
}

/// Disturbances of one run: noise, and the angles and phases at its start, which nobody knows.
#[derive(Debug, Clone)]
pub(crate) struct Disturbing {
    of: Disturbances,
    random: Stream,
    disc_rad: f64,
    ripple_s: f64,
}

impl Disturbing {
    pub(crate) fn new(of: Disturbances, seed: u64) -> Self {
        let mut random = Source::Disturbances.stream(seed);
        let disc_rad = random.between(0.0, std::f64::consts::TAU);
        let ripple_s = of.ripple.map_or(0.0, |line| random.between(0.0, 1.0) / line.frequency_hz);
        Disturbing { of, random, disc_rad, ripple_s }
    }

    /// Error of the next reading of the encoder beside the mean speed over its gate, rad/s.
    pub(crate) fn of_reading_rad_s(&mut self, angle_rad: f64, speed_rad_s: f64) -> f64 {
        let of_disc = self.of.once_a_turn * speed_rad_s * (angle_rad + self.disc_rad).cos();
        of_disc + self.of.speed_noise_rad_s * self.random.normal()
    }

    /// Ripple of so many samples: in parts of the torque, and what is added, Nm; empty without any.
    pub(crate) fn ripple(&self, samples: usize, sample_time_s: f64) -> (Vec<f64>, Vec<f64>) {
        let Some(line) = self.of.ripple else { return (Vec::new(), Vec::new()) };
        (0..samples).map(|k| line.parts(self.ripple_s + k as f64 * sample_time_s)).unzip()
    }
}
