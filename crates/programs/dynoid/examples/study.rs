//! A study from files: records a virtual bench, studies what its bench file lists, and writes the report.

#![allow(clippy::print_stdout, reason = "an example prints")]

use dynoid::{Bench, FileFormat, Files, Session, StudyFolder, StudyOptions};
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use study::verdict;
use study::verdict::Level;
use work::Context;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (files, context) = (Files::new("example", false), Context::new());
    let folder = tempfile::tempdir()?;
    let plans = [ExperimentPlan::bs_t_nt(1200.0, 20.0), ExperimentPlan::white_noise_t_tn(1200.0, 20.0)];
    for (plan, seed) in plans.iter().zip(1..) {
        let recording = virtual_bench::simulate(&BenchParameters::default(), plan, seed)?;
        FileFormat::Mf4.write(&recording, &folder.path().join(format!("{}_1200.mf4", plan.label)), &files)?;
    }
    let mut bench = bench_testkit::benches::default_bench();
    bench.recordings.files = vec!["*.mf4".to_owned()];

    let bench = Bench::of(&folder.path().join("bench.toml"), bench);
    let out = StudyFolder::check(&bench, &folder.path().join("study"), StudyOptions::default(), &files)?;
    let session = Session::open(bench, &files, &context)?;
    let written = out.write(&session, &context)?;
    println!("{} recordings: {:?}", written.study.recordings.len(), verdict(&written.study).level);
    assert!(verdict(&written.study).level != Level::Insufficient);
    assert!(written.report.is_file() && written.model.is_some_and(|model| files.bench_model(&model).is_ok()));
    Ok(())
}
