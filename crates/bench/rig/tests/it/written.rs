//! Results are read as they were written.

use std::fmt::Debug;

use proptest::prelude::*;
use rig::experiment::{ControlMode, Excitation, ExperimentLabel, Test};
use rig::results::{
    Estimate, Outcome, Parameter, Part, Quantity, Reason, Stretch, Trace, read_found, read_if_sought, write_found,
    write_if_sought,
};
use rig::{Diagnostic, Finding, Place, Severity};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

fn read_back<T: Serialize + DeserializeOwned + Debug>(written: &T) -> T {
    let text = serde_json::to_string(written).unwrap();
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error} in {text}"))
}

fn finding(finding: Finding) -> Diagnostic {
    Diagnostic { severity: Severity::Warning, place: Place::default(), finding }
}

#[test]
fn exact_findings_keep_their_quantity_though_several_share_its_symbol() {
    for quantity in Quantity::ALL {
        let twice = Finding::RoutesDisagree { quantity, first: (1.0, 0.1), second: (2.0, 0.1) };
        let unchecked = Finding::NoCheckOfShaft { quantity, value: 1.0, standard_error: 0.5 };
        for written in [twice, unchecked].map(finding) {
            assert_eq!(read_back(&written), written);
        }
    }
}

#[test]
fn exact_findings_have_the_symbol_that_they_always_had() {
    let (quantity, first, second) = (Quantity::TorqueSkew, (1.0, 0.1), (2.0, 0.1));
    let twice = serde_json::to_value(Finding::RoutesDisagree { quantity, first, second }).unwrap();
    let fields = json!({"kind": "routes_disagree", "quantity": "δ_T", "key": "torque_skew", "first": [1.0, 0.1], "second": [2.0, 0.1]});
    assert_eq!(twice, fields);
    let inertia = Finding::ImplausibleInertia {
        inertia: Quantity::DynoInertia,
        given_kg_m2: 0.5,
        estimated_kg_m2: 0.25,
        standard_error_kg_m2: 0.125,
    };
    let mut fields = serde_json::to_value(&inertia).unwrap();
    assert_eq!((&fields["symbol"], &fields["key"]), (&json!("J_d"), &json!("dyno_inertia")));
    // Without a key, as earlier versions wrote it, the symbol alone does where it is one quantity's.
    fields.as_object_mut().unwrap().remove("key");
    assert_eq!(serde_json::from_value::<Finding>(fields).unwrap(), inertia);
}

#[test]
fn regress_a_symbol_of_several_quantities_is_not_read_as_one_of_them() {
    let without_key =
        |symbol: &str| json!({"kind": "no_check_of_shaft", "symbol": symbol, "value": 1.0, "standard_error": 1.0});
    for symbol in ["τ", "δ_T", "ζ", "T_g", "c_1"] {
        let error = serde_json::from_value::<Finding>(without_key(symbol)).unwrap_err().to_string();
        assert!(error.contains("several quantities have the symbol") && error.contains(symbol), "{error}");
    }
    let error = serde_json::from_value::<Finding>(without_key("K_q")).unwrap_err().to_string();
    assert!(error.contains("K_q"), "{error}");
}

#[test]
fn exact_null_is_a_number_that_is_not_known() {
    let unknown = Parameter {
        quantity: Quantity::Stiffness,
        value: 2000.0,
        standard_error: f64::NAN,
        degrees_of_freedom: f64::INFINITY,
        interval: (f64::NEG_INFINITY, 2100.0),
    };
    let read = read_back(&unknown);
    assert!(read.standard_error.is_nan() && read.interval.0.is_nan());
    assert_eq!((read.value, read.degrees_of_freedom, read.interval.1), (2000.0, f64::INFINITY, 2100.0));
}

#[test]
fn regress_a_label_is_read_as_it_stands() {
    let label = |test: &str| ExperimentLabel::new(Test::from(test), Excitation::Torque, ControlMode::Nt);
    for test in ["<b>", "a b", "my_BS", "2018-05-03 BS", "Ünterricht", "BS"] {
        assert_eq!(read_back(&label(test)), label(test));
    }
    // A label within other words is found, as in the name of a file.
    let found: ExperimentLabel = serde_json::from_value(json!("BS_T_NT_1200.mf4")).unwrap();
    assert_eq!(found, ExperimentLabel::BS_T_NT);
    for none in ["", "_T_NT", "BS_T", "BS_X_NT", "T_NT"] {
        assert!(serde_json::from_value::<ExperimentLabel>(json!(none)).is_err(), "{none}");
    }
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Found {
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    one: Outcome<f64>,
    #[serde(serialize_with = "write_if_sought", deserialize_with = "read_if_sought")]
    sought: Option<Outcome<f64>>,
}

#[test]
fn exact_outcomes_keep_all_their_reasons() {
    let part = |part| Reason::Part { part };
    let several = || Outcome::NotEstimated { needs: vec![part(Part::Shaft), part(Part::Timing)] };
    let all = [
        Found { one: Outcome::Estimated(1.5), sought: Some(Outcome::Estimated(2.5)) },
        Found { one: several(), sought: Some(several()) },
        Found { one: Outcome::because(part(Part::Shaft)), sought: None },
        Found { one: Outcome::NotEstimated { needs: Vec::new() }, sought: Some(Outcome::because(part(Part::Whole))) },
    ];
    for written in &all {
        assert_eq!(&read_back(written), written);
    }
    let written = serde_json::to_value(&all[2]).unwrap();
    assert_eq!(written["one"], json!({"not_estimated": {"kind": "part", "name": "shaft"}}));
    let error = |value: Value| serde_json::from_value::<Found>(value).unwrap_err().to_string();
    assert!(error(json!({"one": {}, "sought": null})).contains("found"));
}

#[test]
fn exact_a_trace_has_its_length_before_its_values() {
    let trace = Trace { start_s: 1.5, sample_time_s: 1e-3, values: vec![2.0; 7] };
    let read = read_back(&trace);
    assert_eq!((read.start_s, read.sample_time_s, read.values.len()), (1.5, 1e-3, 7));
    assert!(read.values.iter().all(|value| value.is_nan()));
    let damaged = json!({"start_s": 0.0, "sample_time_s": 1.0, "samples": 1_u64 << 40});
    assert!(serde_json::from_value::<Trace>(damaged).unwrap_err().to_string().contains("1099511627776"));
}

fn parameter() -> impl Strategy<Value = Parameter> {
    let number = || prop::num::f64::NORMAL.prop_map(|x| x % 1e12);
    (0..Quantity::ALL.len(), number(), number(), 1.0..1e6_f64)
        .prop_map(|(place, value, error, freedom)| Parameter::new(Quantity::ALL[place], value, error.abs(), freedom))
}

proptest! {
    #[test]
    fn prop_an_estimate_that_is_read_is_written_the_same(
        parameters in prop::collection::vec(parameter(), 1..4),
        seed in -1.0..1.0_f64,
    ) {
        let entry = |i: usize, j: usize| seed / (1.0 + (i + j) as f64);
        let count = parameters.len();
        let estimate = Estimate {
            parameters,
            covariance: (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect(),
            stretches: vec![Stretch { file: "bs.mf4".to_owned(), start_s: 0.0, end_s: 40.0 }],
            iterations: 6,
            condition: 120.0,
        };
        let read = read_back(&estimate);
        prop_assert_eq!(serde_json::to_string(&read).unwrap(), serde_json::to_string(&estimate).unwrap());
        prop_assert_eq!(read_back(&read), read.clone());
        for (one, other) in read.parameters.iter().zip(&estimate.parameters) {
            prop_assert_eq!(one.quantity, other.quantity);
            prop_assert!((one.value - other.value).abs() <= 4.0 * f64::EPSILON * other.value.abs());
        }
    }

    #[test]
    fn prop_any_test_has_a_label_that_is_read_as_it_was_written(name in "[^\u{0}]{1,12}", torque: bool, nt: bool) {
        let excitation = if torque { Excitation::Torque } else { Excitation::Speed };
        let label = ExperimentLabel::new(Test::from(name.as_str()), excitation, if nt { ControlMode::Nt } else { ControlMode::Tn });
        prop_assert_eq!(read_back(&label), label);
    }
}
