//! [`ChannelPair`]: from which input to which output.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The way from one input to one output of a system, by their indices from zero on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub struct ChannelPair {
    /// Index of the output.
    pub output: usize,
    /// Index of the input.
    pub input: usize,
}

impl ChannelPair {
    /// Every pair of a system, output by output.
    pub fn all(outputs: usize, inputs: usize) -> impl Iterator<Item = ChannelPair> {
        (0..outputs).flat_map(move |output| (0..inputs).map(move |input| ChannelPair { output, input }))
    }
}

impl fmt::Display for ChannelPair {
    /// `u1 to y2`, counted from one.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "u{} to y{}", self.input + 1, self.output + 1)
    }
}
