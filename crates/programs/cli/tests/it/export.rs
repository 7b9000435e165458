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
        ("ssp", &["test_bench.ssp"]),
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
    done(&export(&["--to", "ssp", "--out", "Prüfstand 4.ssp"]));
    assert!(campaign.path("Prüfstand 4.ssp").is_file());
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
    // What T_e leaves of N_d in speed control is zero, and the margins are those of the report: of the open speed loop.
    let facts = |channel: &str| curves.iter().find(|c| c["channel"] == channel).unwrap()["summary"].clone();
    let named = |facts: &serde_json::Value, name: &str| {
        facts.as_array().unwrap().iter().find(|fact| fact["name"] == name).map(|fact| fact["value"].as_f64().unwrap())
    };
    assert_eq!(named(&facts("T_e → N_d"), "gain margin"), None);
    assert_eq!(named(&facts("T_d* → T_d"), "gain margin"), None);
    let of_study = campaign.read("study/study.json");
    let of_study: serde_json::Value = serde_json::from_str(&of_study).unwrap();
    let reported = of_study["study"]["whole"]["speed_loop_margins"]["gain_margin_db"].as_f64().unwrap();
    assert!((named(&facts("N_d* → N_d"), "gain margin").unwrap() - reported).abs() < 1e-9);
    let nt = curves.iter().find(|c| c["model"] == "model NT" && c["channel"] == "T_e → N_d").unwrap();
    assert_eq!(named(&nt["summary"], "gain at rest"), Some(0.0));
    let poles = campaign.run(&["model", "poles", "study/model.json"]);
    done(&poles);
    done(&campaign.run(&["export", "study/model.json", "--to", "linear", "--out", "linear"]));
    done(&campaign.run(&["model", "step", "linear/test_bench_nt.json"]));
    let residuals = ["model", "residuals", "study/model.json", "--on", "recordings/BS_T_NT_1200.mf4"];
    campaign.run(&residuals).assert_refused(3, &["this is a bench model", "--to linear"]);
}

#[test]
fn exact_a_bench_model_is_compared_with_recordings_and_simulated_on_them() {
    let campaign = studied();
    let on = ["--on", "recordings/BS_T_NT_1200.mf4"];
    let with = |start: &[&'static str], more: &[&'static str]| campaign.run(&[start, &on[..], more].concat());
    let compare = ["model", "compare", "study/model.json"];
    let simulate = ["model", "simulate", "study/model.json"];
    // The bench file is that of the study, one folder up, and the mode that of the label.
    let ran = with(&compare, &["--json"]);
    done(&ran);
    let found = ran.json();
    let row = &found[0];
    assert_eq!(
        (&row["model"], &row["mode"], &row["seen_in_estimation"]),
        (&"study/model.json".into(), &"Nt".into(), &true.into())
    );
    let signals = row["signals"].as_array().unwrap();
    let fit = |name: &str| {
        let signal = signals.iter().find(|signal| signal["quantity"] == name).unwrap();
        signal["fit_percent"].as_f64().unwrap()
    };
    for (name, least) in [("N_d", 80.0), ("N_e", 80.0), ("T_shaft", 60.0)] {
        assert!(fit(name) > least, "{name}: {found}");
    }
    // The report has the same numbers of the same replay.
    let study: serde_json::Value = serde_json::from_str(&campaign.read("study/study.json")).unwrap();
    let replays = study["study"]["replays"].as_array().unwrap();
    let of_report =
        replays.iter().find(|replay| replay["stretch"]["file"].as_str().unwrap().contains("BS_T_NT")).unwrap();
    for signal in of_report["signals"].as_array().unwrap() {
        let (reported, name) = (signal["fit_percent"].as_f64().unwrap(), signal["quantity"].as_str().unwrap());
        assert!((fit(name) - reported).abs() < 1e-6, "{name}: {} here, {reported} in the report", fit(name));
    }
    let page = with(&compare, &["--plot", "compare.html"]);
    done(&page);
    assert!(page.stdout.contains("T_shaft") && campaign.read("compare.html").contains("Bench models compared"));
    done(&with(&simulate, &["--out", "simulated.mf4", "--from", "2", "--to", "5"]));
    let inspected = campaign.run(&["inspect", "simulated.mf4", "--json"]);
    done(&inspected);
    assert!(inspected.stdout.contains("T_shaft_simulated"), "{}", inspected.stdout);
    std::fs::copy(campaign.path("recordings/BS_T_NT_1200.mf4"), campaign.path("run.mf4")).unwrap();
    let run = |more: &[&'static str]| campaign.run(&[&compare[..], &["--on", "run.mf4"], more].concat());
    run(&[]).assert_refused(2, &["run.mf4", "no label", "--mode nt or --mode tn"]);
    let by_mode = run(&["--mode", "nt", "--json"]);
    done(&by_mode);
    assert_eq!(by_mode.json()[0]["signals"], row["signals"]);
    std::fs::create_dir(campaign.path("elsewhere")).unwrap();
    std::fs::copy(campaign.path("study/model.json"), campaign.path("elsewhere/model.json")).unwrap();
    std::fs::create_dir(campaign.path("elsewhere/far")).unwrap();
    std::fs::copy(campaign.path("study/model.json"), campaign.path("elsewhere/far/model.json")).unwrap();
    let far = ["model", "compare", "elsewhere/far/model.json"];
    with(&far, &[]).assert_refused(2, &["elsewhere/far/model.json", "--bench bench.toml"]);
    done(&with(&far, &["--bench", "bench.toml"]));
    campaign.run(&[&compare[..], &["--on", "study/model.json"]].concat()).assert_refused(3, &["not a recording"]);
    with(&compare, &["--horizon", "3"]).assert_refused(2, &["--horizon belongs to linear models"]);
    with(&simulate, &["--from-rest"]).assert_refused(2, &["--from-rest belongs to linear models"]);
    done(&campaign.run(&["export", "study/model.json", "--to", "linear", "--out", "linear"]));
    let both = ["model", "compare", "study/model.json", "linear/test_bench_nt.json"];
    with(&both, &[]).assert_refused(2, &["compare models of one kind"]);
    let linear = ["model", "compare", "linear/test_bench_nt.json"];
    with(&linear, &["--mode", "nt"]).assert_refused(2, &["belong to bench models"]);
}

/// Nothing of one export is lost by another, unless it is asked for or said.
#[test]
fn regress_exports_into_one_folder_replace_nothing_silently() {
    let campaign = studied();
    let export = |more: &[&str]| campaign.run(&[&["export", "study/model.json"], more].concat());
    done(&export(&["--to", "fmu2", "--out", "all"]));
    done(&export(&["--to", "fmu3", "--out", "all"]));
    let bytes = |file: &str| std::fs::read(campaign.path("all").join(file)).unwrap();
    assert_ne!(bytes("test_bench_fmi2.fmu"), bytes("test_bench_fmi3.fmu"));
    // The example of the help, and any other name.
    done(&export(&["--to", "fmu2", "--out", "all/TestCell4.fmu"]));
    done(&export(&["--to", "ssv", "--out", "all/Prüfstand 4.ssv"]));
    assert!(campaign.path("all/Prüfstand 4_uncertainty.ssv").is_file());
    export(&["--to", "fmu3", "--out", "all/TestCell4.fmu"])
        .assert_refused(4, &["TestCell4.fmu", "FMI 2.0", "--overwrite"]);
    let again = export(&["--to", "fmu2", "--out", "all/TestCell4.fmu"]);
    assert!(
        again.code == Some(0) && again.stdout.contains("written: "),
        "the same bytes replace nothing: {}",
        again.stdout
    );
    done(&export(&["--to", "fmu3", "--out", "all/TestCell4.fmu", "--overwrite"]));
    // Two models in C share sources that are the same, and no others.
    done(&export(&["--to", "c", "--out", "all"]));
    done(&export(&["--to", "c", "--out", "all/other.h"]));
    assert!(campaign.path("all/other_example.c").is_file() && campaign.path("all/test_bench_example.c").is_file());
    let source = campaign.read("all/bench.c");
    campaign.write("all/bench.c", format!("{source}\n/* changed */\n").as_bytes());
    export(&["--to", "c", "--out", "all"])
        .assert_refused(4, &["all/bench.c", "other models in the folder", "--overwrite"]);
    assert!(campaign.read("all/bench.c").contains("changed"));
    done(&export(&["--to", "c", "--out", "all", "--overwrite"]));
    assert_eq!(campaign.read("all/bench.c"), source);
    // Another model of the same name: it is said.
    let model = campaign.read("study/model.json").replace("\"name\": \"Test bench\"", "\"name\": \"Test-bench\"");
    campaign.write("other.json", model.replace("\"date\": \"", "\"date\": \"1").as_bytes());
    done(&export(&["--to", "python", "--out", "all"]));
    let replaced = campaign.run(&["export", "other.json", "--to", "python", "--out", "all"]);
    assert!(replaced.stdout.contains("replaced: ") && replaced.stdout.contains("test_bench.py"), "{}", replaced.stdout);
    // Draws of an earlier export.
    done(&export(&["--to", "ssv", "--draws", "4", "--out", "all"]));
    let fewer = export(&["--to", "ssv", "--draws", "2", "--out", "all"]);
    assert!(
        fewer.stderr.contains("test_bench_draw_3.ssv") && fewer.stderr.contains("earlier export"),
        "{}",
        fewer.stderr
    );
}

#[cfg(target_os = "linux")]
#[test]
fn regress_a_full_device_is_said_and_leaves_nothing() {
    let campaign = studied();
    let before = std::fs::read_dir(campaign.path(".")).unwrap().count();
    for target in ["python", "modelica", "fmu2", "fmu3"] {
        let ran = campaign.run(&["export", "study/model.json", "--to", target, "--out", "/dev/full"]);
        ran.assert_refused(4, &["/dev/full", "the disk is full"]);
    }
    for target in ["mat", "c", "ssv", "linear"] {
        let ran = campaign.run(&["export", "study/model.json", "--to", target, "--out", "/dev/full"]);
        ran.assert_refused(2, &["/dev/full", "give a folder"]);
    }
    // Behind a link, too: what has no end is not read.
    std::os::unix::fs::symlink("/dev/full", campaign.path("cell.fmu")).unwrap();
    campaign.run(&["export", "study/model.json", "--to", "fmu2", "--out", "cell.fmu"]).assert_refused(4, &["cell.fmu"]);
    std::fs::remove_file(campaign.path("cell.fmu")).unwrap();
    campaign.run(&["study", "bench.toml", "--out", "/dev/full"]).assert_refused(4, &["/dev/full", "device", "--out"]);
    campaign.run(&["init", "recordings", "--out", "/dev/full"]).assert_refused(4, &["/dev/full", "the disk is full"]);
    assert_eq!(std::fs::read_dir(campaign.path(".")).unwrap().count(), before);
    let printed = campaign.run(&["export", "study/model.json", "--to", "python", "--out", "/dev/stdout"]);
    assert!(printed.stdout.contains("class Bench"), "{}", printed.stdout);
}

/// Each command says what the file is, what is wrong with it, and what to give.
#[test]
fn regress_damaged_model_files_are_refused_in_the_words_of_the_user() {
    let campaign = studied();
    let model = campaign.read("study/model.json");
    let commands: [&[&str]; 4] = [
        &["export", "x.json", "--to", "mat"],
        &["model", "bode", "x.json"],
        &["diff", "x.json", "study/model.json"],
        &["experiment", "check", "bench.toml", "BS_T_NT", "--model", "x.json"],
    ];
    let all_refuse = |text: &str, words: &[&str]| {
        campaign.write("x.json", text.as_bytes());
        for command in commands {
            let ran = campaign.run(command);
            ran.assert_refused(3, &[&["x.json"], words].concat());
            assert!(!ran.stderr.contains("dynoid fit …") && !ran.stderr.contains("EOF"), "{}", ran.stderr);
        }
    };
    all_refuse("", &["the file is empty", "give "]);
    all_refuse(&model[..model.len() / 2], &["the file ends in the middle, in `", "dynoid study"]);
    all_refuse("{\"format\": \"shopping list\"}", &["not a model file", "shopping list"]);
    all_refuse(&model.replacen("\"version\": 1", "\"version\": 9", 1), &["version 9", "use a later dynoid"]);
    let stiffness = model.lines().find(|line| line.contains("stiffness_nm_per_rad")).unwrap();
    let with = |value: &str| model.replacen(stiffness, &format!("\"stiffness_nm_per_rad\": {value},"), 1);
    let field = "`model.mechanics.stiffness_nm_per_rad`";
    all_refuse(&with("NaN"), &[field, "`NaN`", "dynoid study"]);
    all_refuse(&with("1e400"), &[field, "too large"]);
    all_refuse(&with("-5.0"), &[field, "is -5, and a bench has 0.01 to 1e10 Nm/rad"]);
    // A study that is no longer read, and a study without its model.
    campaign.write("x.json", b"{\"format\": \"dynoid-study\", \"format_version\": 1, \"study\": {}}");
    for command in &commands[..2] {
        campaign
            .run(command)
            .assert_refused(3, &["this is a study", "model.json beside it", "dynoid study bench.toml"]);
    }
    campaign.run(commands[3]).assert_refused(3, &["this study is of version 1", "again"]);
    // A linear model where a bench model is needed.
    done(&campaign.run(&["export", "study/model.json", "--to", "linear", "--out", "linear"]));
    campaign.write("x.json", campaign.read("linear/test_bench_tn_torques.json").as_bytes());
    for command in &commands[2..] {
        campaign
            .run(command)
            .assert_refused(3, &["x.json", "linear model of `dynoid fit`", "model.json of `dynoid study`"]);
    }
    // A linear model whose covariance has another size is refused by every command, also those that do not need it.
    let mut linear: serde_json::Value = serde_json::from_str(&campaign.read("x.json")).unwrap();
    linear["estimate"]["covariance"].as_array_mut().unwrap().pop();
    campaign.write("x.json", linear.to_string().as_bytes());
    for command in &commands[..2] {
        campaign.run(command).assert_refused(3, &["x.json", "`estimate.covariance`", "dynoid fit"]);
    }
}

#[test]
fn exact_models_of_a_fit_go_to_all_targets_but_linear() {
    let campaign = Campaign::whole();
    let fit =
        ["fit", "arx", "recordings/WhiteNoise_T_TN_1200.mf4", "-u", "DynoTorqueDemand", "-y", "DynoSpeed", "--na", "2"];
    let fitted = campaign.run(&[&fit[..], &["--nb", "2", "--nk", "3", "--out", "arx.json"]].concat());
    assert_eq!(fitted.code, Some(1), "it explains next to nothing: {}", fitted.stderr);
    for (target, file) in [
        ("mat", "arx.m"),
        ("modelica", "Arx.mo"),
        ("python", "arx.py"),
        ("fmu2", "arx_fmi2.fmu"),
        ("fmu3", "arx_fmi3.fmu"),
        ("c", "arx_example.c"),
        ("ssv", "arx_uncertainty.ssv"),
    ] {
        done(&campaign.run(&["export", "arx.json", "--to", target]));
        assert!(campaign.path(file).is_file(), "{file}");
    }
    for target in ["linear", "ssp"] {
        campaign.run(&["export", "arx.json", "--to", target]).assert_refused(3, &["arx.json", "bench models alone"]);
    }
    // The model comes back out of its FMU.
    done(&campaign.run(&["export", "arx_fmi2.fmu", "--to", "python", "--out", "again.py"]));
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
    // The model beside a study is that of the study.
    done(&campaign.run(&["export", "study/study.json", "--to", "mat"]));
    refused(&["export", "bench.toml", "--to", "mat"], 3, &["bench.toml", "not a model file"]);
    refused(&["export", "none.json", "--to", "mat"], 3, &["none.json", "no such file"]);
    refused(&with(&["mat", "--draws", "3"]), 2, &["--draws belongs to --to ssv"]);
    refused(&with(&["python", "--out", "my-bench.py"]), 2, &["my-bench.py", "my_bench.py can"]);
    refused(&with(&["python", "--out", "class.py"]), 2, &["class.py", "class_model.py can"]);
    refused(&with(&["mat", "--out", "x.m"]), 2, &["x.m", "writes .mat, not .m"]);
    refused(&with(&["linear", "--out", "x.json"]), 2, &["give a folder"]);
    done(&campaign.run(&["model", "poles", "study/study.json"]));
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
    // A run that was killed may leave files of two studies.
    std::fs::create_dir(campaign.path("mixed")).unwrap();
    campaign.write("mixed/study.json", campaign.read("study/study.json").as_bytes());
    campaign.write("mixed/model.json", stiffer.to_string().as_bytes());
    campaign
        .run(&["diff", "mixed/study.json", "bench.fmu"])
        .assert_refused(3, &["mixed/study.json", "another one than that of mixed/model.json"]);
    let hash = model["provenance"]["bench_file"]["sha256"].as_str().unwrap();
    let report = campaign.read("study/report.html");
    for (report, is_other) in [(report.clone(), false), (report.replace(hash, &"0".repeat(64)), true)] {
        campaign.write("mixed/report.html", report.as_bytes());
        let ran = campaign.run(&["export", "mixed/model.json", "--to", "fmu3", "--out", "mixed"]);
        done(&ran);
        assert_eq!(ran.stderr.contains("this report is of another study"), is_other, "{}", ran.stderr);
    }
}
