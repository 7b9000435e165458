//! Every command that takes a model, on models of every lead and lag that estimates give: a result in finite numbers,
//! never a fault.

use std::ops::Range;

use bench_model::document::BenchModelDocument;
use bench_model::model::{BenchModel, FeedForwardGains, PiController, TorqueControlModel};
use bench_testkit::documents;
use bench_testkit::models::{RPM, bench_a};
use capability::shapes;
use cycle::{Builtin, EngineMap, Kind};

use crate::can::{self, CAR, MAP};
use crate::support::Campaign;

/// Every target of `dynoid export`.
const TARGETS: [&str; 9] = ["mat", "modelica", "python", "fmu2", "fmu3", "c", "ssp", "ssv", "linear"];

/// Delays of a model, ms: of the controller, of ω_d* in its error and of the feed-forward, the two as recordings have
/// the demand, and of the torque control; its bandwidth, rad/s; the gate of the encoder.
struct Lags {
    controller_ms: f64,
    in_error_ms: f64,
    feed_forward_ms: f64,
    torque_ms: f64,
    bandwidth_rad_s: Option<f64>,
    gate_ms: f64,
}

const fn lags(
    [controller_ms, in_error_ms, feed_forward_ms]: [f64; 3],
    torque_ms: f64,
    bandwidth_rad_s: Option<f64>,
    gate_ms: f64,
) -> Lags {
    Lags { controller_ms, in_error_ms, feed_forward_ms, torque_ms, bandwidth_rad_s, gate_ms }
}

/// Recordings that have the demand as the controller does, one sample later and two; a demand that passes the
/// controller's delay and one that does not; delays of whole samples and of parts; torque control with a lag and
/// without.
const LAGS: [Lags; 6] = [
    lags([1.0, 1.0, 0.0], 1.61, Some(565.5), 1.0),
    lags([3.0, 3.0, 0.0], 0.82, Some(489.3), 1.0),
    lags([3.06, 0.0, 0.0], 1.46, Some(700.0), 1.0),
    lags([2.0, 0.0, -1.0], 1.15, None, 0.0),
    lags([2.06, 1.06, -1.0], 0.84, Some(900.0), 2.4),
    lags([1.0, -1.0, -2.0], 1.78, Some(350.0), 1.0),
];

fn model(lags: &Lags) -> BenchModelDocument {
    let nominal = bench_a();
    let seconds = |ms: f64| 1e-3 * ms;
    documents::of_model(BenchModel {
        speed_controller: nominal.speed_controller.map(|pi| PiController {
            delay_s: seconds(lags.controller_ms),
            demand_delay_s: seconds(lags.in_error_ms),
            ..pi
        }),
        feed_forward: nominal
            .feed_forward
            .map(|fed| FeedForwardGains { delay_s: seconds(lags.feed_forward_ms), ..fed }),
        torque_control: Some(TorqueControlModel {
            delay_s: seconds(lags.torque_ms),
            bandwidth_rad_s: lags.bandwidth_rad_s,
        }),
        encoder_gate_s: seconds(lags.gate_ms),
        ..nominal
    })
}

/// Runs a command line, which ends with a result in finite numbers.
#[track_caller]
fn ends_well(campaign: &Campaign, line: &str) {
    let words: Vec<&str> = line.split(' ').collect();
    let ran = campaign.run(&words);
    assert!(matches!(ran.code, Some(0 | 1)), "{line}: {:?} {}{}", ran.code, ran.stdout, ran.stderr);
    let of_numbers = |c: char| !c.is_alphanumeric();
    let is_bad = |word: &&str| ["NaN", "inf", "infinity"].contains(word);
    let bad = ran.stdout.split(of_numbers).chain(ran.stderr.split(of_numbers)).find(is_bad);
    assert_eq!(bad, None, "{line}: {}{}", ran.stdout, ran.stderr);
}

const OF_MAP: &str = "can bench.toml map --model model.json --samples 72";

/// The lines of commands on the model `model.json` alone.
fn of_model() -> impl Iterator<Item = String> {
    let looks = [
        "model bode model.json",
        "model step model.json --json",
        "model poles model.json",
        "diff model.json other.json",
    ];
    let looks = looks.into_iter().map(str::to_owned);
    looks.chain(TARGETS.iter().map(|target| format!("export model.json --to {target} --out exported")))
}

/// The lines of commands on an experiment with the model `model.json`, but for `can`.
fn of_experiment(experiment: &str) -> [String; 2] {
    [
        format!("experiment check bench.toml {experiment} --duration 6 --model model.json --samples 8"),
        format!("experiment design bench.toml {experiment} --duration 6 --model model.json --out designed"),
    ]
}

/// The lines of all commands but `can`.
fn commands(experiment: &str) -> impl Iterator<Item = String> {
    of_model().chain(of_experiment(experiment))
}

fn of_shape(name: &str) -> String {
    format!("can bench.toml {name} --model model.json --samples 72")
}

fn of_cycle(cycle: &Builtin) -> String {
    let with = match cycle.kind {
        Kind::Vehicle => "--vehicle car.toml",
        _ => "--engine-map engine.csv",
    };
    format!("can bench.toml {} {with} --model model.json --samples 72", cycle.name)
}

fn experiments(campaign: &Campaign) -> Vec<String> {
    let listed = campaign.run(&["experiment", "list", "--json"]).json();
    let name = |one: &serde_json::Value| one["label"].as_str().unwrap().to_owned();
    listed["experiments"].as_array().unwrap().iter().map(name).collect()
}

/// A bench with its limits, an engine map, a cycle, a car, and this model beside another.
fn campaign(document: &BenchModelDocument) -> Campaign {
    let campaign = can::campaign();
    campaign.write("car.toml", CAR.as_bytes());
    campaign.write("model.json", document.to_json().unwrap().as_bytes());
    campaign.write("other.json", documents::of_model(bench_a()).to_json().unwrap().as_bytes());
    campaign
}

/// Every target, a check and a design on each model; the shapes and the experiments take turns, and the slow map is of
/// one model.
#[test]
fn regress_every_command_runs_on_models_of_every_lead_and_lag() {
    for (turn, lags) in LAGS.iter().enumerate() {
        let campaign = campaign(&model(lags));
        let experiments = experiments(&campaign);
        commands(&experiments[turn % experiments.len()]).for_each(|line| ends_well(&campaign, &line));
        for shape in shapes::ALL.iter().skip(turn % 3).step_by(3) {
            ends_well(&campaign, &of_shape(shape.name));
        }
        if turn == LAGS.len() - 1 {
            ends_well(&campaign, OF_MAP);
        }
    }
}

/// The first minute of every built-in cycle of engines, the models taking turns.
#[test]
fn regress_the_first_minute_of_every_cycle_runs_on_a_model() {
    for (cycle, lags) in engine_cycles().zip(LAGS.iter().cycle()) {
        runs_a_minute(&campaign(&model(lags)), cycle);
    }
}

fn engine_cycles() -> impl Iterator<Item = &'static Builtin> {
    cycle::all().iter().filter(|cycle| cycle.kind != Kind::Vehicle)
}

/// The first minute of a cycle, as the command of the README runs the whole.
fn runs_a_minute(campaign: &Campaign, cycle: &Builtin) {
    let points = MAP.lines().skip(1).map(|row| row.split_once(',').unwrap());
    let (speeds, torques): (Vec<f64>, Vec<f64>) =
        points.map(|(rpm, nm)| (rpm.parse::<f64>().unwrap() * RPM, nm.parse::<f64>().unwrap())).unzip();
    let map = EngineMap::new(&speeds, &torques, None, None).unwrap();
    let reference = cycle.reference(&map).unwrap();
    let rows = reference.speed_rad_s.iter().zip(&reference.torque_nm).take(60).enumerate();
    let row = |(second, (speed, torque)): (usize, (&f64, &f64))| format!("{second},{:.3},{torque:.3}\n", speed / RPM);
    let text: String = rows.map(row).collect();
    campaign.write("minute.csv", format!("time [s],speed [rpm],torque [Nm]\n{text}").as_bytes());
    ends_well(campaign, "can bench.toml minute.csv --engine-map engine.csv --model model.json --samples 72");
}

/// Every test, shape and experiment, the first minute of every cycle, and one whole cycle.
fn walk(campaign: &Campaign, turn: usize) {
    ends_well(campaign, OF_MAP);
    of_model().for_each(|line| ends_well(campaign, &line));
    for experiment in experiments(campaign) {
        of_experiment(&experiment).iter().for_each(|line| ends_well(campaign, line));
        ends_well(campaign, &of_shape(&format!("{experiment} --duration 6")));
    }
    shapes::ALL.iter().for_each(|shape| ends_well(campaign, &of_shape(shape.name)));
    engine_cycles().for_each(|cycle| runs_a_minute(campaign, cycle));
    ends_well(campaign, &of_cycle(&cycle::all()[turn % cycle::all().len()]));
}

/// A bench drawn by an independent simulator, with the model of a study of these of its recordings.
fn drawn(number: usize, recordings: &str) -> Option<Campaign> {
    let folder = testdata::shared(&format!("recordings/drawn/bench-{number}"))?;
    let truth: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("truth.json")).unwrap()).unwrap();
    let campaign = campaign(&documents::of_model(bench_a()));
    let text = campaign
        .read("bench.toml")
        .replace("cylinders = 4", &format!("cylinders = {}", truth["imbalance"].as_array().unwrap().len()))
        .replace("0.6 kg m²", &format!("{} kg m²", truth["J_d"]))
        .replace("0.28 kg m²", &format!("{} kg m²", truth["J_e"]))
        .replace("recordings/*.mf4", &format!("{}/{recordings}.mf4", folder.display()));
    campaign.write("bench.toml", text.as_bytes());
    let studied = campaign.run(&["study", "bench.toml", "--quiet"]);
    assert!(matches!(studied.code, Some(0 | 1)), "bench {number}: {}", studied.stderr);
    std::fs::rename(campaign.path("study/model.json"), campaign.path("model.json")).unwrap();
    Some(campaign)
}

/// A bench whose estimates have a lead of the demand.
#[test]
fn regress_commands_run_on_a_study_of_recordings() {
    let Some(campaign) = drawn(200, "[BW]*") else { return };
    commands("Step_T_TN").for_each(|line| ends_well(&campaign, &line));
    ends_well(&campaign, &of_shape("speed-step"));
    runs_a_minute(&campaign, &cycle::builtin("whtc").unwrap());
}

/// Studies of these benches, every test on each, and what to record next.
fn every_command_runs_on(numbers: Range<usize>) {
    for number in numbers {
        let Some(campaign) = drawn(number, "*") else { return };
        walk(&campaign, number);
        ends_well(&campaign, "experiment next bench.toml --duration 12");
    }
}

#[test]
#[ignore = "a study of each bench, and every test on each"]
fn regress_every_command_runs_on_every_drawn_bench() {
    every_command_runs_on(200..208);
}

#[test]
#[ignore = "a study of each bench, and every test on each"]
fn regress_every_command_runs_on_every_other_drawn_bench() {
    every_command_runs_on(208..216);
}
