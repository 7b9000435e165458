//! FMUs: what is in them, and what other programs make of them.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;

use bench_model::document::BenchModelDocument;
use bench_model::model::{AssembledModel, BenchModel, ModelParameter};
use export::fmu::{DRAWS, FmiVersion, c_files, fmu, linear_fmu, model_in, version_of};
use export::names::Names;
use export::{ExportError, ExportedFile};

use crate::cases::{Case, Drive, SAMPLES};
use crate::model::{document, late_demands};
use crate::others::{folder_with, largest, python as run};

fn names() -> Names {
    Names::of("Test cell 4")
}

fn made(document: &BenchModelDocument, version: FmiVersion) -> Vec<u8> {
    fmu(document, &names(), version, None).unwrap().content
}

fn with_model(model: BenchModel) -> BenchModelDocument {
    let whole = document();
    let uncertainty = whole.uncertainty.clone();
    BenchModelDocument::new(
        AssembledModel { model, uncertainty, engine_pulses: None, disturbances: None, dyno_friction: None },
        whole.bench.clone(),
        whole.provenance.clone(),
    )
}

/// The files of an archive, by its directory at the end.
pub(crate) fn unpacked(archive: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let number = |at: usize, bytes: usize| {
        archive[at..at + bytes].iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte))
    };
    let end = archive.len() - 22;
    assert_eq!(&archive[end..end + 4], b"PK\x05\x06");
    let (count, mut at) = (number(end + 10, 2), number(end + 16, 4));
    let mut files = BTreeMap::new();
    for _ in 0..count {
        assert_eq!(&archive[at..at + 4], b"PK\x01\x02");
        let (method, packed, length) = (number(at + 10, 2), number(at + 20, 4), number(at + 24, 4));
        let (name, start) = (number(at + 28, 2), number(at + 42, 4));
        let path = String::from_utf8(archive[at + 46..at + 46 + name].to_vec()).unwrap();
        let data = &archive[start + 30 + name..start + 30 + name + packed];
        let content = match method {
            0 => data.to_vec(),
            8 => {
                let mut content = Vec::new();
                flate2::read::DeflateDecoder::new(data).read_to_end(&mut content).unwrap();
                content
            }
            other => panic!("method {other}"),
        };
        let mut crc = flate2::Crc::new();
        crc.update(&content);
        assert_eq!((content.len(), crc.sum() as usize), (length, number(at + 16, 4)), "{path}");
        files.insert(path, content);
        at += 46 + name;
    }
    files
}

pub(crate) fn text(files: &BTreeMap<String, Vec<u8>>, path: &str) -> String {
    String::from_utf8(files[path].clone()).unwrap()
}

#[test]
fn exact_an_fmu_has_all_its_parts_and_the_same_bytes_again() {
    let report = b"<html></html>".as_slice();
    for (version, name, platforms) in
        [(FmiVersion::V2, "test_cell_4_fmi2.fmu", 4), (FmiVersion::V3, "test_cell_4_fmi3.fmu", 5)]
    {
        let archive = fmu(&document(), &names(), version, Some(report)).unwrap();
        assert_eq!(archive.name, name, "both versions fit into one folder");
        assert_eq!(version_of(&archive.content), Some(version));
        assert_eq!(archive, fmu(&document(), &names(), version, Some(report)).unwrap());
        assert!(archive.content[..512].windows(7).any(|bytes| bytes == b"dynoid "), "it names its program");
        let files = unpacked(&archive.content);
        assert_eq!(files.keys().filter(|path| path.starts_with("binaries/")).count(), platforms);
        let extra = "extra/org.fmi-standard.fmi-ls-ref";
        assert_eq!(files[&format!("{extra}/report.html")], report);
        let manifest = text(&files, &format!("{extra}/fmi-ls-manifest.xml"));
        for name in [
            "reference_in.csv",
            "reference_out.csv",
            "covariance.csv",
            "draws.csv",
            "draws.ssv",
            "report.html",
            "model.json",
        ] {
            assert!(manifest.contains(name) && files.contains_key(&format!("{extra}/{name}")), "{name}");
        }
        let model = model_in(&archive.content).unwrap();
        assert_eq!(BenchModelDocument::from_json(&model).unwrap().model, document().model);
        let description = text(&files, "modelDescription.xml");
        let of =
            |name: &str| description.split(&format!("name=\"{name}\"")).nth(1).unwrap().split("/>").next().unwrap();
        assert!(of("dyno_speed").contains("displayUnit=\"rpm\""), "{}", of("dyno_speed"));
        assert!(of("a").contains("rad/s") && !of("a").contains("rpm"), "a bandwidth is no speed: {}", of("a"));
        let token = description.split(['{', '}']).nth(1).unwrap();
        assert!(text(&files, "resources/bench.txt").contains(&format!("token {{{token}}}")));
    }
}

/// A model that is valid under load alone starts under load, in every target that starts by itself.
#[test]
fn exact_a_model_starts_where_it_is_valid() {
    let mut loaded = document();
    loaded.validity.air_gap_torque_nm = Some((20.0, 220.0));
    for version in [FmiVersion::V2, FmiVersion::V3] {
        let files = unpacked(&made(&loaded, version));
        let description = text(&files, "modelDescription.xml");
        let start = |name: &str| {
            let of = description.split(&format!("name=\"{name}\"")).nth(1).unwrap();
            of.split(" start=\"").nth(1).unwrap().split('"').next().unwrap().parse::<f64>().unwrap()
        };
        for name in ["torque_demand", "engine_torque", "initial_torque"] {
            assert_eq!(start(name), 120.0, "{name}");
        }
        assert_eq!((start("speed_demand"), start("initial_speed")), (170.0, 170.0));
        assert!(text(&files, "resources/bench.txt").contains("# 170 rad/s, 120 Nm"));
    }
    let modelica = String::from_utf8(export::modelica::bench(&loaded, &names()).content).unwrap();
    assert!(
        modelica.contains("T_start(unit = \"N.m\") = 120.0") && modelica.contains("w_start(unit = \"rad/s\") = 170.0")
    );
    let python = String::from_utf8(export::python::bench(&loaded, &names()).content).unwrap();
    assert!(python.contains("speed=170.0, torque=120.0"), "{python}");
    let example = c_files(&loaded, &names()).unwrap();
    let example = example.iter().find(|file| file.name.ends_with("_example.c")).unwrap();
    assert!(String::from_utf8(example.content.clone()).unwrap().contains(".torque_nm = 120"));
}

#[test]
fn exact_variables_have_their_nominal_values() {
    for version in [FmiVersion::V2, FmiVersion::V3] {
        let description = text(&unpacked(&made(&document(), version)), "modelDescription.xml");
        let nominal = |name: &str| {
            let of = description.split(&format!(" name=\"{name}\"")).nth(1).unwrap().split("/>").next().unwrap();
            of.split("nominal=\"").nth(1).map(|text| text.split('"').next().unwrap().parse::<f64>().unwrap())
        };
        assert_eq!((nominal("dyno_side_speed"), nominal("dyno_speed")), (Some(170.0), Some(170.0)));
        assert_eq!((nominal("shaft_torque"), nominal("K")), (Some(220.0), Some(2437.7)));
        assert!(nominal("twist").is_some_and(|twist| (twist - 220.0 / 2437.7).abs() < 1e-12));
        assert_eq!(nominal("time"), None);
    }
}

#[test]
fn exact_the_flange_of_the_engine_is_a_terminal() {
    let files = unpacked(&made(&document(), FmiVersion::V3));
    let terminals = text(&files, "terminalsAndIcons/terminalsAndIcons.xml");
    let description = text(&files, "modelDescription.xml");
    let members: Vec<&str> =
        terminals.split("variableName=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert_eq!(members, ["engine_torque", "engine_side_speed", "engine_angle"]);
    assert!(members.iter().all(|name| description.contains(&format!(" name=\"{name}\""))), "{members:?}");
}

/// No parser of XML takes a control character, whatever the bench is called.
#[test]
fn regress_control_characters_of_a_name_are_in_no_xml() {
    let mut named = document();
    named.bench.name = "a\u{1b}b\0c\u{fffe}".to_owned();
    for version in [FmiVersion::V2, FmiVersion::V3] {
        let files = unpacked(&made(&named, version));
        let texts =
            files.keys().filter(|path| [".xml", ".html", ".ssv", ".txt", ".csv"].iter().any(|end| path.ends_with(end)));
        for path in texts {
            let is_bad = |c: char| (c.is_control() && !"\r\n\t".contains(c)) || c == '\u{fffe}';
            assert!(!text(&files, path).contains(is_bad), "{path}");
        }
        assert!(text(&files, "modelDescription.xml").contains("modelName=\"abc\""));
    }
}

#[test]
fn exact_an_fmu_holds_the_draws_of_the_covariance() {
    let files = unpacked(&made(&document(), FmiVersion::V3));
    let draws = text(&files, "extra/org.fmi-standard.fmi-ls-ref/draws.csv");
    let mut lines = draws.lines();
    assert_eq!(lines.next(), Some("K,B,K_p,K_i,tau_c"));
    let expected = export::draws(&document(), DRAWS, 1);
    assert_eq!(lines.clone().count(), DRAWS);
    for (line, model) in lines.zip(&expected) {
        let stiffness: f64 = line.split(',').next().unwrap().parse().unwrap();
        assert_eq!(Some(stiffness), model.value(ModelParameter::Stiffness));
    }
    let covariance = text(&files, "extra/org.fmi-standard.fmi-ls-ref/covariance.csv");
    assert_eq!(covariance.lines().nth(1), Some("K,36,0.3,0,0,0"));
    assert_eq!(covariance.lines().nth(3), Some("K_p,0,0,0.0001,2e-5,0".replace("2e-5", "0.00002").as_str()));
}

/// Recordings that have ω_d* a sample later than the controller has it.
#[test]
fn ref_an_fmu_takes_the_demand_as_the_controller_has_it() {
    let recorded = |early_s: f64| {
        let mut model = document().model;
        let pi = model.speed_controller.as_mut().unwrap();
        (pi.delay_s, pi.demand_delay_s) = (3.1e-3, 1e-3 - early_s);
        model.feed_forward.as_mut().unwrap().delay_s = -early_s;
        model
    };
    let (late, own) = (recorded(1e-3), recorded(0.0));
    assert_eq!((late.with_demand_of_controller(), own.with_demand_of_controller()), (own.clone(), own.clone()));
    let files = |model: &BenchModel| c_files(&with_model(model.clone()), &names()).unwrap();
    // The numbers are the same; the header of the one says by how much a recorded demand is to be advanced.
    let numbers = |model: &BenchModel| {
        let text = String::from_utf8(files(model).swap_remove(0).content).unwrap();
        text.split("#ifndef").nth(1).unwrap().to_owned()
    };
    assert_eq!(numbers(&late), numbers(&own));
    assert!(!made(&with_model(late), FmiVersion::V2).is_empty());
    let folder = with_cases("fmu_controller", &with_model(own), &[Drive::Speed], false);
    if let Some(lines) = run("fmu.py", &folder) {
        assert!(largest(&lines) < 1e-11, "{lines}");
    }
}

#[test]
fn regress_a_delay_that_the_runtime_cannot_hold_is_refused() {
    let model = document().model.with(ModelParameter::TorqueControlDelay, 0.6);
    let error = fmu(&with_model(model), &names(), FmiVersion::V2, None).unwrap_err();
    assert!(matches!(error, ExportError::Delay { .. }), "{error}");
}

/// Simulations with their parameters, for the script.
fn with_cases(name: &str, document: &BenchModelDocument, drives: &[Drive], is_whole: bool) -> PathBuf {
    let file = |name: &str, version| ExportedFile { name: name.to_owned(), content: made(document, version) };
    let folder = folder_with(name, &[file("fmi2.fmu", FmiVersion::V2), file("fmi3.fmu", FmiVersion::V3)]);
    let model = &document.model;
    let cases: Vec<serde_json::Value> = drives.iter().map(|drive| Case::about(model, *drive).json(model)).collect();
    let held = |drive: &Drive| Case { engine: vec![38.0; SAMPLES], ..Case::about(model, *drive) }.json(model);
    let exchanged: Vec<serde_json::Value> = drives.iter().filter(|_| is_whole).map(held).collect();
    let number = |parameter| model.value(parameter).unwrap_or(0.0);
    let parameters = serde_json::json!({
        "K": number(ModelParameter::Stiffness),
        "k": number(ModelParameter::SpeedFeedForward),
        "a": number(ModelParameter::TorqueControlBandwidth),
    });
    let all =
        serde_json::json!({ "cases": cases, "parameters": parameters, "exchanged": exchanged, "compile": is_whole });
    std::fs::write(folder.join("cases.json"), all.to_string()).unwrap();
    folder
}

#[test]
fn ref_fmpy_simulates_an_fmu_as_the_program_does() {
    let folder = with_cases("fmu_whole", &document(), &[Drive::Speed, Drive::Torque], true);
    if let Some(lines) = run("fmu.py", &folder) {
        println!("{lines}");
        assert!(largest(&lines) < 1e-11, "{lines}");
    }
}

/// With a lag of the torque control and without.
#[test]
fn ref_directional_derivatives_are_those_of_finite_differences() {
    let bench = |name: &str, document: &BenchModelDocument, version| ExportedFile {
        name: name.to_owned(),
        content: made(document, version),
    };
    let without_lag = with_model(late_demands());
    let folder = folder_with(
        "fmu_derivatives",
        &[
            bench("fmi2.fmu", &document(), FmiVersion::V2),
            bench("fmi3.fmu", &document(), FmiVersion::V3),
            bench("without_lag.fmu", &without_lag, FmiVersion::V3),
        ],
    );
    if let Some(lines) = run("derivatives.py", &folder) {
        println!("{lines}");
        assert!(largest(&lines) < 1e-6, "{lines}");
    }
}

#[test]
fn ref_an_fmu_has_fractional_delays_gates_and_late_demands() {
    let model = late_demands();
    let mut early = document().model;
    let pi = early.speed_controller.as_mut().unwrap();
    (pi.delay_s, pi.demand_delay_s) = (2.3e-3, 0.2e-3);
    for (name, model) in [("fmu_late", model), ("fmu_early", early)] {
        let folder = with_cases(name, &with_model(model), &[Drive::Speed, Drive::Torque], false);
        if let Some(lines) = run("fmu.py", &folder) {
            println!("{lines}");
            assert!(largest(&lines) < 1e-11, "{lines}");
        }
    }
}

/// Compiles sources with the machine's compiler; `None`, and the test counts as skipped, where there is none.
pub(crate) fn compiled(folder: &Path, arguments: &[&str]) -> Option<()> {
    let Ok(output) = Command::new("cc").current_dir(folder).args(arguments).output() else {
        testdata::skip("no C compiler");
        return None;
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(())
}

pub(crate) fn printed(program: &Path, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    said
}

/// Compiles an FMU's sources with the misuse of its functions under sanitisers, and runs it.
fn misused(name: &str, archive: &[u8], resource: (&str, usize), kind: &str) {
    let files = unpacked(archive);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    for (path, content) in &files {
        let path = folder.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
    let misuse = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/fmu_misuse.c");
    let sources = files.keys().filter_map(|path| path.strip_prefix("sources/")).filter(|path| path.ends_with(".c"));
    let flags = ["-std=c99", "-g", "-O1", "-I.", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let last = [misuse.to_str().unwrap(), "-lm", "-o", "misuse"];
    let arguments: Vec<&str> = flags.into_iter().chain(sources).chain(last).collect();
    let Some(()) = compiled(&folder.join("sources"), &arguments) else { return };
    let resource = text(&files, resource.0).split_whitespace().nth(resource.1).unwrap().to_owned();
    let resources = folder.join("resources");
    let said = printed(&folder.join("sources/misuse"), &[resources.to_str().unwrap(), &resource, "20000", kind]);
    assert!(said.contains("failures 0"), "{said}");
}

#[test]
fn prop_wrong_calls_are_refused_and_no_calls_crash() {
    misused("fmu_misuse", &made(&document(), FmiVersion::V3), ("resources/bench.txt", 3), "bench");
    let (_, torques) = export::toolbox_models(&document()).unwrap().swap_remove(0);
    let linear = linear_fmu(&torques, &names(), FmiVersion::V3, "0.1.0").unwrap().content;
    misused("linear_misuse", &linear, ("resources/linear.txt", 2), "linear");
}

/// Two benches, and a linear model, in one folder and in one program.
#[test]
fn regress_models_in_one_folder_of_c_share_only_what_is_the_same() {
    let mut stiffer = document();
    stiffer.model.mechanics.stiffness_nm_per_rad = 3000.0;
    let (_, torques) = export::toolbox_models(&document()).unwrap().swap_remove(0);
    let all = [
        c_files(&document(), &names()).unwrap(),
        c_files(&stiffer, &Names::of("bench")).unwrap(),
        export::fmu::linear_c_files(&torques, &Names::of("linear"), "0.1.0").unwrap(),
    ];
    let mut found: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    for file in all.iter().flatten() {
        let is_other = found.insert(file.name.clone(), file.content.clone()).is_some_and(|other| other != file.content);
        assert!(!is_other, "{} is another file for each model", file.name);
    }
    let folder = folder_with("c_together", &all.concat());
    let program = "#include <stdio.h>\n#include \"test_cell_4.h\"\n#include \"bench_model.h\"\n#include \"linear_model.h\"\n\
        int main(void) {\n    printf(\"%g %g %d\\n\", TEST_CELL_4_MODEL[BENCH_STIFFNESS], BENCH_MODEL[BENCH_STIFFNESS], \
        LINEAR_MODEL.inputs);\n    return 0;\n}\n";
    std::fs::write(folder.join("together.c"), program).unwrap();
    let arguments =
        ["-std=c99", "-Wall", "-Werror", "together.c", "bench.c", "matrix.c", "linear.c", "-lm", "-o", "together"];
    let Some(()) = compiled(&folder, &arguments) else { return };
    assert_eq!(printed(&folder.join("together"), &[]).trim(), "2437.7 3000 2");
}

#[test]
fn ref_a_program_in_c_simulates_as_the_program_does() {
    let document = document();
    let folder = folder_with("c_target", &c_files(&document, &names()).unwrap());
    let warnings = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror"];
    let files = ["test_cell_4_example.c", "bench.c", "matrix.c", "-lm", "-o", "example"];
    let Some(()) = compiled(&folder, &[&warnings[..], &files[..]].concat()) else { return };
    let said = printed(&folder.join("example"), &[]);
    // The same in the program: 170 rad/s, the middle of the range, and 5 rad/s more after 0.1 s.
    let speed: Vec<f64> = (0..1001).map(|k| if k < 100 { 170.0 } else { 175.0 }).collect();
    let model = &document.model;
    let inputs = bench_model::simulate::Inputs {
        sample_time_s: 1e-3,
        engine_torque_nm: &[0.0; 1001],
        dyno: bench_model::simulate::DynoInput::SpeedDemand(&speed),
    };
    let start = bench_model::simulate::InitialState::steady(model, 170.0, 0.0);
    let response = bench_model::simulate::simulate(model, &inputs, &start).unwrap();
    let mut largest: f64 = 0.0;
    for (k, line) in said.lines().enumerate() {
        let numbers: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
        largest = largest.max((numbers[1] - response.dyno_speed_rad_s[k + 1]).abs() / 170.0);
        largest = largest.max((numbers[2] - response.shaft_torque_nm[k + 1]).abs() / 100.0);
    }
    println!("example in C {largest:e}");
    assert_eq!(said.lines().count(), 1000);
    assert!(largest < 1e-11, "{largest:e}");
}
