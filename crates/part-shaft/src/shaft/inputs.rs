//! What the shaft is estimated from.

use part_torque::air_gap_torque::NoisyTorque;
use rig::estimation::EstimateError;
use rig::results::Stretch;
use signal::Signal;

/// Largest skew looked for, s.
pub(super) const LARGEST_SKEW_S: f64 = 0.02;
/// Shortest usable recording, s.
const SHORTEST_S: f64 = 4.0;
/// Longest part of a recording that is used, s: of it noise already leaves K less uncertain than the model of the signals does.
const LONGEST_S: f64 = 240.0;
/// Time within which a change of speed twists the shaft, s.
const TWISTING_S: f64 = 0.02;

/// What the shaft is estimated from.
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
    /// Slope of the dynamometer's friction over speed with its standard uncertainty, Nm s/rad, without which it would be taken
    /// for damping of the shaft; without effect where the torque is that of a flange. See [`ShaftInputs::usual_friction`].
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

/// What of a torque that is computed from its demand is uncertain.
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
    /// The slope of the friction where nothing was measured of it: that of a dynamometer that runs out with a time constant of a
    /// minute is a standard deviation away from none.
    #[must_use]
    pub fn usual_friction(inertia_kg_m2: f64) -> (f64, f64) {
        (0.0, inertia_kg_m2 / RUN_OUT_S)
    }

    pub(crate) fn signals(&self) -> impl Iterator<Item = &Signal> {
        [self.dyno_speed, self.engine_speed].into_iter().chain(self.torque.iter().map(|t| &t.signal))
    }

    /// From the first instant all signals share to the last; of longer recordings the four minutes in which N_e changes most.
    pub fn stretch(&self) -> Result<Stretch, EstimateError> {
        let start_s = self.signals().map(|s| s.start_s).fold(f64::NEG_INFINITY, f64::max);
        let end = |s: &Signal| s.start_s + s.len() as f64 * s.sample_time_s;
        let end_s = self.signals().map(end).fold(f64::INFINITY, f64::min);
        let duration_s = (end_s - start_s).max(0.0);
        if self.torque.is_empty() || duration_s < SHORTEST_S {
            return Err(EstimateError::TooShort { file: self.file.to_owned(), duration_s, needed_s: SHORTEST_S });
        }
        let file = self.file.to_owned();
        if duration_s <= LONGEST_S {
            return Ok(Stretch { file, start_s, end_s });
        }
        let start_s = start_s + start_of_liveliest(&self.engine_speed.slice(start_s, end_s), LONGEST_S);
        Ok(Stretch { file, start_s, end_s: start_s + LONGEST_S })
    }
}

/// Where the part so long begins in which a speed changes most within [`TWISTING_S`], in whole seconds after its start.
fn start_of_liveliest(speed: &Signal, duration_s: f64) -> f64 {
    let samples = |time_s: f64| ((time_s / speed.sample_time_s).round() as usize).max(1);
    let lag = samples(TWISTING_S);
    let squares: Vec<f64> = speed.samples.windows(lag + 1).map(|part| (part[lag] - part[0]).powi(2)).collect();
    let of_seconds: Vec<f64> = squares.chunks_exact(samples(1.0)).map(|second| second.iter().sum()).collect();
    let mut best = (0, f64::NEG_INFINITY);
    for (first, part) in of_seconds.windows(duration_s.ceil() as usize).enumerate() {
        let sum: f64 = part.iter().sum();
        if sum > best.1 {
            best = (first, sum);
        }
    }
    best.0 as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At rest for the first 300 s, and once more at the end.
    #[test]
    fn exact_of_a_long_recording_the_part_is_used_that_moves() {
        let moves = |time_s: f64| if (300.0..540.0).contains(&time_s) { (40.0 * time_s).sin() } else { 0.0 };
        let samples = (0..70_000).map(|k| 100.0 + moves(f64::from(k) * 0.01)).collect();
        let speed = Signal { start_s: 0.0, sample_time_s: 0.01, samples };
        let torque = NoisyTorque { signal: speed.clone(), noise_nm: 0.1, unseen_hz: Vec::new() };
        let inputs = ShaftInputs {
            file: "a.mf4",
            dyno_speed: &speed,
            engine_speed: &speed,
            torque: vec![torque],
            inertia_kg_m2: None,
            friction_slope_nm_s_per_rad: (0.0, 0.0),
            encoder_noise_rad_s: 0.01,
            gate_s: (0.0, 0.0),
            torque_control: None,
            firings_per_turn: 2.0,
        };
        let stretch = inputs.stretch().ok();
        let found = stretch.map(|stretch| (stretch.start_s, stretch.end_s));
        assert!(
            found.is_some_and(|(start, end)| (start - 300.0).abs() <= 1.0 && end - start == LONGEST_S),
            "{found:?}"
        );
    }
}
