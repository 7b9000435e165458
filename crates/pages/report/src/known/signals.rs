//! Delays of signals, friction, and the engine's torque.

use rig::ExperimentLabel;
use rig::dyno_friction::EstimatedFriction;
use rig::results::{Outcome, Parameter, SignalDelay};
use study::{Analyses, Study};

use super::grade::{Grade, Known, WIDTHS, grade, of_part, stretch_words};
use crate::engine;
use crate::wording::{self, number};

/// Friction known to within this is known well, however little there is of it, Nm.
const FRICTION_NM: f64 = 1.0;

/// How late each torque signal is.
pub(super) fn delays(study: &Study) -> Vec<Known> {
    of_part(&study.timing, "", "delays of the torque signals", |part| {
        part.delays.iter().filter_map(|delay| one(study, delay)).collect()
    })
}

fn one(study: &Study, delay: &SignalDelay) -> Option<Known> {
    let own = delay.against_demand.as_ref()?;
    let mut by_width = grade(study, own);
    let mut why = vec![format!("Measured against T_d* in {}.", stretch_words(study, &delay.stretch))];
    why.push(match delay.routes_agree() {
        Some(true) => format!("{} methods estimate it, and they agree.", delay.routes.len()),
        Some(false) => {
            by_width = by_width.contradicted();
            format!("The {} methods that estimate it do not agree.", delay.routes.len())
        }
        None => "No second method checks it.".to_owned(),
    });
    if let Some(bend) = &delay.against_speed_bend {
        why.push(beside_bend(delay.role.symbol(), bend));
    }
    let name = format!("delay of {}", delay.role.symbol());
    Some(Known::new("", &name, by_width, number::parameter(own), why))
}

/// How a torque signal lies against the moment at which the course of N_d bends, in a sentence.
fn beside_bend(symbol: &str, late: &Parameter) -> String {
    let turned = |value: f64| if late.value < 0.0 { -value } else { value };
    let (a, b) = (turned(late.interval.0), turned(late.interval.1));
    let apart = Parameter { value: late.value.abs(), interval: (a.min(b), a.max(b)), ..late.clone() };
    let order = if late.value < 0.0 { "before" } else { "after" };
    format!("{symbol} comes {} {order} the course of N_d bends.", number::parameter(&apart))
}

/// Friction of the dynamometer.
pub(super) fn friction(study: &Study, analyses: Option<&Analyses>) -> Known {
    let known = |grade, value: String, why| Known::new("", "friction of the dynamometer", grade, value, vec![why]);
    let without_shaft = study
        .recordings
        .iter()
        .find(|recording| recording.label.as_ref().is_some_and(ExperimentLabel::is_without_shaft));
    match (analyses.map(|found| &found.friction), without_shaft) {
        (Some(Ok(found)), _) => {
            let Some(middle) = found.curve.get(found.curve.len() / 2) else {
                return known(Grade::NotAtAll, "–".to_owned(), "The recorded speeds do not show it.".to_owned());
            };
            let files: Vec<String> = found.run_outs.iter().map(|run_out| run_out.stretch.file.clone()).collect();
            let mut why = format!("From {}, with the shaft off.", wording::join(&files, "and"));
            if middle.half_width_nm >= middle.torque_nm.abs() {
                why.push_str(" It does not differ significantly from zero, and is small in any case.");
            }
            let torque = number::plus_minus(middle.torque_nm, middle.half_width_nm, "Nm");
            let width = middle.half_width_nm / middle.torque_nm.abs().max(FRICTION_NM / WIDTHS.well);
            let value = format!("{torque} at {}", number::rpm(middle.speed_rad_s));
            known(Grade::of_width(width, WIDTHS), value, why)
        }
        (Some(Err(why)), _) => known(Grade::NotAtAll, "–".to_owned(), wording::capitalised(&format!("{why}."))),
        (None, Some(recording)) => {
            if let Some(found) = study.model.as_ref().and_then(|model| model.dyno_friction.as_ref()) {
                return of_model(found);
            }
            let why = format!("It is no part of the model; `dynoid friction` estimates it from {}.", recording.file);
            known(Grade::NotAtAll, "not looked at here".to_owned(), why)
        }
        (None, None) => {
            let why = "With the shaft on it cannot be separated from engine torque, and no recording is without shaft; run NoShaft_N_NT.";
            known(Grade::NotAtAll, "–".to_owned(), why.to_owned())
        }
    }
}

/// Friction that is in the model: at the middle of the speeds of its run-outs.
fn of_model(found: &EstimatedFriction) -> Known {
    let speed_rad_s = 0.5 * (found.speeds_rad_s.0 + found.speeds_rad_s.1);
    let torque_nm = found.torque_nm(speed_rad_s);
    let half_width_nm = found.half_width_nm(speed_rad_s);
    let width = half_width_nm / torque_nm.max(FRICTION_NM / WIDTHS.well);
    let value = format!("{} at {}", number::plus_minus(torque_nm, half_width_nm, "Nm"), number::rpm(speed_rad_s));
    let why = format!("From {}, with the shaft off; predictions count it.", wording::join(&found.recordings, "and"));
    Known::new("", "friction of the dynamometer", Grade::of_width(width, WIDTHS), value, vec![why])
}

/// The engine's torque.
pub(super) fn engine_torque(study: &Study, analyses: Option<&Analyses>) -> Known {
    let known = |grade, value: String, why| Known::new("T_e", "torque of the engine", grade, value, vec![why]);
    let Some(found) = analyses.map(|found| &found.engine_torque) else {
        let why = match study.replays.is_empty() {
            true => "No bench records it, and nothing was replayed.",
            false => {
                "No bench records it; replays reconstruct it from N_e and T_shaft, `dynoid engine` with its uncertainty."
            }
        };
        return known(Grade::NotAtAll, "not looked at here".to_owned(), why.to_owned());
    };
    let rebuilt = found.recordings.iter().filter_map(|one| Some((one, one.engine.estimated()?)));
    let widths =
        rebuilt.map(|(one, engine)| (one, engine, relative(&engine.standard_deviation_nm, &engine.smoothed_nm)));
    match (widths.min_by(|a, b| a.2.total_cmp(&b.2)), &found.masses) {
        (Some((one, engine, width)), _) => {
            let value = format!(
                "rebuilt in {} recordings",
                found.recordings.iter().filter(|r| r.engine.estimated().is_some()).count()
            );
            let why = format!("No bench records it. Best in {}: {}.", one.file, engine::rebuilt(engine));
            known(Grade::of_width(width, WIDTHS), value, why)
        }
        (None, Outcome::NotEstimated { needs: why }) => {
            known(Grade::NotAtAll, "–".to_owned(), wording::capitalised(&format!("{}.", wording::reasons(why))))
        }
        (None, Outcome::Estimated(_)) => {
            known(Grade::NotAtAll, "–".to_owned(), "It could be rebuilt in no recording.".to_owned())
        }
    }
}

/// Median of the 95 % half-widths over the root mean square of the values.
fn relative(deviations: &[f64], values: &[f64]) -> f64 {
    let mut sorted = deviations.to_vec();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(f64::INFINITY);
    let rms = (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt();
    1.96 * median / rms
}
