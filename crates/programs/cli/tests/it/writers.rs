//! Outputs of commands, and files that they must leave alone: every output of every command, by the commands' own help.

use std::collections::BTreeSet;
use std::path::Path;

use crate::help::commands;
use crate::identify::recorded;
use crate::support::{Campaign, Ran, bs, dynoid};

const STUDY: [&str; 4] = ["report.html", "study.json", "model.json", "study-series.parquet"];
const DESIGN: [&str; 4] = ["BS_T_NT_1200.csv", "BS_T_NT_1200.mf4", "BS_T_NT_1200.html", "BS_T_NT_1200_predicted.mf4"];

/// An output of a command: the command line with `OUT` in the place of the output, and the names that are written,
/// below `OUT` where that is a folder.
struct Writer {
    line: &'static str,
    folder: bool,
    names: &'static [&'static str],
}

const fn file(line: &'static str, names: &'static [&'static str]) -> Writer {
    Writer { line, folder: false, names }
}

const fn folder(line: &'static str, names: &'static [&'static str]) -> Writer {
    Writer { line, folder: true, names }
}

/// Every output of every command.
const WRITERS: &[Writer] = &[
    file("init recordings --out OUT", &["new.toml", "report.html"]),
    folder("study bench.toml --out OUT", &STUDY),
    folder(
        "study bench.toml --full --pdf --summary --out OUT",
        &["report-full.html", "report.pdf", "report-full.pdf", "summary.pdf"],
    ),
    file("report study.json --out OUT", &["a.html", "a.pdf"]),
    folder("demo --out OUT", &["bench.toml", "effects.html", "recordings/BS_T_NT_1200.mf4"]),
    file("lines bench.toml --plot OUT", &["a.html", "a.svg", "a.png", "a.pdf"]),
    file("torque-signals bench.toml --plot OUT", &["a.html"]),
    file("torque-signals bench.toml --out OUT", &["a.mf4", "a.parquet", "a.csv"]),
    file("torque-control bench.toml --plot OUT", &["a.html"]),
    file("controller bench.toml --plot OUT", &["a.html"]),
    file("controller noise-test --plot OUT", &["a.html"]),
    file("shaft bench.toml --plot OUT", &["a.html"]),
    file("engine bench.toml --plot OUT", &["a.html"]),
    file("engine bench.toml --out OUT", &["a.mf4"]),
    file("friction bench.toml --plot OUT", &["a.html"]),
    file("can bench.toml map --model bench.json --plot OUT", &["a.html"]),
    folder("experiment design bench.toml BS_T_NT --speed 1200 --out OUT", &DESIGN),
    file("experiment design bench.toml BS_T_NT --out designed --plot OUT", &["a.html"]),
    file("experiment check bench.toml BS_T_NT --plot OUT", &["a.html"]),
    file("experiment simulate bench.toml BS_T_NT --out OUT", &["a.mf4", "a.mat", "a.arrow", "a.tsv"]),
    file("experiment simulate bench.toml BS_T_NT --truth OUT", &["a.mf4"]),
    file("experiment simulate bench.toml BS_T_NT --plot OUT", &["a.html"]),
    file("diff bench.json bench.json --plot OUT", &["a.html"]),
    folder("export bench.json --to mat --out OUT", &["test_bench.mat", "test_bench.m"]),
    folder("export bench.json --to modelica --out OUT", &["TestBench.mo"]),
    folder("export bench.json --to python --out OUT", &["test_bench.py"]),
    folder("export bench.json --to ssp --out OUT", &["test_bench.ssp"]),
    folder("export bench.json --to ssv --out OUT", &["test_bench.ssv", "test_bench_uncertainty.ssv"]),
    folder("export bench.json --to linear --out OUT", &["test_bench_nt.json"]),
    folder("export bench.json --to fmu2 --out OUT", &["test_bench_fmi2.fmu"]),
    folder("export bench.json --to fmu3 --out OUT", &["test_bench_fmi3.fmu"]),
    folder("export bench.json --to c --out OUT", &["test_bench.h", "bench.c"]),
    file("export bench.json --to python --out OUT", &["cell.py"]),
    file("convert run.csv --out OUT", &["a.mf4", "a.csv"]),
    folder("convert run.csv --to parquet --out OUT", &["run.parquet"]),
    file("convert run.csv --out converted.mf4 --plot OUT", &["a.html"]),
    file("data spectrum run.csv -y speed --plot OUT", &["a.html"]),
    file("data delay run.csv -u valve -y speed --plot OUT", &["a.html"]),
    file("data order run.csv -u valve -y speed --plot OUT", &["a.html"]),
    file("fit arx run.csv -u valve -y speed --na 2 --nb 2 --nk 1 --plot OUT", &["a.html"]),
    file("fit arx run.csv -u valve -y speed --na 2 --nb 2 --nk 1 --out OUT", &["package.json"]),
    file("model bode arx.json --plot OUT", &["a.html"]),
    file("model step arx.json --plot OUT", &["a.html"]),
    file("model poles arx.json --plot OUT", &["a.html"]),
    file("model compare arx.json --on run.csv --plot OUT", &["a.html"]),
    file("model residuals arx.json --on run.csv --plot OUT", &["a.html"]),
    file("model simulate arx.json --on run.csv --plot OUT", &["a.html"]),
    file("model simulate arx.json --on run.csv --out OUT", &["a.mf4", "a.csv"]),
    file("model predict arx.json --on run.csv --plot OUT", &["a.html"]),
    file("model predict arx.json --on run.csv --out OUT", &["a.mf4"]),
    file("model convert arx.json --plot OUT", &["a.html"]),
    file("model convert arx.json --to ss --out OUT", &["package.json"]),
    folder("shell manual OUT", &["dynoid-study.1"]),
];

/// A bench with a recording, its model, data for a linear model, and that model.
fn campaign() -> Campaign {
    let campaign = Campaign::whole();
    assert!(campaign.run(&["study", "bench.toml", "--quiet"]).code.is_some_and(|code| code < 2));
    std::fs::rename(campaign.path("study/model.json"), campaign.path("bench.json")).unwrap();
    std::fs::rename(campaign.path("study/study.json"), campaign.path("study.json")).unwrap();
    std::fs::remove_dir_all(campaign.path("study")).unwrap();
    recorded(&campaign.path(""), "run.csv", 1, 0.2);
    let fit = "fit arx run.csv -u valve -y speed --na 2 --nb 2 --nk 1 --out arx.json --quiet";
    assert_eq!(line(&campaign, fit, "").code, Some(0));
    campaign
}

fn line(campaign: &Campaign, line: &str, out: &str) -> Ran {
    let words: Vec<&str> = line.split(' ').map(|word| if word == "OUT" { out } else { word }).collect();
    campaign.run(&words)
}

/// The output that a line writes to: the command's words and the option, or the argument's name.
fn output_of(words: &str) -> (String, String) {
    let words: Vec<&str> = words.split(' ').collect();
    let at = words.iter().position(|word| *word == "OUT").unwrap();
    let grouped = ["experiment", "data", "fit", "model", "shell"].contains(&words[0]) || words[1] == "noise-test";
    let command = if grouped { words[..2].join(" ") } else { words[0].to_owned() };
    let option = if words[at - 1].starts_with("--") { words[at - 1].to_owned() } else { "<FOLDER>".to_owned() };
    (command, option)
}

#[test]
fn exact_every_output_of_every_command_is_walked() {
    let known: BTreeSet<(String, String)> = WRITERS.iter().map(|writer| output_of(writer.line)).collect();
    let mut found = BTreeSet::new();
    for command in commands() {
        let words: Vec<&str> = command.iter().map(String::as_str).chain(["--help"]).collect();
        let page = dynoid(&std::env::temp_dir(), &words).stdout;
        // All of `fit` is one function, and its options for outputs are the same.
        let command = if command[0] == "fit" { "fit arx".to_owned() } else { command.join(" ") };
        for option in ["--out", "--plot", "--truth", "<FOLDER>"] {
            if page.contains(&format!("{option} <")) || (option == "<FOLDER>" && page.contains("<FOLDER>\n")) {
                found.insert((command.clone(), option.to_owned()));
            }
        }
    }
    assert_eq!(found, known, "every output needs a line in WRITERS");
}

#[test]
fn regress_no_command_replaces_a_file_that_it_did_not_make() {
    const PRECIOUS: &str = "[years]\nof = \"work\"\n";
    let campaign = campaign();
    for (number, writer) in WRITERS.iter().enumerate() {
        for name in writer.names {
            let place = format!("foreign{number}/{name}");
            let folder = campaign.path(&place).parent().map(Path::to_owned).unwrap();
            std::fs::create_dir_all(&folder).unwrap();
            campaign.write(&place, PRECIOUS.as_bytes());
            let out = if writer.folder { format!("foreign{number}") } else { place.clone() };
            let ran = line(&campaign, writer.line, &out);
            assert_eq!(ran.code, Some(4), "{} over {place}: {}{}", writer.line, ran.stdout, ran.stderr);
            for words in [name, &"--overwrite"] {
                assert!(ran.stderr.contains(words), "{}: `{words}` is not in {}", writer.line, ran.stderr);
            }
            assert_eq!(campaign.read(&place), PRECIOUS, "{}", writer.line);
            let others = std::fs::read_dir(&folder).unwrap().count();
            assert_eq!(others, 1, "{}: nothing else is written", writer.line);
            std::fs::remove_file(campaign.path(&place)).unwrap();
        }
    }
}

#[cfg(unix)]
#[test]
fn regress_no_command_replaces_a_file_that_it_reads() {
    let campaign = campaign();
    let inputs = ["bench.toml", "bench.json", "study.json", "arx.json", "run.csv", "recordings/BS_T_NT_1200.mf4"];
    let contents = || inputs.map(|input| std::fs::read(campaign.path(input)).unwrap());
    let before = contents();
    for (number, writer) in WRITERS.iter().filter(|writer| !writer.folder).enumerate() {
        let name = writer.names[0];
        for input in inputs {
            // Under a name that ends as the output has to.
            let link = format!("{number}-{}-{name}", input.replace('/', "-"));
            std::os::unix::fs::symlink(campaign.path(input), campaign.path(&link)).unwrap();
            for out in [input, &link] {
                let reads_recordings = ["bench.toml", " recordings "].iter().any(|words| writer.line.contains(words));
                let is_listed = input.starts_with("recordings/") && reads_recordings;
                let is_read = writer.line.split(' ').any(|word| word == input) || is_listed;
                if is_read {
                    let ran = line(&campaign, &format!("{} --overwrite", writer.line), out);
                    // A link among the recordings is known as one when the bench file is read, which may be refused itself.
                    assert!(
                        ran.code.is_some_and(|code| (2..=4).contains(&code)),
                        "{} to {out}: {}",
                        writer.line,
                        ran.stderr
                    );
                }
            }
        }
    }
    assert!(contents() == before);
}

#[test]
fn regress_no_bench_file_is_written_over_the_recording_that_it_is_made_from() {
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &bs());
    let recording = "recordings/BS_T_NT_1200.mf4";
    let content = || std::fs::read(campaign.path(recording)).unwrap();
    let before = content();
    for read in [recording, "recordings"] {
        for allowed in ["--force", "--overwrite", "--update"] {
            let ran = campaign.run(&["init", read, "--out", recording, allowed]);
            assert!(matches!(ran.code, Some(2 | 4)), "{read} {allowed}: {}", ran.stderr);
            assert!(ran.stderr.contains(recording), "{}", ran.stderr);
            assert!(content() == before, "{read} {allowed}");
        }
    }
}

#[test]
fn regress_measured_recordings_of_a_bench_outlive_a_design() {
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &bs());
    let recording = || std::fs::read(campaign.path("recordings/BS_T_NT_1200.mf4")).unwrap();
    let before = recording();
    let design =
        ["experiment", "design", "bench.toml", "BS_T_NT", "--speed", "1200", "--duration", "5", "--out", "recordings"];
    campaign.run(&design).assert_refused(4, &["recordings/BS_T_NT_1200.mf4", "bench.toml", "another folder"]);
    campaign.run(&[&design[..], &["--overwrite"]].concat()).assert_refused(4, &["recordings/BS_T_NT_1200.mf4"]);
    assert!(recording() == before);
    assert_eq!(std::fs::read_dir(campaign.path("recordings")).unwrap().count(), 1);
}

#[test]
fn exact_results_of_the_same_command_are_replaced() {
    let campaign = campaign();
    for (words, out) in [
        ("fit arx run.csv -u valve -y speed --na 1 --nb 2 --nk 1 --out OUT", "arx.json"),
        ("model convert arx.json --to ss --out OUT", "ss.json"),
        ("model bode arx.json --plot OUT", "bode.html"),
        ("model bode arx.json --plot OUT", "bode.svg"),
        ("model bode arx.json --plot OUT", "bode.png"),
        ("model bode arx.json --plot OUT", "bode.pdf"),
        ("convert run.csv --out OUT", "run.mf4"),
        ("convert run.csv --out OUT", "run.mat"),
        ("convert run.csv --out OUT", "run.parquet"),
        ("shell manual OUT", "man1"),
        ("export bench.json --to fmu2 --out OUT", "exported"),
        ("study bench.toml --pdf --summary --quiet --out OUT", "results"),
    ] {
        for _ in 0..2 {
            let ran = line(&campaign, words, out);
            assert!(ran.code.is_some_and(|code| code < 2), "{words} to {out}: {}", ran.stderr);
        }
    }
    // What another command made stays.
    for (words, out, maker) in [
        ("model step arx.json --plot OUT", "bode.html", "`dynoid model bode` wrote it"),
        ("model step arx.json --plot OUT", "bode.png", "`dynoid model bode` wrote it"),
        ("model bode arx.json --plot OUT", "results/report.html", "`dynoid study` wrote it"),
        ("fit arx run.csv -u valve -y speed --na 1 --nb 1 --nk 1 --out OUT", "bench.json", "`dynoid study` wrote it"),
        ("experiment simulate bench.toml BS_T_NT --duration 2 --out OUT", "run.mf4", "`dynoid convert` wrote it"),
        ("init recordings --force --out OUT", "arx.json", "no bench file"),
    ] {
        line(&campaign, words, out).assert_refused(4, &[out, maker, "--overwrite"]);
    }
    let overwritten = line(&campaign, "model step arx.json --overwrite --plot OUT", "bode.html");
    assert_eq!(overwritten.code, Some(0), "{}", overwritten.stderr);
}

#[test]
fn regress_results_of_another_name_are_removed_only_if_a_study_made_them() {
    let campaign = Campaign::whole();
    std::fs::create_dir(campaign.path("study")).unwrap();
    campaign.write("study/summary.pdf", b"%PDF-1.7 of another program");
    assert!(campaign.run(&["study", "bench.toml", "--quiet"]).code.is_some_and(|code| code < 2));
    assert_eq!(campaign.read("study/summary.pdf"), "%PDF-1.7 of another program");
}
