//! A model file with any number in it: it is refused in the words of the file, or what is computed from it ends soon.

use std::time::{Duration, Instant};

use bench_model::disturbances::Disturbances;
use bench_model::document::BenchModelDocument;
use bench_model::model::{BenchModel, FeedForwardGains, Mechanics, PiController, TorqueControlModel};
use bench_model::prediction::PredictionInputs;
use bench_testkit::documents;
use design::safety::{BenchSpread, FrictionSpread, SafetyInputs, check};
use export::names::Names;
use rig::bench_file::Limits;
use rig::bench_parameters::BenchParameters;
use rig::engine_pulses::{EnginePulses, KnownPulses};
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use rig::facts::Engine;
use serde_json::Value;
use toolbox_report::models::{Model, bode};

/// Values that a computer has trouble with.
const VALUES: [f64; 12] =
    [0.0, -1.0, 1e308, -1e308, 1e-308, -1e-300, 1e9, 1e-12, 0.9, 1e5, 1e-5, f64::MIN_POSITIVE * f64::EPSILON];
/// So many times as long as on the file as it is may the commands take on it with another number: a controller may be
/// calculated a hundred times as often.
const LONGEST: u32 = 100;

fn valid() -> Value {
    let model = BenchModel {
        mechanics: Mechanics {
            dyno_inertia_kg_m2: 0.61,
            engine_inertia_kg_m2: 0.28,
            stiffness_nm_per_rad: 2437.7,
            damping_nm_s_per_rad: 5.8,
        },
        speed_controller: Some(PiController {
            proportional_nm_s_per_rad: 8.96,
            integral_nm_per_rad: 17.81,
            delay_s: 1.9e-3,
            demand_delay_s: 1.8e-3,
            sample_time_s: 1e-3,
        }),
        feed_forward: Some(FeedForwardGains {
            speed_nm_s_per_rad: 0.13,
            acceleration_nm_s2_per_rad: 0.59,
            delay_s: 1.1e-3,
        }),
        torque_control: Some(TorqueControlModel { delay_s: 0.7e-3, bandwidth_rad_s: Some(804.0) }),
        torque_limit_nm: Some(400.0),
        encoder_gate_s: 1.2e-3,
    };
    let mut document = documents::of_model(model);
    let mut pulses = EnginePulses::prior(Engine { cylinders: 4, strokes: 4 }, 0.28);
    pulses.harmonics.truncate(2);
    document.engine_pulses = Some(pulses);
    serde_json::from_str(&document.to_json().unwrap()).unwrap()
}

/// The places of all numbers, as pointers.
fn numbers(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(at.to_owned()),
        Value::Array(all) => all.iter().enumerate().for_each(|(i, one)| numbers(one, &format!("{at}/{i}"), found)),
        Value::Object(all) => all.iter().for_each(|(key, one)| numbers(one, &format!("{at}/{key}"), found)),
        _ => {}
    }
}

/// The file with other numbers at places, and in the list for people, which has to have the same.
fn with(file: &Value, changes: &[(&str, f64)]) -> Value {
    let mut changed = file.clone();
    for (place, number) in changes {
        *changed.pointer_mut(place).unwrap() = (*number).into();
    }
    for listed in changed["parameters"].as_array_mut().unwrap() {
        let is_listed = |place: &str| place.starts_with("/model/") && file.pointer(place) == Some(&listed["value"]);
        if let Some((_, number)) = changes.iter().find(|(place, _)| is_listed(place)) {
            listed["value"] = (*number).into();
        }
    }
    changed
}

/// Exports, responses and the check of an experiment, of what is no fault of the file.
fn use_of(document: &BenchModelDocument) {
    let names = Names::of(&document.bench.name);
    let _ = export::python::bench(document, &names);
    let _ = export::ssv::bench(document, &names, 2);
    let _ = export::fmu::c_files(document, &names);
    let _ = export::matlab::bench(document, &names);
    for (name, linear) in export::toolbox_models(document).unwrap_or_default() {
        if let Ok(models) = Model::with_noise(name, linear, false) {
            let _ = bode(models, 0.95).map(|curves| curves.facts());
        }
    }
    let plan = ExperimentPlan::bs_t_nt(1200.0, 0.3);
    let demands = Demands::of(&plan, 1, DEMAND_HOLD_S);
    let engine = &BenchParameters::default().engine;
    let limits = Limits { shaft_torque_nm: Some(600.0), ..Limits::default() };
    let friction = FrictionSpread::NONE;
    let prediction = PredictionInputs {
        plan: &plan,
        demands: &demands,
        model: &document.model,
        engine,
        firing_seed: Some(1),
        friction: friction.middle(),
        disturbances: document.disturbances.unwrap_or_else(Disturbances::assumed),
        limits,
    };
    let spread = BenchSpread::Estimated(&document.uncertainty);
    let pulses = &document.engine_pulses.clone().map_or(KnownPulses::Stated, KnownPulses::Estimated);
    let inputs =
        SafetyInputs { prediction, spread, pulses, friction, slowest_engine_control: 1.0, samples: 3, seed: 1 };
    let _ = check(&inputs, &work::Context::new());
}

fn time_of(document: &BenchModelDocument) -> Duration {
    let since = Instant::now();
    use_of(document);
    since.elapsed()
}

/// How long they take on the file as it is.
fn usual_time() -> Duration {
    time_of(&BenchModelDocument::from_json(&valid().to_string()).unwrap())
}

fn ends_soon(document: &BenchModelDocument, what: &str, usual: Duration) {
    let time = time_of(document);
    assert!(time < LONGEST * usual, "{what} took {time:?}, and the file as it is {usual:?}");
}

/// Every number at these places takes these values; returns how many files were read. All processors share the work.
fn walk(places: &[String], values: &[f64], usual: Duration) -> usize {
    let file = valid();
    let read = |place: &String| values.iter().filter(|value| is_read(&file, place, **value, usual)).count();
    numerics::parallel::map(places, read).into_iter().sum()
}

/// Reads the file with another number at a place and uses it, or hears in clear words why it is not read.
fn is_read(file: &Value, place: &str, value: f64, usual: Duration) -> bool {
    match BenchModelDocument::from_json(&with(file, &[(place, value)]).to_string()) {
        Ok(document) => {
            ends_soon(&document, &format!("{place} = {value:e}"), usual);
            true
        }
        Err(error) => {
            let words = error.to_string();
            let remedies = ["let `dynoid study", "make the two the same"];
            let is_clear = words.contains('`') && remedies.iter().any(|remedy| words.contains(remedy));
            assert!(is_clear, "{place} = {value:e}: {words}");
            false
        }
    }
}

fn places(under: &str) -> Vec<String> {
    let mut all = Vec::new();
    numbers(&valid(), "", &mut all);
    all.retain(|place| place.starts_with(under));
    all
}

#[test]
fn prop_a_number_of_the_model_ends_in_a_result_or_a_refusal() {
    assert!(BenchModelDocument::from_json(&valid().to_string()).is_ok());
    let places = places("/model/");
    assert_eq!(places.len(), 16);
    let read = walk(&places, &VALUES[..6], usual_time());
    assert!(read > 0 && read < 40, "{read} of {} files were read", 6 * places.len());
}

#[test]
#[ignore = "every number of the file with every value takes minutes"]
fn prop_any_number_of_a_model_file_ends_in_a_result_or_a_refusal() {
    let usual = usual_time();
    walk(&places("/model/"), &VALUES, usual);
    let others: Vec<String> = places("").into_iter().filter(|place| !place.starts_with("/model/")).collect();
    assert!(others.len() > 60, "{}", others.len());
    // The rest is tables of the same kind of numbers: each place takes one of the values, in turn.
    for (k, value) in VALUES.iter().enumerate() {
        let turn: Vec<String> = others.iter().skip(k).step_by(VALUES.len()).cloned().collect();
        walk(&turn, &[*value], usual);
    }
}

/// An encoder that averages over many samples makes a model of many states.
#[test]
fn regress_a_long_gate_of_the_encoder_ends_soon() {
    for gate_s in [0.095, 0.13] {
        let text = with(&valid(), &[("/model/encoder_gate_s", gate_s)]).to_string();
        let document = BenchModelDocument::from_json(&text).unwrap();
        ends_soon(&document, &format!("{gate_s} s"), usual_time());
    }
}

/// Two numbers of the file change places.
#[test]
#[ignore = "many pairs"]
fn prop_swapped_numbers_of_a_model_file_end_in_a_result_or_a_refusal() {
    let (file, usual) = (valid(), usual_time());
    let places = places("/model/");
    let number = |place: &str| file.pointer(place).and_then(Value::as_f64).unwrap();
    let mut read = 0;
    for (k, one) in places.iter().enumerate() {
        for other in &places[k + 1..] {
            let text = with(&file, &[(one, number(other)), (other, number(one))]).to_string();
            match BenchModelDocument::from_json(&text) {
                Ok(document) => {
                    read += 1;
                    ends_soon(&document, &format!("{one} and {other}"), usual);
                }
                // Both places have the number of the other, in the model and in the list.
                Err(error) => {
                    let words = error.to_string();
                    assert!(!words.contains("make the two the same"), "{one} and {other}: {words}");
                }
            }
        }
    }
    assert!(read > 0);
}
