//! Where the study came from: recordings, bench facts, the bench file.

use rig::experiment::Choice;
use rig::facts::{BenchFacts, StatedInertia};
use study::{Origin, RecordingSummary, Study};

use page::{Block, Blocks, Cell, Prose, Table};

use crate::wording::{self, number, part, variant};

/// The section on provenance.
pub(crate) fn section(study: &Study, origin: &Origin) -> Blocks {
    let provenance = &study.provenance;
    let seed =
        provenance.seed.map(|seed| format!(" The recordings were simulated with seed {seed}.")).unwrap_or_default();
    let headings = ["Recording", "File", "Recorded on", "Length", "Mean speed", "Sample times", "Used for", "SHA-256"];
    let mut blocks = vec![
        Block::heading("Recordings"),
        Block::Table(Table::of_text(&headings).with_rows(study.recordings.iter().map(recording))),
    ];
    if !study.choices.is_empty() {
        let rows = study.choices.iter().map(|choice| chosen(choice).to_vec());
        blocks.extend([
            Block::heading("Which recording gives which part"),
            Block::Table(Table::of_text(&["Part", "From", "Because"]).with_rows(rows)),
        ]);
    }
    blocks.extend([
        Block::heading("Bench"),
        Block::Table(facts(&study.bench)),
        Block::paragraph(format!("Made on {} with dynoid {}.{seed}", origin.date, provenance.version)),
        Block::heading(Prose::from("Bench file ").then(Prose::code(&provenance.bench_file_name))),
        Block::note(Prose::from("SHA-256: ").then(Prose::code(&origin.bench_file_sha256))),
        Block::Fold {
            summary: "The bench file, word for word".into(),
            blocks: vec![Block::Preformatted { text: provenance.bench_file.clone() }],
        },
    ]);
    blocks.into()
}

fn recording(recording: &RecordingSummary) -> Vec<Cell> {
    let label = recording.label.as_ref().map_or_else(|| "no label".into(), |label| Prose::strong(label.to_string()));
    let used: Vec<String> = recording.used_for.iter().map(|used| part(*used).to_owned()).collect();
    let short: String = recording.sha256.chars().take(12).collect();
    vec![
        label.into(),
        Prose::code(&recording.file).into(),
        recording.recorded_on.clone().unwrap_or_else(|| "–".to_owned()).into(),
        number::duration(recording.duration_s).into(),
        recording.mean_speed_rad_s.map(number::rpm).unwrap_or_else(|| "–".to_owned()).into(),
        rasters(recording).into(),
        if used.is_empty() { "not used".to_owned() } else { used.join(", ") }.into(),
        Prose::code(format!("{short}…")).into(),
    ]
}

/// A part, the recording it is from, and why.
fn chosen(choice: &Choice) -> [Cell; 3] {
    [wording::sought(choice.sought).into(), Prose::code(&choice.file).into(), wording::choice(choice).into()]
}

/// Sample times, each with the roles that share it.
fn rasters(recording: &RecordingSummary) -> Prose {
    let mut times: Vec<f64> = recording.sample_times_s.iter().map(|(_, time)| *time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut all = Prose::default();
    for (n, time) in times.into_iter().enumerate() {
        let roles = recording.sample_times_s.iter().filter(|(_, other)| other.total_cmp(&time).is_eq());
        let between = if n == 0 { "" } else { "; " };
        all = all.then(format!("{between}{}", number::duration(time)));
        all = roles.fold(all, |all, (role, _)| all.then(" ").then(Prose::symbol(role.symbol())));
    }
    all
}

fn inertia(stated: StatedInertia) -> String {
    let value = number::measure(stated.kg_m2, "kg m²");
    let percent = stated.uncertainty_percent;
    match stated.is_uncertainty_stated {
        true if percent == 0.0 => format!("{value}, exact"),
        true => format!("{value}, standard uncertainty {percent} %"),
        false => format!("{value}; no uncertainty is stated, so {percent} % is taken as its standard uncertainty"),
    }
}

fn facts(bench: &BenchFacts) -> Table {
    let optional = |value: Option<f64>, unit: &str| match value {
        Some(value) => number::measure(value, unit),
        None => "not stated".to_owned(),
    };
    let rows = [
        ("", "Name", bench.name.clone()),
        ("", "Torque measurement", variant(bench.variant).to_owned()),
        ("", "Engine", format!("{} cylinders, {} strokes", bench.cylinders, bench.strokes)),
        ("J_d", "Inertia of the dynamometer", inertia(bench.dynamometer_inertia())),
        ("J_e", "Inertia of the engine", inertia(bench.engine_inertia())),
        ("", "Torque limit", optional(bench.torque_limit_nm, "Nm")),
        ("", "Shaft torque limit", optional(bench.shaft_torque_limit_nm, "Nm")),
        ("", "Speed limit", bench.speed_limit_rad_s.map(number::rpm).unwrap_or_else(|| "not stated".to_owned())),
    ];
    let row = |(sign, name, value): (&str, &str, String)| -> Vec<Cell> {
        vec![Prose::symbol(sign).into(), name.into(), Prose::verbatim(value).into()]
    };
    Table::of_text(&["", "Bench fact", "As stated in the bench file"]).with_rows(rows.map(row))
}
