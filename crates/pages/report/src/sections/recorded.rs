//! Recordings as they are.

use page::Blocks;
use page::{Axis, Figure, Layer, Panel, Style};
use rig::Role;
use rig::results::Trace;
use study::{RecordedCourse, StepResponse};

use crate::blocks::{figures, no_result, sentence};
use crate::lines::unit;
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

/// Signals that share a panel.
struct Row<'a> {
    signals: &'a [(Role, Style)],
    name: &'a str,
    unit: &'a str,
    height: u32,
}

impl Row<'_> {
    /// The panel of what of them is there, `first` below it; none where nothing is.
    fn panel(&self, first: Option<Layer>, layer: impl Fn(&(Role, Style)) -> Option<Layer>) -> Option<Panel> {
        let layers: Vec<Layer> = self.signals.iter().filter_map(layer).collect();
        let there = !layers.is_empty();
        let axis = Axis::linear(self.name, self.unit);
        there.then(|| Panel::new(axis, self.height, first.into_iter().chain(layers).collect()))
    }
}

/// Every recording from its beginning to its end.
pub(crate) fn courses(all: &[RecordedCourse]) -> Blocks {
    let mut section = sentence(
        "Speeds and torques as the estimates use them: in one unit and without gaps. A part that looks wrong here is \
         wrong everywhere below",
    );
    section.push(figures(all.iter().map(course).collect()));
    section
}

fn course(one: &RecordedCourse) -> Figure {
    let outline = |(role, style): &(Role, Style)| {
        let trace = of(&one.signals, *role)?;
        let (_, per_si) = unit(*role);
        let values: Vec<f64> = trace.values.iter().map(|v| v * per_si).collect();
        Some(Layer::trace(role.symbol(), *style, (trace.start_s, trace.sample_time_s), &values))
    };
    let rows = [
        Row { signals: &SPEEDS, name: "speed", unit: "rpm", height: 130 },
        Row { signals: &TORQUES, name: "torque", unit: "Nm", height: 170 },
        Row { signals: &[(Role::Throttle, Style::Modelled)], name: "throttle", unit: "%", height: 70 },
    ];
    let panels = rows.iter().filter_map(|row| row.panel(None, outline));
    let words = experiment(&one.label).map(|words| format!("{}.", capitalised(words))).unwrap_or_default();
    Figure::new(&format!("{}, {}", one.label, one.file), Axis::time(), panels.collect())
        .with_caption(words)
        .of_recording(&one.file)
}

fn of(signals: &[(Role, Trace)], role: Role) -> Option<&Trace> {
    signals.iter().find(|(of, _)| *of == role).map(|(_, trace)| trace)
}

/// A step of T_d* and what followed it.
pub(crate) fn step(found: Option<&StepResponse>) -> Blocks {
    match found {
        Some(found) => figures(vec![step_figure(found)]),
        None => no_result(
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
    let rows = [
        Row { signals: &TORQUES, name: "torque", unit: "Nm", height: 220 },
        Row { signals: &[(Role::DynoSpeed, Style::Modelled)], name: "N_d", unit: "rpm", height: 110 },
    ];
    let at_step = || Layer::VerticalMarks { x: vec![page::Rounded(0.0)], label: "T_d* steps".to_owned() };
    let panels = rows.iter().filter_map(|row| row.panel(Some(at_step()), layer));
    Figure::new("A step of T_d*, and what followed it", Axis::linear("time after the step", "ms"), panels.collect())
        .with_caption(format!(
            "{} at {}, as recorded, each signal at its own samples. A torque that bends before N_d has time stamps \
             that are too early. A torque that bends after N_d is late.",
            found.file,
            number::time(found.at_s)
        ))
}
