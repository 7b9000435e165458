//! Parameter sets of SSP.

use export::names::Names;
use export::{ExportError, ssv};

use crate::model::document;
use crate::others::{folder_with, python};

#[test]
fn exact_parameters_have_their_values_and_units() {
    let files = ssv::bench(&document(), &Names::of("Test cell 4"), 2).unwrap();
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    let expected =
        ["test_cell_4.ssv", "test_cell_4_uncertainty.ssv", "test_cell_4_draw_1.ssv", "test_cell_4_draw_2.ssv"];
    assert_eq!(names, expected);
    let text = String::from_utf8(files[0].content.clone()).unwrap();
    assert!(
        text.contains("name=\"K\" description=\"stiffness\"><ssv:Real value=\"2437.7\" unit=\"N.m/rad\"/>"),
        "{text}"
    );
    assert!(text.contains("<ssc:Unit name=\"N.m/rad\"><ssc:BaseUnit kg=\"1\" m=\"2\" s=\"-2\" rad=\"-1\"/>"), "{text}");
    let uncertainty = String::from_utf8(files[1].content.clone()).unwrap();
    let value = |name: &str| {
        let line = uncertainty.lines().find(|line| line.contains(&format!("name=\"{name}\""))).unwrap();
        line.split("value=\"").nth(1).unwrap().split('"').next().unwrap().parse::<f64>().unwrap()
    };
    let shaft = ["cov(K,K)", "cov(K,B)", "cov(B,B)", "degrees_of_freedom_1"].map(value);
    assert_eq!(shaft, [36.0, 0.3, 0.04, 40.0]);
    assert_eq!(uncertainty.matches("cov(").count(), 3 + 6, "each once, of parts that are independent");
    assert_ne!(files[2].content, files[3].content);
}

/// No parser of XML takes a control character, and no compiler of Python a NUL.
#[test]
fn regress_control_characters_of_a_name_are_in_no_file() {
    let mut named = document();
    named.bench.name = "a\u{1b}b\0c\u{fffe}".to_owned();
    let names = Names::of(&named.bench.name);
    let mut files = ssv::bench(&named, &names, 0).unwrap();
    files.push(export::python::bench(&named, &names));
    files.push(export::modelica::bench(&named, &names));
    files.extend(export::matlab::bench(&named, &names).unwrap().into_iter().filter(|file| file.name.ends_with(".m")));
    for file in files {
        let text = String::from_utf8(file.content).unwrap();
        let is_bad = |c: char| (c.is_control() && c != '\n') || c == '\u{fffe}';
        assert!(!text.contains(is_bad), "{}: {text}", file.name);
    }
}

/// Recordings that have ω_d* two samples later than the controller has it: a FMU refuses a negative delay.
#[test]
fn regress_a_set_has_the_delays_of_the_fmu() {
    let mut early = document();
    early.model.speed_controller.as_mut().unwrap().demand_delay_s = -1e-3;
    early.model.feed_forward.as_mut().unwrap().delay_s = -2e-3;
    for file in ssv::bench(&early, &Names::of("early"), 1).unwrap().iter().filter(|file| !file.name.contains("uncert"))
    {
        let text = String::from_utf8(file.content.clone()).unwrap();
        let delay = |name: &str| {
            let line = text.lines().find(|line| line.contains(&format!("name=\"{name}\""))).unwrap();
            let value = line.split("value=\"").nth(1).unwrap().split('"').next().unwrap();
            value.parse::<f64>().unwrap()
        };
        assert!((delay("tau_n") - 1e-3).abs() < 1e-12 && delay("tau_f").abs() < 1e-12, "{text}");
    }
}

/// A delay that is sometimes above and sometimes below where one more sample of lead is needed: a draw has that of the
/// estimate, as the FMU states it and as its own draws have it.
#[test]
fn regress_all_draws_have_the_lead_that_the_fmu_states() {
    let mut document = document();
    let pi = document.model.speed_controller.as_mut().unwrap();
    (pi.delay_s, pi.demand_delay_s) = (2.6e-3, 0.0);
    document.model.torque_control.as_mut().unwrap().delay_s = 0.41e-3;
    document.uncertainty = bench_model::model::ModelUncertainty::new(&[bench_model::model::PartCovariance {
        parameters: vec![bench_model::model::ModelParameter::ControllerDelay],
        covariance: vec![vec![1e-9]],
        degrees_of_freedom: f64::INFINITY,
    }])
    .unwrap();
    let leads: Vec<usize> = export::draws(&document, 20, 1).iter().map(|model| model.demand_lead()).collect();
    assert!(leads.contains(&0) && leads.contains(&1), "the draws need different leads: {leads:?}");
    assert_eq!(document.model.demand_lead(), 0);
    for file in ssv::bench(&document, &Names::of("drawn"), 20).unwrap() {
        let text = String::from_utf8(file.content).unwrap();
        let Some(line) = text.lines().find(|line| line.contains("name=\"tau_n\"")) else { continue };
        assert!(line.contains("value=\"0.0\""), "{}: {line}", file.name);
    }
}

#[test]
fn ref_the_sets_are_valid_by_the_schema() {
    let mut odd = document();
    odd.bench.name = "cell <4> & \"5\" -- \u{1} ü".into();
    let folder = folder_with("ssv", &ssv::bench(&odd, &Names::of("odd"), 1).unwrap());
    if let Some(lines) = python("parameter_sets.py", &folder) {
        assert!(lines.contains("3 sets"), "{lines}");
    }
}

#[test]
fn regress_a_bench_that_can_hardly_be_drawn_is_refused() {
    let mut document = document();
    document.uncertainty = bench_model::model::ModelUncertainty::new(&[bench_model::model::PartCovariance {
        parameters: vec![bench_model::model::ModelParameter::Stiffness; 1],
        covariance: vec![vec![1e30]],
        degrees_of_freedom: f64::INFINITY,
    }])
    .unwrap();
    document.model.mechanics.stiffness_nm_per_rad = -1e16;
    let error = ssv::bench(&document, &Names::of("x"), 3).unwrap_err();
    assert_eq!(error, ExportError::NoDraws);
}
