//! A virtual bench that is like a stated one: what its bench file says, what a model says, and what had to be assumed.

use bench_model::model::BenchModel;
use numerics::null::nan_if_null;
use rig::bench_parameters::{BenchParameters, DualMassFlywheel, EngineParameters, MechanicsParameters};
use rig::engine_pulses::{EnginePulses, KnownPulses};
use rig::experiment::ExperimentPlan;
use rig::facts::BenchVariant;
use rig::role::Role;
use rig::{BenchFile, ControlMode};
use serde::{Deserialize, Serialize};

use super::VirtualBenchError;

/// Damping ratio of the resonance where no damping is stated: that of steel shafts with rubber couplings.
const ASSUMED_DAMPING_RATIO: f64 = 0.1;

/// Something about a bench that nobody stated, so that a default takes the place of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Assumption {
    /// K and B of the shaft.
    Shaft {
        /// K, Nm/rad.
        #[serde(deserialize_with = "nan_if_null")]
        stiffness_nm_per_rad: f64,
        /// B, Nm s/rad.
        #[serde(deserialize_with = "nan_if_null")]
        damping_nm_s_per_rad: f64,
    },
    /// B of the shaft, from a damping ratio.
    Damping {
        /// ζ, 1.
        #[serde(deserialize_with = "nan_if_null")]
        ratio: f64,
        /// B, Nm s/rad.
        #[serde(deserialize_with = "nan_if_null")]
        damping_nm_s_per_rad: f64,
    },
    /// Speed controller and feed-forward.
    SpeedController {
        /// K_p, Nm s/rad.
        #[serde(deserialize_with = "nan_if_null")]
        proportional_nm_s_per_rad: f64,
        /// K_i, Nm/rad.
        #[serde(deserialize_with = "nan_if_null")]
        integral_nm_per_rad: f64,
    },
    /// Feed-forward of the speed controller.
    FeedForward,
    /// Delay and lag of the torque control.
    TorqueControl {
        /// d, s.
        #[serde(deserialize_with = "nan_if_null")]
        delay_s: f64,
        /// a, rad/s.
        #[serde(deserialize_with = "nan_if_null")]
        bandwidth_rad_s: f64,
    },
    /// The drive's limit.
    TorqueLimit {
        /// Nm.
        #[serde(deserialize_with = "nan_if_null")]
        torque_nm: f64,
    },
    /// The dual-mass flywheel of a bench with a torque flange.
    Flywheel,
    /// Motored torque and speed control of the engine.
    Engine,
    /// Firing pulses of the engine.
    Pulses,
}

/// A virtual bench like a stated one.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedBench {
    /// Its parameters.
    pub parameters: BenchParameters,
    /// Assumptions that were needed.
    pub assumptions: Vec<Assumption>,
    /// Knowledge of the engine's firing pulses.
    pub pulses: KnownPulses,
}

impl StatedBench {
    /// The virtual bench of a bench file: the default one, with inertias, cylinders, strokes, variant, torque limit,
    /// encoder gate and shaft as the file states them, with every field of its table `[virtual_bench]`, and with
    /// inertias, shaft, speed controller, feed-forward and torque control of `model`, if there is one, in place of all
    /// that.
    ///
    /// # Errors
    /// [`VirtualBenchError`] where the parameters are impossible.
    pub fn of(file: &BenchFile, model: Option<&BenchModel>) -> Result<Self, VirtualBenchError> {
        let mut parameters = stated_in(file);
        if !file.virtual_bench.is_empty() {
            parameters = overlaid(&parameters, &file.virtual_bench)?;
        }
        if let Some(model) = model {
            take_over(&mut parameters, model);
        }
        parameters.check()?;
        let assumptions = assumptions(file, model, &parameters);
        Ok(Self { parameters, assumptions, pulses: pulses(file) })
    }

    /// The same with an engine whose pulses recordings show, unless the bench file states them. Pulses of an engine
    /// with other cylinders or strokes are not used.
    #[must_use]
    pub fn with_pulses(mut self, shown: Option<&EnginePulses>) -> Self {
        let is_of_engine =
            |own: &EnginePulses, shown: &EnginePulses| (own.cylinders, own.strokes) == (shown.cylinders, shown.strokes);
        if let (KnownPulses::Assumed(own), Some(shown)) = (&self.pulses, shown)
            && is_of_engine(own, shown)
        {
            self.parameters.engine = shown.nominal(&self.parameters.engine);
            self.pulses = KnownPulses::Estimated(shown.clone());
            self.assumptions.retain(|assumption| *assumption != Assumption::Pulses);
        }
        self
    }

    /// The assumptions that an experiment rests on: without a shaft, or in torque control, not all matter.
    pub fn assumed_for(&self, plan: &ExperimentPlan) -> Vec<Assumption> {
        let matters = |assumption: &&Assumption| match assumption {
            Assumption::Shaft { .. }
            | Assumption::Damping { .. }
            | Assumption::Flywheel
            | Assumption::Engine
            | Assumption::Pulses => plan.has_shaft,
            Assumption::SpeedController { .. } | Assumption::FeedForward => plan.label.mode == ControlMode::Nt,
            Assumption::TorqueControl { .. } | Assumption::TorqueLimit { .. } => true,
        };
        self.assumptions.iter().filter(matters).copied().collect()
    }

    /// The linear model of this bench. Speed controller and gate of the encoder are those of the model that it was made
    /// from, where that has them.
    pub fn linear_model(&self, from: Option<&BenchModel>) -> BenchModel {
        let model = BenchModel::of(&self.parameters);
        BenchModel {
            speed_controller: from.and_then(|from| from.speed_controller).or(model.speed_controller),
            encoder_gate_s: from.map_or(model.encoder_gate_s, |from| from.encoder_gate_s),
            ..model
        }
    }

    /// Tells whether the shaft's stiffness is known, and not assumed.
    pub fn knows_shaft(&self) -> bool {
        !self.assumptions.iter().any(|assumption| matches!(assumption, Assumption::Shaft { .. }))
    }
}

fn stated_in(file: &BenchFile) -> BenchParameters {
    let mut parameters = match file.variant {
        BenchVariant::LoadCell => BenchParameters::default(),
        BenchVariant::TorqueFlange => BenchParameters::torque_flange(),
    };
    let (dyno, engine) = (file.dynamometer_inertia_kg_m2, file.engine_inertia_kg_m2);
    let mechanics = &mut parameters.mechanics;
    take_inertias(mechanics, dyno, engine);
    if let Some(stiffness) = file.shaft.stiffness_nm_per_rad((dyno, engine)) {
        mechanics.shaft_stiffness_nm_per_rad = stiffness;
        let natural_rad_s = (stiffness * (1.0 / dyno + 1.0 / engine)).sqrt();
        mechanics.shaft_damping_nm_s_per_rad = 2.0 * ASSUMED_DAMPING_RATIO * stiffness / natural_rad_s;
    }
    if let Some(damping) = file.shaft.damping_nm_s_per_rad {
        mechanics.shaft_damping_nm_s_per_rad = damping;
    }
    parameters.engine = engine_of(file, parameters.engine);
    if let Some(limit) = file.limits.torque_nm {
        parameters.drive.torque_limit_nm = limit;
    }
    let gate_s = file.channels.get(&Role::DynoSpeed).and_then(|mapping| mapping.gate_s);
    if let Some(gate_s) = gate_s.filter(|gate_s| *gate_s > 0.0) {
        parameters.sensors.gate_s = gate_s;
    }
    parameters
}

/// Takes the inertias of dynamometer and engine. The flywheel's secondary side keeps its share of the engine's.
fn take_inertias(mechanics: &mut MechanicsParameters, dyno_kg_m2: f64, engine_kg_m2: f64) {
    let share = engine_kg_m2 / mechanics.engine_inertia_kg_m2;
    mechanics.flywheel = mechanics.flywheel.map(|flywheel| DualMassFlywheel {
        secondary_inertia_kg_m2: flywheel.secondary_inertia_kg_m2 * share,
        ..flywheel
    });
    (mechanics.dyno_inertia_kg_m2, mechanics.engine_inertia_kg_m2) = (dyno_kg_m2, engine_kg_m2);
}

/// An engine with the stated cylinders, unequal as the default one's are.
fn engine_of(file: &BenchFile, engine: EngineParameters) -> EngineParameters {
    let factors = engine.cylinder_factors.iter().cycle().take(file.cylinders as usize);
    EngineParameters { cylinder_factors: factors.copied().collect(), strokes: file.strokes, ..engine }
}

fn overlaid(parameters: &BenchParameters, table: &toml::Table) -> Result<BenchParameters, VirtualBenchError> {
    let unfit = |reason: &dyn std::fmt::Display| VirtualBenchError::Unfit { reason: reason.to_string() };
    let mut whole = toml::Table::try_from(parameters).map_err(|error| unfit(&error))?;
    overlay(&mut whole, table);
    BenchParameters::deserialize(whole).map_err(|error| unfit(&error.message()))
}

fn overlay(whole: &mut toml::Table, table: &toml::Table) {
    for (key, value) in table {
        match (whole.get_mut(key), value) {
            (Some(toml::Value::Table(below)), toml::Value::Table(value)) => overlay(below, value),
            _ => {
                whole.insert(key.clone(), value.clone());
            }
        }
    }
}

fn take_over(parameters: &mut BenchParameters, model: &BenchModel) {
    // Stiffness and damping scale with the inertias that they were estimated with.
    let (dyno_kg_m2, engine_kg_m2) = (model.mechanics.dyno_inertia_kg_m2, model.mechanics.engine_inertia_kg_m2);
    take_inertias(&mut parameters.mechanics, dyno_kg_m2, engine_kg_m2);
    parameters.mechanics.shaft_stiffness_nm_per_rad = model.mechanics.stiffness_nm_per_rad;
    parameters.mechanics.shaft_damping_nm_s_per_rad = model.mechanics.damping_nm_s_per_rad;
    if let Some(pi) = model.speed_controller {
        parameters.controller.proportional_nm_s_per_rad = pi.proportional_nm_s_per_rad;
        parameters.controller.integral_nm_per_rad = pi.integral_nm_per_rad;
        parameters.controller.delay_s = pi.delay_s;
    }
    if let Some(feed_forward) = model.feed_forward {
        parameters.controller.speed_feed_forward_nm_s_per_rad = feed_forward.speed_nm_s_per_rad;
        parameters.controller.acceleration_feed_forward_nm_s2_per_rad = feed_forward.acceleration_nm_s2_per_rad;
    }
    if let Some(control) = model.torque_control {
        parameters.drive.delay_s = control.delay_s;
        parameters.drive.machine = None;
        if let Some(bandwidth) = control.bandwidth_rad_s {
            parameters.drive.bandwidth_rad_s = bandwidth;
        }
    }
}

fn assumptions(file: &BenchFile, model: Option<&BenchModel>, parameters: &BenchParameters) -> Vec<Assumption> {
    let stated = |path: &[&str]| has(&file.virtual_bench, path);
    let (mechanics, controller) = (&parameters.mechanics, &parameters.controller);
    let (shaft, damping) = (file.shaft, mechanics.shaft_damping_nm_s_per_rad);
    let knows_stiffness = shaft.stiffness_nm_per_rad.or(shaft.resonance_hz).is_some()
        || stated(&["mechanics", "shaft_stiffness_nm_per_rad"])
        || model.is_some();
    let knows_damping =
        shaft.damping_nm_s_per_rad.is_some() || stated(&["mechanics", "shaft_damping_nm_s_per_rad"]) || model.is_some();
    let stiffness = mechanics.shaft_stiffness_nm_per_rad;
    let ratio = BenchModel::of(parameters).mechanics.resonance().damping_ratio;
    let lacks = |part: &str, is_modelled: bool| !is_modelled && !stated(&[part]);
    [
        (!knows_stiffness)
            .then_some(Assumption::Shaft { stiffness_nm_per_rad: stiffness, damping_nm_s_per_rad: damping }),
        (knows_stiffness && !knows_damping).then_some(Assumption::Damping { ratio, damping_nm_s_per_rad: damping }),
        lacks("controller", model.is_some_and(|m| m.speed_controller.is_some())).then_some(
            Assumption::SpeedController {
                proportional_nm_s_per_rad: controller.proportional_nm_s_per_rad,
                integral_nm_per_rad: controller.integral_nm_per_rad,
            },
        ),
        lacks("controller", model.is_some_and(|m| m.feed_forward.is_some())).then_some(Assumption::FeedForward),
        lacks("drive", model.is_some_and(|m| m.torque_control.is_some())).then_some(Assumption::TorqueControl {
            delay_s: parameters.drive.delay_s,
            bandwidth_rad_s: parameters.drive.bandwidth_rad_s,
        }),
        (file.limits.torque_nm.is_none() && !stated(&["drive", "torque_limit_nm"]))
            .then_some(Assumption::TorqueLimit { torque_nm: parameters.drive.torque_limit_nm }),
        (mechanics.flywheel.is_some() && !stated(&["mechanics", "flywheel"])).then_some(Assumption::Flywheel),
        (!stated(&["engine"])).then_some(Assumption::Engine),
        (!states_pulses(file)).then_some(Assumption::Pulses),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Knowledge of the pulses that a bench file gives.
fn pulses(file: &BenchFile) -> KnownPulses {
    match states_pulses(file) {
        true => KnownPulses::Stated,
        false => KnownPulses::Assumed(EnginePulses::prior(file.engine(), file.engine_inertia_kg_m2)),
    }
}

/// Tells whether a bench file states the pulses of its engine, by any of the fields that make them.
fn states_pulses(file: &BenchFile) -> bool {
    let fields = ["firing_harmonics", "cylinder_factors", "cycle_harmonics", "slider_crank"];
    fields.iter().any(|field| has(&file.virtual_bench, &["engine", field]))
}

/// Tells whether a table states something at a path.
fn has(table: &toml::Table, path: &[&str]) -> bool {
    match path {
        [] => true,
        [key, rest @ ..] => match table.get(*key) {
            Some(toml::Value::Table(below)) => has(below, rest),
            Some(_) => rest.is_empty(),
            None => false,
        },
    }
}
