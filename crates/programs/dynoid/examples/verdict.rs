//! Can this bench run this test? Of the bench no more is known than its bench file states.

#![allow(clippy::print_stdout, reason = "an example prints")]

use capability::Answer;
use dynoid::can::{Predicted, Requirements, Test, TestOptions};
use dynoid::{Bench, Draws, Files, KnownBench};
use work::Context;

const BENCH: &str = "[bench]\nname = \"Test cell 4\"\nvariant = \"load-cell\"\ncylinders = 4\ndynamometer_inertia = 0.6\n\
    engine_inertia = 0.28\n[shaft]\nresonance = \"18 Hz\"\n[limits]\ntorque = \"400 Nm\"\nshaft_torque = \"600 Nm\"\n\
    speed = \"7000 rpm\"\nshaft_torque_slew = \"90000 Nm/s\"\n";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (files, context) = (Files::new("example", false), Context::new());
    let bench = KnownBench::stated(&Bench::parse("bench.toml".as_ref(), BENCH)?)?;
    let test = Test::find("speed-step", &TestOptions::default(), &files, &context)?;
    let wanted = Requirements::of(&test, &[], &["speed overshoot below 50 %".to_owned()])?;
    let answer = Predicted::of(&bench, &test, &wanted, Draws { benches: 100, seed: 1 }, &context)?;
    println!("{}: {}", test.title(), answer.sentence());
    assert!(answer.verdict().kept.of == 100 && answer.verdict().answer != Answer::NotJudged);
    Ok(())
}
