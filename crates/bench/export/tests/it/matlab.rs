//! Files for MATLAB and Octave.

use bench_model::model::BenchModel;
use export::matlab;
use export::names::Names;

use crate::cases::{Case, Drive};
use crate::model::{arx, document};
use crate::others::{folder_with, largest, octave, python};

/// A folder with both files and the cases to repeat.
fn folder(name: &str) -> std::path::PathBuf {
    let files = matlab::bench(&document(), &Names::of("Test cell 4")).unwrap();
    let folder = folder_with(name, &files);
    let model = BenchModel { torque_limit_nm: None, ..document().model };
    let columns = |series: &[&[f64]]| {
        let rows =
            (0..series[0].len()).map(|k| series.iter().map(|s| format!("{:e}", s[k])).collect::<Vec<_>>().join(","));
        rows.collect::<Vec<_>>().join("\n")
    };
    for (mode, drive) in [("nt", Drive::Speed), ("tn", Drive::Torque)] {
        let case = Case::from_rest(&model, drive);
        let response = case.response(&model);
        std::fs::write(folder.join(format!("{mode}_u.csv")), columns(&[&case.demand, &case.engine])).unwrap();
        let outputs = [
            &response.dyno_speed_rad_s[..],
            &response.engine_speed_rad_s,
            &response.air_gap_torque_nm,
            &response.shaft_torque_nm,
            &response.torque_demand_nm,
        ];
        std::fs::write(folder.join(format!("{mode}_y.csv")), columns(&outputs)).unwrap();
    }
    folder
}

#[test]
fn ref_scipy_reads_the_matrices_and_they_simulate_the_bench() {
    if let Some(lines) = python("matrices.py", &folder("matlab_scipy")) {
        assert!(largest(&lines) < 1e-9, "{lines}");
    }
}

#[test]
fn ref_octave_makes_systems_that_simulate_the_bench() {
    if let Some(lines) = octave("systems.m", &folder("matlab_octave")) {
        assert!(largest(&lines) < 1e-9, "{lines}");
    }
}

#[test]
fn ref_octave_simulates_linear_models() {
    let (model, expected) = arx();
    let folder = folder_with("matlab_linear", &matlab::linear(&model, &Names::of("arx"), "0.1.0").unwrap());
    let column = |key: &str| {
        let rows = expected[key].as_array().unwrap();
        rows.iter().map(|row| format!("{:e}", row[0].as_f64().unwrap())).collect::<Vec<_>>().join("\n")
    };
    std::fs::write(folder.join("u.csv"), column("u")).unwrap();
    std::fs::write(folder.join("y.csv"), column("y")).unwrap();
    if let Some(lines) = octave("linear.m", &folder) {
        assert!(largest(&lines) < 1e-12, "{lines}");
    }
}

#[test]
fn exact_the_function_has_the_name_of_its_file() {
    let files = matlab::bench(&document(), &Names::of("Test cell 4")).unwrap();
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["test_cell_4.mat", "test_cell_4.m"]);
    let function = String::from_utf8(files[1].content.clone()).unwrap();
    assert!(function.starts_with("function [tn, nt, plant, bench] = test_cell_4 ()\n% TEST_CELL_4 "), "{function}");
    assert!(!function.contains('@'), "every place is filled");
    assert!(files[0].content.starts_with(b"MATLAB 5.0 MAT-file"));
}
