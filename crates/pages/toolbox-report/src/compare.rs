//! Models compared on recordings.

use ident::validate::Judgement;
use ident::{Dataset, IdentError};
use page::decimal::{percent, significant};
use page::{Align, Block, Page, Table};
use serde_json::{Value, json};

use crate::blocks::name;
use crate::figures::{Shown, comparison};

/// A model and the recordings it met.
pub struct Met {
    /// Name of the model.
    pub model: String,
    /// The recordings on its clock.
    pub data: Dataset,
    /// How well it describes them, or why that cannot be said.
    pub judged: Result<Judgement, IdentError>,
}

/// How well each model describes each recording.
pub fn page(all: &[Met]) -> Page {
    let figures = comparison(&all.iter().filter_map(shown).collect::<Vec<_>>());
    let blocks = std::iter::once(Block::Table(table(all))).chain(figures.into_iter().map(Block::figure));
    Page::new("Models compared", blocks.collect())
}

/// The same in numbers.
pub fn json(all: &[Met]) -> Value {
    let row = |met: &Met| match &met.judged {
        Ok(j) => json!({"model": met.model, "outputs": met.data.output_labels(),
            "recordings": met.data.experiments().iter().map(|e| e.name.as_str()).collect::<Vec<_>>(),
            "fit_percent": j.fit_percent, "rms_error": j.rms_error, "loss": j.loss}),
        Err(reason) => json!({"model": met.model, "error": reason.to_string()}),
    };
    all.iter().map(row).collect()
}

fn shown(met: &Met) -> Option<Shown<'_>> {
    let response = &met.judged.as_ref().ok()?.response;
    Some(Shown { name: &met.model, data: &met.data, response })
}

fn table(all: &[Met]) -> Table {
    let columns = [
        ("model", Align::Left),
        ("recording", Align::Left),
        ("output", Align::Left),
        ("fit", Align::Right),
        ("rms error", Align::Right),
    ];
    let mut table = Table::new(&columns);
    for met in all {
        let Ok(judgement) = &met.judged else { continue };
        for (number, experiment) in met.data.experiments().iter().enumerate() {
            for (output, label) in met.data.output_labels().iter().enumerate() {
                table.row([
                    name(&met.model),
                    name(&experiment.name),
                    name(&label.name),
                    percent(judgement.fit_percent[number][output]).into(),
                    name(&format!("{} {}", significant(judgement.rms_error[number][output]), label.unit)),
                ]);
            }
        }
    }
    table
}
