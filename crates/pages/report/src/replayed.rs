//! Recordings replayed on bench models, as a page.

use bench_model::replay::Replay;
use page::decimal::significant;
use page::{Block, Blocks, Cell, Figure, Page, Prose, Table};
use rig::results::Validation;

use crate::estimates::stretch;
use crate::sections::replays;
use crate::wording::{mode_short, number};

/// A recording replayed on a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Replayed {
    /// Name of the model.
    pub model: String,
    /// The recording on it.
    pub replay: Replay,
}

/// Fit and error of every signal, and the signals measured and modelled.
pub fn page(title: &str, all: &[Replayed]) -> Page {
    let mut blocks = Blocks::from(Block::lead(replays::WHAT));
    blocks.push(table(all));
    for one in all {
        let replay = &one.replay;
        let title = format!("{} on {}", one.model, replay.stretch.file);
        blocks.push(Block::figure(Figure { title, ..replays::signals(replay) }));
    }
    Page::new(title, blocks.into_vec())
}

fn table(all: &[Replayed]) -> Table {
    let heads = ["Model", "Recording and stretch", "Mode", "Used in estimation?", "Signal", "Fit", "RMS error"];
    let signals = all.iter().flat_map(|one| one.replay.signals.iter().map(move |signal| (one, signal)));
    let row = |(one, signal): (&Replayed, &Validation)| {
        let replay = &one.replay;
        let cells: Vec<Cell> = vec![
            Prose::verbatim(&*one.model).into(),
            stretch(&replay.stretch).into(),
            mode_short(replay.mode).into(),
            (if replay.seen_in_estimation { "yes" } else { "no" }).into(),
            Prose::verbatim(&*signal.quantity).into(),
            number::fit(signal.fit_percent).into(),
            format!("{} {}", significant(signal.rms_error), signal.unit).into(),
        ];
        cells
    };
    Table::of_text(&heads).with_rows(signals.map(row))
}
