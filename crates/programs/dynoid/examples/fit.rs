//! A linear model of two channels of a recording: the lag of a drive, from torque demand to torque.

#![allow(clippy::print_stdout, reason = "an example prints")]

use std::f64::consts::TAU;

use dynoid::linear::{DataOptions, FitData, FitNeeds, Judging, LinearFit, Method};
use dynoid::{FileFormat, Files, replace_file};
use ident::ContinuousTransferFunction;
use ident::uncertainty::Dynamics;
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use work::Context;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (files, context, folder) = (Files::new("example", false), Context::new(), tempfile::tempdir()?);
    let (parameters, plan) = (BenchParameters::default(), ExperimentPlan::white_noise_t_tn(1200.0, 20.0));
    let (recording, model) = (folder.path().join("run.mf4"), folder.path().join("model.json"));
    FileFormat::Mf4.write(&virtual_bench::simulate(&parameters, &plan, 1)?, &recording, &files)?;

    let options = DataOptions::of(&[recording], &["DynoTorqueDemand"], &["DynoTorqueCalc"]);
    let data = FitData::read(&options, &Judging::Split(0.5), FitNeeds::SIMULATION, &files, &context)?;
    let lag = ContinuousTransferFunction::new(0, 1).with_delay_between(&[(0.0, 0.01)]);
    let fit = LinearFit::of(data, &Method::TransferFunction(Box::new(lag)), "lag with delay", &context)?;
    replace_file(&model, fit.model_file()?.as_bytes(), &files)?;
    let pole = fit.fit().model.system()?.poles()?[0].norm() / TAU;
    println!("{}\nThe drive follows up to {pole:.1} Hz.", fit.fit());
    assert!((pole - 90.0).abs() < 9.0 && files.linear_model(&model)? == *fit.document());
    Ok(())
}
