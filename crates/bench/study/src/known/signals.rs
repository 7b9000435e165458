//! Delays of signals, friction, and the engine's torque.

use numerics::order::upper_median;
use rig::ExperimentLabel;
use rig::dyno_friction::EstimatedFriction;
use rig::results::{Outcome, Part, SignalDelay};

use super::grade::{FRICTION_NM, Grade, WIDTHS};
use super::graded::{grade, of_part, source};
use super::result::{Known, Subject, Value};
use super::why::Why;
use crate::{Analyses, Study};

/// Normal quantile of a 95 % interval.
const QUANTILE_95: f64 = 1.96;

/// How late each torque signal is.
pub(super) fn delays(study: &Study) -> Vec<Known> {
    of_part(Part::Timing, &study.timing, |part| part.delays.iter().filter_map(|delay| one(study, delay)).collect())
}

fn one(study: &Study, delay: &SignalDelay) -> Option<Known> {
    let own = delay.against_demand.as_ref()?;
    let agree = delay.routes_agree();
    let by_width = grade(study, own);
    let grade = if agree == Some(false) { by_width.contradicted() } else { by_width };
    let mut why =
        vec![Why::AgainstDemand(source(study, &delay.stretch)), Why::Methods { count: delay.routes.len(), agree }];
    let late = delay.against_speed_bend.clone();
    why.extend(late.map(|late| Why::BesideBend { role: delay.role, late }));
    Some(Known { subject: Subject::SignalDelay(delay.role), ..Known::of(own, grade, why) })
}

/// Friction of the dynamometer.
pub(super) fn friction(study: &Study, analyses: Option<&Analyses>) -> Known {
    let unknown = |why| Known::not_at_all(Subject::Friction, why);
    let without_shaft = study
        .recordings
        .iter()
        .find(|recording| recording.label.as_ref().is_some_and(ExperimentLabel::is_without_shaft));
    match (analyses.map(|found| found.friction.as_ref()), without_shaft) {
        (Some(Ok(found)), _) => {
            let Some(middle) = found.curve.get(found.curve.len() / 2) else { return unknown(Why::SpeedsShowNone) };
            let (torque_nm, half_width_nm) = (middle.torque_nm, middle.half_width_nm);
            let width = half_width_nm / torque_nm.abs().max(FRICTION_NM / WIDTHS.well);
            let value = Value::Friction { torque_nm, half_width_nm, speed_rad_s: middle.speed_rad_s };
            let files = found.run_outs.iter().map(|run_out| run_out.stretch.file.clone()).collect();
            let why = Why::ShaftOff { files, is_small: half_width_nm >= torque_nm.abs() };
            Known::new(Subject::Friction, Grade::of_width(width, WIDTHS), value, vec![why])
        }
        (Some(Err(why)), _) => unknown(Why::NoFriction(why.to_vec())),
        (None, Some(recording)) => {
            if let Some(found) = study.model.as_ref().and_then(|model| model.dyno_friction.as_ref()) {
                return of_model(found);
            }
            Known { value: Value::NotSought, ..unknown(Why::FrictionIn(recording.file.clone())) }
        }
        (None, None) => unknown(Why::ShaftOn),
    }
}

/// Friction that is in the model: at the middle of the speeds of its run-outs.
fn of_model(found: &EstimatedFriction) -> Known {
    let speed_rad_s = 0.5 * (found.speeds_rad_s.0 + found.speeds_rad_s.1);
    let (torque_nm, half_width_nm) = (found.torque_nm(speed_rad_s), found.half_width_nm(speed_rad_s));
    let width = half_width_nm / torque_nm.max(FRICTION_NM / WIDTHS.well);
    let value = Value::Friction { torque_nm, half_width_nm, speed_rad_s };
    let why = Why::InModel { files: found.recordings.clone() };
    Known::new(Subject::Friction, Grade::of_width(width, WIDTHS), value, vec![why])
}

/// The engine's torque.
pub(super) fn engine_torque(study: &Study, analyses: Option<&Analyses>) -> Known {
    let unknown = |why| Known::not_at_all(Subject::EngineTorque, why);
    let Some(found) = analyses.map(|found| &found.engine_torque) else {
        let why = Why::NotRecorded { replayed: !study.replays.is_empty() };
        return Known { value: Value::NotSought, ..unknown(why) };
    };
    let rebuilt = || found.recordings.iter().filter_map(|one| Some((one, one.engine.estimated()?)));
    let widths =
        rebuilt().map(|(one, engine)| (one, engine, relative(&engine.standard_deviation_nm, &engine.smoothed_nm)));
    match (widths.min_by(|a, b| a.2.total_cmp(&b.2)), &found.masses) {
        (Some((one, engine, width)), _) => {
            let why = Why::Rebuilt { file: one.file.clone(), certainty: engine.certainty() };
            let value = Value::Rebuilt(rebuilt().count());
            Known::new(Subject::EngineTorque, Grade::of_width(width, WIDTHS), value, vec![why])
        }
        (None, Outcome::NotEstimated { needs }) => unknown(Why::NoMasses(needs.clone())),
        (None, Outcome::Estimated(_)) => unknown(Why::NotRebuilt),
    }
}

/// Median of the 95 % half-widths over the root mean square of the values.
fn relative(deviations: &[f64], values: &[f64]) -> f64 {
    let median = upper_median(&mut deviations.to_vec()).unwrap_or(f64::INFINITY);
    let rms = (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt();
    QUANTILE_95 * median / rms
}
