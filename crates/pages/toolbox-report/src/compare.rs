//! Models compared on recordings.

use ident::validate::Judgement;
use ident::{Dataset, IdentError, Label};
use numerics::null::nan_if_null;
use page::decimal::{percent, significant};
use page::{Align, Block, Page, Table};
use serde::{Deserialize, Serialize};

use crate::blocks::name;
use crate::figures::{Shown, comparison};

/// A model and the recordings it met.
#[derive(Debug, Clone, PartialEq)]
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

/// A model and the recordings it met, in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum MetFacts {
    /// Its responses were judged.
    Judged {
        /// Name of the model.
        model: String,
        /// Its outputs.
        outputs: Vec<Label>,
        /// Names of the recordings.
        recordings: Vec<String>,
        /// Fit of each recording and output, %.
        #[serde(deserialize_with = "nan_if_null")]
        fit_percent: Vec<Vec<f64>>,
        /// Error of each recording and output, in the unit of the output.
        #[serde(deserialize_with = "nan_if_null")]
        rms_error: Vec<Vec<f64>>,
        /// Determinant of the mean square of the errors.
        #[serde(deserialize_with = "nan_if_null")]
        loss: f64,
    },
    /// It cannot be compared.
    Failed {
        /// Name of the model.
        model: String,
        /// The reason.
        error: String,
    },
}

impl Met {
    /// The same in numbers.
    pub fn facts(&self) -> MetFacts {
        let model = self.model.clone();
        match &self.judged {
            Ok(judged) => MetFacts::Judged {
                model,
                outputs: self.data.output_labels().to_vec(),
                recordings: self.data.experiments().iter().map(|e| e.name.clone()).collect(),
                fit_percent: judged.fit_percent.clone(),
                rms_error: judged.rms_error.clone(),
                loss: judged.loss,
            },
            Err(reason) => MetFacts::Failed { model, error: reason.to_string() },
        }
    }
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
