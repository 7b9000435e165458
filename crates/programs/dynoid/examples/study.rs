//! A study from files: records a virtual bench, studies what its bench file lists, and writes the report.

#![allow(clippy::print_stdout, reason = "an example prints")]

use dynoid::experiments::{BenchParameters, ExperimentPlan, VirtualRecordings};
use dynoid::{Bench, Files, Session, StudyFolder, StudyOptions};
use study::verdict;
use work::Context;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (files, context, folder) = (Files::new("example", false), Context::new(), tempfile::tempdir()?);
    let plans = [ExperimentPlan::bs_t_nt(1200.0, 20.0), ExperimentPlan::white_noise_t_tn(1200.0, 20.0)];
    VirtualRecordings::of(&BenchParameters::default(), &plans, 1, &context)?.write(folder.path(), &files)?;
    let mut bench = bench_testkit::benches::default_bench();
    bench.recordings.files = vec!["*.mf4".to_owned()];

    let bench = Bench::of(&folder.path().join("bench.toml"), bench);
    let out = StudyFolder::check(&bench, &folder.path().join("study"), StudyOptions::default(), &files)?;
    let written = out.write(&Session::open(bench, &files, &context)?, &context)?;
    println!("{} recordings: {:?}", written.study.recordings.len(), verdict(&written.study).level);
    assert!(verdict(&written.study).level != verdict::Level::Insufficient);
    assert!(written.report.is_file() && written.model.is_some_and(|model| files.bench_model(&model).is_ok()));
    Ok(())
}
