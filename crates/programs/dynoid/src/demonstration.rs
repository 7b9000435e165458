//! The demonstration: a bench whose every parameter is known, and its recordings.

use std::path::{Path, PathBuf};

use demo::campaign::{self, Planned};
use demo::comparison::{Row, rows};
use demo::effects::{Effects, ShaftZeros};
use numerics::parallel;
use page::Page;
use rig::bench_parameters::BenchParameters;
use study::Study;
use work::Context;

use crate::error::Error;
use crate::files::Files;
use crate::formats::encode_mdf4;
use crate::mark::Mark;
use crate::models::MODEL;
use crate::output::{OutputFolder, check_replaceable, replace_file};
use crate::pages::html;
use crate::written::{DATA, FULL_REPORT, FULL_REPORT_PDF, REPORT, REPORT_PDF, SERIES, SUMMARY_PDF};

const RECORDINGS: &str = "recordings";
const BENCH_FILE: &str = "bench.toml";
/// The page of a demonstration on firing, aliases and late sensors in recordings.
pub const EFFECTS: &str = "effects.html";

/// A demonstration in a folder.
#[derive(Debug)]
pub struct Demonstration {
    out: PathBuf,
    seed: u64,
    plans: Vec<Planned>,
    parameters: BenchParameters,
    files: Files,
}

impl Demonstration {
    /// Checks before any work that a folder can be written, and holds nothing but an earlier demonstration.
    ///
    /// # Errors
    /// A folder with other things in it, or one that cannot be written.
    pub fn check(out: &Path, seed: u64, files: &Files) -> Result<Self, Error> {
        let plans = campaign::plans();
        let names: Vec<&str> = plans.iter().map(|plan| plan.file_name.as_str()).collect();
        check_folder(out, &names, files)?;
        let (out, parameters) = (out.to_owned(), BenchParameters::default());
        Ok(Demonstration { out, seed, plans, parameters, files: files.clone() })
    }

    /// Simulates the bench, and writes its recordings, the page [`EFFECTS`] and the bench file. Returns the place of
    /// the bench file, whose study [`Demonstration::rows`] compares with the truth.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, context: &Context) -> Result<PathBuf, Error> {
        let recordings = self.recordings(context)?;
        let bytes = recordings.iter().map(Vec::as_slice);
        let named: Vec<(&str, &[u8])> = self.plans.iter().map(|plan| plan.file_name.as_str()).zip(bytes).collect();
        OutputFolder::check(&self.out.join(RECORDINGS), &self.files)?.write(&named)?;
        let effects = html(&self.effects()?, &self.files);
        replace_file(&self.out.join(EFFECTS), effects.as_bytes(), &self.files)?;
        let bench = self.out.join(BENCH_FILE);
        replace_file(&bench, self.bench_file().as_bytes(), &self.files)?;
        Ok(bench)
    }

    /// The estimates of a study of this bench beside the true values.
    pub fn rows(&self, study: &Study) -> Vec<Row> {
        rows(study, &self.parameters)
    }

    /// Simulates the experiments on all cores; returns the recordings' bytes in their order. Every experiment has a
    /// seed of its own, counted from that of the demonstration.
    fn recordings(&self, context: &Context) -> Result<Vec<Vec<u8>>, Error> {
        let seeded: Vec<(&Planned, u64)> = self.plans.iter().zip(self.seed..).collect();
        let record = |(planned, seed): &(&Planned, u64)| {
            let recording = planned.record(&self.parameters, *seed).map_err(Error::internal)?;
            encode_mdf4(&recording, &self.files)
        };
        parallel::map_as_step(context, "simulating the bench", &seeded, record).into_iter().collect()
    }

    /// The page of what the bench shows, its two parts at the same time.
    fn effects(&self) -> Result<Page, Error> {
        let (parameters, seed) = (&self.parameters, self.seed);
        let file = campaign::bench_file(parameters, RECORDINGS);
        let zeros = || ShaftZeros::of(parameters, &file, seed);
        let (effects, zeros) = parallel::join(|| Effects::of(parameters, seed), zeros);
        Ok(report::effects(&effects.map_err(Error::internal)?, &zeros.map_err(Error::internal)?))
    }

    /// The bench file, as text. Its first line is its mark.
    fn bench_file(&self) -> String {
        let file = campaign::bench_file(&self.parameters, &format!("{RECORDINGS}/*.mf4"));
        format!(
            "# Written by {}: the bench file of a simulated bench.\n# Change what you like and run `dynoid study \
             {BENCH_FILE}`; the next demo in this folder writes it anew.\n\n{}",
            self.files.generator(),
            file.to_toml()
        )
    }
}

/// Refuses a folder with things in it that are not the demonstration's.
fn check_folder(out: &Path, recordings: &[&str], files: &Files) -> Result<(), Error> {
    OutputFolder::check(out, files)?;
    let refuse = |found: PathBuf| Error::NotADemoFolder { path: out.to_owned(), found };
    check_replaceable(&out.join(BENCH_FILE), Some(&Mark::of_run(files)), files)?;
    let own = |name: &str| {
        let of_study = [REPORT, FULL_REPORT, DATA, SERIES, MODEL, "study"];
        let on_paper = [REPORT_PDF, FULL_REPORT_PDF, SUMMARY_PDF];
        [RECORDINGS, BENCH_FILE, EFFECTS].iter().chain(&of_study).chain(&on_paper).any(|own| *own == name)
    };
    for file in recordings.iter().map(|name| out.join(RECORDINGS).join(name)).chain([out.join(EFFECTS)]) {
        check_replaceable(&file, Some(&Mark::of_run(files)), files)?;
    }
    let foreign = stranger(out, own).or_else(|| stranger(&out.join(RECORDINGS), |name| recordings.contains(&name)));
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
