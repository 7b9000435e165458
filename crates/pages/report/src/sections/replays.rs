//! Recordings replayed on the assembled model.

use bench_model::replay::Replay;
use rig::results::{Trace, Validation};
use study::Study;

use page::{Axis, Block, Blocks, Cell, Figure, Panel, Prose, Style, Table, Tone};

use crate::estimates::stretch;
use crate::plots::{difference, trace_layer};
use crate::wording::{capitalised, experiment, mode, number};

/// As much of a replay is shown on the first page, s.
const HEADLINE_S: f64 = 2.0;

/// Description of a replay.
pub(crate) const WHAT: &str = "The whole model runs on the recorded demand and on the engine torque reconstructed from N_e and \
                               T_shaft. Its response is compared with the measurement.";

/// The section on replays.
pub(crate) fn section(study: &Study) -> Blocks {
    if study.replays.is_empty() {
        return vec![
            Block::lead(WHAT),
            Block::paragraph(
                Prose::strong("No recording was replayed.")
                    .then(" The model as a whole has not been compared with a measurement."),
            ),
        ]
        .into();
    }
    let mut all = Blocks::from(Block::lead(WHAT));
    all.push(overview(&study.replays));
    let fold = |one: &Replay| Block::Fold {
        summary: Prose::verbatim(format!("{}, {}", one.label, one.stretch.file)),
        blocks: replay(one).into_vec(),
    };
    // The first shows what a replay is; all of them are in the table above.
    all.push(study.replays.iter().take(1).map(replay).collect::<Blocks>());
    all.push(study.replays.iter().skip(1).map(fold).map(Blocks::from).collect::<Blocks>());
    all
}

fn overview(replays: &[Replay]) -> Table {
    let fit = |all: Prose, signal: &Validation| {
        let between = if all.is_empty() { "" } else { ", " };
        all.then(between).then(&*signal.quantity).then(format!(" {}", number::fit(signal.fit_percent)))
    };
    let row = |replay: &Replay| -> Vec<Cell> {
        vec![
            Prose::strong(replay.label.to_string()).into(),
            stretch(&replay.stretch).into(),
            seen(replay.seen_in_estimation).into(),
            replay.signals.iter().fold(Prose::default(), fit).into(),
        ]
    };
    Table::of_text(&["Recording", "Stretch", "Used in estimation?", "Fit"]).with_rows(replays.iter().map(row))
}

fn seen(seen_in_estimation: bool) -> Prose {
    match seen_in_estimation {
        true => Prose::tag(Tone::Faint, "seen").then(" part of the model comes from this recording"),
        false => Prose::tag(Tone::Good, "unseen").then(" no part of the model has seen it"),
    }
}

fn replay(replay: &Replay) -> Blocks {
    let described = experiment(&replay.label).map(|words| format!("{words}. ")).unwrap_or_default();
    let text = Prose::from(capitalised(&described))
        .then(format!("{}. ", capitalised(mode(replay.mode))))
        .then(stretch(&replay.stretch))
        .then(". ")
        .then(seen(replay.seen_in_estimation))
        .then(".");
    vec![
        Block::heading(Prose::verbatim(replay.label.to_string())),
        Block::paragraph(text),
        Block::figure(signals(replay)),
    ]
    .into()
}

/// The lowest fit of a replay's signals, %.
pub(crate) fn lowest_fit(replay: &Replay) -> f64 {
    replay.signals.iter().map(|signal| signal.fit_percent).fold(f64::INFINITY, f64::min)
}

/// Of a replay, the signal with the lowest fit and what is left of it, where it errs most: small enough for a first
/// page, and short enough that measured and modelled are seen apart.
pub(crate) fn headline(replay: &Replay) -> Option<Figure> {
    let worst = replay.signals.iter().min_by(|a, b| a.fit_percent.total_cmp(&b.fit_percent))?;
    let shown = where_it_errs_most(worst);
    let mut panels = vec![signal(&shown), left_over(&shown)];
    panels.iter_mut().zip([110, 50]).for_each(|(panel, height)| panel.height = height);
    let what = if replay.seen_in_estimation { "Replay" } else { "Worst replay of an unseen recording" };
    let title = format!("{what}, {}: {}, the signal with the lowest fit", replay.label, worst.quantity);
    let (part, whole) = (shown.measured.values.len(), worst.measured.values.len());
    let duration = |samples: usize| number::duration(samples as f64 * worst.measured.sample_time_s);
    let part = match part < whole {
        true => format!("The {} of {} in which the model errs most. ", duration(part), duration(whole)),
        false => String::new(),
    };
    let caption = format!("{part}{}", origin(replay));
    Some(Figure::new(&title, Axis::time(), panels).with_caption(caption))
}

/// The stretch of a replayed signal with the largest errors; all of it where it is short.
fn where_it_errs_most(signal: &Validation) -> Validation {
    let errors = difference(signal).values;
    let length = (HEADLINE_S / signal.measured.sample_time_s).round().max(2.0) as usize;
    if errors.len() < 2 * length {
        return signal.clone();
    }
    let power =
        |from: &usize| -> f64 { errors[*from..*from + length].iter().filter(|e| e.is_finite()).map(|e| e * e).sum() };
    let starts = (0..=errors.len() - length).step_by(length.div_ceil(2));
    let from = starts.max_by(|a, b| power(a).total_cmp(&power(b))).unwrap_or(0);
    let cut = |trace: &Trace| Trace {
        start_s: trace.start_s + from as f64 * trace.sample_time_s,
        values: trace.values[from..from + length].to_vec(),
        ..trace.clone()
    };
    Validation { measured: cut(&signal.measured), modelled: cut(&signal.modelled), ..signal.clone() }
}

/// Role of a recording for the model: it has seen it or not.
fn origin(replay: &Replay) -> &'static str {
    match replay.seen_in_estimation {
        true => "Part of the model was estimated from this recording.",
        false => "No part of the model was estimated from this recording.",
    }
}

/// All signals below each other on one time axis, each with its fit.
pub(crate) fn signals(replay: &Replay) -> Figure {
    let panels = replay.signals.iter().map(signal).chain(worst_residual(replay)).collect();
    Figure::new("Measured and modelled", Axis::time(), panels)
        .with_caption(origin(replay))
        .of_recording(&replay.stretch.file)
}

fn signal(signal: &Validation) -> Panel {
    let measured = trace_layer("measured", Style::Measured, &signal.measured);
    let modelled = trace_layer("modelled", Style::Modelled, &signal.modelled);
    Panel::new(Axis::linear(&signal.quantity, &signal.unit), 120, vec![measured, modelled])
        .noted(format!("fit {}", number::fit(signal.fit_percent)))
}

/// Residual of the signal that the model explains least.
fn worst_residual(replay: &Replay) -> Option<Panel> {
    replay.signals.iter().min_by(|a, b| a.fit_percent.total_cmp(&b.fit_percent)).map(left_over)
}

/// Residual of a signal.
fn left_over(signal: &Validation) -> Panel {
    let residual = vec![trace_layer("residual", Style::Residual, &difference(signal))];
    let panel = Panel::new(Axis::linear(&format!("{} − model", signal.quantity), &signal.unit), 80, residual);
    panel.noted("of the signal with the lowest fit".to_owned())
}
