//! Whose report it is, and of when.

use page::{Prose, Tone};
use study::{Origin, Study};

use crate::wording;

/// Characters of a title at the top of each printed page.
const LONGEST_TITLE: usize = 48;

/// Title at the top: the one that the bench file states, or the bench.
pub(super) fn title(study: &Study) -> String {
    study.provenance.report.title.clone().unwrap_or_else(|| format!("{} – bench model", study.bench.name))
}

/// Statements on the report, and always when and with what it was made.
pub(super) fn subtitle(study: &Study, origin: &Origin) -> Prose {
    let report = &study.provenance.report;
    let mut all = Prose::default();
    if let Some(confidentiality) = &report.confidentiality {
        all = all.then(Prose::tag(Tone::Bad, confidentiality.clone())).then(" ");
    }
    let stated = [
        ("test", &report.test_id),
        ("for", &report.customer),
        ("engine:", &report.engine),
        ("by", &report.author),
        ("approved by", &report.approved_by),
    ];
    for (word, value) in stated.into_iter().filter_map(|(word, value)| Some((word, value.as_ref()?))) {
        all = all.then(Prose::verbatim(format!("{word} {value}"))).then(" · ");
    }
    if report.title.is_some() {
        all = all.then(Prose::verbatim(study.bench.name.clone())).then(" · ");
    }
    all = all.then(format!(
        "{} · {} · studied on {} with dynoid {} · document {}",
        wording::variant(study.bench.variant),
        recordings(study),
        origin.date,
        study.provenance.version,
        document_number(study, origin)
    ));
    match study.provenance.seed {
        Some(seed) => {
            all.then(" · ").then(Prose::tag(Tone::Caution, "simulated recordings")).then(format!(", seed {seed}"))
        }
        None => all,
    }
}

/// The day, and digits that other recordings or another bench file change.
fn document_number(study: &Study, origin: &Origin) -> String {
    let digits = |hash: &str| hash.get(..8).and_then(|digits| u32::from_str_radix(digits, 16).ok()).unwrap_or(0);
    let recordings = study.recordings.iter().map(|recording| digits(&recording.sha256));
    let all = recordings.fold(digits(&origin.bench_file_sha256), |all, one| all ^ one);
    format!("{}-{all:08x}", origin.date.replace('-', ""))
}

/// How many recordings there are, and from when.
fn recordings(study: &Study) -> String {
    let count = match study.recordings.len() {
        1 => "1 recording".to_owned(),
        n => format!("{n} recordings"),
    };
    let days = || study.recordings.iter().filter_map(|recording| recording.recorded_on.as_deref());
    match (days().min(), days().max()) {
        (Some(first), Some(last)) if first == last => format!("{count} of {first}"),
        (Some(first), Some(last)) => format!("{count} of {first} to {last}"),
        _ => count,
    }
}

/// The line at the top of each printed page.
pub(super) fn running_head(study: &Study, origin: &Origin) -> String {
    let report = &study.provenance.report;
    let title = title(study);
    let short = match title.char_indices().nth(LONGEST_TITLE) {
        Some((end, _)) => format!("{}…", title[..end].trim_end()),
        None => title,
    };
    // What must not be lost stands first.
    let number = Some(document_number(study, origin));
    let parts =
        [report.confidentiality.clone(), Some(short), report.test_id.clone(), Some(origin.date.clone()), number];
    parts.into_iter().flatten().collect::<Vec<_>>().join(" · ")
}
