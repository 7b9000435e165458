//! `dynoid convert` of recordings.

use std::path::Path;

use recording::{Channel, Format, Raster, Recording, Selection, StartTime, decode, encode_mdf4};
use tempfile::TempDir;

use crate::support::{Ran, dynoid};

const FORMATS: [&str; 6] = ["mf4", "csv", "tsv", "mat", "parquet", "arrow"];

/// Two rasters with missing samples, an empty one, a channel of one sample, and names that formats have trouble with.
fn awkward() -> Recording {
    let clock = |n: usize, step: f64| Raster { time_s: (0..n).map(|i| i as f64 * step).collect(), name: None };
    let channel = |name: &str, unit: &str, raster: usize, samples: Vec<f64>| Channel {
        name: name.into(),
        unit: unit.into(),
        comment: String::new(),
        raster,
        samples,
    };
    let wave = |n: usize, f: f64| (0..n).map(|i| (i as f64 * f).sin() * 1e3 / 7.0).collect::<Vec<f64>>();
    let mut gappy = wave(200, 0.1);
    (gappy[3], gappy[4], gappy[5]) = (f64::NAN, f64::INFINITY, -0.0);
    Recording {
        format: Format::Mdf { version: 410 },
        comment: Some("made\nfor a test".into()),
        start_time: Some(StartTime {
            nanoseconds: 1_700_000_000_123_456_789,
            is_local: false,
            utc_offset_min: Some(60),
        }),
        rasters: vec![
            clock(200, 1e-3),
            Raster { time_s: (0..77).map(|i| 0.01 + i as f64 * 0.0029).collect(), name: Some("slow".into()) },
            clock(0, 1.0),
            Raster { time_s: vec![0.123], name: None },
        ],
        channels: vec![
            channel("n, \"raw\"; [1]", "1/min", 0, gappy),
            channel("n", "rpm", 0, wave(200, 0.2)),
            channel("n", "rad/s", 0, wave(200, 0.3)),
            channel("Überdruck µ°", "", 1, wave(77, 0.4)),
            channel("end", "[V]", 1, wave(77, 0.5)),
            channel(&"x".repeat(90), "°C", 2, vec![]),
            channel("once", "Nm", 3, vec![42.0]),
        ],
        findings: vec![],
    }
}

fn folder_with(name: &str, recording: &Recording) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), encode_mdf4(recording).unwrap()).unwrap();
    folder
}

fn convert(folder: &TempDir, arguments: &str) -> Ran {
    let arguments: Vec<&str> = std::iter::once("convert").chain(arguments.split_whitespace()).collect();
    dynoid(folder.path(), &arguments)
}

#[track_caller]
fn converted(folder: &TempDir, arguments: &str) -> Ran {
    let ran = convert(folder, arguments);
    assert_eq!(ran.code, Some(0), "{arguments}: {}", ran.stderr);
    ran
}

fn read(path: &Path) -> Recording {
    let bytes = std::fs::read(path).unwrap();
    decode(&path.to_string_lossy(), &bytes, &Selection::All).unwrap_or_else(|error| panic!("{error}"))
}

/// Name, unit, time stamps and values of every channel, in the order of their names and units.
fn content(recording: &Recording) -> Vec<(String, String, Vec<u64>, Vec<u64>)> {
    let bits = |v: &[f64]| v.iter().map(|v| if v.is_nan() { u64::MAX } else { v.to_bits() }).collect::<Vec<u64>>();
    let of = |c: &Channel| (c.name.clone(), c.unit.clone(), bits(recording.time_s(c).unwrap()), bits(&c.samples));
    let mut all: Vec<_> = recording.channels.iter().map(of).collect();
    all.sort();
    all
}

#[test]
fn exact_every_pair_of_formats_keeps_values_stamps_names_and_units() {
    if !cfg!(feature = "parquet") {
        return;
    }
    let original = awkward();
    let folder = folder_with("a.mf4", &original);
    for from in FORMATS {
        converted(&folder, &format!("a.mf4 --out from.{from} --overwrite"));
        for to in FORMATS {
            converted(&folder, &format!("from.{from} --out to.{to} --quiet --overwrite"));
            let found = read(&folder.path().join(format!("to.{to}")));
            assert_eq!(content(&found), content(&original), "{from} to {to}");
            let is_text = |ending: &str| ["csv", "tsv"].contains(&ending);
            if !is_text(from) && !is_text(to) {
                assert_eq!(
                    (found.start_time, &found.comment),
                    (original.start_time, &original.comment),
                    "{from} to {to}"
                );
            }
        }
    }
}

#[test]
fn regress_what_text_has_no_place_for_is_said() {
    let mut recording = awkward();
    recording.channels[0].name = "Time".into();
    recording.channels[1].name = "two\nlines".into();
    recording.channels[2].comment = "of the shaft".into();
    let folder = folder_with("a.mf4", &recording);
    let ran = converted(&folder, "a.mf4 --out a.csv");
    for word in ["the start time", "comment", "\"Time\"", "\"Time_channel\"", "\"two lines\"", "the name of 1 raster"] {
        assert!(ran.stderr.contains(word), "{word}: {}", ran.stderr);
    }
    let found = read(&folder.path().join("a.csv"));
    assert_eq!(found.channels.len(), recording.channels.len());
    assert!(found.channel("Time_channel").is_some() && found.channel("two lines").is_some());
}

#[test]
fn exact_channels_and_times_are_selected() {
    let original = awkward();
    let folder = folder_with("a.mf4", &original);
    let ran = converted(&folder, "a.mf4 --out a.csv --channels n,*druck*,once --start 0.05 --end 0.1 --json");
    let found = read(&folder.path().join("a.csv"));
    let names: Vec<&str> = found.channels.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["n", "n", "Überdruck µ°"]);
    assert_eq!(found.rasters[0].time_s, original.rasters[0].time_s[50..=100]);
    assert_eq!(found.channels[1].samples, original.channels[2].samples[50..=100]);
    assert!(found.rasters[1].time_s.iter().all(|t| (0.05..=0.1).contains(t)));
    let json = ran.json();
    assert_eq!((&json[0]["rasters"][0]["samples"], &json[0]["channels"][2]["unit"]), (&51.into(), &"".into()));
    assert!(json[0]["notes"].to_string().contains("1 of 4 channels have no sample"), "{json}");
}

/// A sine of 3 Hz under one of 90 Hz, at 1 kHz, with a gap from 2 s to 2.5 s; a state at 10 Hz.
fn sines() -> Recording {
    let pi2 = 2.0 * std::f64::consts::PI;
    let time_s: Vec<f64> = (0..5000).map(|i| f64::from(i) * 1e-3).filter(|t| !(2.0..2.5).contains(t)).collect();
    let wave = |f: f64| move |t: &f64| (pi2 * f * t).sin();
    let low: Vec<f64> = time_s.iter().map(wave(3.0)).collect();
    let both: Vec<f64> = time_s.iter().map(|t| wave(3.0)(t) + wave(90.0)(t)).collect();
    let slow: Vec<f64> = (0..50).map(|i| f64::from(i) * 0.1).collect();
    let gear: Vec<f64> = slow.iter().map(|t| (t / 1.05).floor()).collect();
    let of = |name: &str, raster: usize, samples: Vec<f64>| Channel {
        name: name.into(),
        unit: "V".into(),
        comment: String::new(),
        raster,
        samples,
    };
    Recording {
        format: Format::Mdf { version: 410 },
        comment: None,
        start_time: None,
        rasters: vec![Raster { time_s, name: None }, Raster { time_s: slow, name: None }],
        channels: vec![of("low", 0, low), of("both", 0, both), of("gear", 1, gear)],
        findings: vec![],
    }
}

#[test]
fn exact_resampling_filters_aliases_and_leaves_gaps() {
    let folder = folder_with("a.mf4", &sines());
    for clock in ["--rate 100", "--sample-time 0.01"] {
        let ran = converted(&folder, &format!("a.mf4 --out a.mat {clock}"));
        assert!(ran.stderr.contains("through a low-pass filter"), "{}", ran.stderr);
        assert!(ran.stderr.contains("\"gear\"") && ran.stderr.contains("missing"), "{}", ran.stderr);
        let found = read(&folder.path().join("a.mat"));
        assert_eq!((found.rasters.len(), found.rasters[0].time_s[321]), (1, 3.21));
        let mut checked = 0;
        for (i, t) in found.rasters[0].time_s.iter().enumerate() {
            let [low, both, gear] = [0, 1, 2].map(|k| found.channels[k].samples[i]);
            let expected = (2.0 * std::f64::consts::PI * 3.0 * t).sin();
            if (2.01..2.49).contains(t) {
                assert!(low.is_nan() && both.is_nan(), "in the gap, at {t}: {low}, {both}");
            } else if (0.3..1.7).contains(t) || (2.8..4.7).contains(t) {
                // 90 Hz would alias to 10 Hz.
                assert!((low - expected).abs() < 1e-3 && (both - expected).abs() < 0.02, "at {t}: {low}, {both}");
                checked += 1;
            }
            if *t < 4.9 {
                assert_eq!(gear, (((t + 1e-9) * 10.0).floor() / 10.0 / 1.05).floor(), "at {t}");
            }
        }
        assert!(checked > 300);
    }
    converted(&folder, "a.mf4 --out held.csv --channels low,gear --sample-time 0.0005 --between straight");
    let held = read(&folder.path().join("held.csv"));
    let low = held.channel("low").unwrap();
    assert!((low.samples[1] - f64::midpoint(low.samples[0], low.samples[2])).abs() < 1e-12);
}

#[test]
fn regress_channels_that_fit_no_clock_are_left_out_and_named() {
    let mut recording = awkward();
    recording.rasters[1].time_s[5] = 0.0;
    let folder = folder_with("a.mf4", &recording);
    let ran = converted(&folder, "a.mf4 --out a.mat --rate 5000 --json");
    let notes = ran.json()[0]["notes"].to_string();
    for word in ["the time stamps do not rise", "fewer than two samples", "once", "Überdruck"] {
        assert!(notes.contains(word), "{word}: {notes}");
    }
    let found = read(&folder.path().join("a.mat"));
    assert_eq!(found.channels.iter().map(|c| c.unit.as_str()).collect::<Vec<_>>(), ["1/min", "rpm", "rad/s"]);
    // From 0 s to 0.2304 s, where the left out channels end.
    assert_eq!(found.rasters[0].time_s.len(), 1153);
}

#[test]
fn exact_several_recordings_go_into_a_folder() {
    let folder = folder_with("a.mf4", &awkward());
    std::fs::write(folder.path().join("b.csv"), "time [s],x [V]\n0,1\n1,2\n").unwrap();
    std::fs::write(folder.path().join("c.csv"), "no time\n").unwrap();
    let ran = convert(&folder, "a.mf4 b.csv c.csv --to mat --out made/here");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    assert!(ran.stderr.contains("c.csv"), "{}", ran.stderr);
    assert_eq!(content(&read(&folder.path().join("made/here/a.mat"))), content(&awkward()));
    assert_eq!(read(&folder.path().join("made/here/b.mat")).channels[0].unit, "V");
    assert!(!folder.path().join("made/here/c.mat").exists());
}

#[test]
fn exact_text_without_time_gets_it_from_the_distance_of_its_rows() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.csv"), "u,y\n1,2\n3,4\n5,6\n").unwrap();
    convert(&folder, "a.csv --out a.mf4").assert_refused(3, &["a.csv", "--sample-time"]);
    converted(&folder, "a.csv --out a.mf4 --sample-time 0.5");
    let found = read(&folder.path().join("a.mf4"));
    assert_eq!(
        (found.channels[1].samples.as_slice(), &found.rasters[0].time_s),
        (&[2.0, 4.0, 6.0][..], &vec![0.0, 0.5, 1.0])
    );
}

#[test]
fn regress_what_cannot_be_converted_is_refused() {
    let folder = folder_with("a.mf4", &awkward());
    std::fs::write(folder.path().join("model.json"), r#"{"format": "dynoid model"}"#).unwrap();
    let refused = |arguments: &str, code: i32, words: &[&str]| convert(&folder, arguments).assert_refused(code, words);
    refused("a.mf4", 2, &["--out"]);
    refused("a.mf4 --out a.mf4", 2, &["a.mf4", "is read"]);
    refused("a.mf4 --to mf4 --out .", 2, &["a.mf4", "is read"]);
    refused("a.mf4 --out a.xlsx", 2, &["a.xlsx", ".parquet"]);
    refused("a.mf4 --out b.csv --to csv", 2, &["b.csv", "folder"]);
    refused("a.mf4 a.mf4 --to csv --out made", 2, &["a.csv"]);
    refused("a.mf4 --out b.csv --channels rpm_engine", 3, &["no channel \"rpm_engine\""]);
    refused("a.mf4 --out b.csv --start 5", 3, &["nothing to convert"]);
    refused("a.mf4 --out b.csv --start 2 --end 1", 2, &["--start 2"]);
    refused("a.mf4 --out b.csv --rate 0", 2, &["--rate <HERTZ>", "above 0"]);
    refused("a.mf4 --out b.csv --sample-time 100", 3, &["100 s"]);
    refused("a.mf4 --out nowhere/b.csv", 4, &["nowhere"]);
    refused("missing.mf4 --out b.csv", 3, &["missing.mf4"]);
    refused("a.mf4 --to ss --out b.json", 2, &["invalid value 'ss'"]);
    refused("model.json --to csv --out made", 3, &["model.json", "this is a model file", "`dynoid model"]);
    refused("model.json --rate 10", 2, &["--out"]);
    let names = |folder: &TempDir| std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(names(&folder), 2, "nothing is left behind");
}

#[test]
fn exact_inspect_lists_without_samples_and_selects() {
    let folder = folder_with("a.mf4", &awkward());
    let list = dynoid(folder.path(), &["inspect", "a.mf4", "--list", "--json"]).json();
    let raster = &list[0]["rasters"][1];
    assert_eq!((&raster["name"], &raster["samples"]), (&"slow".into(), &77.into()));
    assert_eq!((&raster["channels"][1]["unit"], &list[0]["events"]), (&"[V]".into(), &serde_json::json!([])));
    assert!(raster["channels"][1].get("minimum").is_none());
    let text = dynoid(folder.path(), &["inspect", "a.mf4", "--list"]);
    assert!(text.stdout.contains("raster 1 (slow): 77 samples"), "{}", text.stdout);
    let one = dynoid(folder.path(), &["inspect", "a.mf4", "--channels", "on?e", "--json"]).json();
    assert_eq!(one[0]["rasters"].as_array().unwrap().len(), 1);
    assert_eq!(one[0]["rasters"][0]["channels"][0]["maximum"], 42.0);
    dynoid(folder.path(), &["inspect", "a.mf4", "--channels", "onze"]).assert_refused(3, &["\"once\""]);
}

#[test]
fn snap_what_was_written_is_drawn() {
    let folder = crate::identify::folder();
    let ran = crate::identify::run(&folder, "convert run.csv --out run.mf4 --plot run.svg");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let svg = std::fs::read_to_string(folder.path().join("run.svg")).unwrap();
    assert!(svg.contains("valve") && svg.contains("speed") && svg.contains("rad/s"), "{svg}");
}

/// A pattern has to fit in one of several recordings; those without it say so.
#[test]
fn exact_patterns_fit_at_least_one_of_several_recordings() {
    let folder = folder_with("a.mf4", &sines());
    let mut other = sines();
    other.channels.iter_mut().for_each(|channel| channel.name.push_str("_b"));
    let first = format!("{},", sines().channels[0].name);
    std::fs::write(folder.path().join("b.mf4"), encode_mdf4(&other).unwrap()).unwrap();
    let ran = converted(&folder, &format!("a.mf4 b.mf4 --to csv --out out --channels {first}*_b"));
    assert!(!ran.stderr.contains("error"), "{}", ran.stderr);
    let names = |file: &str| read(&folder.path().join(file)).channels.into_iter().map(|c| c.name).collect::<Vec<_>>();
    assert_eq!(names("out/a.csv"), [sines().channels[0].name.as_str()]);
    assert_eq!(names("out/b.csv").len(), sines().channels.len());
    assert!(ran.stderr.contains("a.mf4: it has no channel *_b"), "{}", ran.stderr);
    let ran = converted(&folder, "a.mf4 b.mf4 --to csv --out only --channels *_b");
    assert!(ran.stderr.contains("a.mf4: it has no channel *_b; it is not converted"), "{}", ran.stderr);
    assert!(folder.path().join("only/b.csv").exists() && !folder.path().join("only/a.csv").exists());
    convert(&folder, "a.mf4 b.mf4 --to csv --out other --channels nowhere*")
        .assert_refused(2, &["nowhere*", "no recording"]);
}

/// Rows without time, so far apart, come onto another clock in one go.
#[test]
fn exact_rows_without_time_are_resampled() {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = (0..400).map(|i| format!("{}\n", (i as f64 * 0.01).sin())).collect();
    std::fs::write(folder.path().join("a.csv"), format!("x,y\n{}", rows.replace('\n', ",1\n"))).unwrap();
    converted(&folder, "a.csv --sample-time 0.01 --out whole.csv --quiet");
    converted(&folder, "whole.csv --rate 50 --out twice.csv --quiet");
    converted(&folder, "a.csv --sample-time 0.01 --rate 50 --out once.csv --quiet");
    let [once, twice] = ["once.csv", "twice.csv"].map(|file| read(&folder.path().join(file)));
    assert_eq!(content(&once), content(&twice));
    assert_eq!(once.rasters[0].time_s[..3], [0.0, 0.02, 0.04]);
}
