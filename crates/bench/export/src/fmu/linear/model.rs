//! A linear model as the runtime holds it (`linear_file.h`).

use std::fmt::Write as _;

use faer::MatRef;
use ident::uncertainty::Dynamics;
use ident::{IdentError, LinearModel, ModelDocument};
use lti::StateSpace;
use signal::excitation::Random;

use super::super::resource::hexadecimal;
use crate::ExportError;
use crate::draws::SEED;
use crate::error::MOST_STATES;
use crate::fmu::numbers::DRAWS;
use crate::linear::Matrices;

/// An FMU holds no more numbers than these in its draws, and has fewer of them.
const DRAWN_NUMBERS: usize = 40_000;
/// Draws below which there are none.
const FEWEST_DRAWS: usize = 20;
/// Most numbers that the runtime can hold.
const MOST_NUMBERS: usize = 160_000;

/// The matrices of a linear model, and of models that its covariance allows.
pub(super) struct LinearNumbers {
    /// The model on the clock of its data.
    pub(super) system: StateSpace,
    pub(super) sample_time_s: f64,
    /// A, B, C and D row by row, of each draw.
    pub(super) draws: Vec<Vec<f64>>,
}

impl LinearNumbers {
    pub(super) fn of(document: &ModelDocument) -> Result<Self, ExportError> {
        let system = Matrices::of(document)?.discrete.system().clone();
        let estimate = flat(&system);
        let states = system.states();
        if states > MOST_STATES || estimate.len() > MOST_NUMBERS {
            return Err(ExportError::TooLarge { target: "an FMU", states, others: "c, mat or python" });
        }
        let draws = drawn(document, &system)?;
        Ok(LinearNumbers { system, sample_time_s: document.sample_time_s, draws })
    }

    /// The text of `resources/linear.txt`. Numbers are hexadecimal: exact, and the same whatever decimal sign a program
    /// uses.
    pub(super) fn resource(&self, token: &str) -> String {
        let count = |count: usize| hexadecimal(count as f64);
        let mut text = format!("dynoid-linear 0x1p+0\n{token}\n# states, inputs, outputs, draws, sample time in s\n");
        let system = &self.system;
        let sizes = [system.states(), system.inputs(), system.outputs(), self.draws.len()].map(count).join(" ");
        let _ = writeln!(text, "{sizes} {}", hexadecimal(self.sample_time_s));
        for numbers in std::iter::once(&flat(system)).chain(&self.draws) {
            let written: Vec<String> = numbers.iter().map(|number| hexadecimal(*number)).collect();
            let _ = writeln!(text, "{}", written.join(" "));
        }
        text.push_str("end\n");
        text
    }
}

/// A, B, C and D, each row by row.
fn flat(system: &StateSpace) -> Vec<f64> {
    [system.a(), system.b(), system.c(), system.d()].into_iter().flat_map(rows).collect()
}

/// The numbers of a matrix row by row.
pub(super) fn rows(m: MatRef<'_, f64>) -> Vec<f64> {
    (0..m.nrows()).flat_map(|i| (0..m.ncols()).map(move |j| m[(i, j)])).collect()
}

/// Models that the covariance allows, as far as they have the sizes of the estimate and are stable where it is. None
/// without a covariance, and none where there would be few.
fn drawn(document: &ModelDocument, system: &StateSpace) -> Result<Vec<Vec<f64>>, ExportError> {
    let count = DRAWS.min(DRAWN_NUMBERS / flat(system).len().max(1));
    if count < FEWEST_DRAWS || document.estimate.as_ref().is_none_or(|estimate| estimate.covariance.is_empty()) {
        return Ok(Vec::new());
    }
    let is_stable = document.model.system().and_then(|own| own.is_stable()).map_err(IdentError::from)?;
    let samples = document.fit()?.sample(count, &mut Random::new(SEED))?;
    let usable = samples.models.into_iter().filter(|sample| sample.stable || !is_stable);
    let matrices = |model: ident::AnyModel| {
        let form = model.innovations(document.sample_time_s, document.intersample).ok()?;
        let numbers = flat(form.system());
        (numbers.len() == flat(system).len() && form.system().states() == system.states()).then_some(numbers)
    };
    let draws: Vec<Vec<f64>> = usable.filter_map(|sample| matrices(sample.model)).collect();
    Ok(if draws.len() < FEWEST_DRAWS { Vec::new() } else { draws })
}
