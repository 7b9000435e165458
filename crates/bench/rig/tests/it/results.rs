//! Estimates are in SI; what is written is in the units people read.

use rig::results::{Estimate, Parameter, Quantity, Stretch};
use units::RPM_RAD_S;

fn estimate() -> Estimate {
    Estimate {
        parameters: vec![
            Parameter::new(Quantity::ProportionalGain, 9.0, 0.2, 50.0),
            Parameter::new(Quantity::ControllerDelay, 1e-3, 1e-5, 50.0),
        ],
        covariance: vec![vec![0.04, 1e-6], vec![1e-6, 1e-10]],
        stretches: vec![Stretch { file: "bs.mf4".to_owned(), start_s: 0.0, end_s: 40.0 }],
        iterations: 6,
        condition: 120.0,
    }
}

fn near(found: &serde_json::Value, expected: f64) {
    let found = found.as_f64().unwrap();
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
}

#[test]
fn exact_json_has_the_units_people_read() {
    let json = serde_json::to_value(estimate()).unwrap();
    let gain = &json["parameters"][0];
    assert_eq!(gain["symbol"], "K_p");
    assert_eq!(gain["name"], "proportional gain");
    assert_eq!(gain["unit"], "Nm/rpm");
    near(&gain["value"], 9.0 * RPM_RAD_S);
    near(&gain["standard_error"], 0.2 * RPM_RAD_S);
    let own = &estimate().parameters[0];
    near(&gain["interval"][0], own.interval.0 * RPM_RAD_S);
    near(&gain["interval"][1], own.interval.1 * RPM_RAD_S);
    near(&gain["degrees_of_freedom"], 50.0);
    near(&json["covariance"][0][0], 0.04 * RPM_RAD_S * RPM_RAD_S);
    near(&json["covariance"][0][1], 1e-6 * RPM_RAD_S);
    near(&json["covariance"][1][1], 1e-10);
    let keys: Vec<&String> = gain.as_object().unwrap().keys().collect();
    assert_eq!(keys.len(), 8, "{keys:?}");
    assert_eq!(gain["key"], "proportional_gain");
}

#[test]
fn exact_units_for_people_agree_with_the_table_of_units() {
    let of = |quantity: Quantity| {
        let notation = quantity.notation();
        let si = |unit: &str| units::parse_unit(unit).unwrap().factor;
        (notation.per_si, si(notation.si_unit) / si(notation.unit))
    };
    for quantity in [Quantity::ProportionalGain, Quantity::SpeedErrorOffset, Quantity::FiringResonanceSpeed] {
        let (ours, theirs) = of(quantity);
        assert!((ours / theirs - 1.0).abs() < 1e-12, "{quantity}: {ours} {theirs}");
    }
}

#[test]
fn exact_a_quantity_is_found_by_what_it_is() {
    let found = estimate();
    assert_eq!(found.place(Quantity::ControllerDelay), Some(1));
    assert_eq!(found.parameter(Quantity::ControllerDelay).unwrap().value, 1e-3);
    // The torque control has a τ of its own.
    assert!(found.parameter(Quantity::TorqueControlDelay).is_none());
    assert_eq!(Quantity::TorqueControlDelay.symbol(), Quantity::ControllerDelay.symbol());
}

#[test]
fn exact_in_si_for_people_who_want_that() {
    let gain = estimate().parameters[0].written_in_si();
    assert_eq!((gain.notation.unit, gain.value), ("Nm s/rad", 9.0));
}
