//! Response of a model to recordings: simulated, or predicted some samples ahead.

use ident::validate::Judgement;
use ident::{Dataset, Label};
use numerics::null::nan_if_null;
use page::decimal::percent;
use page::{Block, Page};
use serde::{Deserialize, Serialize};

use crate::blocks::line;
use crate::figures::{Shown, comparison};

/// The response of a model to recordings.
#[derive(Clone, Copy)]
pub struct Responded<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// How it was made to respond: simulated, predicted.
    pub what: &'a str,
    /// The outputs of the model.
    pub outputs: &'a [Label],
    /// The recordings.
    pub data: &'a Dataset,
    /// The response, and how well it fits.
    pub judged: &'a Judgement,
}

/// Response of an output to a recording, in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ResponseFacts {
    /// Name of the recording.
    pub recording: String,
    /// Name of the output.
    pub output: String,
    /// Its unit.
    pub unit: String,
    /// Time of the first value, s.
    pub start_s: f64,
    /// Time between values, s.
    pub sample_time_s: f64,
    /// Fit to the recorded output, %; NaN where it was not recorded.
    #[serde(deserialize_with = "nan_if_null")]
    pub fit_percent: f64,
    /// The values.
    #[serde(deserialize_with = "nan_if_null")]
    pub values: Vec<f64>,
}

impl Responded<'_> {
    /// How well each output is met, and the responses drawn.
    pub fn page(&self) -> Page {
        let sentence = |(n, o): (usize, usize)| {
            let (recording, output) = (&self.data.experiments()[n].name, &self.outputs[o].name);
            line(format!("{recording}: {output} {}, fit {}", self.what, percent(self.judged.fit_percent[n][o])))
        };
        let shown = Shown { name: self.what, data: self.data, response: &self.judged.response };
        let figures = comparison(&[shown]).into_iter().map(Block::figure);
        Page::new(format!("{}, {}", self.model, self.what), self.pairs().map(sentence).chain(figures).collect())
    }

    /// The responses in numbers, one a recording and output.
    pub fn facts(&self) -> Vec<ResponseFacts> {
        let row = |(n, o): (usize, usize)| {
            let (experiment, output) = (&self.data.experiments()[n], &self.outputs[o]);
            ResponseFacts {
                recording: experiment.name.clone(),
                output: output.name.clone(),
                unit: output.unit.clone(),
                start_s: experiment.start_s,
                sample_time_s: self.data.sample_time_s(),
                fit_percent: self.judged.fit_percent[n][o],
                values: self.judged.response.outputs[n].col_as_slice(o).to_vec(),
            }
        };
        self.pairs().map(row).collect()
    }

    /// Recording and output.
    fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        let outputs = self.outputs.len();
        (0..self.judged.response.outputs.len()).flat_map(move |n| (0..outputs).map(move |o| (n, o)))
    }
}
