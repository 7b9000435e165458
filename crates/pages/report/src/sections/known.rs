//! Quantities that are known well, those that are not, and why.

use study::known::Grade;
use study::{Analyses, Study};

use page::{Block, Blocks, Cell, Prose, Table, Tone};

use crate::known::{Worded, headline, known, meaning};

/// The section on what is known.
pub(crate) fn section(study: &Study, analyses: Option<&Analyses>) -> Blocks {
    let all = known(study, analyses);
    let well = all.iter().filter(|one| one.grade == Grade::Well).count();
    let text = format!(
        "Of {} quantities that make up the model, {well} are known well. ± is half of the 95 % interval: if the \
         campaign were repeated many times, 19 of 20 such intervals would contain the true value. This assumes that \
         the model is of the right kind. The last column says why each is known as well as it is; what contradicts a \
         value counts against it.",
        all.len()
    );
    let mut section = Blocks::from(Block::lead(text));
    Grade::ALL.into_iter().for_each(|grade| section.push(group(grade, &all)));
    section
}

/// Quantities that are known poorly, taken on trust, or not known, each with the last reason for it.
pub(crate) fn not_known(study: &Study) -> Blocks {
    let all = known(study, None);
    let poor = all.iter().filter(|one| one.grade >= Grade::Poorly);
    let row = |one: &Worded| -> Vec<Cell> {
        let why = one.why.last().cloned().unwrap_or_default();
        vec![Prose::symbol(one.symbol).then(" ").then(&*one.name).into(), headline(one.grade).into(), why.into()]
    };
    let rows: Vec<Vec<Cell>> = poor.map(row).collect();
    if rows.is_empty() {
        return Blocks::default();
    }
    let table = Table::of_text(&["Quantity", "How well", "Why"]).with_rows(rows);
    vec![Block::heading("What is not known, or known poorly"), Block::Table(table)].into()
}

fn group(grade: Grade, all: &[Worded]) -> Blocks {
    let of_grade: Vec<&Worded> = all.iter().filter(|one| one.grade == grade).collect();
    let rows: Vec<Vec<Cell>> = of_grade.chunk_by(|a, b| is_alike(a, b)).flat_map(rows).collect();
    if rows.is_empty() {
        return Blocks::default();
    }
    vec![
        Block::heading(
            Prose::from(headline(grade)).then(" ").then(Prose::tag(tone(grade), of_grade.len().to_string())),
        ),
        Block::note(meaning(grade)),
        Block::Table(Table::of_text(&["", "Quantity", "Value", "Why"]).with_rows(rows)),
    ]
    .into()
}

/// Tells whether two quantities are of one part and from the same data.
fn is_alike(a: &Worded, b: &Worded) -> bool {
    a.part == b.part && a.why.first() == b.why.first()
}

/// Quantities that come from the same place, a row each, and beside the first what is to be said of any of them.
fn rows(alike: &[&Worded]) -> Vec<Vec<Cell>> {
    let mut why: Vec<&str> = Vec::new();
    for text in alike.iter().flat_map(|one| &one.why) {
        if !why.contains(&text.as_str()) {
            why.push(text);
        }
    }
    let reasons = |n: usize| if n == 0 { why.join(" ") } else { String::new() };
    let row = |(n, one): (usize, &&Worded)| -> Vec<Cell> {
        vec![Prose::symbol(one.symbol).into(), Cell::from(&one.name), Cell::from(&one.value), reasons(n).into()]
    };
    alike.iter().enumerate().map(row).collect()
}

fn tone(grade: Grade) -> Tone {
    match grade {
        Grade::Well => Tone::Good,
        Grade::Roughly | Grade::OnTrust => Tone::Caution,
        Grade::Poorly | Grade::NotAtAll => Tone::Bad,
    }
}
