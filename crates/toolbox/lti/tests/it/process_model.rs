//! Process models: formula, parameters, writing down, refusals.

use lti::{Complex64, LtiError, ProcessModel};
use proptest::prelude::*;

fn full() -> ProcessModel {
    ProcessModel::new(2.0)
        .and_then(|m| m.with_pair(0.5, 0.3))
        .and_then(|m| m.with_lags(vec![4.0]))
        .and_then(|m| m.with_zero(-1.5))
        .and_then(|m| m.with_delay(0.7))
        .unwrap()
        .with_integrator()
}

#[test]
fn exact_transfer_function_is_the_formula() {
    let s = Complex64::new(0.2, 1.3);
    let expected = (1.0 - 1.5 * s) * 2.0 / ((1.0 + 0.3 * s + 0.25 * s * s) * (1.0 + 4.0 * s) * s) * (-0.7 * s).exp();
    let got = full().to_transfer_function().unwrap().evaluate(s);
    assert!((got - expected).norm() < 1e-15 * expected.norm());
    let three = ProcessModel::new(-1.0).unwrap().with_lags(vec![1.0, 0.0, -3.0]).unwrap();
    assert_eq!(three.to_transfer_function().unwrap().den(), [-3.0, -2.0, 1.0]);
}

#[test]
fn exact_names_follow_the_parameters() {
    assert_eq!(full().parameter_names(), ["K", "Tw", "zeta", "Tp3", "Tz", "Td"]);
    assert_eq!(full().parameters(), [2.0, 0.5, 0.3, 4.0, -1.5, 0.7]);
    let two = ProcessModel::new(1.0).unwrap().with_lags(vec![1.0, 2.0]).unwrap();
    assert_eq!(two.parameter_names(), ["K", "Tp1", "Tp2"]);
}

#[test]
fn exact_impossible_models_are_refused() {
    let order = |model: Result<ProcessModel, LtiError>| matches!(model, Err(LtiError::Order { .. }));
    assert!(order(ProcessModel::new(1.0).unwrap().with_lags(vec![1.0; 4])));
    assert!(order(full().with_lags(vec![1.0, 2.0])));
    assert!(matches!(full().with_delay(-0.1), Err(LtiError::Delay { .. })));
    assert!(matches!(full().with_parameters(&[1.0]), Err(LtiError::Shape { .. })));
    assert!(matches!(ProcessModel::new(f64::NAN), Err(LtiError::NonFinite { .. })));
    let text = serde_json::to_string(&full()).unwrap();
    assert!(serde_json::from_str::<ProcessModel>(&text.replace("0.7", "-0.7")).is_err());
}

proptest! {
    #[test]
    fn prop_parameters_and_text_give_the_model_back(values in prop::collection::vec(0.01_f64..10.0, 6)) {
        let model = full().with_parameters(&values).unwrap();
        prop_assert_eq!(&model.parameters(), &values);
        let text = serde_json::to_string(&model).unwrap();
        let read = serde_json::from_str::<ProcessModel>(&text).unwrap();
        prop_assert_eq!(read.parameter_names(), model.parameter_names());
        prop_assert!(read.parameters().iter().zip(&values).all(|(a, b)| (a - b).abs() <= f64::EPSILON * b));
    }
}
