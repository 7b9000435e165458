//! Pieces several sections share: parameter tables, what is missing, where data came from.

use page::{Align, Block, Blocks, Cell, Prose, Table};
use rig::results::{Estimate, Parameter, Reason, Stretch, Validation};

use crate::wording::{self, number};

/// The parameters of an estimate and numbers derived from them with their 95 % intervals, and below what they rest on.
pub(crate) fn parameters(estimate: &Estimate, derived: &[&Parameter]) -> Blocks {
    let mut all = Blocks::from(parameter_table(estimate.parameters.iter().chain(derived.iter().copied())));
    all.push(basis(estimate));
    all
}

/// A table of parameters.
pub(crate) fn parameter_table<'a>(parameters: impl IntoIterator<Item = &'a Parameter>) -> Table {
    let columns =
        [("", Align::Left), ("Parameter", Align::Left), ("Estimate", Align::Right), ("95 % interval", Align::Right)];
    let row = |parameter: &Parameter| -> Vec<Cell> {
        let quantity = number::quantity(parameter);
        vec![
            Prose::symbol(parameter.quantity.symbol()).into(),
            Cell::from(parameter.quantity.name()),
            quantity.clone().into(),
            Cell::interval(quantity),
        ]
    };
    Table::new(&columns).with_rows(parameters.into_iter().map(row))
}

fn basis(estimate: &Estimate) -> Block {
    let solution = match estimate.iterations {
        0 => "direct solution".to_owned(),
        1 => "1 iteration".to_owned(),
        n => format!("{n} iterations"),
    };
    let freedom = estimate.parameters.first().map(|p| p.degrees_of_freedom).filter(|f| f.is_finite());
    let freedom = freedom.map(|f| format!("{f:.0} degrees of freedom, ")).unwrap_or_default();
    Block::note(Prose::from("Estimated from ").then(stretches(&estimate.stretches)).then(format!(
        ". {}, condition number {}.",
        wording::capitalised(&format!("{freedom}{solution}")),
        number::significant_with_unit(estimate.condition, 3, "")
    )))
}

/// Stretches of recordings, in words.
pub(crate) fn stretches(stretches: &[Stretch]) -> Prose {
    let mut listed = stretches.iter().map(stretch);
    let Some(first) = listed.next() else { return "data that were not stated".into() };
    listed.fold(first, |all, next| all.then("; ").then(next))
}

/// One stretch, e.g. `bs.mf4, 10.0–60.0 s`.
pub(crate) fn stretch(stretch: &Stretch) -> Prose {
    let (start, end) = (seconds(stretch.start_s), seconds(stretch.end_s));
    Prose::code(&stretch.file).then(format!(", {start}–{end} s"))
}

/// A moment to a tenth of a second.
pub(crate) fn seconds(value: f64) -> String {
    if value.is_finite() { format!("{value:.1}") } else { "?".to_owned() }
}

/// The text in place of a part that was not estimated.
pub(crate) fn not_estimated(what: &str, needs: &[Reason]) -> Blocks {
    let items = match needs {
        [] => vec![wording::needs(needs).into()],
        _ => needs.iter().map(|need| wording::need(need).into()).collect(),
    };
    vec![
        Block::paragraph(Prose::strong("Not estimated.").then(" ").then(what)),
        Block::paragraph("It needs:"),
        Block::List { items },
    ]
    .into()
}

/// The fit on a held-out stretch, as a sentence.
pub(crate) fn fit_line(validation: &Validation) -> Block {
    Block::paragraph(
        Prose::from("Fit on data the estimate has not seen (")
            .then(stretch(&validation.stretch))
            .then("): ")
            .then(Prose::strong(number::fit(validation.fit_percent)))
            .then(format!(", rms error {}.", number::significant_with_unit(validation.rms_error, 3, &validation.unit))),
    )
}

/// A plain sentence at the head of a part, and its equation.
pub(crate) fn lead(sentence: &str, equation: &str) -> Blocks {
    vec![Block::lead(sentence), Block::equation(equation)].into()
}
