//! The operating point that a linear model is about.

use ident::{Line, ModelDocument};

/// The levels that were taken off the channels before the estimate, in their units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Levels {
    pub(crate) inputs: Vec<f64>,
    pub(crate) outputs: Vec<f64>,
}

impl Levels {
    /// Zero where nothing was taken off; `None` where recordings have levels of their own, or where levels drift.
    pub(crate) fn of(document: &ModelDocument) -> Option<Self> {
        let Some(trend) = &document.trend else {
            return Some(Levels {
                inputs: vec![0.0; document.inputs.len()],
                outputs: vec![0.0; document.outputs.len()],
            });
        };
        let level = |line: &Line| (line.slope_per_s == 0.0).then_some(line.level);
        let of = |lines: &[Line]| lines.iter().map(level).collect::<Option<Vec<f64>>>();
        (trend.count() == 1).then_some(())?;
        Some(Levels { inputs: of(trend.inputs(0))?, outputs: of(trend.outputs(0))? })
    }
}

/// A sentence about the levels, in ASCII.
pub(crate) fn sentence(document: &ModelDocument) -> String {
    let listed = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    match Levels::of(document) {
        _ if document.trend.is_none() => "Inputs and outputs are absolute values.".to_owned(),
        Some(Levels { inputs, outputs }) => format!(
            "Inputs and outputs are differences from levels. Levels of the inputs: {}; of the outputs: {}.",
            listed(&inputs),
            listed(&outputs)
        ),
        None => "Inputs and outputs are differences from the mean or trend of each recording.".to_owned(),
    }
}
