//! The shaft: stiffness and damping, and why to believe them.

use rig::facts::BenchVariant;
use rig::results::{Estimate, MeasuredResponse, Outcome, Quantity, ResidualSpectrum, Shaft};
use study::Study;

use page::{Axis, Block, Blocks, Cell, Figure, Layer, Panel, Prose, Rounded, Style, Table, rounded};

use crate::estimates::{fit_line, lead, not_estimated, parameters};
use crate::plots::comparison;
use crate::wording::number;

/// An inertia less certain than this part of itself is not worth a number.
const SILENT: f64 = 0.2;

/// The section on the shaft.
pub(crate) fn section(study: &Study) -> Blocks {
    let what = "The elastic connection between engine and dynamometer: it carries torque when the two are twisted against \
                each other.";
    let part = match &study.shaft {
        Outcome::Estimated(part) => part,
        Outcome::NotEstimated { needs } => return not_estimated(what, needs),
    };
    let equation = "T_shaft = K ∫(ω_e − ω_d) dt + B (ω_e − ω_d)";
    let all: Vec<Blocks> = vec![
        lead(what, equation),
        parameters(&part.estimate, &[&part.zero]),
        fit_line(&part.validation).into(),
        comparison("Shaft torque on the held-out stretch", &part.validation, None).into(),
        response(&part.frequency_response).into(),
        residuals(&part.residual_spectrum),
        ignoring_timing(part),
        cross_checks(part),
        inertias(study, part),
    ];
    all.into_iter().collect()
}

fn response(response: &MeasuredResponse) -> Figure {
    let hz = &response.frequencies_hz;
    let panel = |label: &str, unit: &str, measured: &[f64], modelled: &[f64]| {
        let measured = Layer::dots("measured", Style::Measured, hz, measured);
        let modelled = Layer::curve("modelled", Style::Modelled, hz, modelled);
        Panel::new(Axis::linear(label, unit), 150, vec![measured, modelled])
    };
    let panels = vec![
        panel("gain", "dB", &response.measured_gain_db, &response.modelled_gain_db),
        panel("phase", "°", &response.measured_phase_deg, &response.modelled_phase_deg),
    ];
    Figure::new("Frequency response from twist speed to shaft torque", Axis::frequency(), panels).with_caption(
        "Δω = ω_e − ω_d to T_shaft, gain relative to 1 Nm s/rad. The falling part is the stiffness; the level part is \
         the damping.",
    )
}

/// The residual's test: by frequency, since that is how the shaft is fitted.
fn residuals(spectrum: &ResidualSpectrum) -> Blocks {
    let text = "The shaft is fitted frequency by frequency, with the noise of all three signals known as a function \
                of frequency. Its residual is tested in the same way. If the model is right, one frequency in a \
                hundred lies above the bound, each with the same probability. Several frequencies in a row above it \
                speak against the model.";
    vec![Block::note(text), Block::figure(spectrum_figure(spectrum))].into()
}

fn spectrum_figure(spectrum: &ResidualSpectrum) -> Figure {
    let above = spectrum.normalised_magnitude.iter().filter(|magnitude| **magnitude > spectrum.bound).count();
    let mut layers = vec![Layer::YRegion {
        low: Rounded(0.0),
        high: Rounded(spectrum.bound),
        label: "99 % if the model is right".to_owned(),
    }];
    if !spectrum.excluded_hz.is_empty() {
        layers.push(Layer::VerticalMarks { x: rounded(&spectrum.excluded_hz), label: "left out".to_owned() });
    }
    layers.push(Layer::dots("|error|/σ", Style::Residual, &spectrum.frequencies_hz, &spectrum.normalised_magnitude));
    let panels = vec![Panel::new(Axis::linear("|error|/σ", ""), 150, layers)];
    let x = Axis::linear("frequency", "Hz");
    Figure::new("Residual of the shaft model by frequency", x, panels).with_caption(format!(
        "Equation error over its standard deviation; {above} of {} frequencies lie above the 99 % bound.{}",
        spectrum.normalised_magnitude.len(),
        match spectrum.excluded_hz.len() {
            0 => String::new(),
            1 => " Dashed line: a frequency that the fit leaves out.".to_owned(),
            n => format!(" Dashed lines: {n} frequencies that the fit leaves out."),
        }
    ))
}

/// The fit that takes the signals' timing as given, beside the one that estimates it.
fn ignoring_timing(part: &Shaft) -> Blocks {
    let rows = part.ignoring_timing.parameters.iter().map(|plain| {
        let honest = part.estimate.parameter(plain.quantity).or_else(|| {
            let is_zero = plain.quantity == part.zero.quantity;
            is_zero.then_some(&part.zero)
        });
        vec![
            Cell::from(Prose::symbol(plain.quantity.symbol())),
            Cell::from(plain.quantity.name()),
            honest.map_or_else(|| "".into(), |p| number::quantity(p).into()),
            number::quantity(plain).into(),
        ]
    });
    let text = "A speed is the mean over the gate of its encoder, the time in which that counts. Skews are by how much the time \
                stamps of a signal are late. A fit that ignores both takes the difference for damping, and its intervals do not \
                show that.";
    let headings = ["", "Parameter", "With gate and skew", "Ignoring them"];
    vec![
        Block::heading("What ignoring the timing would give"),
        Block::paragraph(text),
        Block::Table(Table::of_text(&headings).with_rows(rows)),
    ]
    .into()
}

fn cross_checks(part: &Shaft) -> Blocks {
    if part.cross_checks.is_empty() {
        return Block::note("No other recording and no second method checks this estimate.").into();
    }
    let value = |estimate: &Estimate, quantity| match estimate.parameter(quantity) {
        Some(parameter) => number::quantity(parameter).into(),
        None => Cell::from("–"),
    };
    let row = |name: Cell, estimate: &Estimate| {
        vec![name, value(estimate, Quantity::Stiffness), value(estimate, Quantity::Damping)]
    };
    let this = row(Prose::strong("this estimate").into(), &part.estimate);
    let others = part.cross_checks.iter().map(|(name, estimate)| row(name.into(), estimate));
    let table = Table::of_text(&["From", "K", "B"]).with_rows(std::iter::once(this).chain(others));
    vec![
        Block::heading("Other recordings and methods"),
        Block::note(
            "The others are estimated from whole recordings. An analysis of one recording keeps a part of it for the test of the \
             estimate, and so has slightly other values.",
        ),
        Block::Table(table),
    ]
    .into()
}

/// The inertias of the bench file beside what the data see.
fn inertias(study: &Study, part: &Shaft) -> Blocks {
    let Some((file, estimate)) = &part.inertias else {
        let why = match study.bench.variant {
            BenchVariant::LoadCell => {
                "No recording shows J_e, or J_d together with it. That takes a wide-band torque demand in torque control, \
                 such as WhiteNoise_T_TN or Multisine_T_TN. Both are those of the bench file."
            }
            BenchVariant::TorqueFlange => {
                "J_d and J_e are those of the bench file. Torque is measured between them, and a dual-mass flywheel \
                 splits the inertia of the engine."
            }
        };
        return Block::note(why).into();
    };
    let stated = [
        (Quantity::DynoInertia, study.bench.dynamometer_inertia_kg_m2),
        (Quantity::EngineInertia, study.bench.engine_inertia_kg_m2),
    ];
    let rows = stated.into_iter().filter_map(|(quantity, kg_m2)| {
        let found = estimate.parameter(quantity)?;
        let silent = found.standard_error > SILENT * found.value.abs();
        let seen = if silent { Cell::from("too uncertain to say") } else { number::quantity(found).into() };
        Some(vec![
            Cell::from(Prose::symbol(quantity.symbol())),
            Cell::from(quantity.name()),
            number::measure(kg_m2, "kg m²").into(),
            seen,
        ])
    });
    let text = format!(
        "From {file}, with nothing known of them beforehand. J_e follows from the response of both sides of the \
         shaft to the torque demand. The engine’s own torque is not recorded, and does not follow that demand. If \
         the engine’s speed control reacts to it, that control is estimated too."
    );
    vec![
        Block::heading("The inertias estimated from the data"),
        Block::paragraph(text),
        Block::Table(Table::of_text(&["", "Parameter", "Bench file", "Data"]).with_rows(rows)),
    ]
    .into()
}
