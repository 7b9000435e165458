//! `dynoid export`: a model as the files of other programs.

use crate::support::{Campaign, Ran};

fn studied() -> Campaign {
    let campaign = Campaign::whole();
    campaign.run(&["study", "bench.toml", "--quiet"]);
    campaign
}

#[track_caller]
fn done(ran: &Ran) {
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
}

#[test]
fn exact_a_bench_model_goes_to_every_target() {
    let campaign = studied();
    let export = |more: &[&str]| campaign.run(&[&["export", "study/model.json"], more].concat());
    for (target, files) in [
        ("mat", &["test_bench.mat", "test_bench.m"][..]),
        ("modelica", &["TestBench.mo"]),
        ("python", &["test_bench.py"]),
        ("ssv", &["test_bench.ssv", "test_bench_uncertainty.ssv"]),
        ("linear", &["test_bench_tn_torques.json", "test_bench_tn_speeds.json", "test_bench_nt.json"]),
    ] {
        let ran = export(&["--to", target, "--out", "exports", "--json"]);
        done(&ran);
        let written: Vec<String> = ran.json()["files"].as_array().unwrap().iter().map(|f| f.to_string()).collect();
        assert_eq!(written.len(), files.len(), "{written:?}");
        for file in files {
            assert!(campaign.path("exports").join(file).is_file(), "{file}");
        }
    }
    // What dynoid wrote it may replace.
    done(&export(&["--to", "mat", "--out", "exports"]));
    done(&export(&["--to", "python", "--out", "cell4.py"]));
    assert!(campaign.read("cell4.py").contains("from cell4 import Bench"));
    done(&export(&["--to", "ssv", "--draws", "3", "--out", "draws"]));
    assert!(campaign.path("draws/test_bench_draw_3.ssv").is_file());
}

#[test]
fn exact_linear_commands_take_a_bench_model() {
    let campaign = studied();
    let ran = campaign.run(&["model", "bode", "study/model.json", "--json"]);
    done(&ran);
    let curves = ran.json();
    let curves = curves.as_array().unwrap();
    let resonance = curves.iter().find(|curve| curve["channel"] == "T_d* → T_shaft").unwrap();
    assert_eq!(resonance["model"], "model TN torques");
    assert!(resonance["quantities"][0]["band"].is_array(), "bands from the covariance");
    let gain = resonance["summary"].as_array().unwrap().iter().find(|fact| fact["name"] == "gain at rest").unwrap();
    assert!((gain["value"].as_f64().unwrap() - 0.28 / 0.88).abs() < 0.01, "{gain}");
    let poles = campaign.run(&["model", "poles", "study/model.json"]);
    done(&poles);
    done(&campaign.run(&["export", "study/model.json", "--to", "linear", "--out", "linear"]));
    done(&campaign.run(&["model", "step", "linear/test_bench_nt.json"]));
    let simulate = ["model", "simulate", "study/model.json", "--on", "recordings/BS_T_NT_1200.mf4"];
    campaign.run(&simulate).assert_refused(3, &["this is a bench model", "--to linear"]);
}

#[test]
fn exact_models_of_a_fit_go_to_all_targets_but_linear() {
    let campaign = Campaign::whole();
    let fit =
        ["fit", "arx", "recordings/WhiteNoise_T_TN_1200.mf4", "-u", "DynoTorqueDemand", "-y", "DynoSpeed", "--na", "2"];
    done(&campaign.run(&[&fit[..], &["--nb", "2", "--nk", "3", "--out", "arx.json"]].concat()));
    for (target, file) in [
        ("mat", "arx.m"),
        ("modelica", "Arx.mo"),
        ("python", "arx.py"),
        ("fmu2", "arx.fmu"),
        ("fmu3", "arx.fmu"),
        ("c", "linear.c"),
        ("ssv", "arx_uncertainty.ssv"),
    ] {
        done(&campaign.run(&["export", "arx.json", "--to", target]));
        assert!(campaign.path(file).is_file(), "{file}");
    }
    campaign.run(&["export", "arx.json", "--to", "linear"]).assert_refused(3, &["arx.json", "bench models alone"]);
    // The model comes back out of its FMU.
    done(&campaign.run(&["export", "arx.fmu", "--to", "python", "--out", "again.py"]));
    let numbers = |file: &str| {
        let text = campaign.read(file);
        text.split("# begin of the model").nth(1).unwrap().split("# end of the model").next().unwrap().to_owned()
    };
    assert_eq!(numbers("again.py"), numbers("arx.py"));
}

#[test]
fn regress_what_cannot_be_exported_is_refused_in_words() {
    let campaign = studied();
    let refused = |arguments: &[&str], code, words: &[&str]| campaign.run(arguments).assert_refused(code, words);
    let export = ["export", "study/model.json", "--to"];
    let with = |more: &[&'static str]| [&export[..], more].concat();
    refused(&["export", "study/study.json", "--to", "mat"], 3, &["this is a study", "model.json beside it"]);
    refused(&["export", "bench.toml", "--to", "mat"], 3, &["bench.toml", "not a model file"]);
    refused(&["export", "none.json", "--to", "mat"], 3, &["none.json", "no such file"]);
    refused(&with(&["mat", "--draws", "3"]), 2, &["--draws belongs to --to ssv"]);
    refused(&with(&["python", "--out", "my-bench.py"]), 2, &["my-bench.py", "my_bench.py can"]);
    refused(&with(&["python", "--out", "class.py"]), 2, &["class.py", "class_model.py can"]);
    refused(&with(&["mat", "--out", "x.m"]), 2, &["x.m", "writes .mat, not .m"]);
    refused(&with(&["linear", "--out", "x.json"]), 2, &["give a folder"]);
    refused(&["model", "poles", "study/study.json"], 3, &["this is a study", "model.json beside it"]);
    campaign.write("test_bench.py", b"print('mine')\n");
    refused(&with(&["python"]), 4, &["test_bench.py", "--overwrite"]);
    assert_eq!(campaign.read("test_bench.py"), "print('mine')\n");
    done(&campaign.run(&with(&["python", "--overwrite"])));
    let model = campaign.read("study/model.json");
    campaign.write("later.json", model.replacen("\"version\": 1", "\"version\": 7", 1).as_bytes());
    refused(&["export", "later.json", "--to", "mat"], 3, &["later.json", "version 7", "use a later dynoid"]);
}

#[test]
fn exact_a_bench_is_compared_by_its_fmu_its_study_and_its_recordings() {
    let campaign = studied();
    done(&campaign.run(&["export", "study/model.json", "--to", "fmu3", "--out", "bench.fmu"]));
    for (first, second) in
        [("bench.fmu", "study/model.json"), ("study/study.json", "bench.fmu"), ("bench.fmu", "bench.toml")]
    {
        let ran = campaign.run(&["diff", first, second, "--json"]);
        done(&ran);
        let found = ran.json();
        assert_eq!(found["changed"], false, "{found}");
        let tests = found["comparison"]["parts"].as_array().unwrap();
        assert!(tests.iter().all(|part| part["test"]["statistic"].as_f64().is_none_or(|s| s < 1e-6)), "{found}");
    }
    let model: serde_json::Value = serde_json::from_str(&campaign.read("study/model.json")).unwrap();
    let mut stiffer = model.clone();
    let scaled = |value: &serde_json::Value| serde_json::json!(1.2 * value.as_f64().unwrap());
    let stiffness = &mut stiffer["model"]["mechanics"]["stiffness_nm_per_rad"];
    *stiffness = scaled(stiffness);
    let listed = stiffer["parameters"].as_array_mut().unwrap();
    let entry = listed.iter_mut().find(|entry| entry["parameter"] == "stiffness").unwrap();
    entry["value"] = scaled(&entry["value"]);
    campaign.write("stiffer.json", stiffer.to_string().as_bytes());
    let ran = campaign.run(&["diff", "stiffer.json", "bench.toml", "--json"]);
    assert_eq!((ran.code, &ran.json()["changed"]), (Some(1), &serde_json::json!(true)));
    campaign.write("other.fmu", b"PK\x03\x04 no archive");
    campaign
        .run(&["diff", "other.fmu", "bench.toml"])
        .assert_refused(3, &["other.fmu", "no FMU with a model of dynoid"]);
    std::fs::create_dir(campaign.path("alone")).unwrap();
    campaign.write("alone/study.json", campaign.read("study/study.json").as_bytes());
    campaign.run(&["diff", "alone/study.json", "bench.fmu"]).assert_refused(3, &["this is a study"]);
}
