//! Time series, models that run away, and data that tell nothing.

use tempfile::TempDir;

use crate::identify::{fitted, folder, run};

fn said(folder: &TempDir, line: &str) -> String {
    let ran = run(folder, line);
    assert_eq!(ran.code, Some(0), "{line}: {}", ran.stderr);
    ran.stdout
}

#[test]
fn exact_a_time_series_is_shown_from_its_noise() {
    let folder = folder();
    let fit = said(&folder, "fit armax run.csv -y speed --na 2 --nc 1 --out series.json");
    assert!(fit.contains("ARMA na 2 nc 1: e → speed"), "{fit}");
    for (command, wanted) in [
        ("model poles", "zeros"),
        ("model bode", "e → speed"),
        ("model step", "final value"),
        ("model convert", "numerator"),
        ("model convert --to zpk", "gain"),
        ("model convert --to ss", "K"),
    ] {
        let text = said(&folder, &format!("{command} series.json"));
        assert!(text.contains(wanted), "{command}: {text}");
    }
    let roots = run(&folder, "model poles series.json --json").json();
    let root = &roots[0]["poles"][0]["roots"][0];
    assert!(root["covariance"][0][0].as_f64().unwrap() > 0.0, "poles of the noise have regions: {roots}");
    fitted(&folder, "fit bj --out bj.json");
    let both = run(&folder, "model poles bj.json --noise --json").json();
    assert_eq!((both.as_array().unwrap().len(), &both[1]["poles"][0]["channels"][0]), (2, &"e → speed".into()));
}

#[test]
fn regress_a_model_that_runs_away_is_said_to() {
    let folder = folder();
    fitted(&folder, "fit arx --out model.json");
    let path = folder.path().join("model.json");
    let mut model: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    model.as_object_mut().unwrap().remove("estimate");
    model["model"]["value"]["equations"][0]["a"][0] = serde_json::json!([0.376, -2.814]);
    std::fs::write(&path, model.to_string()).unwrap();
    for command in ["model bode", "model step"] {
        let text = said(&folder, &format!("{command} model.json"));
        assert!(text.contains("not stable") && text.contains("pole at -1.876"), "{text}");
        assert!(!text.contains("bandwidth (") && !text.contains("final value  "), "{text}");
    }
    let ran = run(&folder, "model compare model.json --on unseen.csv");
    assert!(ran.stderr.contains("is not stable") && ran.stderr.contains("--horizon"), "{}", ran.stderr);
    assert!(ran.stdout.lines().all(|line| line.len() < 120), "{}", ran.stdout);
}

#[test]
fn regress_data_that_tell_nothing_are_refused_by_name() {
    let folder = folder();
    let write = |name: &str, row: &dyn Fn(f64) -> [f64; 2]| {
        let line = |t: u32| format!("{},{},{}\n", 0.1 * f64::from(t), row(f64::from(t))[0], row(f64::from(t))[1]);
        let text = format!("time,u,y\n{}", (0..200).map(line).collect::<String>());
        std::fs::write(folder.path().join(name), text).unwrap();
    };
    write("still.csv", &|t| [(0.3 * t * t).sin(), 2.1]);
    write("off.csv", &|t| [3.3, (0.3 * t * t).sin()]);
    write("huge.csv", &|t| [1e160 * (0.3 * t * t).sin(), (0.2 * t * t).sin()]);
    for (file, structure, words) in [
        ("still", "process --structure P1D", ["\"y\"", "does not vary"]),
        ("off", "arx", ["\"u\"", "does not vary"]),
        ("huge", "oe", ["\"u\"", "another unit"]),
    ] {
        run(&folder, &format!("fit {structure} {file}.csv -u u -y y")).assert_refused(3, &words);
    }
    for command in ["data order", "data spectrum", "data delay"] {
        let ran = run(&folder, &format!("{command} off.csv -u u -y y"));
        ran.assert_refused(3, &["off.csv", "\"u\"", "does not vary"]);
    }
}

#[test]
fn regress_delays_longer_than_the_data_are_refused_with_their_unit() {
    let folder = folder();
    let refused =
        |line: &str, words: &[&str]| run(&folder, &format!("{line} -u valve -y speed")).assert_refused(2, words);
    refused("fit arx run.csv --nk 5000", &["--nk 5000", "in samples", "600"]);
    refused("fit tf run.csv --delay 0:1000", &["--delay 0:1000", "in seconds", "60 s"]);
    refused("data delay run.csv --longest 5000", &["--longest 5000", "600"]);
}

#[test]
fn regress_predictions_beyond_the_data_are_called_simulations() {
    let folder = folder();
    fitted(&folder, "fit arx --out model.json");
    for command in ["model predict", "model compare"] {
        let ran = run(&folder, &format!("{command} model.json --on unseen.csv --horizon 100000"));
        assert!(ran.stderr.contains("100000 samples ahead is a simulation"), "{}", ran.stderr);
        let ran = run(&folder, &format!("{command} model.json --on unseen.csv --horizon 5"));
        assert!(!ran.stderr.contains("simulation"), "{}", ran.stderr);
    }
}

#[test]
fn regress_places_that_cannot_be_written_are_found_before_any_work() {
    let folder = folder();
    fitted(&folder, "fit arx --out model.json");
    for command in
        ["model bode model.json", "model step model.json", "model poles model.json", "data spectrum run.csv -y speed"]
    {
        run(&folder, &format!("{command} --plot nowhere/x.png")).assert_refused(4, &["nowhere/x.png", "folder"]);
        run(&folder, &format!("{command} --plot x.bmp")).assert_refused(2, &["x.bmp", ".png"]);
    }
    for command in ["data order", "data delay"] {
        let line = format!("{command} run.csv -u valve -y speed --plot nowhere/x.png");
        run(&folder, &line).assert_refused(4, &["nowhere/x.png", "folder"]);
    }
}

#[test]
fn exact_a_parameter_of_a_process_model_can_be_held() {
    let folder = folder();
    let held = fitted(&folder, "fit process --structure P2ZU --hold K=7");
    assert_eq!(held["model"]["model"]["value"]["channels"][0]["gain"], 7.0);
    assert_eq!(held["standard_errors"][0], 0.0);
    run(&folder, "fit process run.csv -u valve -y speed --hold K").assert_refused(2, &["--hold K", "K=2"]);
    run(&folder, "fit process run.csv -u valve -y speed --hold Q=1").assert_refused(3, &["Tp1"]);
}

#[test]
fn exact_a_parameter_of_a_process_model_can_be_bounded() {
    let folder = folder();
    let free = fitted(&folder, "fit process --structure P1");
    let lag = free["model"]["estimate"]["parameters"][1].as_f64().unwrap();
    let (low, high) = (2.0 * lag, 10.0 * lag);
    let line = format!("fit process run.csv -u valve -y speed --structure P1 --bound Tp1={low}:{high}");
    let text = said(&folder, &line);
    assert!(text.contains("at its bound") && text.contains("Tp1 is at its bound, so it has no interval"), "{text}");
    let bounded = run(&folder, &format!("{line} --json")).json();
    assert_eq!(bounded["model"]["estimate"]["parameters"][1], low);
    assert_eq!((&bounded["at_bound"][0], &bounded["at_bound"][1]), (&false.into(), &true.into()));
    assert!(bounded["standard_errors"][1].is_null() && bounded["intervals_95"][1][0].is_null(), "{bounded}");
    assert!(bounded["standard_errors"][0].as_f64().unwrap() > 0.0);
    let refused = |option: &str, code, words: &[&str]| {
        run(&folder, &format!("fit process run.csv -u valve -y speed {option}")).assert_refused(code, words);
    };
    refused("--bound Tp1", 2, &["--bound Tp1", "Tp1=0.1:2"]);
    refused("--bound Tp1=2:1", 2, &["the lower number first"]);
    refused("--bound Tp1=-1:2", 3, &["Tp1", "a time constant is a positive number of seconds"]);
    refused("--bound Td=-1:2", 3, &["a delay is a number of seconds that is not negative"]);
    refused("--bound Q=1:2", 3, &["Tp1"]);
}

#[test]
fn regress_data_without_noise_have_intervals_without_width() {
    let folder = folder();
    let (mut y, mut text) = ([0.0; 3], String::from("time [s],u,y\n"));
    let input = |i: i32| f64::from((i * 7919 + i * i * 13) % 17 - 8);
    for i in 0..600 {
        y = [1.5 * y[0] - 0.7 * y[1] + 0.1 * input(i - 1), y[0], y[1]];
        text += &format!("{},{},{}\n", f64::from(i) * 0.01, input(i), y[0]);
    }
    std::fs::write(folder.path().join("exact.csv"), text).unwrap();
    for fit in ["arx --na 2 --nb 1", "ss --order 2"] {
        said(&folder, &format!("fit {fit} exact.csv -u u -y y --detrend none --out exact.json"));
        for look in ["model poles", "model bode", "model step"] {
            said(&folder, &format!("{look} exact.json"));
        }
    }
}

#[test]
fn regress_numbers_that_are_none_are_refused_with_what_is_wanted() {
    let folder = folder();
    for (line, words) in [
        ("convert run.csv --out c.csv --rate -5", ["--rate", "above 0"]),
        ("convert run.csv --out c.csv --start nan", ["--start", "give a number"]),
        ("convert run.csv --out c.csv --sample-time 0", ["--sample-time", "above 0"]),
        ("fit ss run.csv -u valve -y speed --order -3", ["--order -3", "from 1 on, or auto"]),
        ("fit arx run.csv -u valve -y speed --na -2", ["--na", "whole number"]),
        ("fit arx run.csv -u valve -y speed --nb 2,x", ["--nb", "whole number"]),
        ("fit arx run.csv -u valve -y speed --split 1.5", ["--split", "between 0 and 1"]),
        ("fit arx run.csv -u valve -y speed --from inf", ["--from", "give a number"]),
    ] {
        run(&folder, line).assert_refused(2, &words);
    }
    let ran = run(&folder, "convert run.csv --out c.csv --start -5");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
}

#[test]
fn regress_model_files_are_separated_from_recordings_and_by_their_version() {
    let folder = folder();
    run(&folder, "fit arx run.csv -u valve -y speed --out m.json");
    for line in ["inspect m.json", "inspect m.json --list", "fit arx m.json -u valve -y speed"] {
        let ran = run(&folder, line);
        assert_eq!(ran.code, Some(3), "{line}");
        assert!(ran.stderr.contains("this is a model file, not a recording"), "{line}: {}", ran.stderr);
    }
    let text = std::fs::read_to_string(folder.path().join("m.json")).unwrap();
    let later = text.replace("\"version\": 1", "\"version\": 2").replace("\"inputs\"", "\"entries\"");
    std::fs::write(folder.path().join("later.json"), later).unwrap();
    run(&folder, "model poles later.json").assert_refused(3, &["later.json", "version 2", "a later dynoid wrote it"]);
    std::fs::write(folder.path().join("other.json"), "{\"format\": \"shopping list\", \"version\": 1}").unwrap();
    run(&folder, "model poles other.json").assert_refused(3, &["other.json", "not a model file", "shopping list"]);
}

#[test]
fn exact_a_transfer_function_that_integrates_is_fitted_from_where_it_stood() {
    let folder = TempDir::new().unwrap();
    let mut random = signal::excitation::Random::new(5);
    // 2/(s (0.5 s + 1)) from rest, on a level of 7; every value of the input is held for a tenth of a second.
    let pole = (-0.1_f64 / 0.5).exp();
    let (mut speed, mut angle) = (0.0, 0.0);
    let mut text = "time [s],torque [Nm],angle [rad]\n".to_owned();
    for n in 0..800 {
        let torque = random.normal().signum();
        text += &format!("{},{torque},{}\n", 0.1 * f64::from(n), 7.0 + angle + 0.01 * random.normal());
        let rest = 2.0 * torque;
        angle += rest * 0.1 + (speed - rest) * 0.5 * (1.0 - pole);
        speed = rest + (speed - rest) * pole;
    }
    std::fs::write(folder.path().join("run.csv"), text).unwrap();
    let line = "fit tf run.csv -u torque -y angle --poles 2 --integrators 1 --offset --initial zero --detrend none";
    let ran = run(&folder, &format!("{line} --json"));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let result = ran.json();
    let parameters = result["model"]["estimate"]["parameters"].as_array().unwrap();
    let errors = result["standard_errors"].as_array().unwrap();
    // 4/(s² + 2 s)
    for (truth, at) in [(4.0, 0), (2.0, 1)] {
        let (value, error) = (parameters[at].as_f64().unwrap(), errors[at].as_f64().unwrap());
        assert!((value - truth).abs() < 4.0 * error && error < 0.02 * truth, "{value} ± {error} for {truth}");
    }
}

#[cfg(unix)]
#[test]
fn regress_a_device_is_refused_as_a_recording() {
    let folder = folder();
    for command in ["inspect /dev/zero", "inspect /dev/null --list", "convert /dev/zero --out a.csv"] {
        run(&folder, command).assert_refused(3, &["pipe or a device", "save it to a file"]);
    }
    // What has no end is not read to its end.
    for command in ["study /dev/zero", "model bode /dev/zero", "diff /dev/zero /dev/zero"] {
        run(&folder, command).assert_refused(3, &["/dev/zero", "pipe or a device"]);
    }
}

#[test]
fn regress_edges_of_a_band_are_refused_in_words() {
    let folder = folder();
    for band in ["0,15", "15,5"] {
        let command = format!("fit oe run.csv -u valve -y speed --nb 1 --nf 1 --band {band}");
        run(&folder, &command).assert_refused(2, &["lower edge first"]);
    }
}
