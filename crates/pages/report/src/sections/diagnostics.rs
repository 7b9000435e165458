//! All findings, grouped by severity, with what to do about each.

use rig::{Diagnostic, Severity};
use study::Study;

use page::{Block, Blocks, Tone};

use crate::wording;

/// The section on findings.
pub(crate) fn section(study: &Study) -> Blocks {
    if study.diagnostics.is_empty() {
        return Block::paragraph("The checks of the recordings and of the bench file found nothing. Each result states how well it is known.").into();
    }
    [Severity::Error, Severity::Warning, Severity::Note].into_iter().map(|severity| group(study, severity)).collect()
}

fn group(study: &Study, severity: Severity) -> Blocks {
    let found: Vec<&Diagnostic> = study.diagnostics.iter().filter(|d| d.severity == severity).collect();
    if found.is_empty() {
        return Blocks::default();
    }
    let mut all = Blocks::from(vec![
        Block::heading(title(severity, found.len())),
        Block::note(format!("{}.", wording::capitalised(wording::severity_meaning(severity)))),
    ]);
    alike(&found).iter().for_each(|same| all.push(entry(same)));
    all
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
pub(crate) fn entry(same: &[&Diagnostic]) -> Blocks {
    let Some(first) = same.first() else { return Blocks::default() };
    let tone = match first.severity {
        Severity::Error => Tone::Bad,
        Severity::Warning => Tone::Caution,
        Severity::Note => Tone::Faint,
    };
    Block::Finding(page::Finding {
        tone,
        severity: wording::severity(first.severity).to_owned(),
        text: wording::finding(&first.finding).into(),
        remedy: Some(wording::advice(&first.finding).into()),
        places: same.iter().filter_map(|d| wording::place(&d.place)).collect(),
    })
    .into()
}
