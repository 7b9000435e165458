//! Two bench models, compared: whether the bench is still the same.

use bench_model::document::{BenchModelDocument, DescribedParameter};
use bench_model::model::ModelParameter;
use page::{Align, Block, Blocks, Cell, Finding, Page, Prose, Quantity, Table, Tone};
use serde::Serialize;
use study::{CHANGED, ComparedPart, ModelComparison, ParameterComparison, PartComparison, SourceChanges};

use crate::wording::{self, number};

/// The page of a comparison; the models by the names of their files.
pub fn page(comparison: &ModelComparison, [first, second]: [(&str, &BenchModelDocument); 2]) -> Page {
    let title = title(comparison);
    let tone = if comparison.has_changed() { Tone::Bad } else { Tone::Good };
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
    all.push(Block::paragraph(explanation(comparison)));
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

fn title(comparison: &ModelComparison) -> &'static str {
    if comparison.has_changed() { "The bench has changed" } else { "No change of the bench is found" }
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
            false => Cell::toned("no change found", Tone::Good),
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
        Some(p) if p > 0.99 => "above 99 %".to_owned(),
        Some(p) => format!("{} %", number::significant(100.0 * p, 2)),
    }
}

/// Changes since an earlier study, of this day, in a line; `None` compares with a study that has no model.
pub fn since(date: &str, comparison: Option<&ModelComparison>) -> String {
    let Some(found) = comparison else {
        return format!("The study of {date} in this folder had a model, and this one has none.");
    };
    let changed: Vec<&PartComparison> = found.parts.iter().filter(|part| part.has_changed()).collect();
    let names: Vec<&str> = changed.iter().map(|part| words(part.part)).collect();
    let counted = if changed.is_empty() { found.parts.iter().collect() } else { changed };
    let largest = counted.iter().flat_map(|part| &part.parameters).max_by(|a, b| distance(a).total_cmp(&distance(b)));
    let largest = largest.filter(|one| one.first != one.second).and_then(in_percent);
    let what = match (names.is_empty(), largest) {
        (true, None) => "every number that both have is the same.".to_owned(),
        (true, Some(largest)) => format!("no part has changed beyond chance. The largest difference: {largest}."),
        (false, largest) => {
            let most = largest.map(|largest| format!(" Most of all: {largest}.")).unwrap_or_default();
            format!("changed beyond chance: {}.{most}", wording::join(&names, "and"))
        }
    };
    let names: Vec<&str> = found.only_in_one.iter().map(|one| one.symbol()).collect();
    let only = match names.is_empty() {
        true => String::new(),
        false => format!(" Only one of the two has {}.", wording::join(&names, "and")),
    };
    format!("Since the study of {date}: {what}{only} {}", explanation(found))
}

/// A difference in standard errors, by which those of one comparison are ranked.
fn distance(one: &ParameterComparison) -> f64 {
    match (one.second - one.first).abs() {
        0.0 => 0.0,
        difference => difference / one.standard_error,
    }
}

/// A difference as a part of the first value; of zero there is no part.
fn in_percent(one: &ParameterComparison) -> Option<String> {
    let (symbol, _, _) = wording::model_parameter(one.parameter);
    let percent = |width: f64| 100.0 * width / one.first.abs();
    let shown = percent(one.second - one.first);
    let sign = if shown < 0.0 { "−" } else { "+" };
    let text = format!("{} {sign}{} %", short(one.parameter, symbol), number::significant(shown.abs(), 2));
    (one.first != 0.0).then(|| match one.standard_error > 0.0 {
        true => {
            let half = percent(one.difference.1 - one.difference.0) / 2.0;
            format!("{text} (± {} %)", number::significant(half, 2))
        }
        false => text,
    })
}

/// In what the sources of two models differ, which may explain a difference.
fn explanation(ModelComparison { sources, shared_recordings, .. }: &ModelComparison) -> String {
    let SourceChanges { only_first, only_second, bench_file, dynoid_versions } = sources;
    let files = |files: &[String], what: &str| (!files.is_empty()).then(|| format!("{} {what}", files.join(", ")));
    let mut all: Vec<String> = [files(only_first, "in the first alone"), files(only_second, "in the second alone")]
        .into_iter()
        .flatten()
        .collect();
    if *bench_file {
        all.push("another bench file".to_owned());
    }
    if let Some((first, second)) = dynoid_versions {
        all.push(format!("dynoid {first} and {second}"));
    }
    match (all.is_empty(), shared_recordings.is_empty()) {
        (true, true) => "Neither model names recordings.".to_owned(),
        (true, false) => "Recordings, bench file and dynoid are the same.".to_owned(),
        (false, _) => format!("The sources differ: {}.", all.join("; ")),
    }
}

fn findings(comparison: &ModelComparison) -> Blocks {
    let warning = |text| Block::Finding(Finding::new(Tone::Caution, "warning", text));
    remarks(comparison).into_iter().map(warning).collect()
}

/// Remarks on what the comparison rests on, in words.
fn remarks(comparison: &ModelComparison) -> Vec<String> {
    let mut all = Vec::new();
    let mut warn = |text: String| all.push(text);
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

/// Two bench models, compared, in words and in the units that people use.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparisonFacts {
    changed: bool,
    title: &'static str,
    parts: Vec<PartFacts>,
    /// Remarks on what the comparison rests on.
    remarks: Vec<String>,
    /// Differences between the sources of the models.
    sources: String,
}

/// A part of the bench, compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct PartFacts {
    name: String,
    changed: bool,
    /// Probability of so large a difference by chance, in words.
    chance: String,
    parameters: Vec<ParameterFacts>,
}

/// A parameter in both models.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct ParameterFacts {
    symbol: &'static str,
    name: String,
    unit: &'static str,
    first: ValueFacts,
    second: ValueFacts,
    /// The second less the first.
    difference: f64,
    /// 95 % interval of the difference; none where both count as exact.
    interval_95: Option<(f64, f64)>,
    chance: String,
}

/// A value in one of the models.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct ValueFacts {
    value: f64,
    /// None of a value that counts as exact.
    interval_95: Option<(f64, f64)>,
}

impl ComparisonFacts {
    /// Of a comparison of these models.
    pub fn of(comparison: &ModelComparison, models: [&BenchModelDocument; 2]) -> Self {
        ComparisonFacts {
            changed: comparison.has_changed(),
            title: title(comparison),
            parts: comparison.parts.iter().map(|part| PartFacts::of(part, models)).collect(),
            remarks: remarks(comparison),
            sources: explanation(comparison),
        }
    }
}

impl PartFacts {
    fn of(part: &PartComparison, models: [&BenchModelDocument; 2]) -> Self {
        PartFacts {
            name: wording::capitalised(words(part.part)),
            changed: part.has_changed(),
            chance: chance(part.test.map(|test| test.adjusted_p_value)),
            parameters: part.parameters.iter().filter_map(|one| ParameterFacts::of(one, models)).collect(),
        }
    }
}

impl ParameterFacts {
    fn of(one: &ParameterComparison, models: [&BenchModelDocument; 2]) -> Option<Self> {
        let (symbol, unit, si) = wording::model_parameter(one.parameter);
        let [first, second] = models.map(|model| model.parameters().iter().find(|p| p.parameter == one.parameter));
        let (first, second) = (first?, second?);
        let scaled = |(low, high): (f64, f64)| (low / si, high / si);
        let value =
            |of: &DescribedParameter| ValueFacts { value: of.value / si, interval_95: of.interval_95.map(scaled) };
        Some(ParameterFacts {
            symbol: short(one.parameter, symbol),
            name: first.name.clone(),
            unit,
            first: value(first),
            second: value(second),
            difference: (one.second - one.first) / si,
            interval_95: (one.standard_error > 0.0).then(|| scaled(one.difference)),
            chance: chance(one.p_value),
        })
    }
}
