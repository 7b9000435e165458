//! From the parts of a study to one model and its uncertainty.

use bench_model::model::{
    AssembledModel, BenchModel, FeedForwardGains, Mechanics, ModelParameter, ModelUncertainty, PartCovariance,
    PiController, TorqueControlModel,
};
use rig::facts::BenchFacts;
use rig::results::{Estimate, FeedForward, Quantity, Shaft, SpeedController, TorqueControl};

/// Parts of a study that make up a model. Only the shaft is indispensable.
#[derive(Debug, Clone, Copy)]
pub struct StudyParts<'a> {
    /// Inertias and torque limit.
    pub facts: &'a BenchFacts,
    /// K and B.
    pub shaft: &'a Shaft,
    /// K_p, K_i, τ.
    pub speed_controller: Option<&'a SpeedController>,
    /// k, k_a.
    pub feed_forward: Option<&'a FeedForward>,
    /// τ and a of delay and lag, without the skew of T_d,calc.
    pub torque_control: Option<&'a TorqueControl>,
    /// Time over which an encoder averages the speed, s.
    pub encoder_gate_s: f64,
}

const SHAFT: &[ModelParameter] = &[ModelParameter::Stiffness, ModelParameter::Damping];
/// Where J_d is known with an uncertainty and the shaft torque is computed with it.
const SHAFT_AND_INERTIA: &[ModelParameter] =
    &[ModelParameter::Stiffness, ModelParameter::Damping, ModelParameter::DynoInertia];
const CONTROLLER: &[ModelParameter] =
    &[ModelParameter::Proportional, ModelParameter::Integral, ModelParameter::ControllerDelay];
const FEED_FORWARD: &[ModelParameter] = &[ModelParameter::SpeedFeedForward, ModelParameter::AccelerationFeedForward];
const TORQUE_CONTROL: &[ModelParameter] = &[ModelParameter::TorqueControlDelay, ModelParameter::TorqueControlBandwidth];

/// Assembles the model and its uncertainty; `None` where the shaft's estimate lacks K or B. A part whose estimate lacks
/// one of its numbers is left out. The gate is taken as exact, and so is an inertia whose stated uncertainty is zero.
pub fn assemble(parts: &StudyParts<'_>) -> Option<AssembledModel> {
    let (shaft, facts) = (&parts.shaft.estimate, parts.facts);
    let inertia = shaft.parameter(Quantity::DynoInertia);
    let engine_inertia = engine_inertia(parts);
    let mechanics = Mechanics {
        dyno_inertia_kg_m2: inertia.map_or(facts.dynamometer_inertia_kg_m2, |p| p.value),
        engine_inertia_kg_m2: engine_inertia.0,
        stiffness_nm_per_rad: value(shaft, ModelParameter::Stiffness)?,
        damping_nm_s_per_rad: value(shaft, ModelParameter::Damping)?,
    };
    let torque_control = parts.torque_control.map(|part| &part.delay_and_lag);
    let model = BenchModel {
        mechanics,
        speed_controller: parts.speed_controller.and_then(|part| controller(part, parts.feed_forward)),
        feed_forward: parts.feed_forward.and_then(|part| feed_forward(part, parts.speed_controller?.sample_time_s)),
        torque_control: torque_control.and_then(torque_control_model),
        torque_limit_nm: facts.torque_limit_nm,
        encoder_gate_s: parts.encoder_gate_s,
    };
    let blocks: Vec<PartCovariance> = [
        Some((shaft, if inertia.is_some() { SHAFT_AND_INERTIA } else { SHAFT })),
        parts.speed_controller.map(|c| (&c.estimate, CONTROLLER)),
        parts.feed_forward.map(|f| (&f.estimate, FEED_FORWARD)),
        torque_control.map(|t| (t, TORQUE_CONTROL)),
    ]
    .into_iter()
    .flatten()
    .map(|(estimate, parameters)| block(estimate, parameters))
    .chain([alone(ModelParameter::EngineInertia, engine_inertia.1)])
    .chain(inertia.is_none().then(|| {
        let stated = facts.dynamometer_inertia();
        alone(ModelParameter::DynoInertia, stated.standard_uncertainty_kg_m2())
    }))
    .flatten()
    .collect();
    let uncertainty = ModelUncertainty::new(&blocks).ok()?;
    Some(AssembledModel { model, uncertainty, engine_pulses: None, disturbances: None, dyno_friction: None })
}

/// J_e and its standard uncertainty, kg m²: as the bench file states it, with what the recordings show.
fn engine_inertia(parts: &StudyParts<'_>) -> (f64, f64) {
    let stated = parts.facts.engine_inertia();
    let seen = parts.shaft.inertias.as_ref().and_then(|(_, both)| both.parameter(Quantity::EngineInertia));
    seen.map_or((stated.kg_m2, stated.standard_uncertainty_kg_m2()), |seen| {
        stated.with_seen(seen.value, seen.standard_error)
    })
}

/// An inertia that is uncertain by itself; nothing where it is exact.
fn alone(parameter: ModelParameter, uncertainty_kg_m2: f64) -> Option<PartCovariance> {
    (uncertainty_kg_m2 > 0.0).then(|| PartCovariance {
        parameters: vec![parameter],
        covariance: vec![vec![uncertainty_kg_m2.powi(2)]],
        degrees_of_freedom: f64::INFINITY,
    })
}

fn value(estimate: &Estimate, which: ModelParameter) -> Option<f64> {
    Some(estimate.parameter(which.quantity())?.value)
}

/// With the delay of N_d* that the feed-forward's recording shows; without one, as if the delay acted on the speed
/// error.
fn controller(part: &SpeedController, feed_forward: Option<&FeedForward>) -> Option<PiController> {
    let value = |which| value(&part.estimate, which);
    let delay_s = value(ModelParameter::ControllerDelay)?.max(0.0);
    let of_lags = |found: &FeedForward| f64::from(found.lags.speed_error) * part.sample_time_s;
    Some(PiController {
        proportional_nm_s_per_rad: value(ModelParameter::Proportional)?,
        integral_nm_per_rad: value(ModelParameter::Integral)?,
        delay_s,
        demand_delay_s: feed_forward.map_or(delay_s, of_lags),
        sample_time_s: part.sample_time_s,
    })
}

fn feed_forward(part: &FeedForward, sample_time_s: f64) -> Option<FeedForwardGains> {
    Some(FeedForwardGains {
        speed_nm_s_per_rad: value(&part.estimate, ModelParameter::SpeedFeedForward)?,
        acceleration_nm_s2_per_rad: value(&part.estimate, ModelParameter::AccelerationFeedForward)?,
        delay_s: f64::from(part.lags.feed_forward) * sample_time_s,
    })
}

fn torque_control_model(estimate: &Estimate) -> Option<TorqueControlModel> {
    Some(TorqueControlModel {
        delay_s: value(estimate, ModelParameter::TorqueControlDelay)?.max(0.0),
        bandwidth_rad_s: Some(value(estimate, ModelParameter::TorqueControlBandwidth)?),
    })
}

/// The rows and columns of an estimate's covariance that belong to the model.
fn block(estimate: &Estimate, parameters: &[ModelParameter]) -> Option<PartCovariance> {
    let places = parameters.iter().map(|p| estimate.place(p.quantity())).collect::<Option<Vec<usize>>>()?;
    let row = |i: &usize| {
        let row = estimate.covariance.get(*i)?;
        places.iter().map(|j| row.get(*j).copied()).collect::<Option<Vec<f64>>>()
    };
    Some(PartCovariance {
        parameters: parameters.to_vec(),
        covariance: places.iter().map(row).collect::<Option<Vec<_>>>()?,
        degrees_of_freedom: estimate.parameters.get(*places.first()?)?.degrees_of_freedom,
    })
}
