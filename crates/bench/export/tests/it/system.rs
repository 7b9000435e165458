//! A bench and the place of an engine as a system of SSP.

use export::fmu::{FmiVersion, linear_fmu, ssp};
use export::names::Names;
use ident::{FormulaStructure, GreyBoxModel, Label, ModelDocument};

use crate::fmu::{text, unpacked};
use crate::model::document;
use crate::others::{folder_with, largest, python};

/// An engine that brakes with 0.3 Nm s/rad of its speed, with a lag of 20 ms.
fn engine() -> ModelDocument {
    let structure = serde_json::json!({
        "parameters": { "c": { "value": 0.3 }, "a": { "value": 50.0 } },
        "matrices": { "A": [["-a"]], "B": [["-a*c"]], "C": [["1"]] },
    });
    let structure: FormulaStructure = serde_json::from_value(structure).unwrap();
    let label = |name: &str, unit: &str| vec![Label::new(name, unit)];
    ModelDocument::new(GreyBoxModel::new(structure).unwrap(), label("w", "rad/s"), label("tau", "Nm"), 1e-3)
}

/// The schema, the rules beyond it, and a simulation of the system with an engine in its place.
#[test]
fn ref_fmpy_opens_the_system_and_simulates_it_with_an_engine() {
    let mut plant = document();
    plant.model.speed_controller = None;
    plant.model.feed_forward = None;
    plant.bench.name = "cell <4> & \"5\" ü".into();
    let mut fmu = linear_fmu(&engine(), &Names::of("engine"), FmiVersion::V2, "0.1.0").unwrap();
    fmu.name = "engine.fmu".into();
    let systems = [
        ssp(&document(), &Names::of("Test cell 4"), None).unwrap(),
        ssp(&plant, &Names::of("plant"), None).unwrap(),
        fmu,
    ];
    let folder = folder_with("ssp", &systems);
    if let Some(lines) = python("system.py", &folder) {
        assert!(largest(&lines) < 1e-12, "{lines}");
    }
}

#[test]
fn exact_a_system_has_the_bench_with_its_parameters_and_a_place_for_an_engine() {
    let file = ssp(&document(), &Names::of("Test cell 4"), None).unwrap();
    assert_eq!(file.name, "test_cell_4.ssp");
    assert_eq!(file, ssp(&document(), &Names::of("Test cell 4"), None).unwrap(), "the same bytes again");
    assert!(file.content[..512].windows(7).any(|bytes| bytes == b"dynoid "), "it names its program");
    let files = unpacked(&file.content);
    let paths: Vec<&str> = files.keys().map(String::as_str).collect();
    let resources =
        ["resources/test_cell_4.ssv", "resources/test_cell_4_fmi2.fmu", "resources/test_cell_4_uncertainty.ssv"];
    assert_eq!(paths, [&["SystemStructure.ssd"], &resources[..]].concat());
    let structure = text(&files, "SystemStructure.ssd");
    for part in [
        "<ssd:Component name=\"engine\" description=\"place of an engine without its inertia, which the bench has: torque at a speed\" source=\"\">",
        "<ssd:Connection startElement=\"engine\" startConnector=\"tau\" endElement=\"bench\" endConnector=\"engine_torque\"/>",
        "<ssd:Connection startElement=\"bench\" startConnector=\"engine_side_speed\" endElement=\"engine\" endConnector=\"w\"/>",
        "<ssd:ParameterBinding source=\"resources/test_cell_4.ssv\"/>",
        "source=\"resources/test_cell_4_fmi2.fmu\"",
    ] {
        assert!(structure.contains(part), "{part} is not in {structure}");
    }
}
