//! Tests and experiments on a bench of which a bench file is all that is known.

use dynoid::can::{Capability, CapabilityOptions, Requirements, Test, TestOptions};
use dynoid::experiments::{DesignedExperiment, Given, PlanDoubt, Planned};
use dynoid::{Bench, Draws, Error, Files, KnownBench, NotPredicted};
use work::Context;

const BENCH: &str = "[bench]\nname = \"x\"\nvariant = \"load-cell\"\ncylinders = 4\ndynamometer_inertia = 0.6\n\
    engine_inertia = 0.28\n";

fn bench(more: &str) -> KnownBench {
    KnownBench::stated(&Bench::parse("bench.toml".as_ref(), &format!("{BENCH}{more}")).unwrap()).unwrap()
}

fn found(name: &str) -> Result<Test, Error> {
    Test::find(name, &TestOptions::default(), &Files::new("test", false), &Context::new())
}

#[test]
fn exact_texts_of_errors_hold_for_any_program() {
    let without_shaft = bench("");
    let (test, draws) = (found("speed-step").unwrap(), Draws { benches: 1, seed: 1 });
    let errors = [
        found("whtc").unwrap_err(),
        found("udds").unwrap_err(),
        found("nothing").unwrap_err(),
        Requirements::of(&test, &["86".to_owned()], &[]).unwrap_err(),
        Requirements::of(&test, &[], &["fast".to_owned()]).unwrap_err(),
        Capability::of(&without_shaft, CapabilityOptions::of(draws)).unwrap_err(),
        Capability::of(
            &bench("[shaft]\nresonance = \"18 Hz\"\n"),
            CapabilityOptions { speed_rpm: Some(0.0), ..CapabilityOptions::of(draws) },
        )
        .unwrap_err(),
    ];
    for error in errors {
        assert!(!error.to_string().contains("--"), "an option of a command line: {error}");
    }
}

#[test]
fn exact_demands_are_made_where_nothing_can_be_predicted() {
    let (bench, context) = (bench(""), Context::new());
    let (given, files) =
        (vec![Given { name: "clock".to_owned(), value: "0.01".to_owned() }], Files::new("test", false));
    let planned = Planned::find("BS_T_NT", &given, &files, &context).unwrap();
    let doubts = PlanDoubt::of(&planned.plan, bench.file());
    assert_eq!(doubts.first().and_then(PlanDoubt::remedy).unwrap().name, "clock");
    assert!(!doubts[0].to_string().contains("--"));
    assert!(planned.file_name(1).starts_with("BS_T_NT_"));
    let designed = DesignedExperiment::of(&bench, planned, 1, &context);
    assert!(matches!(designed.predicted(), Err(NotPredicted::UnknownShaft)) && designed.responses().is_none());
    assert!(!designed.recording().channels.is_empty() && designed.table().unwrap().rasters.len() == 1);
}
