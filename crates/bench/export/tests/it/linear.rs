//! A bench model as linear models.

use std::f64::consts::TAU;

use export::names::Names;
use export::{ExportError, ExportedFile};
use ident::uncertainty::Dynamics;
use ident::{Line, LinearModel, Trend};

use crate::model::{arx, document};

#[test]
fn exact_the_linear_models_have_the_responses_of_the_bench() {
    let models = export::toolbox_models(&document()).unwrap();
    assert_eq!(models.iter().map(|(mode, _)| *mode).collect::<Vec<_>>(), ["TN torques", "TN speeds", "NT"]);
    let bench = document().model;
    let omega: Vec<f64> = [0.5, 3.0, 18.0, 40.0].iter().map(|f| TAU * f).collect();
    let tn = models[0].1.model.frequency_response(1, 0, &omega).unwrap();
    let speeds = models[1].1.model.frequency_response(0, 1, &omega).unwrap();
    let nt = models[2].1.model.frequency_response(0, 0, &omega).unwrap();
    for (k, omega) in omega.iter().enumerate() {
        let expected = bench.demand_to_shaft(*omega).unwrap();
        assert!((tn.response[k] - expected).norm() < 1e-9 * expected.norm(), "TN at {omega}");
        let expected = bench.mechanics.engine_to_speed(*omega);
        assert!((speeds.response[k] - expected).norm() < 1e-9 * expected.norm(), "speeds at {omega}");
        // The analysis leaves out what sampling folds; the discrete model reads the speed with its gate.
        let gate = bench_model::model::mean_over(bench.encoder_gate_s, *omega);
        let expected = bench.speed_demand_to_speed(*omega).unwrap() * gate;
        assert!(
            (nt.response[k] - expected).norm() < 0.02 * expected.norm(),
            "NT at {omega}: {} {expected}",
            nt.response[k]
        );
    }
}

#[test]
fn exact_the_covariance_goes_with_the_parameters() {
    let (_, tn) = &export::toolbox_models(&document()).unwrap()[0];
    let fit = tn.fit().unwrap();
    let names = &tn.estimate.as_ref().unwrap().parameter_names;
    let place = |name: &str| names.iter().position(|other| other == name).unwrap();
    assert_eq!(names.len(), 6);
    assert_eq!(fit.covariance[(place("K"), place("B"))], 0.3);
    assert_eq!(fit.covariance[(place("J_d"), place("J_d"))], 0.0, "exact");
    assert_eq!(fit.degrees_of_freedom, 40.0);
    assert_eq!((fit.model.inputs(), fit.model.outputs()), (2, 2));
    let text = serde_json::to_string(tn).unwrap();
    let read: ident::ModelDocument = serde_json::from_str(&text).unwrap();
    assert!(read.checked().is_ok());
}

#[test]
fn exact_a_bench_without_controllers_has_the_mechanics() {
    let mut bare = document();
    (bare.model.torque_control, bare.model.speed_controller, bare.model.feed_forward) = (None, None, None);
    let models = export::toolbox_models(&bare).unwrap();
    assert_eq!(models.len(), 2);
    assert_eq!(models[0].1.inputs[0].name, "T_d");
    let expected = bare.model.mechanics.torque_to_shaft(30.0);
    let found = models[0].1.model.frequency_response(1, 0, &[30.0]).unwrap().response[0];
    assert!((found - expected).norm() < 1e-12);
    let expected = bare.model.mechanics.torque_to_speed(30.0);
    let found = models[1].1.model.frequency_response(0, 0, &[30.0]).unwrap().response[0];
    assert!((found - expected).norm() < 1e-12 * expected.norm());
    let poles = models[1].1.model.system().unwrap().poles().unwrap();
    assert!(poles.iter().any(|pole| pole.norm() == 0.0), "the speeds integrate exactly: {poles:?}");
}

#[test]
fn exact_linear_models_name_the_levels_that_they_are_about() {
    let texts = |trend: Option<Trend>| -> Vec<String> {
        let (mut model, _) = arx();
        model.trend = trend;
        let names = Names::of("arx");
        let mut files = export::matlab::linear(&model, &names, "0").unwrap();
        files.retain(|file| file.name.ends_with(".m"));
        files.push(export::python::linear(&model, &names, "0").unwrap());
        files.push(export::modelica::linear(&model, &names, "0").unwrap());
        files.push(export::fmu::linear_c_files(&model, &names, "0").unwrap().remove(0));
        files.into_iter().map(|file: ExportedFile| String::from_utf8(file.content).unwrap()).collect()
    };
    let all_have = |trend, sentence: &str| {
        for text in texts(trend) {
            assert!(text.contains(sentence), "{text}");
        }
    };
    all_have(None, "Inputs and outputs are absolute values.");
    let levels = Trend::offsets(&[60.5], &[1200.25]).unwrap();
    assert!(texts(Some(levels.clone()))[1].contains("OUTPUT_LEVELS = [1200.25]"));
    all_have(Some(levels), "Levels of the inputs: 60.5; of the outputs: 1200.25.");
    let drifting = Line { slope_per_s: 0.1, ..Line::level(3.0) };
    let each = Trend::per_experiment(vec![vec![drifting]], vec![vec![Line::level(1.0)]]).unwrap();
    assert!(texts(Some(each.clone()))[1].contains("INPUT_LEVELS = None"));
    all_have(Some(each), "the mean or trend of each recording");
}

#[test]
fn regress_a_delay_of_seconds_makes_no_file_of_hundreds_of_megabytes() {
    let mut long = document();
    let pi = long.model.speed_controller.as_mut().unwrap();
    (pi.delay_s, pi.demand_delay_s) = (5.0, 5.0);
    let error = export::matlab::bench(&long, &Names::of("long")).unwrap_err();
    assert!(matches!(error, ExportError::TooLarge { target: "mat", .. }), "{error}");
}
