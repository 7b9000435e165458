//! Formulas, and grey-box structures made of them.

use faer::{Mat, mat};
use ident::{
    AnyModel, Dataset, EstimateRecord, Formula, FormulaStructure, GreyBox, GreyBoxModel, GreyNoise, IdentError, Label,
    LinearModel, ModelDocument, Parametric, Structure, StructureFault,
};
use lti::StateSpace;
use proptest::prelude::*;

use crate::noise::Noise;

fn value(text: &str) -> f64 {
    let formula: Formula = text.parse().unwrap();
    let values: Vec<f64> = formula
        .names()
        .iter()
        .map(|name| ["a", "b_1", "Ω"].iter().position(|n| n == name).unwrap() as f64 + 2.0)
        .collect();
    formula.evaluate(|index| values[index])
}

#[test]
fn exact_operators_bind_as_on_paper() {
    for (text, expected) in [
        ("1 + 2*3", 7.0),
        ("1 - 2 - 3", -4.0),
        ("16/4/2", 2.0),
        ("2/3*6", 4.0),
        ("2^3^2", 512.0),
        ("-2^2", -4.0),
        ("(-2)^2", 4.0),
        ("2^-1", 0.5),
        ("2*-3", -6.0),
        ("1--1", 2.0),
        ("2^-2^2", 0.0625),
        ("-a*b_1", -6.0),
        ("a - -b_1^a", 11.0),
        ("sqrt(16) + exp(0)*Ω", 8.0),
        ("sqrt (a*(b_1 + Ω + 1))", 4.0),
        ("1.5e2 + .5 + 2.E-1", 150.7),
        ("  ( ( 3 ) )  ", 3.0),
        ("2*pi/pi", 2.0),
    ] {
        assert!((value(text) - expected).abs() < 1e-13, "{text}: {}", value(text));
    }
    assert!(value("1/(a - 2)").is_infinite() && value("sqrt(0 - 1)").is_nan());
}

#[test]
fn regress_errors_name_the_position_and_what_was_expected() {
    for (text, at, words) in [
        ("", 1, "a number, a name"),
        ("1 +", 4, "a number, a name"),
        ("(1 + 2", 7, "\")\""),
        ("1 + 2)", 6, "the end"),
        ("2K", 2, "an operator"),
        ("a b", 3, "an operator"),
        ("Ω + sin(a)", 5, "sqrt or exp"),
        ("sqrt 2", 6, "\"(\""),
        ("1 + *", 5, "a number, a name"),
        ("1e999", 1, "finite"),
        (".", 1, "finite"),
        ("a $ b", 3, "an operator"),
        ("2e", 2, "an operator"),
    ] {
        match text.parse::<Formula>() {
            Err(IdentError::Formula { formula, position, expected }) => {
                assert_eq!((formula.as_str(), position), (text, at));
                assert!(expected.contains(words), "{text}: {expected}");
            }
            other => panic!("{text}: {other:?}"),
        }
    }
    for deep in ["(".repeat(100_000), "-".repeat(100_000), "2^".repeat(100_000), "1+(2*3^(".repeat(20)] {
        let text = format!("{deep}1");
        assert!(
            matches!(text.parse::<Formula>(), Err(IdentError::Formula { expected, .. }) if expected.contains("nested"))
        );
    }
    assert_eq!(value(&format!("0{}", "+1".repeat(10_000))), 10_000.0);
}

proptest! {
    #[test]
    fn prop_no_text_makes_the_parser_fail_otherwise(text in "[-+*/^() .0-9aΩespiqrtx_]{0,40}") {
        if let Ok(formula) = text.parse::<Formula>() {
            let _ = formula.evaluate(|_| 1.5);
            prop_assert_eq!(formula.to_string().parse::<Formula>().unwrap(), formula);
        }
    }

    #[test]
    fn prop_numbers_come_back_bit_for_bit(number in proptest::num::f64::NORMAL | proptest::num::f64::ZERO) {
        let formula = Formula::try_from(number).unwrap();
        prop_assert_eq!(formula.evaluate(|_| 0.0).to_bits(), number.to_bits());
    }
}

/// Two inertias on a shaft; the states are both speeds and the twist.
const TWO_MASS: &str = r#"{
    "parameters": {
        "J_e": { "value": 0.5, "min": 0.01, "max": 10 },
        "J_d": { "value": 0.6, "fixed": true },
        "K": { "value": 1500, "min": 0 },
        "B": { "value": 3, "min": 0 }
    },
    "matrices": {
        "A": [["-B/J_d", "B/J_d", "-K/J_d"], ["B/J_e", "-B/J_e", "K/J_e"], [1, -1, 0]],
        "B": [["1/J_d"], [0], [0]],
        "C": [[1, 0, 0], [0, 1, 0]]
    },
    "derived": { "resonance_rad_s": "sqrt(K*(1/J_d + 1/J_e))", "ratio": "J_e/J_d" }
}"#;

fn two_mass() -> FormulaStructure {
    serde_json::from_str(TWO_MASS).unwrap()
}

fn shaken(noise_level: f64) -> Dataset {
    let (jd, je, k, b) = (0.6, 0.28, 2437.7, 4.2);
    let a = mat![[-b / jd, b / jd, -k / jd], [b / je, -b / je, k / je], [1.0, -1.0, 0.0]];
    let c = mat![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let system = StateSpace::continuous(a, mat![[1.0 / jd], [0.0], [0.0]], c, Mat::zeros(2, 1)).unwrap();
    let mut noise = Noise::new(11);
    let u = Mat::from_fn(2000, 1, |_, _| 20.0 * noise.normal());
    let mut y = system.to_discrete_zoh(0.005).unwrap().simulate(u.as_ref(), &[1.0, 2.0, 0.001]).unwrap();
    (0..2000).for_each(|t| (0..2).for_each(|i| y[(t, i)] += noise_level * noise.normal()));
    Dataset::new(0.005, u, y).unwrap()
}

#[test]
fn exact_two_masses_written_as_formulas() {
    let fit = GreyBox::new(two_mass()).fit(&shaken(0.0)).unwrap();
    assert_eq!(fit.model.parameter_names(), ["J_e", "J_d", "K", "B"]);
    for (found, truth) in fit.parameters().iter().zip([0.28, 0.6, 2437.7, 4.2]) {
        assert!((found / truth - 1.0).abs() < 1e-7, "{:?}", fit.parameters());
    }
}

#[test]
fn stat_derived_quantities_carry_the_errors_of_the_delta_method() {
    let fit = GreyBox::new(two_mass()).fit(&shaken(0.1)).unwrap();
    let derived = fit.derive(|m| Ok(m.derived().into_iter().map(|(_, v)| v).collect())).unwrap();
    let errors = derived.standard_errors();
    // The ratio is J_e over a known number, so its error is that of J_e over it.
    assert!((errors[1] / (fit.standard_errors()[0] / 0.6) - 1.0).abs() < 1e-9);
    let (je, jd, k) = (fit.parameters()[0], 0.6, fit.parameters()[2]);
    let resonance = (k * (1.0 / jd + 1.0 / je)).sqrt();
    assert!((derived.values[0] / resonance - 1.0).abs() < 1e-14);
    let gradient = [-k / (je * je) / (2.0 * resonance), (1.0 / jd + 1.0 / je) / (2.0 * resonance)];
    let p = &fit.covariance;
    let variance = gradient[0] * gradient[0] * p[(0, 0)]
        + 2.0 * gradient[0] * gradient[1] * p[(0, 2)]
        + gradient[1] * gradient[1] * p[(2, 2)];
    assert!((errors[0] / variance.sqrt() - 1.0).abs() < 1e-5, "{} {}", errors[0], variance.sqrt());
    let truth = (2437.7_f64 * (1.0 / 0.6 + 1.0 / 0.28)).sqrt();
    assert!((derived.values[0] - truth).abs() < 4.0 * errors[0]);
}

fn document() -> ModelDocument {
    let data = shaken(0.1);
    let fit = GreyBox::new(two_mass()).fit(&data).unwrap();
    let record = EstimateRecord::new(&fit, "grey box", Vec::new());
    let labels = |names: &[&str]| names.iter().map(|n| Label::new(*n, "")).collect();
    let mut document = ModelDocument::new(fit.model, labels(&["T"]), labels(&["w_d", "w_e"]), 0.005);
    document.estimate = Some(record);
    document
}

#[test]
fn exact_a_document_comes_back_bit_for_bit() {
    let document = document();
    let text = serde_json::to_string(&document).unwrap();
    let read = serde_json::from_str::<ModelDocument>(&text).unwrap().checked().unwrap();
    assert_eq!(read, document);
    assert_eq!(read.fit().unwrap().standard_errors()[1], 0.0);
    let AnyModel::GreyBox(model) = &read.model else { panic!("another kind of model") };
    assert_eq!(model.structure(), &two_mass());
    let form = |d: &ModelDocument| d.model.innovations(0.005, d.intersample).unwrap();
    assert_eq!(form(&read), form(&document));
}

#[test]
fn regress_an_estimate_of_parameters_in_another_order_is_refused() {
    let mut document = document();
    let record = document.estimate.as_mut().unwrap();
    record.parameter_names.swap(0, 2);
    assert!(matches!(document.fit(), Err(IdentError::Document { .. })));
    let text = serde_json::to_string(&document.model).unwrap();
    let short = text.replace("\"parameters\":{\"B\":", "\"parameters\":{\"Q\":");
    assert_ne!(text, short);
    assert!(serde_json::from_str::<AnyModel>(&short).is_err());
}

#[test]
fn exact_discrete_structures_with_gain_and_delayed_ones() {
    let text = r#"{
        "sample_time_s": 0.1,
        "parameters": { "a": { "value": 0.5, "prior": { "mean": 0.6, "sd": 0.1 } }, "k": { "value": 0.2 } },
        "matrices": { "A": [["a"]], "B": [["1 - a"]], "C": [[1]], "D": [[0.5]], "K": [["k/2"]] }
    }"#;
    let structure: FormulaStructure = serde_json::from_str(text).unwrap();
    assert_eq!(structure.parameters()[0].prior, Some((0.6, 0.1)));
    assert_eq!(structure.noise(&[0.5, 0.2]), GreyNoise::Gain(mat![[0.1]]));
    let system = structure.system(&[0.75, 0.2]).unwrap();
    assert_eq!((system.b()[(0, 0)], system.d()[(0, 0)], system.sample_time_s()), (0.25, 0.5, Some(0.1)));
    let written = serde_json::to_string(&structure).unwrap();
    assert_eq!(serde_json::from_str::<FormulaStructure>(&written).unwrap(), structure);
    let delayed = TWO_MASS.replacen('{', "{ \"input_delays_s\": [\"B/1000\"],", 1);
    let model = GreyBoxModel::new(serde_json::from_str::<FormulaStructure>(&delayed).unwrap()).unwrap();
    assert_eq!(model.input_delay_s(0), 0.003);
    assert!(structure.system(&[]).is_err(), "too few parameters");
}

#[test]
fn regress_faults_of_a_structure_are_named() {
    let refused = |from: &str, to: &str| {
        let text = TWO_MASS.replacen(from, to, 1);
        assert_ne!(text, TWO_MASS, "{from}");
        serde_json::from_str::<FormulaStructure>(&text).unwrap_err().to_string()
    };
    for (from, to, words) in [
        ("\"1/J_d\"", "\"1/J_x\"", "B, row 1, column 1: there is no parameter \"J_x\""),
        ("\"1/J_d\"", "\"1/\"", "character 3"),
        ("\"1/J_d\"", "true", "a number, or a formula"),
        ("[1, -1, 0]", "[1, -1]", "A: 3 × 2 entries where 3 × 3"),
        ("[[1, 0, 0], [0, 1, 0]]", "[]", "C: 0 × 3 entries where 1 × 3"),
        ("\"K\": {", "\"g\": { \"value\": 1 }, \"K\": {", "parameter \"g\": no matrix"),
        ("\"K\": {", "\"g\": { \"value\": 1, \"fixed\": true }, \"K\": {", "parameter \"g\": no matrix"),
        ("\"K\": {", "\"B\": { \"value\": 1 }, \"K\": {", "parameter \"B\": the name is given twice"),
        ("\"K\": {", "\"pi\": { \"value\": 1 }, \"K\": {", "parameter \"pi\": a name has"),
        ("\"value\": 1500", "\"value\": -1", "parameter \"K\": the value -1"),
        ("\"value\": 1500", "\"valu\": 1", "valu"),
        ("\"value\": 3", "\"value\": 3, \"prior\": { \"mean\": 1, \"sd\": 0 }", "parameter \"B\": a prior"),
        ("\"matrices\"", "\"input_delays_s\": [0, 0], \"matrices\"", "input_delays_s: 1 × 2 entries where 1 × 1"),
        ("\"matrices\"", "\"sample_time_s\": 0.1, \"input_delays_s\": [1], \"matrices\"", "discrete"),
        ("\"matrices\"", "\"sample_time_s\": -1, \"matrices\"", "sample time -1"),
        ("J_e/J_d", "J_e/Q", "derived ratio: there is no parameter \"Q\""),
    ] {
        let reason = refused(from, to);
        assert!(reason.contains(words), "`{words}` is not in: {reason}");
    }
    let parts = ident::FormulaParts::default();
    let found = FormulaStructure::new(parts).unwrap_err();
    let shape = StructureFault::Shape { expected: (1, 1).into(), found: (0, 1).into() };
    assert_eq!(found, IdentError::FormulaStructure { place: "A".into(), fault: shape });
}

#[test]
fn regress_messages_show_a_part_of_long_formulas() {
    let long = format!("{}1", "(".repeat(100_000));
    let message = long.parse::<Formula>().unwrap_err().to_string();
    assert!(message.len() < 400, "{}", message.len());
}
