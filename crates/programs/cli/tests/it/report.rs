//! `dynoid report`: the report of a study that was written.

use crate::support::Campaign;

/// A study of the usual campaign, whose recordings are gone.
fn studied() -> Campaign {
    let campaign = Campaign::whole();
    assert!(campaign.run(&["study", "bench.toml", "--quiet"]).code.is_some_and(|code| code < 2));
    std::fs::remove_dir_all(campaign.path("recordings")).unwrap();
    std::fs::remove_file(campaign.path("bench.toml")).unwrap();
    campaign
}

/// A page but for the command that made it.
fn page(campaign: &Campaign, name: &str) -> String {
    campaign.read(name).lines().filter(|line| !line.contains("name=\"generator\"")).collect::<Vec<_>>().join("\n")
}

#[test]
fn exact_the_report_of_a_study_is_written_again_without_its_recordings() {
    let campaign = studied();
    let ran = campaign.run(&["report", "study/study.json"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stdout.contains("written: study/study.html") && ran.stderr.is_empty(), "{}{}", ran.stdout, ran.stderr);
    let (again, first) = (page(&campaign, "study/study.html"), page(&campaign, "study/report.html"));
    let differs = again.lines().zip(first.lines()).find(|(one, other)| one != other);
    assert!(again == first, "{differs:?}");
    let paper = campaign.run(&["report", "study/study.json", "--out", "paper.pdf"]);
    assert_eq!(paper.code, Some(0), "{}", paper.stderr);
    assert!(std::fs::read(campaign.path("paper.pdf")).unwrap().starts_with(b"%PDF"));
}

#[test]
fn exact_figures_without_their_curves_are_left_out_and_said_to_be() {
    let campaign = studied();
    let series = campaign.path("study/study-series.parquet");
    std::fs::remove_file(&series).unwrap();
    let ran = campaign.run(&["report", "study/study.json", "--out", "alone.html"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    for words in ["study-series.parquet", "not there", "left out"] {
        assert!(ran.stderr.contains(words), "`{words}` is not in {}", ran.stderr);
    }
    let (alone, whole) = (campaign.read("alone.html"), campaign.read("study/report.html"));
    assert!(alone.contains("is left out: its curves are in the table of series beside study.json."));
    let figures = |html: &str| html.matches("<figure").count();
    assert!(figures(&alone) > 0 && figures(&alone) < figures(&whole), "{} {}", figures(&alone), figures(&whole));

    // Nor does a table of another run, or a damaged one, give them.
    std::fs::write(&series, b"PAR1 of something else").unwrap();
    let damaged = campaign.run(&["report", "study/study.json", "--out", "damaged.html"]);
    assert_eq!(damaged.code, Some(0), "{}", damaged.stderr);
    for words in ["study-series.parquet", "of another run", "left out"] {
        assert!(damaged.stderr.contains(words), "`{words}` is not in {}", damaged.stderr);
    }
    assert_eq!(page(&campaign, "damaged.html"), page(&campaign, "alone.html"));
}

#[test]
fn regress_what_is_no_study_is_refused() {
    let campaign = studied();
    let study = campaign.read("study/study.json");
    campaign.run(&["report", "study/model.json"]).assert_refused(3, &["study/model.json", "not a study"]);
    campaign.run(&["report", "nowhere.json"]).assert_refused(3, &["nowhere.json"]);
    campaign.write("later.json", study.replacen("\"format_version\":3", "\"format_version\":9", 1).as_bytes());
    campaign.run(&["report", "later.json"]).assert_refused(3, &["later.json", "version 9"]);
    campaign.write("cut.json", &study.as_bytes()[..study.len() / 2]);
    campaign.run(&["report", "cut.json"]).assert_refused(3, &["cut.json", "ends in the middle"]);
    let damaged = study.replacen("\"duration_s\":", "\"duration_s\":\"long\",\"was\":", 1);
    campaign.write("damaged.json", damaged.as_bytes());
    campaign.run(&["report", "damaged.json"]).assert_refused(3, &["study.recordings[0].duration_s", "long"]);
    // The name of a table leads to no other folder.
    let elsewhere = study.replacen("study-series.parquet", "../study-series.parquet", 1);
    campaign.write("elsewhere.json", elsewhere.as_bytes());
    let ran = campaign.run(&["report", "elsewhere.json"]);
    assert!(ran.code == Some(0) && ran.stderr.contains("must lie beside its study"), "{}", ran.stderr);
    assert!(campaign.read("elsewhere.html").contains("is left out"));
}
