//! Statements of a bench file on one channel.

use units::{self, Unit};

/// How a role is recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelMapping {
    /// Name of the channel in the recordings.
    pub name: String,
    /// Unit of its samples, in place of the one the recording states.
    pub unit: Option<Unit>,
    /// True where its samples have the opposite sign of the role's convention (`sign = -1`).
    pub inverted: bool,
    /// Worth of one of its samples, in its unit: a torque constant in Nm/A, a lever arm, a gear ratio.
    pub factor: f64,
    /// Length of the encoder's gate over which a speed is averaged, s, if known.
    pub gate_s: Option<f64>,
}

impl ChannelMapping {
    /// A channel recorded in its own unit and with the role's sign.
    pub fn named(name: impl Into<String>) -> ChannelMapping {
        ChannelMapping { name: name.into(), unit: None, inverted: false, factor: 1.0, gate_s: None }
    }

    /// Multiplier of a sample: the factor, with the sign that makes it follow the role's convention.
    pub fn signed_factor(&self) -> f64 {
        if self.inverted { -self.factor } else { self.factor }
    }
}
