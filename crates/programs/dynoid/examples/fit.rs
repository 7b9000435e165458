//! A linear model of two channels of a recording: the lag of a drive, from torque demand to torque.

#![allow(clippy::print_stdout, reason = "an example prints")]

use dynoid::Files;
use dynoid::experiments::{BenchParameters, ExperimentPlan, VirtualRecordings};
use dynoid::linear::{DataOptions, FitData, FitNeeds, Judging, LinearFit, Method};
use ident::ContinuousTransferFunction;
use work::Context;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (files, context, folder) = (Files::new("example", false), Context::new(), tempfile::tempdir()?);
    let (plan, model) = (ExperimentPlan::white_noise_t_tn(1200.0, 20.0), folder.path().join("model.json"));
    let simulated = VirtualRecordings::of(&BenchParameters::default(), &[plan], 1, &context)?;
    let recordings = simulated.write(folder.path(), &files)?;
    let options = DataOptions::of(&recordings, &["DynoTorqueDemand"], &["DynoTorqueCalc"]);
    let data = FitData::read(&options, &Judging::Split(0.5), FitNeeds::SIMULATION, &files, &context)?;
    let lag = ContinuousTransferFunction::new(0, 1).with_delay_between(&[(0.0, 0.01)]);
    let fit = LinearFit::of(data, &Method::TransferFunction(Box::new(lag)), "lag with delay", &context)?;
    fit.write(&model, &files)?;
    let pole_hz = fit.natural_frequencies_hz()?[0];
    println!("{}\nThe drive follows up to {pole_hz:.1} Hz.", fit.fit());
    assert!((pole_hz - 90.0).abs() < 9.0 && files.linear_model(&model)? == *fit.document());
    Ok(())
}
