//! `dynoid demo`: a bench whose every parameter is known, its recordings, and a study of them beside the truth.

mod comparison;

use std::path::{Path, PathBuf};

use demo::campaign::{self, Planned};
use demo::comparison::{Row, rows};
use demo::effects::{Effects, ShaftZeros};
use dynoid::pages::html;
use dynoid::{Files, MODEL, Mark, OutputFolder, StudyOptions, WrittenStudy, check_replaceable, encode_mdf4};
use rig::BenchFile;
use rig::bench_parameters::BenchParameters;

use crate::cli::bench::DemoArguments;
use crate::commands::study;
use crate::error::{CliError, Outcome};
use crate::summary::{self, shown};
use crate::terminal::Terminal;
use numerics::parallel;
use page::{Block, Page, Prose};
use work::Context;

const RECORDINGS: &str = "recordings";
const BENCH_FILE: &str = "bench.toml";
const EFFECTS: &str = "effects.html";
/// The first line of the bench file that the demo writes, with its mark.
const FIRST_LINE: &str =
    concat!("# Written by dynoid demo ", env!("CARGO_PKG_VERSION"), ": the bench file of a simulated bench.");

pub(crate) fn run(arguments: &DemoArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let out = &arguments.out;
    let parameters = BenchParameters::default();
    let plans = campaign::plans();
    let names: Vec<String> = plans.iter().map(|plan| plan.file_name.clone()).collect();
    check_folder(out, &names, &terminal.files())?;
    let recordings = simulate_all(&parameters, &plans, arguments.seed, terminal.work(), &terminal.files())?;
    let folder = out.join(RECORDINGS);
    let files: Vec<(&str, &[u8])> =
        names.iter().map(String::as_str).zip(recordings.iter().map(Vec::as_slice)).collect();
    OutputFolder::check(&folder, &terminal.files())?.write(&files)?;
    let effects = html(&effects(&parameters, arguments.seed)?, &terminal.files());
    dynoid::replace_file(&out.join(EFFECTS), effects.as_bytes(), &terminal.files())?;
    let bench = out.join(BENCH_FILE);
    dynoid::replace_file(&bench, bench_file(&parameters).as_bytes(), &terminal.files())?;
    let written = study::study(&bench, out, Some(arguments.seed), StudyOptions::default(), terminal)?;
    let rows = rows(&written.study, &parameters);
    if arguments.json {
        terminal.json(&comparison::Document::new(arguments.seed, &written, &bench, &rows))?;
    } else if !terminal.is_quiet() {
        terminal.page(&page(&written, &bench, &rows));
    }
    Ok(summary::outcome(&written.study))
}

/// Simulates the experiments on all cores; returns the recordings' bytes in their order. Every experiment has a seed of
/// its own, counted from `seed`.
fn simulate_all(
    parameters: &BenchParameters,
    plans: &[Planned],
    seed: u64,
    context: &Context,
    files: &Files,
) -> Result<Vec<Vec<u8>>, CliError> {
    let seeded: Vec<(&Planned, u64)> = plans.iter().zip(seed..).collect();
    let record = |(planned, seed): &(&Planned, u64)| {
        let recording = planned.record(parameters, *seed).map_err(CliError::internal)?;
        Ok(encode_mdf4(&recording, files)?)
    };
    parallel::map_as_step(context, "simulating the bench", &seeded, record).into_iter().collect()
}

/// The page of what the bench shows, its two parts at the same time.
fn effects(parameters: &BenchParameters, seed: u64) -> Result<Page, CliError> {
    let file = campaign::bench_file(parameters, RECORDINGS);
    let (effects, zeros) = parallel::join(|| Effects::of(parameters, seed), || ShaftZeros::of(parameters, &file, seed));
    Ok(report::effects(&effects.map_err(CliError::internal)?, &zeros.map_err(CliError::internal)?))
}

/// The bench file, as text.
fn bench_file(parameters: &BenchParameters) -> String {
    let file: BenchFile = campaign::bench_file(parameters, &format!("{RECORDINGS}/*.mf4"));
    format!(
        "{FIRST_LINE}\n# Change what you like and run `dynoid study {BENCH_FILE}`; the next demo in this folder \
         writes it anew.\n\n{}",
        file.to_toml()
    )
}

/// Refuses a folder with things in it that are not the demo's.
fn check_folder(out: &Path, recordings: &[String], files: &Files) -> Result<(), CliError> {
    OutputFolder::check(out, files)?;
    let refuse = |found: PathBuf| CliError::NotADemoFolder { path: out.to_owned(), found: shown(&found) };
    check_replaceable(&out.join(BENCH_FILE), Some(&Mark::of_run(files)), files)?;
    let own = |name: &str| {
        let of_study = [dynoid::REPORT, dynoid::FULL_REPORT, dynoid::DATA, dynoid::SERIES, MODEL, "study"];
        let on_paper = [dynoid::REPORT_PDF, dynoid::FULL_REPORT_PDF, dynoid::SUMMARY_PDF];
        [RECORDINGS, BENCH_FILE, EFFECTS].iter().chain(&of_study).chain(&on_paper).any(|own| *own == name)
    };
    for file in recordings.iter().map(|name| out.join(RECORDINGS).join(name)).chain([out.join(EFFECTS)]) {
        check_replaceable(&file, Some(&Mark::of_run(files)), files)?;
    }
    let foreign = stranger(out, own)
        .or_else(|| stranger(&out.join(RECORDINGS), |name| recordings.iter().any(|recording| recording == name)));
    foreign.map_or(Ok(()), |found| Err(refuse(found)))
}

/// Something in the folder that is neither hidden nor expected.
fn stranger(folder: &Path, expected: impl Fn(&str) -> bool) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.filter_map(Result::ok);
    let mut strangers = entries.filter(|entry| {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        !name.starts_with('.') && !expected(&name)
    });
    strangers.next().map(|entry| entry.path())
}

/// Page of the demo on a screen.
fn page(written: &WrittenStudy, bench: &Path, rows: &[Row]) -> Page {
    let beside = |name: &str| shown(&written.report.with_file_name(name));
    let next = vec![
        format!("open {} in a browser", shown(&written.report)),
        format!("open {}: firing, aliases and late sensors in the recordings", beside(EFFECTS)),
        format!("dynoid inspect {}", beside(RECORDINGS)),
        format!("change {} and: dynoid study {0}", shown(bench)),
        "your own recordings: dynoid init FOLDER".to_owned(),
    ];
    let mut blocks = vec![
        Block::paragraph("A bench was simulated, recorded and studied. The estimates and the true values:"),
        Block::Table(comparison::table(rows)),
        Block::paragraph(comparison::remark(rows)),
    ];
    blocks.extend(summary::judgement(written));
    blocks.push(Block::heading("Next"));
    blocks.push(Block::List { items: next.into_iter().map(Prose::verbatim).collect() });
    Page::new("Demonstration", blocks)
}
