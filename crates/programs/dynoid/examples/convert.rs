//! Recordings in another format: two channels of a recording as text, on one clock of 100 Hz.

#![allow(clippy::print_stdout, reason = "an example prints")]

use dynoid::Files;
use dynoid::convert::{Conversion, ConvertOptions, Converted};
use dynoid::experiments::{BenchParameters, ExperimentPlan, VirtualRecordings};
use work::Context;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (files, context, folder) = (Files::new("example", false), Context::new(), tempfile::tempdir()?);
    let (plan, out) = (ExperimentPlan::bs_t_nt(1200.0, 5.0), folder.path().join("run.csv"));
    let simulated = VirtualRecordings::of(&BenchParameters::default(), &[plan], 1, &context)?;
    let recordings = files.named(&simulated.write(folder.path(), &files)?)?;
    let channels = vec!["DynoSpeed".to_owned(), "DynoTorque*".to_owned()];
    let options = ConvertOptions { channels, rate_hz: Some(100.0), ..ConvertOptions::default() };
    Conversion::into_file(recordings, &out, options, &files)?.run(&files, &context, |converted| match converted {
        Converted::Written(written) => println!("{}: {} channels", written.facts().out, written.facts().channels.len()),
        Converted::Left { file, note } => println!("{file}: {note}"),
        Converted::Failed { file, error } => println!("{file}: {error}"),
    })?;
    assert!(std::fs::read_to_string(&out)?.contains("DynoSpeed"));
    Ok(())
}
