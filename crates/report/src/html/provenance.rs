//! Where the study came from: recordings, bench facts, the bench file.

use bench::Study;
use bench::study::{BenchFacts, RecordingSummary};

use super::parts::{table, unbroken};
use super::typeset::symbol;
use crate::wording::{experiment, number, part, variant};
use page::markup;
use page::markup::Markup;

/// The section on provenance.
pub(crate) fn section(study: &Study) -> Markup {
    let provenance = &study.provenance;
    let seed =
        provenance.seed.map(|seed| format!(" The recordings were simulated with seed {seed}.")).unwrap_or_default();
    markup!(
        "<h3>Recordings</h3>\n{}<h3>Bench</h3>\n{}<p>Made with dynoid {}.{}</p>\n\
         <h3>Bench file <span class=\"file\">{}</span></h3>\n<pre class=\"bench-file\">{}</pre>\n",
        table(
            "recordings",
            &["Recording", "Length", "Mean speed", "Sample times", "Used for", "SHA-256"],
            study.recordings.iter().map(recording)
        ),
        facts(&study.bench),
        provenance.version,
        seed,
        provenance.bench_file_name,
        provenance.bench_file,
    )
}

fn recording(recording: &RecordingSummary) -> Vec<Markup> {
    let label = match &recording.label {
        Some(label) => markup!("<strong title=\"{}\">{}</strong><br>", experiment(label).unwrap_or_default(), label),
        None => markup!("<em>no label</em><br>"),
    };
    let used: Vec<String> = recording.used_for.iter().map(|name| part(name).to_owned()).collect();
    let used =
        if used.is_empty() { markup!("<span class=\"none\">not used</span>") } else { markup!("{}", used.join(", ")) };
    let short: String = recording.sha256.chars().take(12).collect();
    vec![
        markup!("{}<span class=\"file\">{}</span>", label, recording.file),
        unbroken(&number::duration(recording.duration_s)),
        unbroken(&recording.mean_speed_rad_s.map(number::rpm).unwrap_or_else(|| "–".to_owned())),
        rasters(recording),
        used,
        markup!("<code title=\"{}\">{}…</code>", recording.sha256, short),
    ]
}

/// Sample times, with the roles that share one on one line.
fn rasters(recording: &RecordingSummary) -> Markup {
    let mut times: Vec<f64> = recording.sample_times_s.iter().map(|(_, time)| *time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let line = |time: f64| -> Markup {
        let roles = recording.sample_times_s.iter().filter(|(_, other)| other.total_cmp(&time).is_eq());
        let roles: Markup = roles.map(|(role, _)| markup!(" {}", symbol(role.symbol()))).collect();
        markup!("<div class=\"raster\"><span class=\"n\">{}</span><span>{}</span></div>", number::duration(time), roles)
    };
    times.into_iter().map(line).collect()
}

fn inertia(kg_m2: f64, uncertainty_percent: Option<f64>) -> String {
    let value = number::measure(kg_m2, "kg m²");
    match uncertainty_percent {
        Some(percent) => format!("{value}, standard uncertainty {percent} %"),
        None => value,
    }
}

fn facts(bench: &BenchFacts) -> Markup {
    let optional = |value: Option<f64>, unit: &str| match value {
        Some(value) => number::measure(value, unit),
        None => "not stated".to_owned(),
    };
    let rows = [
        ("", "Name", bench.name.clone()),
        ("", "Torque measurement", variant(bench.variant).to_owned()),
        ("", "Engine", format!("{} cylinders, {} strokes", bench.cylinders, bench.strokes)),
        (
            "J_d",
            "Inertia of the dynamometer",
            inertia(bench.dynamometer_inertia_kg_m2, bench.dynamometer_inertia_uncertainty_percent),
        ),
        ("J_e", "Inertia of the engine", inertia(bench.engine_inertia_kg_m2, bench.engine_inertia_uncertainty_percent)),
        ("", "Torque limit of the inverter", optional(bench.torque_limit_nm, "Nm")),
        ("", "Shaft torque limit", optional(bench.shaft_torque_limit_nm, "Nm")),
        ("", "Speed limit", bench.speed_limit_rad_s.map(number::rpm).unwrap_or_else(|| "not stated".to_owned())),
    ];
    table(
        "facts",
        &["", "Bench fact", "As stated in the bench file"],
        rows.map(|(sign, name, value)| vec![symbol(sign), markup!("{}", name), markup!("{}", value)]),
    )
}
