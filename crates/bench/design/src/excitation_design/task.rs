//! Task of a design.

use bench_model::model::{BenchModel, ModelParameter};
use serde::{Deserialize, Serialize};
use units::RPM_RAD_S;

use super::unknown::Unknown;
use crate::excitation_design::error::DesignError;

/// Time that unknown times are counted against, s.
pub(super) const TIME_SCALE_S: f64 = 1e-3;
/// Longest a design may be, in steps of its demand.
const MOST_STEPS: usize = 100_000;
/// A time may differ from a whole number of another by this part of it.
const WHOLE: f64 = 1e-6;

/// Which demand carries the excitation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExcitedDemand {
    /// T_d* in torque control (TN), Nm.
    Torque,
    /// N_d* in speed control (NT), rad/s.
    Speed,
}

/// A number that is unknown too, though nobody asks for it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Nuisance {
    /// Which.
    pub unknown: Unknown,
    /// Prior knowledge of it, as a standard uncertainty in SI; none: nothing.
    pub standard_uncertainty: Option<f64>,
}

/// White noise on the samples of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SampleNoise {
    /// Standard deviation, rad/s or Nm.
    pub standard_deviation: f64,
    /// Time between samples, s.
    pub sample_time_s: f64,
}

/// Measured signals, each with its noise; none: not measured. T_e is never measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measurements {
    /// N_d.
    pub dyno_speed: Option<SampleNoise>,
    /// Error of the speed controller's reading, beyond the noise of the record of N_d; none: nothing.
    pub controller_reading: Option<SampleNoise>,
    /// N_e.
    pub engine_speed: Option<SampleNoise>,
    /// T_d* as the controller computes it, in speed control; in torque control it is the excitation, known exactly.
    pub torque_demand: Option<SampleNoise>,
    /// T_d as the torque control computes it.
    pub air_gap_torque: Option<SampleNoise>,
    /// T_shaft of a flange.
    pub shaft_torque: Option<SampleNoise>,
    /// Two-sided density of what T_e does by itself, Nm²/Hz; none: it may do anything, so that no conclusion is drawn
    /// from it, as the shaft's estimator draws none.
    pub engine_torque_density: Option<f64>,
}

impl Default for Measurements {
    /// A load-cell bench: encoders with 0.03 rpm of noise at 1 kHz and 500 Hz, T_d,calc with 0.15 Nm at 250 Hz, T_d*
    /// rounded to 0.01 Nm, an engine that does what it likes.
    fn default() -> Self {
        let noise = |standard_deviation, sample_time_s| Some(SampleNoise { standard_deviation, sample_time_s });
        Measurements {
            dyno_speed: noise(0.03 * RPM_RAD_S, 1e-3),
            controller_reading: noise(0.03 * RPM_RAD_S, 1e-3),
            engine_speed: noise(0.03 * RPM_RAD_S, 2e-3),
            torque_demand: noise(0.01 / 12f64.sqrt(), 1e-3),
            air_gap_torque: noise(0.15, 4e-3),
            shaft_torque: None,
            engine_torque_density: None,
        }
    }
}

/// Largest deviations from the operating point; none: no limit. At least one is needed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PeakLimits {
    /// Of T_shaft, Nm.
    pub shaft_torque_nm: Option<f64>,
    /// Of T_d, Nm; in speed control of T_d*, too, which steps of N_d* drive further.
    pub air_gap_torque_nm: Option<f64>,
    /// Of the dynamometer's speed, rad/s.
    pub speed_rad_s: Option<f64>,
    /// Of the demand itself, Nm or rad/s.
    pub demand: Option<f64>,
}

/// Criterion that is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// The sum of the relative variances of what matters (A-optimality on a part of the parameters).
    #[default]
    RelativeVariance,
    /// The determinant of the covariance of what matters (D_s-optimality).
    Determinant,
}

/// Treatment of several possible models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Robustness {
    /// The mean of the criterion over the models.
    #[default]
    Mean,
    /// The worst of them.
    Worst,
}

/// A design to be made. [`DesignTask::shaft`] has what the shaft needs; every field may be changed afterwards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DesignTask {
    /// Models of the bench: first the nominal one, which predictions are made for; further ones where it is uncertain.
    /// Limits hold for all of them.
    pub models: Vec<BenchModel>,
    /// Treatment of several models.
    pub robustness: Robustness,
    /// Which demand is excited.
    pub excited: ExcitedDemand,
    /// Its operating point, about which it is excited, Nm or rad/s.
    pub mean_demand: f64,
    /// Parameters to be known well.
    pub of_interest: Vec<ModelParameter>,
    /// Further unknowns.
    pub nuisances: Vec<Nuisance>,
    /// Criterion that is made small.
    pub criterion: Criterion,
    /// Measured signals.
    pub measurements: Measurements,
    /// Limits.
    pub limits: PeakLimits,
    /// Lowest and highest frequency of the excitation, Hz.
    pub band_hz: (f64, f64),
    /// Lowest and highest frequency the estimator uses, Hz.
    pub estimated_hz: (f64, f64),
    /// Bands within these that it leaves out, as that about the rotational frequency, Hz.
    pub excluded_hz: Vec<(f64, f64)>,
    /// Power is spread evenly over bands of this width, Hz. Single lines far from each other beat, and have high peaks.
    pub resolution_hz: f64,
    /// The demand changes once in this time, s.
    pub hold_s: f64,
    /// Period of the excitation, s.
    pub period_s: f64,
    /// Length of the experiment, s.
    pub duration_s: f64,
}

/// The band about the rotational frequency, where encoders err and the engine's first order lies: it is left to them.
pub(super) fn beside_rotation(speed_rad_s: f64) -> Vec<(f64, f64)> {
    let turn_hz = speed_rad_s.abs() / std::f64::consts::TAU;
    vec![(turn_hz - 3.0, turn_hz + 3.0)]
}

impl DesignTask {
    /// K and B, by the determinant of their covariance, from torque control for 20 s: 1 to 45 Hz, T_d* held 10 ms,
    /// period 4 s. The skew of N_e, the delay of the torque control (with it that of T_d) and the gate (to a tenth) are
    /// unknown as they are to the shaft's estimator; it uses 1 to 110 Hz but 3 Hz on both sides of the rotational
    /// frequency.
    pub fn shaft(model: BenchModel, mean_torque_nm: f64, speed_rad_s: f64, limits: PeakLimits) -> Self {
        let unknown = |unknown, standard_uncertainty| Nuisance { unknown, standard_uncertainty };
        DesignTask {
            nuisances: vec![
                unknown(Unknown::EngineSpeedSkew, None),
                unknown(Unknown::Model(ModelParameter::TorqueControlDelay), None),
                unknown(Unknown::EncoderGate, Some(0.1 * model.encoder_gate_s.max(TIME_SCALE_S))),
            ],
            models: vec![model],
            robustness: Robustness::Mean,
            excited: ExcitedDemand::Torque,
            mean_demand: mean_torque_nm,
            of_interest: vec![ModelParameter::Stiffness, ModelParameter::Damping],
            criterion: Criterion::Determinant,
            // The model of the torque control gives T_d from T_d*; its delay is among the unknowns.
            measurements: Measurements { air_gap_torque: None, ..Measurements::default() },
            limits,
            band_hz: (1.0, 45.0),
            estimated_hz: (1.0, 110.0),
            excluded_hz: beside_rotation(speed_rad_s),
            resolution_hz: 8.0,
            hold_s: 0.01,
            period_s: 4.0,
            duration_s: 20.0,
        }
    }

    /// Adds models whose resonance is off by ± half of `share` and ± `share`: K by (1 ± share)², so that frequencies
    /// are by 1 ± share; B alike, so that the damping ratio is that of the nominal one.
    #[must_use]
    pub fn with_uncertain_resonance(mut self, share: f64) -> Self {
        let Some(nominal) = self.models.first().cloned() else { return self };
        for factor in [-1.0, -0.5, 0.5, 1.0].map(|part| 1.0 + part * share) {
            let mut other = nominal.clone();
            other.mechanics.stiffness_nm_per_rad *= factor * factor;
            other.mechanics.damping_nm_s_per_rad *= factor;
            self.models.push(other);
        }
        self
    }

    /// Everything unknown, what matters first.
    pub(super) fn unknowns(&self) -> Vec<Unknown> {
        let first = self.of_interest.iter().map(|p| Unknown::Model(*p));
        first.chain(self.nuisances.iter().map(|n| n.unknown)).collect()
    }

    /// Steps of the demand in its period.
    pub(super) fn steps(&self) -> usize {
        (self.period_s / self.hold_s).round() as usize
    }

    /// Steps of the demand in the experiment.
    pub(super) fn all_steps(&self) -> usize {
        (self.duration_s / self.hold_s).round() as usize
    }

    /// Tells whether the estimator uses a frequency.
    pub(super) fn is_used(&self, frequency_hz: f64) -> bool {
        let inside = |(low, high): &(f64, f64)| (*low..=*high).contains(&frequency_hz);
        inside(&self.estimated_hz) && !self.excluded_hz.iter().any(inside)
    }

    /// Refuses what cannot be designed.
    pub(super) fn check(&self) -> Result<(), DesignError> {
        let (limits, measured) = (&self.limits, &self.measurements);
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let all = [limits.shaft_torque_nm, limits.air_gap_torque_nm, limits.speed_rad_s, limits.demand];
        let noises = [
            measured.dyno_speed,
            measured.engine_speed,
            measured.torque_demand,
            measured.air_gap_torque,
            measured.shaft_torque,
        ];
        let is_noise = |n: &SampleNoise| positive(n.standard_deviation) && positive(n.sample_time_s);
        let whole = |x: f64| (x - x.round()).abs() < WHOLE * x.max(1.0) && x >= 0.5;
        let unknowns = self.unknowns();
        let twice = (0..unknowns.len()).any(|i| unknowns[..i].contains(&unknowns[i]));
        let steps = self.period_s / self.hold_s;
        let checks = [
            (!self.models.is_empty(), "a model is needed"),
            (!self.of_interest.is_empty(), "a parameter of interest is needed"),
            (!twice, "a parameter is named twice"),
            (all.iter().any(Option::is_some), "a limit is needed"),
            (all.iter().flatten().all(|l| positive(*l)), "limits must be positive"),
            (noises.iter().flatten().all(is_noise), "noise needs a positive deviation and sample time"),
            (noises.iter().any(Option::is_some), "a measured signal is needed"),
            (
                measured.engine_torque_density.is_none_or(positive),
                "the density of the engine's torque must be positive",
            ),
            (
                self.nuisances.iter().filter_map(|n| n.standard_uncertainty).all(positive),
                "a standard uncertainty must be positive",
            ),
            (self.mean_demand.is_finite(), "the operating point must be finite"),
            (positive(self.hold_s) && positive(self.period_s) && positive(self.duration_s), "times must be positive"),
            (whole(steps) && steps >= 8.0, "the period must be at least eight whole steps of the demand"),
            (self.duration_s >= self.period_s, "the experiment must last a period at least"),
            (self.duration_s / self.hold_s <= MOST_STEPS as f64, "the experiment has more than 100 000 steps"),
            (positive(self.resolution_hz), "the resolution must be positive"),
            (
                self.band_hz.0 > 0.0 && self.band_hz.0 < self.band_hz.1 && self.band_hz.1 < 0.5 / self.hold_s,
                "the band must lie between zero and half the rate of the demand",
            ),
            (
                self.estimated_hz.0 > 0.0 && positive(self.estimated_hz.1) && self.estimated_hz.1 <= 1000.0,
                "the estimator's band must lie between zero and 1 kHz",
            ),
        ];
        match checks.iter().find(|(holds, _)| !holds) {
            Some((_, requirement)) => Err(DesignError::Task { requirement }),
            None => self.check_models(),
        }
    }

    fn check_models(&self) -> Result<(), DesignError> {
        for model in &self.models {
            if model.torque_control.is_none() {
                return Err(DesignError::MissingPart { part: "torque control" });
            }
            if self.excited == ExcitedDemand::Speed && model.speed_controller.is_none() {
                return Err(DesignError::MissingPart { part: "speed controller" });
            }
            for unknown in self.unknowns() {
                match unknown {
                    Unknown::Model(p) if model.value(p).is_none() => {
                        return Err(DesignError::MissingPart { part: "part that a parameter belongs to" });
                    }
                    _ => (),
                }
            }
            let mechanics = &model.mechanics;
            let positive =
                [mechanics.dyno_inertia_kg_m2, mechanics.engine_inertia_kg_m2, mechanics.stiffness_nm_per_rad];
            let sound = positive.iter().all(|x| x.is_finite() && *x > 0.0)
                && mechanics.damping_nm_s_per_rad.is_finite()
                && mechanics.damping_nm_s_per_rad >= 0.0;
            if !sound {
                return Err(DesignError::Task { requirement: "inertias and stiffness must be positive" });
            }
        }
        Ok(())
    }
}

impl std::fmt::Display for Unknown {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Unknown::Model(parameter) => parameter.symbol(),
            Unknown::EngineSpeedSkew => "the skew of N_e",
            Unknown::EncoderGate => "the gate of the encoders",
        })
    }
}

impl Unknown {
    /// Scale that variances are relative to: the value; 1 ms for times, one where the value is zero.
    pub(super) fn scale(self, model: &BenchModel) -> f64 {
        match self {
            Unknown::EngineSpeedSkew
            | Unknown::EncoderGate
            | Unknown::Model(ModelParameter::TorqueControlDelay | ModelParameter::ControllerDelay) => TIME_SCALE_S,
            Unknown::Model(parameter) => match model.value(parameter).map(f64::abs) {
                Some(value) if value > 0.0 => value,
                _ => 1.0,
            },
        }
    }
}

impl SampleNoise {
    /// Two-sided spectral density σ²T.
    pub(super) fn density(self) -> f64 {
        self.standard_deviation * self.standard_deviation * self.sample_time_s
    }
}
