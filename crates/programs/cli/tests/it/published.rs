//! The commands on measurements of others, against what they published. Skipped where the shared folder is not there.
#![allow(clippy::print_stdout, reason = "what was found is for whoever reads the test run")]

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::support::Campaign;

/// A file of the reference data; `None`, and the test counts as skipped, where it is absent.
fn reference(path: &str) -> Option<PathBuf> {
    testdata::shared(&format!("reference/{path}"))
}

/// A bench where nothing fires, with one recording.
fn bench(recording: &Path, label: &str, inertia: &str, channels: &str) -> Campaign {
    let campaign = Campaign::empty();
    let file = recording.display();
    let text = format!(
        "[bench]\nname = \"b\"\nvariant = \"load-cell\"\ncylinders = 0\ndynamometer_inertia = \"{inertia}\"\n\
         dynamometer_inertia_uncertainty_percent = 20\nengine_inertia = \"{inertia}\"\n[channels]\n{channels}\n\
         [recordings]\nfiles = ['{file}']\n[[recordings.label]]\nfile = '{file}'\nlabel = \"{label}\"\n"
    );
    campaign.write("bench.toml", text.as_bytes());
    campaign
}

fn run(campaign: &Campaign, line: &[&str]) -> Value {
    let ran = campaign.run(&[line, &["--json"]].concat());
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    ran.json()
}

/// A parameter's value and interval.
fn estimate_of(parameters: &Value, symbol: &str) -> (f64, [f64; 2]) {
    let parameter = parameters.as_array().unwrap().iter().find(|p| p["symbol"] == symbol).expect(symbol);
    println!("{symbol} = {} in {}", parameter["value"], parameter["interval"]);
    (parameter["value"].as_f64().unwrap(), [0, 1].map(|i| parameter["interval"][i].as_f64().unwrap()))
}

fn near(found: f64, published: f64, part: f64) {
    assert!((found / published - 1.0).abs() < part, "{found}, published {published}");
}

/// Two motors on a coupling, torque in units of the current (the torque constant is not published). Published, from
/// frequency responses: K 551, J 0.00482 and 0.00479, antiresonance 53 to 54 Hz, resonance 76.2 to 77 Hz, 0.12 ms from
/// current to angle. From a dynamometer on its bearings no more friction is expected than one with which it runs out in
/// a minute; these motors have much more, and unless that is stated it counts as damping of the coupling.
#[test]
#[ignore = "slow"]
fn ref_two_motors_by_the_command_shaft() {
    let Some(file) = reference("motor-bench-two-mass/MultisineTypeA.mat") else { return };
    let channels = "dyno_speed = { name = \"theta_mx\", unit = \"rad\" }\n\
                    engine_speed = { name = \"theta_my\", unit = \"rad\", sign = -1 }\n\
                    air_gap_torque = { name = \"iq_adx\", unit = \"Nm\", sign = -1 }\n\
                    dyno_torque_demand = { name = \"iq_refx\", unit = \"Nm\", sign = -1 }";
    let campaign = bench(&file, "Multisine_T_TN", "0.005 kg m²", channels);
    let found = run(&campaign, &["shaft", "bench.toml"]);
    let recording = &found["recordings"][0];
    let whole = &recording["inertias"]["found"]["parameters"];
    let periods = &recording["routes"]["multisine"]["found"];
    for parameters in [whole, &periods["estimate"]["parameters"]] {
        let [stiffness, motor, load] = ["K", "J_d", "J_e"].map(|symbol| estimate_of(parameters, symbol).0);
        near(stiffness, 551.0, 0.025);
        near(motor, 0.00482, 0.02);
        near(load, 0.00479, 0.04);
        near((stiffness / load).sqrt() / TAU, 53.5, 0.015);
        near((stiffness * (1.0 / motor + 1.0 / load)).sqrt() / TAU, 76.6, 0.02);
        // More is in this shaft than K and B, so a delay of a tenth of a sample shows to some hundredths of a
        // millisecond.
        near(-estimate_of(parameters, "δ_T").0, 1.2e-4, 0.4);
    }
    // A delay below zero is not left without a word.
    let ran = campaign.run(&["torque-control", "bench.toml", "--highest-order", "1", "--longest-delay", "1"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let text = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("is below zero (−") && text.contains("record both on one clock"), "{text}");
    // ζ = 0.005 of the published response, B = 2ζ√(K J J_l/(J + J_l)), once any friction of the bearings is thought
    // possible.
    let text = campaign.read("bench.toml").replace(
        "cylinders = 0\n",
        "cylinders = 0\ndynamometer_friction = \"0.02 Nm s/rad\"\ndynamometer_friction_uncertainty_percent = 300\n",
    );
    campaign.write("friction.toml", text.as_bytes());
    let free = run(&campaign, &["shaft", "friction.toml"]);
    let (_, [low, high]) = estimate_of(&free["recordings"][0]["inertias"]["found"]["parameters"], "B");
    let published = 2.0 * 0.005 * (551.0_f64 * 0.00482 * 0.00479 / (0.00482 + 0.00479)).sqrt();
    assert!(low < published && published < high, "{low} … {high}, published {published}");
    // More than K and B is in this shaft, and it is said.
    let cost = &periods["cost"];
    assert!(cost["achieved"].as_f64().unwrap() > 10.0 * cost["limits"][1].as_f64().unwrap(), "{cost}");
}

/// EMPS, a ball screw drive, metres for radians and newtons for newton metres. Published: M = 95.109 ± 0.109 kg, F_v =
/// 203.50 ± 1.15 N s/m, F_c = 20.39 ± 0.10 N, offset −3.165 ± 0.044 N.
#[test]
fn ref_positioning_system_by_the_command_friction() {
    let Some(file) = reference("emps/DATA_EMPS.mat") else { return };
    let channels = "dyno_speed = { name = \"qm\", unit = \"rad\" }\n\
                    air_gap_torque = { name = \"vir\", unit = \"Nm\", factor = 35.15065188248547, sign = -1 }";
    let campaign = bench(&file, "NoShaft_N_NT", "90 kg m²", channels);
    let found = run(&campaign, &["friction", "bench.toml"]);
    let mass = found["inertia"]["inertia"]["value"].as_f64().unwrap();
    near(mass, 95.109, 0.005);
    let (_, offset) = estimate_of(&found["friction"]["parameters"], "T_0");
    assert!(offset[0] < -3.165 && -3.165 < offset[1], "{offset:?}");
    // The terms that were published, beside which others explain this speed better.
    let candidates = found["candidates"].as_array().unwrap();
    let plain = candidates.iter().find(|c| c["terms"] == serde_json::json!(["offset", "coulomb", "viscous"])).unwrap();
    for (symbol, published) in [("c_0/J", 20.39), ("c_1/J", 203.5)] {
        let (_, [low, high]) = estimate_of(&plain["per_inertia"], symbol);
        assert!(low < published / mass && published / mass < high, "{symbol}: {low} … {high}");
    }
    for point in found["curve"].as_array().unwrap() {
        let [v, force, half] = ["speed_rad_s", "torque_nm", "half_width_nm"].map(|key| point[key].as_f64().unwrap());
        let published = 203.5 * v + 20.39 * v.signum() - 3.165;
        assert!(v.abs() < 0.04 || (force - published).abs() < half + 1.5, "{v}: {force} ± {half}, {published}");
    }
}

/// A flywheel left alone, J = 0.8489 kg m². Published: dω/dt = −1.74e-7 ω³ + 2.903e-5 ω² − 3.222e-3 ω − 3.097e-2.
#[test]
fn ref_run_out_by_the_command_friction() {
    let Some(file) = reference("inertia-dyno/unloaded_spindown.txt") else { return };
    let text = std::fs::read_to_string(file).unwrap();
    let rows = text.lines().map(|line| line.split_whitespace().take(6).collect::<Vec<_>>().join(",") + "\n");
    let table = format!("volt,ampere,watt,speed [rpm],throttle,time [ms]\n{}", rows.collect::<String>());
    let campaign = bench(Path::new("recordings/run.csv"), "NoShaft_T_TN", "0.8489 kg m²", "dyno_speed = \"speed\"");
    campaign.write("recordings/run.csv", table.as_bytes());
    let found = run(&campaign, &["friction", "bench.toml", "--slowest", "38"]);
    for point in found["curve"].as_array().unwrap() {
        let [w, torque] = ["speed_rad_s", "torque_nm"].map(|key| point[key].as_f64().unwrap());
        let published = 1.74e-7 * w.powi(3) - 2.903e-5 * w * w + 3.222e-3 * w + 3.097e-2;
        // The published window ends below the highest speeds, and the lowest are within noise.
        assert!(
            !(10.0..100.0).contains(&w) || (torque / 0.8489 / published - 1.0).abs() < 0.06,
            "{w}: {torque} {published}"
        );
    }
}

/// A rotary joint with a spring, under feedback. Published, by eye from a plot: 13.45 rad/s, ζ = 0.05.
#[test]
fn ref_flexible_joint_by_the_command_fit() {
    let Some(file) = reference("flexible-joint/Joint_SI_CL_40s_Data.mat") else { return };
    let campaign = Campaign::empty();
    campaign.write(
        "joint.toml",
        b"[parameters]\nw = { value = 12, min = 1, max = 100 }\nz = { value = 0.1, min = 0, max = 1 }\ng = { value = -1 }\n\
          [matrices]\nA = [[0, 1], [\"-w^2\", \"-2*z*w\"]]\nB = [[0], [1]]\nC = [[\"-g*w^2\", \"-2*g*z*w\"]]\nD = [[\"g\"]]\n",
    );
    let line = ["fit", "greybox", "joint.toml", file.to_str().unwrap(), "-u", "Theta", "-y", "Alpha"];
    let ran = campaign.run(&[&line[..], &["--between", "band-limited", "--out", "joint.json"]].concat());
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let number = |name: &str| -> f64 {
        let row = ran.stdout.lines().find(|line| line.trim_start().starts_with(&format!("{name} "))).expect(name);
        row.split_whitespace().nth(1).unwrap().parse().unwrap()
    };
    near(number("w"), 13.45, 0.02);
    near(number("z"), 0.05, 0.25);
}

/// Two carts and a spring, driven by a voltage; m, b, k and dry friction are in its units. Published, from steps: 2.49
/// and 3.09 Hz. Dry friction is in no linear model, but its sign is that of the measured speeds, and so it is an input.
#[test]
fn ref_flexible_drive_by_the_command_fit() {
    let runs = ["0_5", "1", "1_5", "2", "2_5", "3"];
    let campaign = Campaign::empty();
    for run in runs {
        let file = format!("flexible-drive/Project3_Lab3_360_Data_velocity_response_sine_{run}.mat");
        let Some(file) = reference(&file) else { return };
        assert_eq!(campaign.run(&["convert", file.to_str().unwrap(), "--out", &format!("{run}.csv")]).code, Some(0));
        let text = campaign.read(&format!("{run}.csv"));
        campaign.write(&format!("{run}.csv"), with_signs(&text, ["v1", "v2"]).as_bytes());
    }
    campaign.write(
        "drive.toml",
        b"[parameters]\nm1 = { value = 1e-3, min = 0 }\nm2 = { value = 1e-3, min = 0 }\nk = { value = 0.1, min = 0 }\n\
          b1 = { value = 0.01, min = 0 }\nb2 = { value = 0.01, min = 0 }\nd1 = { value = 0.1 }\nd2 = { value = 0.1 }\n\
          [matrices]\nA = [[\"-b1/m1\", 0, \"-k/m1\"], [0, \"-b2/m2\", \"k/m2\"], [1, -1, 0]]\n\
          B = [[\"1/m1\", \"-d1/m1\", 0], [0, 0, \"-d2/m2\"], [0, 0, 0]]\nC = [[1, 0, 0], [0, 1, 0]]\n\
          [derived]\ndip = \"sqrt(k/m2)/(2*pi)\"\npeak = \"sqrt(k*(1/m1 + 1/m2))/(2*pi)\"\n",
    );
    let files: Vec<String> = runs.iter().map(|run| format!("{run}.csv")).collect();
    let mut line = vec!["fit", "greybox", "drive.toml", "-u", "u", "-u", "sign of v1", "-u", "sign of v2"];
    line.extend(["-y", "v1", "-y", "v2"]);
    line.extend(files.iter().map(String::as_str));
    let ran = campaign.run(&line);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    for (name, published) in [("dip", 2.49), ("peak", 3.09)] {
        let row = ran.stdout.lines().find(|line| line.trim_start().starts_with(name)).expect(name);
        println!("{row}");
        near(row.split_whitespace().nth(1).unwrap().parse().unwrap(), published, 0.025);
    }
}

/// A table with a column more for each named one: its sign.
fn with_signs(text: &str, names: [&str; 2]) -> String {
    let mut lines = text.lines();
    let header = lines.next().unwrap();
    let columns: Vec<&str> = header.split(',').collect();
    let places = names.map(|name| columns.iter().position(|c| c.starts_with(name)).expect(name));
    let signs = lines.map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let [one, two] = places.map(|at| cells[at].parse::<f64>().unwrap());
        let sign = |v: f64| if v == 0.0 { 0.0 } else { v.signum() };
        format!("{line},{},{}\n", sign(one), sign(two))
    });
    format!("{header},sign of {},sign of {}\n{}", names[0], names[1], signs.collect::<String>())
}

/// Two servo motors, a step of the torque. Published: J = 1.2e-4 kg m² of the catalogue; own fits of others find 1.4e-4
/// to 1.6e-4 forwards, and twice that backwards, where friction is another.
#[test]
fn ref_servo_motors_by_the_command_fit() {
    for (run, is_forwards) in [("pos_0.06", true), ("pos_0.065", true), ("neg_0.04", false), ("neg_0.045", false)] {
        let Some(file) = reference(&format!("hsm150/idf_{run}_1.mat")) else { return };
        let campaign = Campaign::empty();
        let file = file.to_str().unwrap();
        let line = ["fit", "tf", file, "--sample-time", "0.001", "-u", "data(:,5)", "-y", "data(:,4)", "--poles", "1"];
        let line = [&line[..], &["--zeros", "0", "--from", "5"]].concat();
        let ran = campaign.run(&line);
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        let row = ran.stdout.lines().find(|line| line.trim_start().starts_with("b0 ")).unwrap();
        let numbers: Vec<f64> = row.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let [one_over_j, _, low, high] = numbers[..] else { panic!("{row}") };
        println!("{run}: J = {:.3e}, {:.3e} to {:.3e} kg m²", 1.0 / one_over_j, 1.0 / high, 1.0 / low);
        match is_forwards {
            true => assert!(low < 1.0 / 1.4e-4 && 1.0 / 1.6e-4 < high, "{row}"),
            false => assert!(1.0 / one_over_j > 1.7e-4, "{row}"),
        }
    }
}

/// A drive train in the laboratory after a step of its load. Published: peaks at 27.9 and 39.0 Hz, beside 2.78, 11.1
/// and 33.3 Hz, where the shafts turn. Both are multiples of 2.78 Hz too, 10 and 14; the published model's second mode,
/// 39.7 Hz, has ζ = 0.33 and makes no peak of its own. At 39.0 Hz the spectra rise less than chance can make them: it
/// is in no list of peaks.
#[test]
fn ref_drive_train_by_the_command_spectrum() {
    let Some(file) = reference("aalto-drivetrain/step_sensor.csv") else { return };
    let campaign = Campaign::empty();
    let text = std::fs::read_to_string(file).unwrap();
    campaign.write("step.csv", format!("t [s],n1 [rad/s],n2 [rad/s],T1 [Nm],T2 [Nm]\n{text}").as_bytes());
    for channel in ["T1", "T2", "n2"] {
        let spectrum = |window: &str| {
            run(&campaign, &["data", "spectrum", "step.csv", "-y", channel, "--method", "welch", "--window", window])
        };
        let coarse = spectrum("2048");
        let found: Vec<f64> =
            coarse[0]["peaks"].as_array().unwrap().iter().map(|p| p["frequency_hz"].as_f64().unwrap()).collect();
        for published in [27.9, 33.3] {
            assert!(found.iter().any(|f| (f - published).abs() < 0.3), "{channel}: {published}, {found:?}");
        }
        let fine = spectrum("4096");
        let numbers =
            |key: &str| fine[0][key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect::<Vec<_>>();
        let points: Vec<(f64, f64)> = numbers("frequency_hz").into_iter().zip(numbers("magnitude")).collect();
        let between = |from: f64, to: f64| points.iter().filter(move |(f, _)| (from..to).contains(f));
        let top = between(37.5, 40.5).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        let floor = between(37.0, 41.0).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        println!("{channel}: {} Hz, {:.1} dB above its surroundings", top.0, 10.0 * (top.1 / floor.1).log10());
        assert!((top.0 - 39.0).abs() < 0.3 && top.1 > 2.0 * floor.1, "{top:?}, {floor:?}");
    }
}
