//! Observations given to the smoother.

use faer::Mat;

/// Observations on the clock of N_d: row k is at `start_s` + k steps, where the means of its speeds end and that of its
/// torque begins.
#[derive(Debug, Clone)]
pub struct Observations {
    /// Time of the first row, s.
    pub start_s: f64,
    /// Time between rows, s.
    pub sample_time_s: f64,
    /// The first value of N_d.
    pub first_rad_s: f64,
    /// Speeds less that, a column each; NaN where none was read.
    pub speeds: Mat<f64>,
    /// Mean of T_d from each sample to the next, one column.
    pub torque: Mat<f64>,
    /// Firing frequency and multiples, Hz.
    pub lines_hz: Vec<f64>,
    /// Standard deviation of the noise on each speed, a guess.
    pub noise_rad_s: Vec<f64>,
}
