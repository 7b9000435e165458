//! `dynoid schema`, and commands whose JSON has the form that it shows.

use bench_testkit::schemas::assert_valid;
use serde_json::Value;

use crate::support::{Campaign, bs, dynoid, white_noise};
use crate::{can, friction, identify};

/// What commands print, by the name of the schema; those that think for a second or two.
const QUICK: [(&str, &str); 10] = [
    ("init-output", "init recordings --out new.toml --json"),
    ("inspect-output", "inspect recordings --json"),
    ("inspect-list-output", "inspect recordings --list --json"),
    ("experiment-simulate-output", "experiment simulate bench.toml demands.csv --out run.mf4 --json"),
    ("experiment-design-output", "experiment design bench.toml BS_T_NT --duration 4s --out designed --json"),
    ("experiment-check-output", "experiment check bench.toml BS_T_NT --duration 4s --samples 72 --json"),
    ("can-output", "can bench.toml tip-in --samples 72 --json"),
    ("can-recorded-output", "can bench.toml cycle.csv --recorded run.mf4 --json"),
    ("can-map-output", "can bench.toml map --samples 72 --json"),
    ("controller-output", "controller bench.toml --json"),
];

const SLOW: [(&str, &str); 7] = [
    ("lines-output", "lines bench.toml --json"),
    ("torque-signals-output", "torque-signals bench.toml --json"),
    ("torque-control-output", "torque-control bench.toml --json"),
    ("shaft-output", "shaft bench.toml --json"),
    ("engine-output", "engine bench.toml --json"),
    ("friction-output", "friction bench.toml --json"),
    ("experiment-next-output", "experiment next bench.toml --json"),
];

/// Commands for linear models, in an order in which each finds the model that it needs.
const LINEAR: [(&str, &str); 12] = [
    ("data-spectrum-output", "data spectrum run.csv -u valve -y speed --json"),
    ("data-delay-output", "data delay run.csv -u valve -y speed --longest 5 --json"),
    ("data-order-output", "data order run.csv -u valve -y speed --na 1:2 --nb 1:2 --nk 1:2 --json"),
    ("fit-output", "fit arx run.csv -u valve -y speed --validate unseen.csv --out arx.json --json"),
    ("model-bode-output", "model bode arx.json --json"),
    ("model-step-output", "model step arx.json --json"),
    ("model-poles-output", "model poles arx.json --json"),
    ("model-convert-zpk-output", "model convert arx.json --to zpk --json"),
    ("model-compare-output", "model compare arx.json --on unseen.csv --json"),
    ("model-residuals-output", "model residuals arx.json --on unseen.csv --json"),
    ("model-simulate-output", "model simulate arx.json --on unseen.csv --json"),
    ("model-predict-output", "model predict arx.json --on unseen.csv --horizon 5 --json"),
];

fn check_all(campaign: &Campaign, runs: &[(&str, &str)]) {
    for (name, line) in runs {
        let words: Vec<&str> = line.split(' ').collect();
        let ran = campaign.run(&words);
        assert!(matches!(ran.code, Some(0 | 1)), "{line}: {:?} {}", ran.code, ran.stderr);
        assert_valid(name, &ran.json());
    }
}

#[test]
fn exact_what_quick_commands_print_has_the_form_of_its_schema() {
    let campaign = can::campaign().with("BS_T_NT_1200.mf4", &bs()).with("WhiteNoise_T_TN_1200.mf4", &white_noise());
    check_all(&campaign, &QUICK);
}

#[test]
#[ignore = "slow"]
fn exact_what_slow_commands_print_has_the_form_of_its_schema() {
    check_all(&friction::campaign(), &SLOW);
}

#[test]
fn exact_what_commands_for_linear_models_print_has_the_form_of_its_schema() {
    let folder = identify::folder();
    for (name, line) in LINEAR {
        let ran = identify::run(&folder, line);
        assert_eq!(ran.code, Some(0), "{line}: {}", ran.stderr);
        assert_valid(name, &ran.json());
    }
}

#[test]
fn exact_the_files_of_a_study_and_of_a_fit_have_the_form_of_their_schemas() {
    let campaign = Campaign::whole();
    let done = |line: &str| {
        let ran = campaign.run(&line.split(' ').collect::<Vec<_>>());
        assert!(matches!(ran.code, Some(0 | 1)), "{line}: {}", ran.stderr);
        ran
    };
    assert_valid("study-output", &done("study bench.toml --json").json());
    done(
        "fit arx recordings/BS_T_NT_1200.mf4 -u DynoTorqueDemand -y DynoTorqueCalc --sample-time 10ms --na 2 --nb 2 --nk 1 --out arx.json",
    );
    for (name, file) in [("study", "study/study.json"), ("model", "study/model.json"), ("linear-model", "arx.json")] {
        assert_valid(name, &serde_json::from_str(&campaign.read(file)).unwrap());
    }
}

#[test]
fn exact_every_schema_is_listed_and_printed() {
    let run = |arguments: &[&str]| dynoid(&std::env::temp_dir(), arguments);
    let listed = run(&["schema"]).stdout;
    let names: Vec<&str> = listed.lines().filter_map(|line| line.split_once(": ")).map(|(name, _)| name).collect();
    assert!(names.len() > 30 && names.contains(&"study"), "{listed}");
    for name in names {
        let schema: Value = run(&["schema", name]).json();
        assert_eq!(schema["$id"], format!("urn:dynoid:schema:{name}"));
    }
    run(&["schema", "studdy"]).assert_refused(2, &["studdy", "study"]);
}
