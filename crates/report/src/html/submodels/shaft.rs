//! The shaft: stiffness and damping, and why to believe them.

use bench::study::{BenchVariant, Estimate, MeasuredResponse, Part, ResidualSpectrum, Shaft, Study};

use crate::html::parts::{fit_line, lead, not_estimated, parameters, table, unbroken};
use crate::html::plots::{comparison, figure};
use crate::html::typeset::{prose, symbol};
use crate::wording::number;
use page::markup;
use page::markup::Markup;
use page::{Axis, Figure, Layer, Panel, Rounded, Style, rounded};

/// An inertia less certain than this part of itself is not worth a number.
const SILENT: f64 = 0.2;

/// The section on the shaft.
pub(crate) fn shaft(study: &Study) -> Markup {
    let what = "The elastic connection between engine and dynamometer: it carries torque when the two are twisted against \
                each other.";
    let part = match &study.shaft {
        Part::Estimated(part) => part,
        Part::NotEstimated { needs } => return not_estimated(what, needs),
    };
    let equation = "<i>T</i><sub>shaft</sub> = <i>K</i> ∫(<i>ω</i><sub>e</sub> − <i>ω</i><sub>d</sub>) d<i>t</i> + \
                    <i>B</i> (<i>ω</i><sub>e</sub> − <i>ω</i><sub>d</sub>)";
    [
        lead(what, equation),
        parameters(&part.estimate, &[&part.zero]),
        fit_line(&part.validation),
        figure(&comparison("Shaft torque on the held-out stretch", &part.validation, None)),
        figure(&response(&part.frequency_response)),
        residuals(&part.residual_spectrum),
        ignoring_timing(part),
        cross_checks(part),
        inertias(study, part),
    ]
    .into_iter()
    .collect()
}

fn response(response: &MeasuredResponse) -> Figure {
    let hz = &response.frequencies_hz;
    let panel = |label: &str, unit: &str, measured: &[f64], modelled: &[f64]| {
        let measured = Layer::dots("measured", Style::Measured, hz, measured);
        let modelled = Layer::curve("modelled", Style::Modelled, hz, modelled);
        Panel::new(Axis::linear(label, unit), 150, vec![measured, modelled])
    };
    Figure {
        equal_axes: false,
        symbols: true,
        title: "Frequency response from twist speed to shaft torque".to_owned(),
        caption: "Δω = ω_e − ω_d to T_shaft, gain relative to 1 Nm s/rad. The falling part is the stiffness; where it \
                  levels off, the damping takes over."
            .to_owned(),
        x: Axis::frequency(),
        panels: vec![
            panel("gain", "dB", &response.measured_gain_db, &response.modelled_gain_db),
            panel("phase", "°", &response.measured_phase_deg, &response.modelled_phase_deg),
        ],
    }
}

/// The residual's test: by frequency, since that is how the shaft is fitted.
fn residuals(spectrum: &ResidualSpectrum) -> Markup {
    markup!(
        "<p class=\"note\">{}</p>\n{}",
        prose(
            "The shaft is fitted frequency by frequency, with the noise of all three signals known as a function of \
             frequency. So is its residual tested: where the model is right, every frequency is as likely as any other to \
             lie above the bound, and one in a hundred does. A stretch of frequencies above it would be what a correlation \
             outside its region is over time."
        ),
        figure(&spectrum_figure(spectrum))
    )
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
    Figure {
        equal_axes: false,
        symbols: true,
        title: "What the shaft model leaves over, by frequency".to_owned(),
        caption: format!(
            "Equation error over its standard deviation; {above} of {} frequencies lie above the 99 % bound. Dashed lines: \
             {} left out of the fit.",
            spectrum.normalised_magnitude.len(),
            match spectrum.excluded_hz.len() {
                1 => "one frequency".to_owned(),
                n => format!("{n} frequencies"),
            }
        ),
        x: Axis::linear("frequency", "Hz"),
        panels: vec![Panel::new(Axis::linear("|error|/σ", ""), 150, layers)],
    }
}

/// The fit that takes the signals' timing as given, beside the one that estimates it.
fn ignoring_timing(part: &Shaft) -> Markup {
    let rows = part.ignoring_timing.parameters.iter().map(|plain| {
        let honest = part.estimate.parameter(&plain.symbol).or_else(|| {
            let is_zero = plain.symbol == part.zero.symbol;
            is_zero.then_some(&part.zero)
        });
        vec![
            symbol(&plain.symbol),
            prose(&plain.name),
            honest.map(|p| unbroken(&number::parameter(p))).unwrap_or_default(),
            unbroken(&number::parameter(plain)),
        ]
    });
    markup!(
        "<h3>What ignoring the timing would give</h3>\n<p>{}</p>\n{}",
        prose(
            "Speed and torque arrive through different gates and at different times. A fit that takes their time stamps \
             at their word puts the difference into the damping; its intervals do not show that."
        ),
        table("parameters", &["", "Parameter", "With gate and skew", "Ignoring them"], rows)
    )
}

fn cross_checks(part: &Shaft) -> Markup {
    if part.cross_checks.is_empty() {
        return markup!("<p class=\"note\">No other recording or route was there to check this estimate.</p>\n");
    }
    let value = |estimate: &Estimate, symbol: &str| match estimate.parameter(symbol) {
        Some(parameter) => unbroken(&number::parameter(parameter)),
        None => markup!("<span class=\"none\">–</span>"),
    };
    let this = vec![markup!("<strong>this estimate</strong>"), value(&part.estimate, "K"), value(&part.estimate, "B")];
    let others =
        part.cross_checks.iter().map(|(name, estimate)| vec![prose(name), value(estimate, "K"), value(estimate, "B")]);
    markup!(
        "<h3>Other recordings and routes</h3>\n{}",
        table("routes", &["Route", "K", "B"], std::iter::once(this).chain(others))
    )
}

/// The inertias of the bench file beside what the data see.
fn inertias(study: &Study, part: &Shaft) -> Markup {
    let Some((file, estimate)) = &part.inertias else {
        let why = match study.bench.variant {
            BenchVariant::LoadCell => {
                "No recording tells J_e, and J_d together with it: that takes a wide-band torque demand in torque control, \
                 such as WhiteNoise_T_TN or Multisine_T_TN. Both are those of the bench file."
            }
            BenchVariant::TorqueFlange => {
                "J_d and J_e are those of the bench file: torque is measured between them, and behind a dual-mass \
                 flywheel there is no one J_e to be found."
            }
        };
        return markup!("<p class=\"note\">{}</p>\n", prose(why));
    };
    let stated = [("J_d", study.bench.dynamometer_inertia_kg_m2), ("J_e", study.bench.engine_inertia_kg_m2)];
    let rows = stated.into_iter().filter_map(|(name, kg_m2)| {
        let found = estimate.parameter(name)?;
        let silent = found.standard_error > SILENT * found.value.abs();
        let seen = if silent { prose("says too little of it") } else { unbroken(&number::parameter(found)) };
        Some(vec![symbol(name), prose(&found.name), unbroken(&number::measure(kg_m2, "kg m²")), seen])
    });
    markup!(
        "<h3>The inertias as the data see them</h3>\n<p>{}</p>\n{}",
        prose(&format!(
            "From {file}, with nothing known of them beforehand. J_e follows from what the torque demand makes both sides of the shaft \
             do, since the engine’s own torque, which is not recorded, does not follow that demand; where its speed control \
             does, that is estimated along."
        )),
        table("parameters", &["", "Parameter", "Bench file", "Data"], rows)
    )
}
