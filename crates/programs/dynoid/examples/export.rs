//! The model of a bench as the files of other programs.

#![allow(clippy::print_stdout, reason = "an example prints")]

use dynoid::experiments::{BenchParameters, ExperimentPlan, VirtualRecordings};
use dynoid::{Bench, Export, ExportTarget, Files, Session};
use work::Context;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (files, context, folder) = (Files::new("example", false), Context::new(), tempfile::tempdir()?);
    let plans = [ExperimentPlan::bs_t_nt(1200.0, 20.0), ExperimentPlan::white_noise_t_tn(1200.0, 20.0)];
    let recordings = VirtualRecordings::of(&BenchParameters::default(), &plans, 1, &context)?;
    let bench = Bench::of("bench.toml".as_ref(), bench_testkit::benches::default_bench());
    let model = Session::of(bench, recordings.sources(), &context).bench_model(&context)?;
    for target in [ExportTarget::Python, ExportTarget::Fmu3] {
        let written = Export::of_bench(&model, target, folder.path())?.write(&files)?;
        println!("{:?}", written.files);
        assert!(written.files.iter().all(|file| file.is_file()) && written.replaced.is_empty());
    }
    Ok(())
}
