//! `dynoid study`: results and where they go.

use bench_model::document::BenchModelDocument;
use rig::experiment::ExperimentPlan;

use crate::support::{BENCH, Campaign, bs, dynoid, simulated};

#[test]
fn exact_report_and_data_lie_beside_the_bench_file() {
    let campaign = Campaign::whole();
    let ran = campaign.run(&["study", "bench.toml"]);
    assert!(matches!(ran.code, Some(0 | 1)), "{}", ran.stderr);
    assert_eq!(campaign.results(), ["model.json", "report.html", "study-series.parquet", "study.json"]);
    assert!(campaign.read("study/report.html").contains("Test bench"));
    let data: serde_json::Value = serde_json::from_str(&campaign.read("study/study.json")).unwrap();
    assert_eq!(data["format"], "dynoid-study");
    for words in ["Verdict", "K_p", "Nm/rad", "Not estimated", "feed-forward", "needs", "study/report.html"] {
        assert!(ran.stdout.contains(words), "`{words}` is not in:\n{}", ran.stdout);
    }
}

#[test]
fn exact_reports_for_paper_lie_beside_the_others_with_the_logo_of_the_bench_file() {
    let campaign = Campaign::whole();
    let report = "\n[report]\nauthor = \"A. Meyer\"\ncustomer = \"試験社\"\nlogo = \"logo.svg\"\n";
    std::fs::write(campaign.path("bench.toml"), campaign.read("bench.toml") + report).unwrap();
    let refused = campaign.run(&["study", "--pdf", "bench.toml"]);
    refused
        .assert_refused(3, &["logo.svg: this logo cannot be shown", "correct the path", "remove `logo`", "bench.toml"]);
    std::fs::write(campaign.path("logo.svg"), "GIF89a").unwrap();
    campaign.run(&["study", "bench.toml"]).assert_refused(3, &["no PNG, JPEG or SVG"]);
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='40' height='10'><rect width='40' height='10'/></svg>";
    std::fs::write(campaign.path("logo.svg"), svg).unwrap();
    let ran = campaign.run(&["study", "bench.toml", "--pdf=letter", "--summary"]);
    assert!(matches!(ran.code, Some(0 | 1)), "{}", ran.stderr);
    let names = ["model.json", "report.html", "report.pdf", "study-series.parquet", "study.json", "summary.pdf"];
    assert_eq!(campaign.results(), names);
    assert!(ran.stderr.contains("report.pdf: its fonts lack the characters 社試験"), "{}", ran.stderr);
    assert!(ran.stdout.contains("study/report.pdf") && ran.stdout.contains("study/summary.pdf"), "{}", ran.stdout);
    assert!(campaign.read("study/report.html").contains("<img class=\"logo\""));
    let has = |file: &str, words: &str| {
        let bytes = std::fs::read(campaign.path(file)).unwrap();
        bytes.windows(words.len()).filter(|window| *window == words.as_bytes()).count()
    };
    assert_eq!(has("study/summary.pdf", "/Type/Page/"), 1);
    assert!(has("study/report.pdf", "/Type/Page/") > 5);
    for words in ["/MediaBox[0 0 612 792]", "/Author(A. Meyer)", "/Creator(dynoid ", "/Subtype/Image", "/Marked true"] {
        assert!(has("study/report.pdf", words) > 0, "{words}");
    }
}

#[test]
fn exact_the_values_of_every_series_of_the_document_are_in_the_table() {
    let campaign = Campaign::whole();
    campaign.run(&["study", "bench.toml", "--quiet"]);
    let text = campaign.read("study/study.json");
    assert!(text.len() < 1_000_000, "{} bytes", text.len());
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(document["series_file"], "study-series.parquet");
    let mut places = Vec::new();
    series_in(&document["study"], "", &mut places);
    assert!(places.len() > 10, "{places:?}");
    let bytes = std::fs::read(campaign.path("study/study-series.parquet")).unwrap();
    let table = recording::decode("study-series.parquet", &bytes, &recording::Selection::All).unwrap();
    let names: Vec<&str> = table.channels.iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(names.len(), places.len(), "{names:?}");
    for (place, samples, start_s) in places {
        let channel = table.channel(&place).unwrap_or_else(|| panic!("{place} is not in {names:?}"));
        assert_eq!(channel.samples.len() as u64, samples, "{place}");
        assert_eq!(table.time_s(channel).unwrap()[0], start_s, "{place}");
        assert!(channel.samples.iter().all(|value| value.is_finite()), "{place}");
    }
}

/// Places of series below a value, with their numbers of samples and their starts.
fn series_in(value: &serde_json::Value, place: &str, found: &mut Vec<(String, u64, f64)>) {
    let below = |key: &str| if place.is_empty() { key.to_owned() } else { format!("{place}/{key}") };
    match value {
        serde_json::Value::Object(fields) => match (fields.get("samples"), fields.get("start_s")) {
            (Some(samples), Some(start)) => {
                found.push((place.to_owned(), samples.as_u64().unwrap(), start.as_f64().unwrap()));
            }
            _ => fields.iter().for_each(|(key, value)| series_in(value, &below(key), found)),
        },
        serde_json::Value::Array(values) => {
            values.iter().enumerate().for_each(|(k, value)| series_in(value, &below(&k.to_string()), found));
        }
        _ => {}
    }
}

#[test]
fn stat_json_holds_the_stiffness() {
    let study = Campaign::whole().run(&["study", "bench.toml", "--json"]).study();
    let stiffness = study["estimates"].as_array().unwrap().iter().find(|e| e["symbol"] == "K").unwrap();
    let (value, error) = (stiffness["value"].as_f64().unwrap(), stiffness["standard_error"].as_f64().unwrap());
    assert!((value - 2437.7).abs() < 4.0 * error && error < 100.0, "{value} ± {error}");
    assert!(matches!(study["verdict"]["level"].as_str(), Some("good" | "reservations" | "insufficient")));
}

#[test]
fn exact_the_model_file_states_model_range_and_origin() {
    let campaign = Campaign::whole();
    let study = campaign.run(&["study", "bench.toml", "--json"]).study();
    let text = campaign.read("study/model.json");
    let document = BenchModelDocument::from_json(&text).unwrap();
    assert!(text.len() < 24_000, "{} bytes", text.len());
    assert_eq!(study::model(&campaign.read("study/study.json")).unwrap(), document.assembled());
    assert_eq!(document.to_json().unwrap(), text);
    let (low, high) = document.validity.dyno_speed_rad_s.unwrap();
    assert!(low < 125.6 && 125.6 < high && high - low < 40.0, "{low} {high}");
    assert!(document.validity.air_gap_torque_nm.is_some() && document.validity.frequency_hz.is_some());
    assert_eq!(document.provenance.recordings.len(), 2);
    assert_eq!(document.provenance.recordings[0].sha256, study["recordings"][0]["sha256"].as_str().unwrap());
    assert_eq!(document.provenance.verdict.unwrap().level, study["verdict"]["level"].as_str().unwrap());
    assert!(document.not_estimated.iter().any(|one| one.needs.contains("Ramp_N_NT")));
}

#[test]
fn regress_a_file_that_is_no_bench_model_is_not_replaced_and_an_old_model_does_not_stay() {
    let campaign = Campaign::whole();
    std::fs::create_dir(campaign.path("study")).unwrap();
    campaign.write("study/model.json", b"{\"format\": \"dynoid model\"}");
    campaign.run(&["study", "bench.toml"]).assert_refused(4, &["model.json", "`dynoid fit` wrote it", "--overwrite"]);
    std::fs::remove_file(campaign.path("study/model.json")).unwrap();
    campaign.run(&["study", "bench.toml", "--quiet"]);
    std::fs::remove_file(campaign.path("recordings/BS_T_NT_1200.mf4")).unwrap();
    std::fs::remove_file(campaign.path("recordings/WhiteNoise_T_TN_1200.mf4")).unwrap();
    let free = simulated(&ExperimentPlan::no_shaft_n_nt(1200.0, 6.0), 1);
    let campaign = campaign.with("NoShaft_N_NT.mf4", &free);
    campaign.run(&["study", "bench.toml", "--quiet"]);
    assert_eq!(campaign.results(), ["report.html", "study.json"]);
}

#[test]
fn exact_the_working_directory_does_not_matter() {
    let campaign = Campaign::whole();
    let bench = campaign.path("bench.toml");
    let elsewhere = tempfile::tempdir().unwrap();
    let ran = dynoid(elsewhere.path(), &["study", bench.to_str().unwrap(), "--out", "here", "--json"]);
    assert_eq!(ran.study()["recordings"][0]["file"], "recordings/BS_T_NT_1200.mf4");
    assert!(elsewhere.path().join("here/report.html").is_file());
    assert_eq!(campaign.results(), [""; 0]);
}

#[test]
fn regress_existing_results_are_kept_when_a_run_fails() {
    let campaign = Campaign::whole();
    campaign.run(&["study", "bench.toml", "--quiet"]);
    let before = [campaign.read("study/report.html"), campaign.read("study/study.json")];
    for name in ["BS_T_NT_1200.mf4", "WhiteNoise_T_TN_1200.mf4"] {
        let path = campaign.path("recordings").join(name);
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..200]).unwrap();
    }
    campaign.run(&["study", "bench.toml"]).assert_refused(3, &["(2 tried)", "BS_T_NT_1200"]);
    assert_eq!([campaign.read("study/report.html"), campaign.read("study/study.json")], before);
    assert_eq!(campaign.results(), ["model.json", "report.html", "study-series.parquet", "study.json"]);
}

#[test]
fn regress_results_are_written_all_or_none() {
    let campaign = Campaign::whole();
    std::fs::create_dir_all(campaign.path("study/report.html")).unwrap();
    let old = "{\"format\": \"dynoid-study\"}";
    campaign.write("study/study.json", old.as_bytes());
    campaign.run(&["study", "bench.toml"]).assert_refused(4, &["report.html", "a folder of this name"]);
    assert_eq!(campaign.read("study/study.json"), old);
    assert_eq!(campaign.results(), ["report.html", "study.json"]);
}

#[test]
fn regress_other_files_beside_the_results_are_left_alone() {
    let campaign = Campaign::whole();
    std::fs::create_dir(campaign.path("study")).unwrap();
    campaign.write("study/notes.txt", b"mine");
    campaign.run(&["study", "bench.toml", "--quiet"]);
    assert_eq!(campaign.results(), ["model.json", "notes.txt", "report.html", "study-series.parquet", "study.json"]);
    assert_eq!(campaign.read("study/notes.txt"), "mine");
}

#[test]
fn regress_a_place_that_cannot_be_written_is_named() {
    let campaign = Campaign::whole();
    let run = |out| campaign.run(&["study", "bench.toml", "--out", out]);
    run("bench.toml").assert_refused(4, &["bench.toml", "a file of this name", "--out"]);
    run("bench.toml/below").assert_refused(4, &["below", "--out"]);
    #[cfg(target_os = "linux")]
    run("/proc/dynoid").assert_refused(4, &["/proc/dynoid", "--out"]);
}

#[test]
fn regress_a_file_listed_twice_is_read_once() {
    let campaign = Campaign::whole();
    let twice = r#"files = ["recordings/*.mf4", "recordings/BS_T_NT_1200.mf4", "./recordings"]"#;
    campaign.write("bench.toml", BENCH.replace(r#"files = ["recordings/*.mf4"]"#, twice).as_bytes());
    let study = campaign.run(&["study", "bench.toml", "--json"]).study();
    assert_eq!(study["recordings"].as_array().map(Vec::len), Some(2));
}

#[test]
fn regress_a_folder_named_like_a_pattern_is_found() {
    let campaign = Campaign::empty();
    std::fs::create_dir(campaign.path("cell [4]")).unwrap();
    std::fs::create_dir(campaign.path("cell [4]/recordings")).unwrap();
    campaign.write("cell [4]/bench.toml", BENCH.as_bytes());
    let bytes = recording::encode_mdf4(&bs()).unwrap();
    campaign.write("cell [4]/recordings/BS_T_NT.mf4", &bytes);
    let study = campaign.run(&["study", "cell [4]/bench.toml", "--json"]).study();
    assert_eq!(study["recordings"][0]["file"], "recordings/BS_T_NT.mf4");
}

#[test]
fn snap_a_study_states_whose_report_it_is_and_of_which_day() {
    let campaign = Campaign::whole();
    let bench = campaign.read("bench.toml");
    campaign.write("bench.toml", format!("{bench}\n[report]\ntitle = \"Cell 4\"\ntest_id = \"T-17\"\n").as_bytes());
    assert!(matches!(campaign.run(&["study", "bench.toml", "--quiet"]).code, Some(0 | 1)));
    let page = campaign.read("study/report.html");
    for words in ["<h1>Cell 4</h1>", "test T-17", "studied on 20", "SHA-256"] {
        assert!(page.contains(words), "{words}");
    }
    campaign.write("bench.toml", format!("{bench}\n[report]\ncustomr = \"X\"\n").as_bytes());
    campaign.run(&["study", "bench.toml"]).assert_refused(3, &["report.customr", "customer"]);
}

#[test]
fn exact_json_may_stand_anywhere_on_the_line() {
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &bs());
    let behind = campaign.run(&["inspect", "recordings", "--json"]);
    for line in [["--json", "inspect", "recordings"], ["inspect", "--json", "recordings"]] {
        assert_eq!(campaign.run(&line).json(), behind.json(), "{line:?}");
    }
    assert!(!campaign.run(&["--json", "experiment", "list"]).json().is_null());
}

#[test]
fn regress_a_value_that_is_not_filled_in_gets_an_example_of_its_own() {
    let campaign = Campaign::empty();
    let empty =
        |text: &str| text.replace("cylinders = 4", "cylinders = \"FILL IN\"").replace("\"0.28 kg m²\"", "\"FILL IN\"");
    campaign.write("bench.toml", empty(&campaign.read("bench.toml")).as_bytes());
    let words =
        ["bench.cylinders: nothing is filled in yet", "such as 4", "bench.engine_inertia", "such as \"0.2 kg m²\""];
    campaign.run(&["study", "bench.toml"]).assert_refused(3, &words);
}
