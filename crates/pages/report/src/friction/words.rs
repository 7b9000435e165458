//! Friction and inertia of the dynamometer, in words and figures.

use page::{Abscissa, Axis, Figure, Layer, Panel, Style, rounded};
use part_friction::{Friction, Inertia, Term, TorqueUsed, Undetermined};
use rig::facts::StatedInertia;
use rig::results::{Parameter, Quantity};
use units::RPM_RAD_S;

use crate::figures::{BAND, HEIGHT};
use crate::wording::number;

/// Measured speeds that are drawn of a stretch.
const DOTS: usize = 150;
/// Below this difference a criterion does not decide.
const UNDECIDED: f64 = 6.0;

/// A term in one word.
pub fn term(term: Term) -> &'static str {
    match term {
        Term::Offset => "offset",
        Term::Coulomb => "Coulomb",
        Term::Viscous => "viscous",
        Term::Quadratic => "quadratic",
        Term::Cubic => "cubic",
    }
}

/// A choice of terms, e.g. `Coulomb + viscous`.
pub fn terms(all: &[Term]) -> String {
    all.iter().map(|one| term(*one)).collect::<Vec<_>>().join(" + ")
}

/// Remarks beside the numbers.
pub fn remarks(friction: &Friction) -> Vec<String> {
    let of_inertia = match &friction.inertia {
        Inertia::Estimated { .. } => None,
        Inertia::Stated { inertia_kg_m2, why } => Some(format!(
            "{}: these recordings show friction over inertia alone; torques hold for the {} of the bench file. For J_d, step \
             N_d* (NoShaft_N_NT)",
            undetermined(*why),
            number::measure(*inertia_kg_m2, "kg m²"),
        )),
    };
    let uses = |source| friction.run_outs.iter().any(|run_out| run_out.torque == Some(source));
    let calculated = uses(TorqueUsed::Calculated).then(|| {
        "T_d is T_d,calc as recorded. No T_d* shows what it does between its samples, so means over several samples were \
         compared, and the interval of J_d is wider. A recording with T_d*, named in the bench file as dyno_torque_demand, \
         makes it narrower"
            .to_owned()
    });
    of_inertia.into_iter().chain(calculated).chain(undecided(friction)).collect()
}

/// Doubts about the numbers, with the remedies.
pub fn doubts(friction: &Friction, stated: StatedInertia) -> Vec<String> {
    let of_inertia = match &friction.inertia {
        Inertia::Estimated { inertia, .. } => against_stated(inertia, stated),
        Inertia::Stated { .. } => None,
    };
    let of_cell = || {
        let is_of_cell = |run_out: &&part_friction::RunOut| run_out.torque == Some(TorqueUsed::LoadCell);
        let mut files: Vec<&str> =
            friction.run_outs.iter().filter(is_of_cell).map(|run_out| run_out.stretch.file.as_str()).collect();
        files.dedup();
        (!files.is_empty()).then(|| {
            format!(
                "{}: T_d is taken from the load cell, T_d,meas, since no T_d,calc can be used. δ_T contains the \
                 delay of the load cell; its other errors show in J_d. For a narrower interval of J_d record \
                 T_d,calc with T_d*, or correct what a warning says about it",
                files.join(", ")
            )
        })
    };
    of_inertia.into_iter().chain(of_cell()).chain(below_zero(friction)).collect()
}

/// J_d against that of the bench file, where the difference is more than both uncertainties allow.
fn against_stated(inertia: &Parameter, stated: StatedInertia) -> Option<String> {
    let own = 0.5 * (inertia.interval.1 - inertia.interval.0);
    let theirs = BAND * stated.uncertainty_percent / 100.0 * stated.kg_m2;
    let apart = inertia.value - stated.kg_m2;
    (apart.abs() > own.hypot(theirs)).then(|| {
        let way = if apart > 0.0 { "above" } else { "below" };
        let doubt = match stated.is_uncertainty_stated {
            true => String::new(),
            false => format!(" (taken with a standard uncertainty of {} %, as none is stated)", stated.uncertainty_percent),
        };
        format!(
            "J_d comes out {} % {way} the {} of the bench file{doubt}, more than the intervals allow: if the shaft was off and \
             the gain of T_d is right, correct dynamometer_inertia in the bench file",
            number::significant(100.0 * apart.abs() / stated.kg_m2, 2),
            number::measure(stated.kg_m2, "kg m²"),
        )
    })
}

/// Coulomb friction below zero: what holds over the speeds seen drives at others.
fn below_zero(friction: &Friction) -> Option<String> {
    let coulomb = friction.friction.parameter(Quantity::CoulombFriction).filter(|c| c.interval.1 < 0.0)?;
    Some(format!(
        "c_0 is below zero ({}), which no friction is: T_fric is valid at the recorded speeds, not below them; record slower speeds",
        number::interval(coulomb)
    ))
}

/// Source of T_d of a stretch, in a word.
pub fn torque_used(used: Option<TorqueUsed>) -> &'static str {
    match used {
        None => "no T_d",
        Some(TorqueUsed::Modelled) => "T_d from T_d* through the torque control",
        Some(TorqueUsed::Calculated) => "T_d from T_d,calc",
        Some(TorqueUsed::LoadCell) => "T_d from the load cell",
    }
}

/// Candidates that explain the speed as well as the chosen one.
fn undecided(friction: &Friction) -> Option<String> {
    let chosen = friction.candidates.iter().find(|candidate| candidate.chosen)?;
    let rivals: Vec<String> = friction
        .candidates
        .iter()
        .filter(|c| {
            !c.chosen && c.terms.len() <= chosen.terms.len() && c.bic_above_best < chosen.bic_above_best + UNDECIDED
        })
        .map(|c| terms(&c.terms))
        .collect();
    (!rivals.is_empty()).then(|| {
        format!(
            "{} would fit as well at the recorded speeds: record a wider range of speeds to decide",
            crate::wording::join(&rivals, "or")
        )
    })
}

fn undetermined(why: Undetermined) -> &'static str {
    match why {
        Undetermined::NoTorque => "no torque was recorded",
        Undetermined::TorqueFree => "T_d was zero",
        Undetermined::LittleExcitation => "T_d hardly changed the speed, or only as friction does",
    }
}

/// Measured values as dots evenly spaced, few enough that the model's line is seen over them.
fn measured(time_s: &[f64], values: &[f64]) -> Layer {
    let every = values.len().div_ceil(DOTS).max(1);
    let thinned = |all: &[f64]| all.iter().step_by(every).copied().collect::<Vec<f64>>();
    Layer::dots("measured", Style::Measured, &thinned(time_s), &thinned(values))
}

/// T_fric over speed, and each stretch with the speed of the model.
pub fn figures(friction: &Friction) -> Vec<Figure> {
    let rpm: Vec<f64> = friction.curve.iter().map(|p| p.speed_rad_s / RPM_RAD_S).collect();
    let of = |f: fn(&part_friction::CurvePoint) -> f64| friction.curve.iter().map(f).collect::<Vec<f64>>();
    let band = Layer::Band {
        name: "95 % interval".to_owned(),
        style: Style::Modelled,
        x: Abscissa::Values(rounded(&rpm)),
        low: rounded(&of(|p| p.torque_nm - p.half_width_nm)),
        high: rounded(&of(|p| p.torque_nm + p.half_width_nm)),
    };
    let curve = Layer::curve("T_fric", Style::Modelled, &rpm, &of(|p| p.torque_nm));
    let panel = Panel::new(Axis::linear("T_fric", "Nm"), HEIGHT, vec![band, curve]);
    let first = Figure::new("Friction over speed", Axis::linear("N_d", "rpm"), vec![panel])
        .with_caption(format!("Terms: {}.", terms(friction.terms())));
    let rest = friction.run_outs.iter().map(|run_out| {
        let speeds = |values: &[f64]| values.iter().map(|w| w / RPM_RAD_S).collect::<Vec<f64>>();
        let layers = vec![
            measured(&run_out.time_s, &speeds(&run_out.measured_rad_s)),
            Layer::curve("modelled", Style::Modelled, &run_out.time_s, &speeds(&run_out.modelled_rad_s)),
        ];
        let panel = Panel::new(Axis::linear("N_d", "rpm"), HEIGHT, layers);
        Figure::new(&run_out.stretch.file, Axis::time(), vec![panel]).with_caption(format!(
            "Dots: some of the measured speeds; line: the model, which runs from the first sample on, driven by T_d \
             alone; errors of T_d add up. Used: {}.",
            torque_used(run_out.torque)
        ))
    });
    std::iter::once(first).chain(rest).collect()
}
