//! Goal of an experiment, in the words of the method, and the task that follows from it.

use std::fmt;
use std::str::FromStr;

use bench_model::model::{BenchModel, ModelParameter};
use rig::bench_file::Limits;
use rig::bench_parameters::BenchParameters;
use rig::experiment::{DEMAND_HOLD_S, UPDATE_S};
use rig::facts::BenchVariant;

use super::task::{
    DesignTask, ExcitedDemand, Measurements, Nuisance, PeakLimits, SampleNoise, TIME_SCALE_S, beside_rotation,
};
use super::{Criterion, Robustness};
use crate::excitation_design::error::DesignError;
use crate::excitation_design::unknown::Unknown;

/// Lowest frequency of an excitation from which gains of an integrator have to be determined, Hz.
const SLOW_HZ: f64 = 0.25;
/// Highest frequency of N_d*, Hz.
const HIGHEST_SPEED_HZ: f64 = 30.0;
/// Highest frequency that the shaft's estimator uses, Hz; that of the torque control uses what folds back, too.
const SHAFT_HIGHEST_HZ: f64 = 110.0;
/// Period, s.
const PERIOD_S: f64 = 4.0;
/// Part of what a limit leaves for T_shaft.
const SHAFT_SHARE: f64 = 0.5;
/// Part of what the limit leaves for T_d.
const TORQUE_SHARE: f64 = 0.95;
/// A sensor without noise is taken for one with this little, SI.
const LEAST_NOISE: f64 = 1e-6;

/// Goal of an experiment: the parameter that it is to teach.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Goal {
    /// K.
    Stiffness,
    /// B.
    Damping,
    /// J_d.
    DynoInertia,
    /// J_e.
    EngineInertia,
    /// K_p and K_i.
    SpeedController,
    /// k and k_a.
    FeedForward,
    /// Delay and bandwidth of the torque control.
    TorqueControl,
}

/// A text names no goal.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is none of {}", Goal::ALL.map(|goal| goal.to_string()).join(", "))]
pub struct UnknownGoal {
    /// The text.
    pub text: String,
}

impl Goal {
    /// All of them.
    pub const ALL: [Goal; 7] = [
        Goal::Stiffness,
        Goal::Damping,
        Goal::DynoInertia,
        Goal::EngineInertia,
        Goal::SpeedController,
        Goal::FeedForward,
        Goal::TorqueControl,
    ];

    /// The parameters that belong to it.
    pub fn parameters(self) -> &'static [ModelParameter] {
        match self {
            Goal::Stiffness => &[ModelParameter::Stiffness],
            Goal::Damping => &[ModelParameter::Damping],
            Goal::DynoInertia => &[ModelParameter::DynoInertia],
            Goal::EngineInertia => &[ModelParameter::EngineInertia],
            Goal::SpeedController => &[ModelParameter::Proportional, ModelParameter::Integral],
            Goal::FeedForward => &[ModelParameter::SpeedFeedForward, ModelParameter::AccelerationFeedForward],
            Goal::TorqueControl => &[ModelParameter::TorqueControlDelay, ModelParameter::TorqueControlBandwidth],
        }
    }

    /// Tells whether it shows in speed control alone: the controller rests in torque control, where the engine's speed
    /// control acts in its place and hides J_e.
    pub fn needs_speed_control(self) -> bool {
        matches!(self, Goal::SpeedController | Goal::FeedForward | Goal::EngineInertia)
    }
}

impl fmt::Display for Goal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Goal::Stiffness => "K",
            Goal::Damping => "B",
            Goal::DynoInertia => "J_d",
            Goal::EngineInertia => "J_e",
            Goal::SpeedController => "PI",
            Goal::FeedForward => "FF",
            Goal::TorqueControl => "TC",
        })
    }
}

impl FromStr for Goal {
    type Err = UnknownGoal;

    fn from_str(text: &str) -> Result<Self, UnknownGoal> {
        let named = |goal: &Goal| goal.to_string().eq_ignore_ascii_case(text.trim());
        Goal::ALL.into_iter().find(named).ok_or_else(|| UnknownGoal { text: text.trim().to_owned() })
    }
}

/// At what speed and torque a bench is excited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatingPoint {
    /// ω, rad/s.
    pub speed_rad_s: f64,
    /// T, Nm.
    pub torque_nm: f64,
}

impl PeakLimits {
    /// Peaks that the limits of a bench leave for an excitation at an operating point. Of T_shaft it is half, since
    /// firing pulses take the rest, of T_d nearly all, since the torque control cuts at its limit.
    pub fn left_by(limits: &Limits, at: OperatingPoint) -> Self {
        let left = |limit: f64| limit - at.torque_nm.abs();
        PeakLimits {
            shaft_torque_nm: limits.shaft_torque_nm.map(|limit| SHAFT_SHARE * left(limit)),
            air_gap_torque_nm: limits.torque_nm.map(|limit| TORQUE_SHARE * left(limit)),
            ..PeakLimits::default()
        }
    }
}

impl Measurements {
    /// Measurements on a bench like a virtual one, with the noise of its sensors and the engine's own variation at an
    /// operating point. From firing to firing the engine's torque varies by a part, held until the next.
    pub fn of_bench(bench: &BenchParameters, at: OperatingPoint) -> Self {
        let (sensors, clocks, engine) = (&bench.sensors, &bench.clocks, &bench.engine);
        let noise = |deviation: f64, resolution: f64, updates: usize| {
            let standard_deviation = deviation.hypot(resolution / 12f64.sqrt()).max(LEAST_NOISE);
            Some(SampleNoise { standard_deviation, sample_time_s: updates as f64 * UPDATE_S })
        };
        let speed = |updates| noise(sensors.speed_noise_rad_s, sensors.speed_resolution_rad_s, updates);
        let flange = noise(sensors.flange.noise_nm, sensors.flange.resolution_nm, clocks.torque_decimation);
        let firings_per_rad = engine.cylinder_factors.len() as f64 / engine.cycle_rad();
        let varies_nm = engine.cycle_variation * at.torque_nm;
        let density = varies_nm * varies_nm / (at.speed_rad_s.abs() * firings_per_rad).max(1.0);
        Measurements {
            dyno_speed: speed(1),
            controller_reading: None,
            engine_speed: speed(clocks.engine_speed_decimation),
            torque_demand: noise(0.0, sensors.demand_resolution_nm, 1),
            air_gap_torque: noise(sensors.calc_noise_nm, 0.0, clocks.torque_decimation),
            shaft_torque: flange.filter(|_| bench.variant == BenchVariant::TorqueFlange),
            engine_torque_density: Some(density.max(LEAST_NOISE)),
        }
    }
}

impl DesignTask {
    /// The task of learning some goals in an experiment of `duration_s`. What is not asked for is unknown too as far as
    /// it shows in what is measured: the rest of the shaft, the skew of N_e, the encoder's gate (to a tenth), delay and
    /// bandwidth of the torque control, in speed control the controller and its feed-forward. J_d and J_e are known
    /// unless asked for. T_e may do anything unless J_e is asked for; the torque control alone is learnt from T_d* and
    /// T_d.
    ///
    /// # Errors
    /// [`DesignError::Task`] for goals that do not show in what is excited, or no goal.
    ///
    /// # Example
    /// ```
    /// use design::excitation_design::{DesignTask, ExcitedDemand, Goal, Measurements, OperatingPoint, PeakLimits};
    /// use bench_model::model::BenchModel;
    /// use rig::bench_parameters::BenchParameters;
    /// let bench = BenchParameters::default();
    /// let at = OperatingPoint { speed_rad_s: 150.0, torque_nm: 60.0 };
    /// let measured = Measurements::of_bench(&bench, at);
    /// let limits = PeakLimits { shaft_torque_nm: Some(30.0), ..PeakLimits::default() };
    /// let goals = [Goal::Stiffness, "B".parse()?];
    /// let model = BenchModel::of(&bench);
    /// let task = DesignTask::of_goals(&goals, model, ExcitedDemand::Torque, at, measured, limits, 20.0)?;
    /// assert_eq!(task.of_interest.len(), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_goals(
        goals: &[Goal],
        model: BenchModel,
        excited: ExcitedDemand,
        at: OperatingPoint,
        measured: Measurements,
        limits: PeakLimits,
        duration_s: f64,
    ) -> Result<Self, DesignError> {
        if excited == ExcitedDemand::Torque && goals.iter().any(|goal| goal.needs_speed_control()) {
            let requirement = "PI, FF and J_e show in speed control, where N_d* is excited";
            return Err(DesignError::Task { requirement });
        }
        let of_interest: Vec<ModelParameter> = goals.iter().flat_map(|goal| goal.parameters()).copied().collect();
        let measurements = used(goals, excited, measured);
        let nuisances = nuisances(&model, excited, &measurements)
            .into_iter()
            .filter(|n| !of_interest.iter().any(|p| n.unknown == Unknown::Model(*p)));
        let is_slow = goals.iter().any(|goal| matches!(goal, Goal::SpeedController | Goal::FeedForward));
        let lowest_hz = if is_slow { SLOW_HZ } else { 1.0 };
        let (hold_s, mean_demand, highest_hz) = match excited {
            ExcitedDemand::Torque => (DEMAND_HOLD_S, at.torque_nm, 45.0),
            ExcitedDemand::Speed => (UPDATE_S, at.speed_rad_s, HIGHEST_SPEED_HZ),
        };
        Ok(DesignTask {
            nuisances: nuisances.collect(),
            models: vec![model],
            robustness: Robustness::Mean,
            excited,
            mean_demand,
            of_interest,
            criterion: Criterion::Determinant,
            measurements,
            limits,
            band_hz: (lowest_hz, highest_hz),
            estimated_hz: (lowest_hz, if measurements.dyno_speed.is_some() { SHAFT_HIGHEST_HZ } else { 500.0 }),
            excluded_hz: beside_rotation(at.speed_rad_s),
            resolution_hz: 8.0,
            hold_s,
            period_s: PERIOD_S.min(duration_s),
            duration_s,
        })
    }
}

/// Part of the measurements that the estimators of the goals use.
fn used(goals: &[Goal], excited: ExcitedDemand, all: Measurements) -> Measurements {
    if goals == [Goal::TorqueControl] && excited == ExcitedDemand::Torque {
        return Measurements { dyno_speed: None, engine_speed: None, shaft_torque: None, ..all };
    }
    let engine_torque_density = all.engine_torque_density.filter(|_| goals.contains(&Goal::EngineInertia));
    Measurements { engine_torque_density, ..all }
}

fn nuisances(model: &BenchModel, excited: ExcitedDemand, measured: &Measurements) -> Vec<Nuisance> {
    let nothing = |unknown| Nuisance { unknown, standard_uncertainty: None };
    let of_model = |p| nothing(Unknown::Model(p));
    let mut all = vec![of_model(ModelParameter::TorqueControlDelay), of_model(ModelParameter::TorqueControlBandwidth)];
    if measured.dyno_speed.is_some() {
        all.extend([of_model(ModelParameter::Stiffness), of_model(ModelParameter::Damping)]);
        all.push(nothing(Unknown::EngineSpeedSkew));
        let standard_uncertainty = Some(0.1 * model.encoder_gate_s.max(TIME_SCALE_S));
        all.push(Nuisance { unknown: Unknown::EncoderGate, standard_uncertainty });
    }
    if excited == ExcitedDemand::Speed {
        all.extend(
            [ModelParameter::Proportional, ModelParameter::Integral, ModelParameter::ControllerDelay].map(of_model),
        );
        if model.feed_forward.is_some() {
            let feed_forward = [ModelParameter::SpeedFeedForward, ModelParameter::AccelerationFeedForward];
            all.extend(feed_forward.map(of_model));
        }
    }
    all
}
