//! Recordings before and after an estimate: clocks, gaps, faults, and what is said of them.

use faer::{Mat, mat};
use lti::StateSpace;
use tempfile::TempDir;

use crate::identify::{fitted, folder, run};
use crate::support::{Ran, dynoid};

/// A lag of 5 ms, 1.2 ms late: its demand every millisecond, its answer every fourth.
fn two_rasters() -> TempDir {
    let mut random = signal::excitation::Random::new(3);
    let (count, lag_s) = (4001, 0.005);
    let u = Mat::from_fn(count, 1, |_, _| random.normal().signum());
    let system = StateSpace::continuous(mat![[-1.0 / lag_s]], mat![[1.0 / lag_s]], mat![[1.0]], mat![[0.0]]).unwrap();
    let y = system.to_discrete_delayed(&[0.0012], 0.001).unwrap().simulate(u.as_ref(), &[0.0], &[0.0]).unwrap();
    let rows = (0..count).map(|n| {
        let slow = match 4 * n < count {
            true => format!("{},{}", 0.004 * n as f64, y[(4 * n, 0)] + 0.01 * random.normal()),
            false => ",".into(),
        };
        format!("{},{},{slow}\n", 0.001 * n as f64, u[(n, 0)])
    });
    let text = format!("time [s],demand [Nm],time 2 [s],torque [Nm]\n{}", rows.collect::<String>());
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("run.csv"), text).unwrap();
    folder
}

#[track_caller]
fn done(folder: &TempDir, line: &str) -> Ran {
    let ran = run(folder, line);
    assert_eq!(ran.code, Some(0), "{line}: {}", ran.stderr);
    ran
}

fn notes(result: &serde_json::Value) -> String {
    result["adjustments"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect::<Vec<_>>().join("\n")
}

#[test]
fn stat_fits_to_the_simulated_output_run_on_the_fastest_clock() {
    let folder = two_rasters();
    let line = "run.csv -u demand -y torque --json";
    for method in ["fit tf --zeros 0 --poles 1 --delay 0:0.004", "fit process --structure P1D --delay 0:0.004"] {
        let result = done(&folder, &format!("{method} {line}")).json();
        assert_eq!(result["model"]["sample_time_s"], 0.001);
        assert!(notes(&result).contains("\"torque\" has a sample only every 0.004 s"), "{}", notes(&result));
        let estimate = &result["model"]["estimate"];
        let at =
            estimate["parameter_names"].as_array().unwrap().iter().position(|n| n == "delay" || n == "Td").unwrap();
        let delay_s = estimate["parameters"][at].as_f64().unwrap();
        let error_s = result["standard_errors"][at].as_f64().unwrap();
        assert!((delay_s - 0.0012).abs() < 4.0 * error_s && error_s < 5e-5, "{method}: {delay_s} ± {error_s}");
        // Residuals every fourth sample: the tests of whiteness hold all the same.
        assert_eq!(result["residuals"]["whiteness"][0]["joint"]["passed"], true, "{}", result["residuals"]);
    }
    let lag = |delay: &str, parameters: &str, gain: &str| {
        let matrices = "[matrices]\nA = [[\"-1/lag\"]]\nB = [[\"1/lag\"]]\nC = [[1]]";
        let parameters = format!("[parameters]\nlag = {{ value = 0.01, min = 1e-4 }}\n{parameters}");
        let text = format!("{delay}\n{parameters}\n{matrices}\n{gain}");
        std::fs::write(folder.path().join("lag.toml"), text).unwrap();
        done(&folder, &format!("fit greybox lag.toml {line}")).json()
    };
    let result = lag("input_delays_s = [\"late\"]", "late = { value = 0.0005, min = 0 }", "");
    let late_s = result["model"]["estimate"]["parameters"][1].as_f64().unwrap();
    assert!((late_s - 0.0012).abs() < 1e-4, "{late_s}");
    // With a gain of the predictor every output has to be there.
    assert_eq!(lag("", "", "K = [[0.01]]")["model"]["sample_time_s"], 0.004);
    let result = done(&folder, &format!("fit arx {line}")).json();
    assert_eq!(result["model"]["sample_time_s"], 0.004);
    assert!(notes(&result).contains("\"demand\" was brought from a sample time of 0.001 s to 0.004 s"));
}

#[test]
fn stat_the_delay_of_a_held_demand_is_found_on_the_fastest_clock() {
    let folder = two_rasters();
    // A demand that changes with every sample may be held or run straight in between: half a sample of delay apart.
    let unsaid = done(&folder, "data delay run.csv -u demand -y torque --json").json();
    assert!(unsaid["delay"][0]["interval_95_s"].is_null(), "{unsaid}");
    assert!(unsaid["delay"][0]["unclaimed"].as_str().unwrap().contains("--between"), "{unsaid}");
    let line = "data delay run.csv -u demand -y torque --between held";
    let found = done(&folder, &format!("{line} --json")).json();
    assert_eq!(found["sample_time_s"], 0.001);
    let delay = &found["delay"][0];
    let [low, high] = [0, 1].map(|end| delay["interval_95_s"][end].as_f64().unwrap());
    assert!(low <= 0.0012 && 0.0012 <= high && high - low < 3e-4, "{delay}");
    let text = done(&folder, line).stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("clock of the fastest channel, 0.001 s"), "{text}");
    assert!(text.contains("the dead time beside a lag of first order"), "{text}");
    // Brought to a slower clock, the demand is blurred: then nothing is claimed.
    let slow = done(&folder, &format!("{line} --sample-time 0.004 --json")).json();
    assert!(slow["delay"][0]["interval_95_s"].is_null(), "{slow}");
    assert!(slow["delay"][0]["unclaimed"].as_str().unwrap().contains("low-pass filter"), "{slow}");
}

#[test]
fn regress_no_delay_is_claimed_of_channels_that_do_not_vary() {
    let folder = TempDir::new().unwrap();
    let mut random = signal::excitation::Random::new(9);
    let rows = (0..600).map(|n| format!("{},{},5\n", 0.1 * f64::from(n), random.normal()));
    std::fs::write(folder.path().join("run.csv"), format!("time,moves,rests\n{}", rows.collect::<String>())).unwrap();
    for [input, output] in [["rests", "moves"], ["moves", "rests"]] {
        for detrend in ["mean", "none"] {
            let line = format!("data delay run.csv -u {input} -y {output} --detrend {detrend}");
            run(&folder, &line).assert_refused(3, &["\"rests\"", "does not vary"]);
        }
    }
}

#[test]
fn regress_outputs_that_depend_on_each_other_make_a_short_result() {
    let folder = folder();
    let text = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let doubled = |(n, line): (usize, &str)| match (n, line.rsplit(',').next().unwrap().parse::<f64>()) {
        (0, _) => format!("{line},twice\n"),
        (_, Ok(speed)) => format!("{line},{}\n", 2.0 * speed),
        _ => format!("{line},\n"),
    };
    std::fs::write(folder.path().join("twice.csv"), text.lines().enumerate().map(doubled).collect::<String>()).unwrap();
    let shown = done(&folder, "fit ss twice.csv -u valve -y speed -y twice --order auto").stdout;
    assert!(shown.contains("twice follow from those of the outputs before it"), "{shown}");
    assert!(!shown.contains("does not vary") && !shown.contains("loss 0"), "{shown}");
    assert!(shown.lines().count() < 25, "{shown}");
}

#[test]
fn regress_more_structures_than_can_be_compared_are_refused() {
    let folder = folder();
    let line = "data order run.csv -u valve -y speed --na 1:100 --nb 1:100 --nk 1:200";
    run(&folder, line).assert_refused(2, &["2000000 structures", "100000", "--nk"]);
}

#[test]
fn exact_a_peak_says_where_its_top_may_be() {
    let folder = folder();
    let spectra = done(&folder, "data spectrum run.csv -u valve -y speed --json").json();
    for peak in spectra[0]["peaks"].as_array().unwrap() {
        let at = |end: usize| peak["frequency_interval_95_hz"][end].as_f64().unwrap();
        let top = peak["frequency_hz"].as_f64().unwrap();
        assert!(at(0) <= top && top <= at(1) && at(1) > at(0), "{peak}");
    }
    assert!(!done(&folder, "data spectrum run.csv -u valve -y speed").stdout.contains('±'));
}

#[test]
fn regress_a_model_that_explains_nothing_is_doubted() {
    let folder = TempDir::new().unwrap();
    let mut random = signal::excitation::Random::new(8);
    let rows = (0..600).map(|n| format!("{},{},{}\n", 0.1 * f64::from(n), random.normal(), random.normal()));
    std::fs::write(folder.path().join("run.csv"), format!("time,valve,speed\n{}", rows.collect::<String>())).unwrap();
    let ran = run(&folder, "fit oe run.csv -u valve -y speed --json --out m.json");
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    let result = ran.json();
    let doubts = result["doubts"].to_string();
    assert!(doubts.contains("the model explains next to nothing of speed"), "{doubts}");
    let kinds = &result["model"]["estimate"]["doubts"];
    assert!(kinds.as_array().unwrap().iter().any(|d| d["kind"] == "explains_little"), "{kinds}");
    let text = run(&folder, "fit oe run.csv -u valve -y speed").stdout;
    assert_eq!(text.matches("next to nothing").count(), 1, "{text}");
    assert!(text.contains("doubt:"), "{text}");
    done(&folder, "model poles m.json");
    let good = crate::identify::folder();
    assert!(!fitted(&good, "fit oe")["doubts"].to_string().contains("next to nothing"));
    let noise = std::fs::read(folder.path().join("run.csv")).unwrap();
    std::fs::write(good.path().join("noise.csv"), noise).unwrap();
    let unseen = run(&good, "fit oe run.csv -u valve -y speed --validate noise.csv");
    assert_eq!(unseen.code, Some(1), "{}", unseen.stderr);
    assert!(unseen.stdout.contains("(a fit below 5 % on"), "{}", unseen.stdout);
}

/// `run.csv` without some inputs, and without one output.
fn with_gaps(folder: &TempDir) {
    let text = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let cut = |(n, line): (usize, &str)| {
        let cells: Vec<&str> = line.split(',').collect();
        match n {
            200..=230 | 400 => format!("{},,{}\n", cells[0], cells[2]),
            100 => format!("{},{},\n", cells[0], cells[1]),
            _ => format!("{line}\n"),
        }
    };
    std::fs::write(folder.path().join("gaps.csv"), text.lines().enumerate().map(cut).collect::<String>()).unwrap();
}

#[test]
fn exact_recordings_are_cut_where_inputs_are_missing() {
    let folder = folder();
    with_gaps(&folder);
    for method in
        ["arx", "arx --iv", "armax", "oe", "bj", "tf --zeros 1 --poles 2", "process --structure P2ZU", "ss --order 2"]
    {
        let line = format!("fit {method} gaps.csv -u valve -y speed --json --validate unseen.csv");
        let result = done(&folder, &line).json();
        let notes = notes(&result);
        let stretches = if notes.contains("\"valve\", \"speed\"") { 4 } else { 3 };
        assert!(notes.contains(&format!("into {stretches} stretches")), "{method}: {notes}");
        assert_eq!(result["judged"][0]["fit_percent_simulated"].as_array().unwrap().len(), stretches, "{method}");
        let fit = result["judged"][1]["fit_percent_predicted"][0][0].as_f64().unwrap();
        assert!(fit > 60.0, "{method}: {fit}");
    }
    fitted(&folder, "fit armax --out m.json");
    done(&folder, "model residuals m.json --on gaps.csv");
    done(&folder, "model compare m.json --on gaps.csv");
    done(&folder, "model simulate m.json --on gaps.csv --out s.csv --plot s.svg");
    let text = std::fs::read_to_string(folder.path().join("s.csv")).unwrap();
    let rows: Vec<&str> = text.lines().collect();
    assert_eq!(rows.len(), 601);
    assert!(rows[210].ends_with(",NaN") && !rows[100].ends_with(",NaN"), "{} and {}", rows[210], rows[100]);
}

#[test]
fn regress_recordings_without_a_stretch_are_refused_and_name_the_channel() {
    let folder = folder();
    let rows = (0..400).map(|n| format!("{n},{},{n}\n", if n % 8 == 0 { "" } else { "1.5" }));
    std::fs::write(folder.path().join("sieve.csv"), format!("time,valve,speed\n{}", rows.collect::<String>())).unwrap();
    run(&folder, "fit oe sieve.csv -u valve -y speed").assert_refused(3, &["sieve.csv", "\"valve\"", "missing"]);
}

#[test]
fn regress_an_estimate_is_kept_where_its_judgement_fails() {
    let folder = folder();
    let text = std::fs::read_to_string(folder.path().join("unseen.csv")).unwrap();
    let short: String = text.lines().take(60).map(|line| format!("{line}\n")).collect();
    std::fs::write(folder.path().join("short.csv"), short).unwrap();
    let result = fitted(&folder, "fit arx --validate short.csv --out m.json");
    assert!(result["residuals_error"].as_str().unwrap().contains("59 samples are too few"), "{result}");
    done(&folder, "model poles m.json");
}

#[test]
fn regress_wrong_orders_are_faults_of_the_command_line() {
    let folder = folder();
    for (line, words) in [
        ("arx --nb 1,2", "--nb: 2 values for 1 input"),
        ("arx --nk 1,2,3", "--nk: 3 values for 1 input"),
        ("arx --na 0 --nb 0", "nothing to estimate"),
        ("oe --nb 0", "--nb 0"),
        ("oe --nf 1,2", "--nf: 2 values"),
        ("tf --zeros 3 --poles 2", "--zeros 3 is more than --poles 2"),
        ("tf --delay 0.2:0.1", "--delay 0.2:0.1"),
        ("tf --poles 1,1", "--poles: 2 values"),
        ("process --structure P1X", "--structure P1X"),
        ("ss --order 0", "--order 0"),
    ] {
        run(&folder, &format!("fit {line} run.csv -u valve -y speed")).assert_refused(2, &[words]);
    }
    run(&folder, "fit tf run.csv -y speed").assert_refused(2, &["--input"]);
}

#[test]
fn regress_too_few_samples_name_the_data_and_what_to_lower() {
    let folder = folder();
    let ran = run(&folder, "fit arx run.csv -u valve -y speed --na 500 --nb 500");
    ran.assert_refused(3, &["run.csv (valve → speed)", "samples cannot determine", "lower --na"]);
    let ran = run(&folder, "fit tf run.csv -u valve -y speed --to 0.6 --zeros 3 --poles 4");
    ran.assert_refused(3, &["run.csv (valve → speed)", "--poles"]);
}

#[test]
fn regress_files_are_called_what_they_are() {
    let folder = folder();
    std::fs::write(folder.path().join("m.json"), [0xff, 0xfe, b'{']).unwrap();
    let ran = run(&folder, "model poles m.json");
    ran.assert_refused(3, &["m.json", "UTF-8", "model file"]);
    assert!(!ran.stderr.contains("bench file"), "{}", ran.stderr);
}

#[test]
fn regress_models_meet_no_other_units() {
    let folder = folder();
    done(&folder, "fit arx run.csv -u valve -y speed --out m.json");
    let text = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    std::fs::write(folder.path().join("other.csv"), text.replace("[rad/s]", "[rpm]")).unwrap();
    run(&folder, "model compare m.json --on other.csv").assert_refused(3, &["other.csv", "rpm", "rad/s"]);
    run(&folder, "fit arx run.csv other.csv -u valve -y speed").assert_refused(3, &["other.csv", "rpm", "rad/s"]);
}

/// Names that read like the counts they stand for.
#[test]
fn regress_advice_names_the_channel_it_means() {
    let folder = folder();
    let text = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let swapped = text.replace("valve", "speed_").replace("speed [", "output 1 [").replace("speed_", "speed");
    std::fs::write(folder.path().join("odd.csv"), swapped).unwrap();
    let ran = dynoid(folder.path(), &["fit", "arx", "odd.csv", "-u", "output 1", "-y", "speed"]);
    assert!(ran.stderr.contains("\"output 1\" follows \"speed\""), "{}", ran.stderr);
}

#[test]
fn regress_recordings_count_once() {
    let folder = folder();
    run(&folder, "fit arx run.csv ./run.csv -u valve -y speed").assert_refused(2, &["run.csv", "twice"]);
    std::fs::copy(folder.path().join("run.csv"), folder.path().join("copy.csv")).unwrap();
    let ran = done(&folder, "fit arx run.csv copy.csv -u valve -y speed");
    assert!(ran.stderr.contains("copy.csv holds the same as run.csv"), "{}", ran.stderr);
    let ran = done(&folder, "fit arx run.csv -u valve -y speed --validate run.csv");
    assert!(ran.stderr.contains("no unseen one"), "{}", ran.stderr);
}

#[test]
fn regress_targets_are_checked_before_anything_is_read() {
    let folder = folder();
    // The recording is not there; the target is found to be wrong all the same.
    for (target, words) in [("--out absent/m.json", "absent/m.json"), ("--plot absent/p.svg", "absent/p.svg")] {
        run(&folder, &format!("fit arx none.csv -u valve -y speed {target}")).assert_refused(4, &[words]);
    }
    run(&folder, "fit arx none.csv -u valve -y speed --plot p.bmp").assert_refused(2, &["p.bmp", ".html"]);
    assert!(!folder.path().join("absent").exists());
}

#[test]
fn exact_models_meet_untimed_text_and_other_clocks() {
    let folder = folder();
    fitted(&folder, "fit tf --zeros 1 --poles 2 --out tf.json");
    fitted(&folder, "fit arx --out arx.json");
    let text = std::fs::read_to_string(folder.path().join("unseen.csv")).unwrap();
    let untimed: String = text.lines().map(|line| format!("{}\n", line.split_once(',').unwrap().1)).collect();
    std::fs::write(folder.path().join("bare.csv"), untimed).unwrap();
    let fit = |line: &str| {
        let compared = done(&folder, &format!("model compare {line} --json")).json();
        compared[0]["fit_percent"][0][0].as_f64().unwrap()
    };
    let timed = fit("tf.json --on unseen.csv");
    assert!((fit("tf.json --on bare.csv") - timed).abs() < 1e-9);
    assert!((fit("tf.json --on bare.csv --sample-time 0.1") - timed).abs() < 1e-9);
    // With the wrong time from row to row the model is too fast for the data.
    assert!(fit("tf.json --on bare.csv --sample-time 0.2") < timed - 20.0);
    for command in ["model residuals arx.json", "model simulate tf.json", "model predict arx.json"] {
        done(&folder, &format!("{command} --on bare.csv --sample-time 0.1"));
    }
    run(&folder, "model residuals arx.json --on unseen.csv --sample-time 0.2")
        .assert_refused(2, &["--sample-time", "discrete"]);
}

#[test]
fn snap_comparisons_say_everything_once() {
    let folder = folder();
    with_gaps(&folder);
    fitted(&folder, "fit tf --zeros 1 --poles 2 --out tf.json");
    fitted(&folder, "fit arx --out arx.json");
    let ran = done(&folder, "model compare tf.json arx.json --on gaps.csv");
    assert_eq!(ran.stderr.matches("\"valve\": 32 of 600 samples are missing").count(), 1, "{}", ran.stderr);
    let text = done(&folder, "fit arx gaps.csv -u valve -y speed").stdout;
    assert!(text.contains("estimation, gaps.csv part 2"), "{text}");
    let fit = done(&folder, "fit arx gaps.csv -u valve -y speed");
    assert_eq!(fit.stderr.matches("of 600 samples").count(), 3, "{}", fit.stderr);
}

#[test]
fn snap_written_times_are_short_decimals() {
    let folder = TempDir::new().unwrap();
    let mut random = signal::excitation::Random::new(2);
    let rows = (0..400).map(|n| format!("{},{},{}\n", 2.5 + 0.01 * f64::from(n), random.normal(), random.normal()));
    std::fs::write(folder.path().join("run.csv"), format!("time,valve,speed\n{}", rows.collect::<String>())).unwrap();
    let explains_nothing = run(&folder, "fit arx run.csv -u valve -y speed --out m.json");
    assert_eq!(explains_nothing.code, Some(1), "{}", explains_nothing.stderr);
    done(&folder, "model simulate m.json --on run.csv --out s.csv");
    let text = std::fs::read_to_string(folder.path().join("s.csv")).unwrap();
    let times: Vec<&str> = text.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!((times.len(), times[0], times[51], times[399]), (400, "2.5", "3.01", "6.49"));
    assert!(times.iter().all(|time| time.len() <= 4), "{times:?}");
}

#[test]
fn regress_an_integrator_and_a_trend_taken_off_are_noticed() {
    let folder = TempDir::new().unwrap();
    let mut random = signal::excitation::Random::new(4);
    let mut speed = 0.0;
    let rows = (0..800).map(|n| {
        let torque = if n % 10 < 5 { 1.0 } else { -0.6 } + 0.5 * random.normal();
        let row = format!("{},{torque},{}\n", 0.01 * f64::from(n), speed + 0.01 * random.normal());
        speed += 0.01 * torque;
        row
    });
    std::fs::write(folder.path().join("run.csv"), format!("time,torque,speed\n{}", rows.collect::<String>())).unwrap();
    let line = "fit arx run.csv -u torque -y speed";
    let ran = run(&folder, line);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    assert!(ran.stderr.contains("\"speed\" seems to integrate \"torque\""), "{}", ran.stderr);
    assert!(!done(&folder, &format!("{line} --detrend none")).stderr.contains("integrate"));
    let settling = crate::identify::folder();
    assert!(!run(&settling, "fit arx run.csv -u valve -y speed").stderr.contains("integrate"));
}

#[test]
fn regress_a_recording_left_out_at_its_gaps_is_no_source() {
    let folder = folder();
    // No twenty values of the input on end.
    let text = std::fs::read_to_string(folder.path().join("unseen.csv")).unwrap();
    let sparse = |(row, line): (usize, &str)| match line.split(',').collect::<Vec<_>>()[..] {
        [time, _, speed] if row > 0 && row % 10 == 0 => format!("{time},,{speed}\n"),
        _ => format!("{line}\n"),
    };
    let sparse = text.lines().enumerate().map(sparse).collect::<String>();
    std::fs::write(folder.path().join("sparse.csv"), sparse).unwrap();
    let line = "fit arx sparse.csv run.csv -u valve -y speed --json --out m.json";
    let ran = done(&folder, line);
    assert!(ran.stderr.contains("warning: sparse.csv was left out"), "{}", ran.stderr);
    let model = &ran.json()["model"];
    let sources = model["estimate"]["sources"].as_array().unwrap();
    assert_eq!((sources.len(), sources[0]["file"].as_str()), (1, Some("run.csv")));
    let own = fitted(&folder, "fit arx");
    assert_eq!(model["trend"], own["model"]["trend"], "the operating point is that of the one used");
}

#[test]
fn regress_what_was_done_is_a_note_and_what_may_be_wrong_a_warning() {
    let folder = two_rasters();
    let ran = done(&folder, "fit tf run.csv -u demand -y torque");
    assert!(ran.stderr.contains("note: \"torque\" has a sample only every 0.004 s"), "{}", ran.stderr);
    assert!(!ran.stderr.contains("warning"), "{}", ran.stderr);
    assert_eq!(done(&folder, "fit tf run.csv -u demand -y torque --quiet").stderr, "");
}
