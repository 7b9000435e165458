//! Recordings replayed on the assembled model.

use bench_model::replay::Replay;
use rig::results::Validation;
use study::Study;

use page::{Axis, Block, Blocks, Cell, Figure, Panel, Prose, Style, Table, Tone};

use super::parts::stretch;
use super::plots::{difference, trace_layer};
use crate::wording::{capitalised, experiment, mode, number};

/// What a replay is.
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
            Prose::code(&replay.stretch.file).into(),
            seen(replay.seen_in_estimation).into(),
            replay.signals.iter().fold(Prose::default(), fit).into(),
        ]
    };
    Table::of_text(&["Recording", "File", "Used in estimation?", "Fit"]).with_rows(replays.iter().map(row))
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

/// Of a replay, the signal with the lowest fit and what is left of it: small enough for a first page.
pub(crate) fn headline(replay: &Replay) -> Option<Figure> {
    let worst = replay.signals.iter().min_by(|a, b| a.fit_percent.total_cmp(&b.fit_percent))?;
    let mut panels = vec![signal(worst)];
    panels.extend(worst_residual(replay));
    panels.iter_mut().zip([110, 50]).for_each(|(panel, height)| panel.height = height);
    let title = format!("Replay of {}: {}, the signal with the lowest fit", replay.label, worst.quantity);
    let caption = match replay.seen_in_estimation {
        true => "Part of the model was estimated from this recording.",
        false => "No part of the model was estimated from this recording.",
    };
    Some(Figure::new(&title, Axis::time(), panels).with_caption(caption).of_recording(&replay.stretch.file))
}

/// All signals below each other on one time axis, each with its fit.
pub(crate) fn signals(replay: &Replay) -> Figure {
    let panels = replay.signals.iter().map(signal).chain(worst_residual(replay)).collect();
    let caption = match replay.seen_in_estimation {
        true => "Part of the model was estimated from this recording.",
        false => "No part of the model was estimated from this recording.",
    };
    Figure::new("Measured and modelled", Axis::time(), panels).with_caption(caption).of_recording(&replay.stretch.file)
}

fn signal(signal: &Validation) -> Panel {
    let measured = trace_layer("measured", Style::Measured, &signal.measured);
    let modelled = trace_layer("modelled", Style::Modelled, &signal.modelled);
    Panel::new(Axis::linear(&signal.quantity, &signal.unit), 120, vec![measured, modelled])
        .noted(format!("fit {}", number::fit(signal.fit_percent)))
}

/// What is left of the signal the model explains least.
fn worst_residual(replay: &Replay) -> Option<Panel> {
    let worst = replay.signals.iter().min_by(|a, b| a.fit_percent.total_cmp(&b.fit_percent))?;
    let left_over = vec![trace_layer("residual", Style::Residual, &difference(worst))];
    let panel = Panel::new(Axis::linear(&format!("{} − model", worst.quantity), &worst.unit), 80, left_over);
    Some(panel.noted("of the signal with the lowest fit".to_owned()))
}
