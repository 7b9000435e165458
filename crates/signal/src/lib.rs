//! Uniformly sampled data on one clock.

/// A uniformly sampled signal.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Signal {
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Sample time, s.
    pub sample_time_s: f64,
    /// Samples.
    pub samples: Vec<f64>,
}
