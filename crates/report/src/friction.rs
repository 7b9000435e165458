//! Friction and inertia of the dynamometer, in words and figures.

use bench::friction::{Friction, Inertia, Term, Undetermined};
use bench::units::RPM_RAD_S;
use plot::{Abscissa, Axis, Figure, Layer, Panel, Style, rounded};

use crate::wording::number;

/// Height of a panel on the page.
const HEIGHT: u32 = 220;
/// An estimated J_d beyond the stated one by more than this part of it is as if more than the dynamometer turned.
const MORE_TURNS: f64 = 0.15;
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

/// What is to be said beside the numbers; `stated_kg_m2` is J_d of the bench file.
pub fn remarks(friction: &Friction, stated_kg_m2: f64) -> Vec<String> {
    let mut all = Vec::new();
    match &friction.inertia {
        Inertia::Estimated { inertia, .. } => {
            let (low, high) = inertia.interval;
            if low > (1.0 + MORE_TURNS) * stated_kg_m2 {
                all.push(format!(
                    "J_d comes out {} % above the {} of the bench file: if the shaft was off, correct the bench file",
                    number::significant(100.0 * (inertia.value / stated_kg_m2 - 1.0), 2),
                    number::measure(stated_kg_m2, "kg m²"),
                ));
            } else if !(low..=high).contains(&stated_kg_m2) {
                all.push(format!("the bench file states {} for J_d", number::measure(stated_kg_m2, "kg m²")));
            }
        }
        Inertia::Stated { inertia_kg_m2, why } => all.push(format!(
            "{}: these recordings tell friction over inertia alone; torques hold for the {} of the bench file. For J_d, step \
             N_d* (NoShaft_N_NT)",
            undetermined(*why),
            number::measure(*inertia_kg_m2, "kg m²"),
        )),
    }
    all.extend(undecided(friction));
    all
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
            "{} would do as well over the speeds seen: record a wider range of speeds to tell",
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

/// T_fric over speed, and each stretch with the speed of the model.
pub fn figures(friction: &Friction) -> Vec<Figure> {
    let rpm: Vec<f64> = friction.curve.iter().map(|p| p.speed_rad_s / RPM_RAD_S).collect();
    let of = |f: fn(&bench::friction::CurvePoint) -> f64| friction.curve.iter().map(f).collect::<Vec<f64>>();
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
            Layer::timed_trace("measured", Style::Measured, &run_out.time_s, &speeds(&run_out.measured_rad_s)),
            Layer::timed_trace("modelled", Style::Modelled, &run_out.time_s, &speeds(&run_out.modelled_rad_s)),
        ];
        let panel = Panel::new(Axis::linear("N_d", "rpm"), HEIGHT, layers);
        Figure::new(&run_out.stretch.file, Axis::time(), vec![panel])
            .with_caption("The model runs from the first sample on, driven by T_d alone; what T_d lacks adds up.")
    });
    std::iter::once(first).chain(rest).collect()
}
