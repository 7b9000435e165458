//! Inputs of the shaft's estimate.

use part_torque::air_gap_torque::NoisyTorque;
use rig::estimation::EstimateError;
use rig::results::Stretch;
use signal::Signal;

/// Largest skew looked for, s.
pub(crate) const LARGEST_SKEW_S: f64 = 0.02;
/// Shortest usable recording, s.
const SHORTEST_S: f64 = 4.0;

/// Inputs of the shaft's estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct ShaftInputs<'a> {
    /// File, for messages.
    pub file: &'a str,
    /// N_d, rad/s.
    pub dyno_speed: &'a Signal,
    /// N_e, rad/s.
    pub engine_speed: &'a Signal,
    /// T_d, or T_shaft where a flange measures it, as a sum of records.
    pub torque: Vec<NoisyTorque>,
    /// J_d and its standard uncertainty, kg m²; `None` where the torque is that of a flange.
    pub inertia_kg_m2: Option<(f64, f64)>,
    /// Slope of the dynamometer's friction over speed with its standard uncertainty, Nm s/rad, without which it would
    /// be taken for damping of the shaft; without effect where the torque is that of a flange. See
    /// [`ShaftInputs::usual_friction`].
    pub friction_slope_nm_s_per_rad: (f64, f64),
    /// Standard deviation of the encoders' noise, rad/s.
    pub encoder_noise_rad_s: f64,
    /// Gate of the encoders and its standard uncertainty, s.
    pub gate_s: (f64, f64),
    /// The torque control, where the torque is computed from its demand.
    pub torque_control: Option<TorqueDelay>,
    /// Firings of the engine a turn; zero where nothing fires.
    pub firings_per_turn: f64,
}

/// Uncertain parts of a torque that is computed from its demand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueDelay {
    /// Lag 1/a of the torque control that it was computed with, s.
    pub lag_s: f64,
    /// Standard uncertainty of that, s.
    pub lag_uncertainty_s: f64,
    /// Standard uncertainty of the delay τ, s.
    pub delay_uncertainty_s: f64,
}

/// Time constant, s, with which a dynamometer left alone runs out: electric ones take a minute or more.
const RUN_OUT_S: f64 = 60.0;

impl ShaftInputs<'_> {
    /// The slope of the friction where nothing was measured of it: that of a dynamometer that runs out with a time
    /// constant of a minute is a standard deviation away from none.
    #[must_use]
    pub fn usual_friction(inertia_kg_m2: f64) -> (f64, f64) {
        (0.0, inertia_kg_m2 / RUN_OUT_S)
    }

    pub(crate) fn signals(&self) -> impl Iterator<Item = &Signal> {
        [self.dyno_speed, self.engine_speed].into_iter().chain(self.torque.iter().map(|t| &t.signal))
    }

    /// From the first instant all signals share to the last.
    pub fn stretch(&self) -> Result<Stretch, EstimateError> {
        let start_s = self.signals().map(|s| s.start_s).fold(f64::NEG_INFINITY, f64::max);
        let end = |s: &Signal| s.start_s + s.len() as f64 * s.sample_time_s;
        let end_s = self.signals().map(end).fold(f64::INFINITY, f64::min);
        let duration_s = (end_s - start_s).max(0.0);
        if self.torque.is_empty() || duration_s < SHORTEST_S {
            return Err(EstimateError::TooShort { file: self.file.to_owned(), duration_s, needed_s: SHORTEST_S });
        }
        Ok(Stretch { file: self.file.to_owned(), start_s, end_s })
    }
}
