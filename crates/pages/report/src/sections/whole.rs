//! The assembled model: resonance, Bode curves, sine tests, margins.

use bench_model::analysis::{BodeCurve, Margins, SinePoint, WholeModel};
use rig::ControlMode;
use rig::engine_pulses::{EnginePulses, KnownPulses};
use rig::facts::BenchFacts;
use rig::results::{Outcome, Parameter, Quantity};
use study::{Origin, Study, bench_model, parameters};
use units::RPM_RAD_S;

use page::{Abscissa, Align, Axis, Block, Blocks, Cell, Figure, Layer, Panel, Prose, Rounded, Style, Table, rounded};

use crate::estimates::{lead, not_estimated, parameter_table};
use crate::wording::{self, mode_short, number};

/// Normal quantile of the error bars.
const QUANTILE_95: f64 = 1.96;

/// The section on the whole model.
pub(crate) fn section(study: &Study, origin: &Origin) -> Blocks {
    let what = "All parts connected: how the bench responds to a demand, and where it resonates.";
    let whole = match &study.whole {
        Outcome::Estimated(whole) => whole,
        Outcome::NotEstimated { needs } => return not_estimated(what, needs),
    };
    let equation =
        "{T_shaft}/{T_d} = {H_d H_s}/{1 + H_s (H_d + H_e)}, H_d = 1/(J_d s), H_e = 1/(J_e s), H_s = (K + B s)/s";
    let results = [&whole.resonance_hz, &whole.firing_meets_resonance, &whole.resonance_gain, &whole.damping_ratio];
    let mut all = lead(what, equation);
    all.push(parameter_table(results));
    all.push(notes(study, whole));
    let mut figures = bode_figures(whole).into_vec();
    let rest = figures.split_off(figures.len().min(1));
    all.push(figures);
    let mut more = influences(whole);
    more.push(rest);
    all.push(Block::Fold {
        summary: "Further responses, and what each parameter does".into(),
        blocks: more.into_vec(),
    });
    all.push(sine_tests(whole));
    all.push(numbers(study, origin));
    all
}

/// The numbers that model.json has, in one table.
fn numbers(study: &Study, origin: &Origin) -> Blocks {
    let Some(document) = bench_model(study, origin.clone(), &wording::MODEL_WORDS) else { return Blocks::default() };
    let blocks = vec![
        Block::paragraph("These are the numbers that model.json has, and that simulations and exports use."),
        Block::Table(parameter_table(&parameters(&document))),
    ];
    let mut all = Blocks::from(Block::Fold { summary: "The numbers of the model".into(), blocks });
    all.push(document.engine_pulses.iter().map(pulses).collect::<Blocks>());
    all
}

/// The firing pulses of the engine, harmonic by harmonic.
fn pulses(pulses: &EnginePulses) -> Block {
    let mut table = Table::new(&[
        ("order", Align::Right),
        ("without load", Align::Right),
        ("part of the mean torque", Align::Right),
        ("by masses at 2000 rpm", Align::Right),
    ]);
    let speed_squared = (2000.0 * RPM_RAD_S).powi(2);
    for one in pulses.harmonics.iter().filter(|one| one.is_estimated) {
        let with_error = |parts: [f64; 2], k: usize, times: f64, unit: &str| {
            let (size, error) = (times * parts[0].hypot(parts[1]), times * one.covariance[k][k].max(0.0).sqrt());
            let written = format!("{} ± {}", number::significant(size, 3), number::significant(1.96 * error, 2));
            Cell::from(format!("{written} {unit}").trim_end().to_owned())
        };
        table.row([
            Cell::from(number::significant(one.order, 3)),
            with_error(one.value.unloaded_nm, 0, 1.0, "Nm"),
            with_error(one.value.of_torque, 1, 1.0, ""),
            with_error(one.value.of_speed_nm_s2, 2, speed_squared, "Nm"),
        ]);
    }
    let from = format!(
        "{} The amplitude of each order is α + β T + γ ω², with the mean torque T and the speed ω. The table shows the size of each part with its 95 % \
         interval. Where torques or speeds of the recordings are alike, the parts are less certain than their sum.",
        wording::engine_pulses(&KnownPulses::Estimated(pulses.clone()))
    );
    Block::Fold {
        summary: "The firing pulses of the engine".into(),
        blocks: vec![Block::paragraph(from), Block::Table(table)],
    }
}

/// Where J_e of the model comes from.
fn engine_inertia(study: &Study) -> &'static str {
    let has_seen = study.shaft.estimated().and_then(|shaft| shaft.inertias.as_ref());
    match has_seen.is_some_and(|(_, both)| both.parameter(Quantity::EngineInertia).is_some()) {
        true => "J_e is what the bench file and the recordings give together",
        false => "J_e is taken from the bench file",
    }
}

fn notes(study: &Study, whole: &WholeModel) -> Blocks {
    let gain = format!(
        "Far below the resonance the shaft carries J_e/(J_d + J_e) = {} of the dynamometer’s torque. {}. \
         Resonance and static gain depend on it. Neither replays nor sine tests can show that \
         it is wrong, since the engine’s torque is reconstructed with it.",
        number::significant(whole.static_gain, 3),
        engine_inertia(study)
    );
    vec![Block::paragraph(format!("{gain} {}", firing(study, whole))), margins(whole.speed_loop_margins.as_ref())]
        .into()
}

/// The engine speeds to avoid: firing, and its half and quarter orders from unequal cylinders (2.1).
fn firing(study: &Study, whole: &WholeModel) -> String {
    let full = whole.firing_meets_resonance.written().value;
    let speed = |times: f64| number::significant_with_unit(times * full, 3, "rpm");
    let BenchFacts { cylinders, strokes, .. } = study.bench;
    if cylinders == 0 {
        return "Nothing fires at this bench.".to_owned();
    }
    let mut text =
        format!("With {cylinders} cylinders and {strokes} strokes, firing meets the resonance at {}", speed(1.0));
    if strokes == 4 {
        text.push_str(&format!(
            "; unequal cylinders excite it with half the firing frequency at {}, with a quarter of it at {}",
            speed(2.0),
            speed(4.0)
        ));
    }
    text + "."
}

fn margins(margins: Option<&Margins>) -> Block {
    match margins {
        Some(margins) => Block::paragraph(format!(
            "The speed loop crosses unit gain at {}, with a phase margin of {} and a gain margin of {}.",
            number::significant_with_unit(margins.crossover_hz, 3, "Hz"),
            number::significant_with_unit(margins.phase_margin_deg, 2, "°").replace(" °", "°"),
            number::significant_with_unit(margins.gain_margin_db, 3, "dB"),
        )),
        None => Block::note("Margins of the speed loop are not known: the speed control was not estimated."),
    }
}

/// Influence of each parameter on the results computed from the model.
fn influences(whole: &WholeModel) -> Blocks {
    let rows = whole.influences.iter().flat_map(|influence| {
        influence.parameters.iter().enumerate().map(move |(place, one)| {
            let first = place == 0;
            let share = match one.variance_share {
                Some(share) => number::share(share),
                None => "not known".to_owned(),
            };
            vec![
                if first { Prose::symbol(influence.quantity.symbol()).into() } else { Cell::from("") },
                if first { Cell::from(influence.quantity.name()) } else { Cell::from("") },
                Prose::symbol(one.parameter.symbol()).into(),
                number::significant_with_unit(one.elasticity, 2, "%").into(),
                share.into(),
            ]
        })
    });
    let heads =
        ["", "Result", "Parameter", "1 % of it moves the result by", "Part of the variance, were it known exactly"];
    let text = "The effect of every parameter on the results of the model. The last column is the most that a better \
                experiment for this parameter could gain. Parameters that are estimated together share it.";
    vec![Block::paragraph(text), Block::Table(Table::of_text(&heads).with_rows(rows))].into()
}

/// One figure for each pair of input and output; curves of the same pair share it.
fn bode_figures(whole: &WholeModel) -> Blocks {
    let mut pairs: Vec<(&str, &str)> = Vec::new();
    for curve in &whole.bode {
        let pair = (curve.input.as_str(), curve.output.as_str());
        if !pairs.contains(&pair) {
            pairs.push(pair);
        }
    }
    pairs.iter().map(|(input, output)| bode(whole, input, output)).collect()
}

fn bode(whole: &WholeModel, input: &str, output: &str) -> Figure {
    let curves: Vec<&BodeCurve> = whole.bode.iter().filter(|c| c.input == input && c.output == output).collect();
    let unit = curves.first().map(|curve| curve.unit.as_str()).unwrap_or_default();
    let resonates = output == "T_shaft" && curves.iter().any(|curve| curve.mode == ControlMode::Tn);
    let points: &[SinePoint] = if resonates && input == "T_d" { &whole.sine_points } else { &[] };
    let mut gain: Vec<Layer> = if resonates { resonance_layers(&whole.resonance_hz) } else { Vec::new() };
    gain.extend(curves.iter().enumerate().map(|(n, curve)| band(curve, style(n))));
    gain.extend(
        curves
            .iter()
            .enumerate()
            .map(|(n, curve)| Layer::curve(&curve_name(curve), style(n), &curve.frequencies_hz, &curve.gain_db)),
    );
    if resonates && input == "T_d" {
        let label = format!("static gain {}", number::significant(whole.static_gain, 3));
        gain.push(Layer::HorizontalMark { y: decibel(whole.static_gain), label });
    }
    if !points.is_empty() {
        gain.extend(sine_layers(points, decibel));
    }
    let phase = curves
        .iter()
        .enumerate()
        .map(|(n, curve)| Layer::curve(&curve_name(curve), style(n), &curve.frequencies_hz, &curve.phase_deg));
    let panels = vec![
        Panel::new(Axis::linear("gain", "dB"), 190, gain),
        Panel::new(Axis::linear("phase", "°"), 110, phase.collect()),
    ];
    Figure::new(&format!("From {input} to {output}"), Axis::frequency(), panels)
        .with_caption(bode_caption(unit, !points.is_empty()))
}

fn style(number: usize) -> Style {
    [Style::Modelled, Style::Other, Style::Residual, Style::Measured][number % 4]
}

fn curve_name(curve: &BodeCurve) -> String {
    match &curve.variant {
        Some(variant) => format!("{variant} ({})", mode_short(curve.mode)),
        None => mode_short(curve.mode).to_owned(),
    }
}

fn band(curve: &BodeCurve, style: Style) -> Layer {
    Layer::Band {
        name: curve_name(curve),
        style,
        x: Abscissa::Values(rounded(&curve.frequencies_hz)),
        low: rounded(&curve.gain_band_db.0),
        high: rounded(&curve.gain_band_db.1),
    }
}

fn resonance_layers(resonance: &Parameter) -> Vec<Layer> {
    let (low, high) = resonance.interval;
    vec![
        Layer::XRegion { low: Rounded(low), high: Rounded(high), label: String::new() },
        Layer::VerticalMarks {
            x: vec![Rounded(resonance.value)],
            label: format!("resonance {}", number::parameter(resonance)),
        },
    ]
}

/// The sine tests as points, without the contribution of the engine. Those at an engine order, where the two cannot be
/// separated, are a series of their own. `scale` turns a gain into what the axis shows.
fn sine_layers(points: &[SinePoint], scale: impl Fn(f64) -> Rounded) -> Vec<Layer> {
    let (at_order, clear): (Vec<&SinePoint>, Vec<&SinePoint>) = points.iter().partition(|p| p.at_engine_order);
    let series = |name: &str, style: Style, points: &[&SinePoint]| {
        let at = |errors: f64| points.iter().map(|p| scale(shown_gain(p) + errors * p.standard_error)).collect();
        Layer::Points {
            name: name.to_owned(),
            style,
            x: Abscissa::Values(points.iter().map(|p| Rounded(p.frequency_hz)).collect()),
            y: at(0.0),
            low: Some(at(-QUANTILE_95)),
            high: Some(at(QUANTILE_95)),
        }
    };
    let all = [("sine tests", Style::Other, clear), ("sine tests at an engine order", Style::Measured, at_order)];
    all.iter().filter(|(.., points)| !points.is_empty()).map(|(name, style, p)| series(name, *style, p)).collect()
}

/// The gain to set against (7.2): without the part that engine torque caused, where that is known.
fn shown_gain(point: &SinePoint) -> f64 {
    point.gain_corrected_for_engine.unwrap_or(point.gain)
}

fn decibel(gain: f64) -> Rounded {
    Rounded(20.0 * gain.log10())
}

fn bode_caption(unit: &str, with_sines: bool) -> String {
    let mut caption = format!("Gain relative to 1 {unit}; shaded: 95 % band of the model.");
    if with_sines {
        caption.push_str(" Points: gains measured by sine tests, the engine’s part removed, with 95 % intervals of the measured gain.");
    }
    caption
}

fn sine_tests(whole: &WholeModel) -> Blocks {
    if whole.sine_points.is_empty() {
        return Block::note(
            "No sine tests were recorded (Sine_T_TN), so the gain is not checked frequency by frequency.",
        )
        .into();
    }
    vec![Block::heading("Sine tests"), Block::figure(sine_figure(whole)), Block::Table(sine_table(&whole.sine_points))]
        .into()
}

/// Gain as a ratio over the tested frequencies, where a Bode plot is too coarse to show the error bars.
fn sine_figure(whole: &WholeModel) -> Figure {
    let points = &whole.sine_points;
    let highest = points.iter().map(|point| point.frequency_hz).fold(0.0, f64::max);
    let mut layers = Vec::new();
    if let Some(curve) = whole.bode.iter().find(|curve| curve.input == "T_d" && curve.output == "T_shaft") {
        let ratio = |db: &[f64]| db.iter().map(|db| Rounded(10f64.powf(db / 20.0))).collect::<Vec<_>>();
        let (name, x) = ("model".to_owned(), Abscissa::Values(rounded(&curve.frequencies_hz)));
        let (low, high) = (ratio(&curve.gain_band_db.0), ratio(&curve.gain_band_db.1));
        layers.push(Layer::Band { name: name.clone(), style: Style::Modelled, x: x.clone(), low, high });
        layers.push(Layer::Line { name, style: Style::Modelled, x, y: ratio(&curve.gain_db) });
    }
    layers.extend(sine_layers(points, Rounded));
    let panels = vec![Panel::new(Axis::linear("gain", ""), 190, layers)];
    let x = Axis::linear("frequency", "Hz").within(0.0, 1.1 * highest);
    Figure::new("Gain from T_d to T_shaft, sine by sine", x, panels).with_caption(
            "Points: measured, the engine’s part removed, with 95 % intervals of the measured gain. Grey: at an engine order, where the \
                  engine cannot be separated from the dynamometer. Shaded: 95 % band of the model.",
    )
}

fn sine_table(points: &[SinePoint]) -> Table {
    let row = |point: &SinePoint| -> Vec<Cell> {
        let error = QUANTILE_95 * point.standard_error;
        vec![
            number::significant_with_unit(point.frequency_hz, 3, "Hz").into(),
            number::plus_minus(point.gain, error, "").into(),
            number::plus_minus(shown_gain(point), error, "").into(),
            number::to_place_of(point.model_gain, error).into(),
            deviation(point).into(),
            if point.at_engine_order { "at an engine order" } else { "" }.into(),
            Prose::code(&point.file).into(),
        ]
    };
    let headings = [
        "Frequency",
        "Measured gain, ± 95 %",
        "Without the engine’s part, ± as measured",
        "Model",
        "Over model",
        "",
        "Recording",
    ];
    Table::of_text(&headings).with_rows(points.iter().map(row))
}

fn deviation(point: &SinePoint) -> String {
    let percent = 100.0 * (shown_gain(point) / point.model_gain - 1.0);
    match percent {
        p if !p.is_finite() => number::NOT_KNOWN.to_owned(),
        p if p > 0.0 => format!("+{} %", number::significant(p, 2)),
        p => format!("{} %", number::significant(p, 2)),
    }
}
