//! Check that a document describes a possible bench.
//!
//! A document may be edited by hand, or come from elsewhere. The bounds are far beyond every bench; they keep what is
//! computed from a model within the numbers and the memory of a computer. `docs/src/bench-model-format.md` states them.

use rig::dyno_friction::EstimatedFriction;
use rig::engine_pulses::EnginePulses;

use super::error::DocumentError;
use super::{BenchModelDocument, DescribedParameter, Range};
use crate::disturbances::Disturbances;
use crate::drive_ripple::{RecordedTorque, RippleLine};
use crate::model::{BenchModel, Bound, ModelParameter, ModelUncertainty, short};

/// Times of controller and sensors.
const TIME: Bound = Bound::within(1.0, "s");
const NOT_NEGATIVE_TIME: Bound = Bound::new(0.0, 1.0, "s");
const SKEW: Bound = Bound::within(1000.0, "s");
/// A controller that is calculated more often than 100 000 times a second makes every simulation last minutes.
const SAMPLE_TIME: Bound = Bound::new(1e-5, 1.0, "s");
/// Samples of the controller that a delay or an encoder's gate lasts: each is a state of the closed loop.
const MOST_SAMPLES: f64 = 250.0;
/// Where the model has no controller, s.
const USUAL_SAMPLE_TIME_S: f64 = 1e-3;
/// Ripple of a drive, and how many lines of it a model may have.
const RIPPLE: Bound = Bound::new(1e-3, 1e5, "Hz");
const MOST_LINES: usize = 64;
/// Errors of an encoder and ripple of a drive, as parts and by themselves.
const PART: Bound = Bound::new(0.0, 1.0, "");
const SPEED_NOISE: Bound = Bound::new(0.0, 1e5, "rad/s");
const RIPPLE_TORQUE: Bound = Bound::new(0.0, 1e8, "Nm");
/// The frequency of the shaft between both masses.
const RESONANCE: Bound = Bound::new(1e-3, 1e5, "Hz");
const TORQUE: Bound = Bound::new(1e-3, 1e8, "Nm");
const ANY_SLOPE: Bound = Bound::within(1e8, "Nm s/rad");
const ANY_TORQUE: Bound = Bound::within(1e8, "Nm");
const SPEED: Bound = Bound::new(1e-3, 1e5, "rad/s");
const ANY_SPEED: Bound = Bound::within(1e5, "rad/s");
const FREQUENCY: Bound = Bound::new(0.0, 1e6, "Hz");
const INERTIA: Bound = Bound::new(0.0, 1e6, "kg m²");
const PERCENT: Bound = Bound::new(0.0, 1000.0, "%");
/// None where nothing fires, as in an electric machine.
const CYLINDERS: Bound = Bound::new(0.0, 64.0, "");
/// Degrees of freedom that an estimate can rest on; none is infinite.
const DEGREES_OF_FREEDOM: Bound = Bound::new(0.1, f64::MAX, "");
/// Eigenvalues of a correlation matrix below this are no rounding.
const LEAST_EIGENVALUE: f64 = -1e-6;
/// By so large a part of itself rounding may move a product.
const ROUNDING: f64 = 1e-6;

/// Refuses numbers that no bench can have, and contradictions.
pub(super) fn all(document: &BenchModelDocument) -> Result<(), DocumentError> {
    let BenchModelDocument { model, parameters: listed, uncertainty, .. } = document;
    facts(document)?;
    parameters(model)?;
    constants(model)?;
    samples(model)?;
    resonance(model)?;
    described(model, listed)?;
    uncertain(model, uncertainty)?;
    pulses(document.engine_pulses.as_ref())?;
    friction(document.dyno_friction.as_ref())?;
    recorded_torque(document.recorded_torque.as_ref())?;
    disturbances(document.disturbances.as_ref())?;
    ranges(document)
}

/// Numbers with their fields, of which the first that is out of its bound is refused.
fn bounded<'a>(numbers: impl IntoIterator<Item = (&'a str, Option<f64>, Bound)>) -> Result<(), DocumentError> {
    numbers.into_iter().try_for_each(|(field, value, bound)| match value.filter(|value| !bound.allows(*value)) {
        Some(value) => Err(DocumentError::Impossible { field: field.to_owned(), value, bound }),
        None => Ok(()),
    })
}

/// Checks the facts that the bench file stated.
fn facts(document: &BenchModelDocument) -> Result<(), DocumentError> {
    let bench = &document.bench;
    if ![2, 4].contains(&bench.strokes) {
        let problem = format!("`bench.strokes` is {}, and an engine has 2 or 4", bench.strokes);
        return Err(DocumentError::Together { problem });
    }
    let skews = document.skews.as_ref();
    bounded([
        ("bench.cylinders", Some(f64::from(bench.cylinders)), CYLINDERS),
        ("bench.dynamometer_inertia_kg_m2", Some(bench.dynamometer_inertia_kg_m2), INERTIA),
        ("bench.dynamometer_inertia_uncertainty_percent", bench.dynamometer_inertia_uncertainty_percent, PERCENT),
        ("bench.engine_inertia_kg_m2", Some(bench.engine_inertia_kg_m2), INERTIA),
        ("bench.engine_inertia_uncertainty_percent", bench.engine_inertia_uncertainty_percent, PERCENT),
        ("bench.torque_limit_nm", bench.torque_limit_nm, TORQUE),
        ("bench.shaft_torque_limit_nm", bench.shaft_torque_limit_nm, TORQUE),
        ("bench.speed_limit_rad_s", bench.speed_limit_rad_s, SPEED),
        ("skews.engine_speed_s", skews.map(|skews| skews.engine_speed_s), SKEW),
        ("skews.torque_s", skews.map(|skews| skews.torque_s), SKEW),
    ])
}

/// Refuses pulses that no engine can have.
fn pulses(pulses: Option<&EnginePulses>) -> Result<(), DocumentError> {
    pulses.map_or(Ok(()), EnginePulses::check).map_err(|impossible| DocumentError::Pulses { impossible })
}

/// Refuses friction that no dynamometer can have.
fn friction(friction: Option<&EstimatedFriction>) -> Result<(), DocumentError> {
    let Some(friction) = friction else { return Ok(()) };
    let EstimatedFriction { coulomb_nm, viscous_nm_s_per_rad, covariance, speeds_rad_s, .. } = friction;
    bounded([
        ("dyno_friction.coulomb_nm", Some(*coulomb_nm), ANY_TORQUE),
        ("dyno_friction.viscous_nm_s_per_rad", Some(*viscous_nm_s_per_rad), ANY_SLOPE),
        ("dyno_friction.speeds_rad_s", Some(speeds_rad_s.0), ANY_SPEED),
        ("dyno_friction.speeds_rad_s", Some(speeds_rad_s.1), SPEED),
    ])?;
    let [[coulomb, both], [other, viscous]] = *covariance;
    let is_covariance =
        coulomb >= 0.0 && viscous >= 0.0 && both == other && both * both <= coulomb * viscous * (1.0 + ROUNDING);
    let problem = if !(is_covariance && (coulomb + viscous).is_finite()) {
        "`dyno_friction.covariance` is no covariance of two numbers, [[variance, both], [both, variance]]"
    } else if !(0.0..=speeds_rad_s.1).contains(&speeds_rad_s.0) {
        "`dyno_friction.speeds_rad_s` is not [lowest, highest] of speeds above zero"
    } else if friction.drives() {
        "`dyno_friction` drives the dynamometer: at its speeds it is below zero by more than its interval"
    } else {
        return Ok(());
    };
    Err(DocumentError::Together { problem: problem.to_owned() })
}

/// Refuses delays and lines of ripple that no recording shows.
fn recorded_torque(torque: Option<&RecordedTorque>) -> Result<(), DocumentError> {
    let Some(RecordedTorque { delay_s, ripple_hz }) = torque else { return Ok(()) };
    if ripple_hz.len() > MOST_LINES {
        let count = ripple_hz.len();
        let problem = format!("`recorded_torque.ripple_hz` has {count} lines, and a drive has {MOST_LINES} at most");
        return Err(DocumentError::Together { problem });
    }
    let lines = ripple_hz.iter().map(|hz| ("recorded_torque.ripple_hz", Some(*hz), RIPPLE));
    bounded(lines.chain([("recorded_torque.delay_s", Some(*delay_s), TIME)]))
}

/// Refuses errors of encoders and ripple that no bench has.
fn disturbances(disturbances: Option<&Disturbances>) -> Result<(), DocumentError> {
    let Some(Disturbances { speed_noise_rad_s, once_a_turn, ripple }) = disturbances else { return Ok(()) };
    let line = |of: fn(&RippleLine) -> f64| ripple.as_ref().map(of);
    bounded([
        ("disturbances.speed_noise_rad_s", Some(*speed_noise_rad_s), SPEED_NOISE),
        ("disturbances.once_a_turn", Some(*once_a_turn), PART),
        ("disturbances.ripple.frequency_hz", line(|line| line.frequency_hz), RIPPLE),
        ("disturbances.ripple.additive_nm", line(|line| line.additive_nm[0].hypot(line.additive_nm[1])), RIPPLE_TORQUE),
        ("disturbances.ripple.relative", line(|line| line.relative[0].hypot(line.relative[1])), PART),
    ])
}

fn parameters(model: &BenchModel) -> Result<(), DocumentError> {
    let fields = ModelParameter::ALL.map(|one| (format!("model.{}", one.field()), model.value(one), one.bound()));
    bounded(fields.iter().map(|(field, value, bound)| (field.as_str(), *value, *bound)))
}

/// The numbers that are no estimates.
fn constants(model: &BenchModel) -> Result<(), DocumentError> {
    let pi = model.speed_controller;
    bounded([
        ("model.encoder_gate_s", Some(model.encoder_gate_s), NOT_NEGATIVE_TIME),
        ("model.torque_limit_nm", model.torque_limit_nm, TORQUE),
        ("model.speed_controller.sample_time_s", pi.map(|pi| pi.sample_time_s), SAMPLE_TIME),
        ("model.speed_controller.demand_delay_s", pi.map(|pi| pi.demand_delay_s), TIME),
        ("model.feed_forward.delay_s", model.feed_forward.map(|feed| feed.delay_s), TIME),
    ])
}

/// Refuses delays of very many samples.
fn samples(model: &BenchModel) -> Result<(), DocumentError> {
    let pi = model.speed_controller;
    let sample_time_s = pi.map_or(USUAL_SAMPLE_TIME_S, |pi| pi.sample_time_s);
    let delays = [
        ("model.encoder_gate_s", model.encoder_gate_s),
        ("model.speed_controller.delay_s", pi.map_or(0.0, |pi| pi.delay_s)),
        ("model.speed_controller.demand_delay_s", pi.map_or(0.0, |pi| pi.demand_delay_s)),
        ("model.feed_forward.delay_s", model.feed_forward.map_or(0.0, |feed| feed.delay_s)),
        ("model.torque_control.delay_s", model.torque_control.map_or(0.0, |control| control.delay_s)),
    ];
    let is_long = |(_, delay_s): &&(&str, f64)| delay_s.abs() > MOST_SAMPLES * sample_time_s;
    match delays.iter().find(is_long) {
        None => Ok(()),
        Some((field, delay_s)) => Err(DocumentError::Together {
            problem: format!(
                "`{field}` is {} s, and lasts at most {MOST_SAMPLES} samples of `model.speed_controller.sample_time_s`, {} s",
                short(*delay_s),
                short(sample_time_s)
            ),
        }),
    }
}

fn resonance(model: &BenchModel) -> Result<(), DocumentError> {
    let found_hz = model.mechanics.resonance().natural_frequency_hz;
    if RESONANCE.allows(found_hz) {
        return Ok(());
    }
    let problem = format!(
        "stiffness and inertias under `model.mechanics` give a resonance of {} Hz, and a shaft has {RESONANCE}",
        short(found_hz)
    );
    Err(DocumentError::Together { problem })
}

/// Checks that the numbers for people and those for programs are the same.
fn described(model: &BenchModel, listed: &[DescribedParameter]) -> Result<(), DocumentError> {
    for one in listed {
        let modelled = model.value(one.parameter);
        if modelled != Some(one.value) {
            let (parameter, listed) = (one.parameter, one.value);
            return Err(DocumentError::Contradiction { parameter, listed, modelled });
        }
        let (low, high) = one.interval_95.unwrap_or((one.value, one.value));
        if low > high || one.standard_error.is_some_and(|error| error < 0.0) {
            let problem = format!(
                "`parameters` has {} with a negative standard error, or with an interval whose low end is the higher one",
                one.parameter.quantity().name()
            );
            return Err(DocumentError::Together { problem });
        }
    }
    let times = |parameter: ModelParameter| listed.iter().filter(|one| one.parameter == parameter).count();
    let is_wrong = |one: &ModelParameter| times(*one) != usize::from(model.value(*one).is_some());
    ModelParameter::ALL.into_iter().find(is_wrong).map_or(Ok(()), |parameter| {
        let problem =
            format!("`parameters` has {} {} times, and each once", parameter.quantity().name(), times(parameter));
        Err(DocumentError::Together { problem })
    })
}

fn uncertain(model: &BenchModel, uncertainty: &ModelUncertainty) -> Result<(), DocumentError> {
    let mut seen = Vec::new();
    for parameter in uncertainty.parameters() {
        let is_twice = seen.contains(&parameter);
        if is_twice || model.value(parameter).is_none() {
            return Err(DocumentError::Uncertainty { parameter, is_twice });
        }
        seen.push(parameter);
        let Some((error, degrees)) = uncertainty.standard_error(parameter) else { continue };
        let (name, most) = (parameter.quantity().name(), parameter.bound().largest());
        if error > most {
            let problem = format!(
                "`uncertainty` has a standard error of {} for {name}, more than its largest value, {}",
                short(error),
                short(most)
            );
            return Err(DocumentError::Together { problem });
        }
        if degrees.is_finite() && !DEGREES_OF_FREEDOM.allows(degrees) {
            let problem = format!(
                "`uncertainty` has {} degrees of freedom for {name}, and an estimate has 0.1 or more, or null",
                short(degrees)
            );
            return Err(DocumentError::Together { problem });
        }
    }
    if let Some((part, least)) = uncertainty.least_eigenvalues().find(|(_, least)| *least < LEAST_EIGENVALUE) {
        let problem = format!(
            "`uncertainty[{part}].covariance` is no covariance: its correlations contradict each other (the least eigenvalue of their matrix is {}, and 0 or above is possible)",
            short(least)
        );
        return Err(DocumentError::Together { problem });
    }
    Ok(())
}

/// Ranges of validity from their low to their high end.
fn ranges(document: &BenchModelDocument) -> Result<(), DocumentError> {
    let validity = &document.validity;
    let ranges: [(&str, Option<Range>, Bound); 3] = [
        ("validity.dyno_speed_rad_s", validity.dyno_speed_rad_s, ANY_SPEED),
        ("validity.air_gap_torque_nm", validity.air_gap_torque_nm, ANY_TORQUE),
        ("validity.frequency_hz", validity.frequency_hz, FREQUENCY),
    ];
    let ends = ranges.iter().flat_map(|(field, range, bound)| {
        let (low, high) = range.unzip();
        [(*field, low, *bound), (*field, high, *bound)]
    });
    bounded(ends)?;
    let reversed = ranges.iter().find(|(_, range, _)| range.is_some_and(|(low, high)| low > high));
    reversed.map_or(Ok(()), |(field, ..)| {
        Err(DocumentError::Together { problem: format!("the low end of `{field}` is above its high end") })
    })
}
