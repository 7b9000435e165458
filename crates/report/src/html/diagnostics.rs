//! All findings, grouped by severity, with what to do about each.

use bench::{Diagnostic, Severity, Study};

use super::typeset::prose;
use crate::wording;
use page::markup;
use page::markup::Markup;

/// The section on findings.
pub(crate) fn section(study: &Study) -> Markup {
    if study.diagnostics.is_empty() {
        return markup!("<p>Nothing was found that would weaken the results.</p>\n");
    }
    [Severity::Error, Severity::Warning, Severity::Note].into_iter().map(|severity| group(study, severity)).collect()
}

fn group(study: &Study, severity: Severity) -> Markup {
    let found: Vec<&Diagnostic> = study.diagnostics.iter().filter(|d| d.severity == severity).collect();
    if found.is_empty() {
        return Markup::default();
    }
    let entries: Markup = alike(&found).iter().map(|same| entry(same)).collect();
    markup!(
        "<h3>{}</h3>\n<p class=\"note\">{}.</p>\n<ul class=\"findings\">{}</ul>\n",
        title(severity, found.len()),
        wording::capitalised(wording::severity_meaning(severity)),
        entries
    )
}

fn title(severity: Severity, count: usize) -> String {
    let word = wording::severity(severity);
    match count {
        1 => format!("1 {word}"),
        n => format!("{n} {word}s"),
    }
}

/// Findings that say the same of several places, together.
pub(crate) fn alike<'a>(found: &[&'a Diagnostic]) -> Vec<Vec<&'a Diagnostic>> {
    let mut groups: Vec<Vec<&Diagnostic>> = Vec::new();
    for diagnostic in found {
        match groups.iter_mut().find(|group| group.first().is_some_and(|first| first.finding == diagnostic.finding)) {
            Some(group) => group.push(diagnostic),
            None => groups.push(vec![diagnostic]),
        }
    }
    groups
}

/// One finding with every place it was made at.
pub(crate) fn entry(same: &[&Diagnostic]) -> Markup {
    let Some(first) = same.first() else { return Markup::default() };
    let places: Vec<String> = same.iter().filter_map(|d| wording::place(&d.place)).collect();
    let places = match places.as_slice() {
        [] => Markup::default(),
        _ => markup!("<span class=\"where\">{}</span>", places.join(" · ")),
    };
    markup!(
        "<li class=\"severity-{}\"><span class=\"tag\">{}</span><div><p>{}</p><p class=\"todo\">{}</p>{}</div></li>\n",
        wording::severity(first.severity),
        wording::severity(first.severity),
        prose(&wording::finding(&first.finding)),
        prose(wording::advice(&first.finding)),
        places
    )
}
