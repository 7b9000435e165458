//! Recordings as they are.

use bench::Role;
use bench::study::{RecordedCourse, StepResponse, Trace};
use plot::markup::Markup;
use plot::{Axis, Figure, Layer, Panel, Style};

use super::{figures, sentence};
use crate::look::unit;
use crate::wording::{capitalised, experiment, number};

/// Speeds and torques as they share panels; a style each.
const SPEEDS: [(Role, Style); 3] =
    [(Role::DynoSpeedDemand, Style::Measured), (Role::EngineSpeed, Style::Other), (Role::DynoSpeed, Style::Modelled)];
const TORQUES: [(Role, Style); 5] = [
    (Role::SystemShaftTorque, Style::Fourth),
    (Role::LoadCellTorque, Style::Other),
    (Role::FlangeTorque, Style::Residual),
    (Role::AirGapTorque, Style::Modelled),
    (Role::DynoTorqueDemand, Style::Measured),
];

/// Every recording from its beginning to its end.
pub(crate) fn courses(all: &[RecordedCourse]) -> Markup {
    let mut section = sentence(
        "Speeds and torques as the estimates got them: in one unit, without gaps, before any model. A part that looks wrong \
         here is wrong everywhere below",
    );
    section.push(figures(all.iter().map(course).collect()));
    section
}

fn course(one: &RecordedCourse) -> Figure {
    let outline = |(role, style): &(Role, Style)| {
        let trace = of(&one.signals, *role)?;
        let (_, per_si) = unit(*role);
        let values: Vec<f64> = trace.values.iter().map(|v| v * per_si).collect();
        Some(Layer::outline(role.symbol(), *style, (trace.start_s, trace.sample_time_s), &values))
    };
    let throttle = [(Role::Throttle, Style::Modelled)];
    let rows: [(&[(Role, Style)], &str, &str, u32); 3] =
        [(&SPEEDS, "speed", "rpm", 130), (&TORQUES, "torque", "Nm", 170), (&throttle, "throttle", "%", 70)];
    let panels = rows.into_iter().filter_map(|(roles, name, unit, height)| {
        let layers: Vec<Layer> = roles.iter().filter_map(outline).collect();
        (!layers.is_empty()).then(|| Panel::new(Axis::linear(name, unit), height, layers))
    });
    let words = experiment(&one.label).map(|words| format!("{}. ", capitalised(words))).unwrap_or_default();
    Figure::new(&format!("{}, {}", one.label, one.file), Axis::time(), panels.collect())
        .with_caption(format!("{words}Long traces are thinned; every peak is kept."))
}

fn of(signals: &[(Role, Trace)], role: Role) -> Option<&Trace> {
    signals.iter().find(|(of, _)| *of == role).map(|(_, trace)| trace)
}

/// A step of T_d* and what followed it.
pub(crate) fn step(found: Option<&StepResponse>) -> Markup {
    match found {
        Some(found) => figures(vec![step_figure(found)]),
        None => super::untold(
            "A step of T_d* with what follows it is not shown",
            "no recording in torque control holds T_d* constant, steps it and holds it again; run Step_T_TN",
        ),
    }
}

fn step_figure(found: &StepResponse) -> Figure {
    let layer = |(role, style): &(Role, Style)| {
        let trace = of(&found.signals, *role)?;
        let (_, per_si) = unit(*role);
        let values: Vec<f64> = trace.values.iter().map(|v| v * per_si).collect();
        let time_ms: Vec<f64> =
            (0..values.len()).map(|k| 1e3 * (trace.start_s + k as f64 * trace.sample_time_s)).collect();
        Some(Layer::curve(role.symbol(), *style, &time_ms, &values))
    };
    let speed = [(Role::DynoSpeed, Style::Modelled)];
    let rows: [(&[(Role, Style)], &str, &str, u32); 2] = [(&TORQUES, "torque", "Nm", 220), (&speed, "N_d", "rpm", 110)];
    let panels = rows.into_iter().map(|(roles, name, unit, height)| {
        let at_step = Layer::VerticalMarks { x: vec![plot::Rounded(0.0)], label: "T_d* steps".to_owned() };
        let layers = std::iter::once(at_step).chain(roles.iter().filter_map(layer)).collect();
        Panel::new(Axis::linear(name, unit), height, layers)
    });
    Figure::new("A step of T_d*, and what followed it", Axis::linear("time after the step", "ms"), panels.collect())
        .with_caption(format!(
            "{} at {}, as recorded, each signal at its own samples. A torque that bends before N_d does is dated too early, one that \
             bends after it is late.",
            found.file,
            number::time(found.at_s)
        ))
}
