//! Two bench models, compared: whether the bench is still the same.

use bench_model::document::BenchModelDocument;
use bench_model::model::ModelParameter;
use page::{Align, Block, Blocks, Cell, Finding, Page, Prose, Quantity, Table, Tone};
use study::{CHANGED, ComparedPart, ModelComparison, ParameterComparison, PartComparison};

use crate::wording::{self, number};

/// The page of a comparison; the models by the names of their files.
pub fn page(comparison: &ModelComparison, [first, second]: [(&str, &BenchModelDocument); 2]) -> Page {
    let changed = comparison.has_changed();
    let title = if changed { "The bench has changed" } else { "No change of the bench is found" };
    let tone = if changed { Tone::Bad } else { Tone::Good };
    let mut all = Blocks::from(Block::Callout {
        tone,
        kicker: "Two bench models".to_owned(),
        title: title.to_owned(),
        blocks: vec![Block::Table(parts(comparison))],
    });
    all.push(Block::paragraph(format!(
        "First: {}, {} of {}. Second: {}, {} of {}.",
        first.0, first.1.bench.name, first.1.provenance.date, second.0, second.1.bench.name, second.1.provenance.date
    )));
    all.push(findings(comparison));
    for part in &comparison.parts {
        all.push(Block::heading(wording::capitalised(words(part.part))));
        all.push(Block::Table(parameters(part)));
    }
    all.push(Block::note(format!(
        "Each part has one test of all its parameters (Wald). A part has changed if chance gives so large a difference with a \
         probability below {} %, with allowance for the number of parts. The errors of both models count as independent. What they \
         share, such as a stated inertia, makes the test find less.",
        100.0 * CHANGED
    )));
    Page::new("Two bench models, compared", all.into_vec())
}

fn words(part: ComparedPart) -> &'static str {
    match part {
        ComparedPart::Shaft => "inertias and shaft",
        ComparedPart::SpeedController => "speed controller",
        ComparedPart::FeedForward => "feed-forward",
        ComparedPart::TorqueControl => "torque control",
    }
}

fn parts(comparison: &ModelComparison) -> Table {
    let mut table = Table::new(&[("", Align::Left), ("", Align::Left), ("Chance", Align::Right)]);
    for part in &comparison.parts {
        let verdict = match part.has_changed() {
            true => Cell::toned("changed", Tone::Bad),
            false => Cell::toned("the same", Tone::Good),
        };
        table.row([words(part.part).into(), verdict, chance(part.test.map(|test| test.adjusted_p_value)).into()]);
    }
    table
}

/// A probability.
fn chance(p_value: Option<f64>) -> String {
    match p_value {
        None => "–".to_owned(),
        Some(p) if p < 1e-4 => "below 0.01 %".to_owned(),
        Some(p) => format!("{} %", number::significant(100.0 * p, 2)),
    }
}

fn findings(comparison: &ModelComparison) -> Blocks {
    let mut all = Blocks::default();
    let mut warn = |text: String| all.push(Block::Finding(Finding::new(Tone::Caution, "warning", text)));
    if !comparison.shared_recordings.is_empty() {
        let files = comparison.shared_recordings.join(", ");
        warn(format!("both models come from {files}; the test finds less than it should"));
    }
    if !comparison.different_constants.is_empty() {
        let names: Vec<String> = comparison.different_constants.iter().map(ToString::to_string).collect();
        warn(format!("the models differ in what is no estimate: {}", wording::join(&names, "and")));
    }
    if !comparison.only_in_one.is_empty() {
        let names: Vec<String> = comparison.only_in_one.iter().map(|one| one.symbol().to_owned()).collect();
        warn(format!("only one of the models has {}", wording::join(&names, "and")));
    }
    all
}

fn parameters(part: &PartComparison) -> Table {
    let mut table = Table::new(&[
        ("", Align::Left),
        ("First", Align::Right),
        ("Second", Align::Right),
        ("Difference", Align::Right),
        ("Chance", Align::Right),
    ]);
    for one in &part.parameters {
        table.row(row(one));
    }
    table
}

fn row(one: &ParameterComparison) -> [Cell; 5] {
    let (symbol, unit, si) = wording::model_parameter(one.parameter);
    let value = |si_value: f64| number::significant_with_unit(si_value / si, 5, unit);
    let difference: Cell = match one.standard_error > 0.0 {
        true => {
            let (low, high) = one.difference;
            Quantity::within((one.second - one.first) / si, (low / si, high / si), unit).into()
        }
        false if one.first == one.second => "exact".into(),
        false => Cell::toned("stated differently", Tone::Bad),
    };
    [
        Prose::symbol(short(one.parameter, symbol)).into(),
        value(one.first).into(),
        value(one.second).into(),
        difference,
        chance(one.p_value).into(),
    ]
}

/// Within its own part the symbol of the thesis says enough.
fn short(parameter: ModelParameter, symbol: &'static str) -> &'static str {
    if parameter == ModelParameter::ControllerDelay { parameter.quantity().symbol() } else { symbol }
}
