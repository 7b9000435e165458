//! What is known well, what is not, and why.

use bench::Study;
use bench::study::Analyses;

use super::parts::{table, unbroken};
use super::typeset::{prose, symbol};
use crate::known::{Grade, Known, known};
use crate::wording::number;
use page::markup;
use page::markup::Markup;

/// The section on what is known.
pub(crate) fn section(study: &Study, analyses: Option<&Analyses>) -> Markup {
    let all = known(study, analyses);
    let well = all.iter().filter(|one| one.grade == Grade::Well).count();
    let text = format!(
        "Of {} quantities that make up the model, {well} are known well. ± is half of the 95 % interval: were the campaign repeated many \
         times, 19 of 20 such intervals would hold the truth, provided that the model is of the right kind. Why each is known as well as \
         it is stands beside it; what contradicts it counts against it.",
        all.len()
    );
    let mut section = markup!("<p class=\"lead\">{}</p>\n", prose(&text));
    Grade::ALL.into_iter().for_each(|grade| section.push(group(grade, &all)));
    section
}

fn group(grade: Grade, all: &[Known]) -> Markup {
    let of_grade: Vec<&Known> = all.iter().filter(|one| one.grade == grade).collect();
    let rows: Vec<Vec<Markup>> = of_grade.chunk_by(|a, b| is_alike(a, b)).map(row).collect();
    if rows.is_empty() {
        return Markup::default();
    }
    markup!(
        "<h3>{} <span class=\"tag {}\">{}</span></h3>\n<p class=\"note\">{}</p>\n{}",
        grade.headline(),
        class(grade),
        of_grade.len(),
        prose(grade.meaning()),
        table("known", &["Quantity", "Why"], rows)
    )
}

/// Whether two quantities are of one part and from the same data.
fn is_alike(a: &Known, b: &Known) -> bool {
    a.part == b.part && a.why.first() == b.why.first()
}

/// Quantities that come from the same place, and what is to be said of any of them.
fn row(alike: &[&Known]) -> Vec<Markup> {
    let mut why: Vec<&str> = Vec::new();
    for text in alike.iter().flat_map(|one| &one.why) {
        if !why.contains(&text.as_str()) {
            why.push(text);
        }
    }
    vec![alike.iter().map(|one| quantity(one)).collect(), prose(&why.join(" "))]
}

fn quantity(one: &Known) -> Markup {
    let value = if one.value.contains(number::NOT_KNOWN) { prose(&one.value) } else { unbroken(&one.value) };
    markup!("<p><b>{}</b> {}<br>{}</p>", symbol(&one.symbol), prose(&one.name), value)
}

fn class(grade: Grade) -> &'static str {
    match grade {
        Grade::Well => "good",
        Grade::Roughly | Grade::OnTrust => "reservations",
        Grade::Poorly | Grade::NotAtAll => "insufficient",
    }
}
