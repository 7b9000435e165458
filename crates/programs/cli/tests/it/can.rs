//! `dynoid can`.

use std::fmt::Write as _;

use crate::support::{BENCH, Campaign};

const LIMITS: &str = "[limits]\ntorque = \"400 Nm\"\nshaft_torque = \"600 Nm\"\nspeed = \"7000 rpm\"\nshaft_torque_slew = \"90000 Nm/s\"\n\
    torque_slew = \"30000 Nm/s\"\ntime_at_resonance = \"600 s\"\npower = \"150 kW\"\nspeed_gradient = \"6000 rpm/s\"\n\
    [shaft]\nresonance = \"18 Hz\"\n";

pub(crate) const MAP: &str =
    "speed [rpm],torque [Nm]\n700,120\n1000,150\n1500,175\n2000,190\n3000,200\n4000,190\n5000,170\n5800,140\n6200,60\n";

pub(crate) const CAR: &str = "[vehicle]\nmass_kg = 1500\nrolling_resistance = 0.01\ndrag_area_m2 = 0.65\ntyre_radius_m = 0.31\n\
    axle_ratio = 3.9\n[gears]\nratios = [3.5, 2.0, 1.35, 1.0, 0.8]\nup_rpm = 2400\ndown_rpm = 1100\nidle_rpm = 800\n";

/// Speed, rpm, and torque, Nm, of a cycle of one's own at a second.
fn level(second: f64) -> (f64, f64) {
    // Above the resonance with the firing, which is at 540 rpm.
    let speed = 2000.0 + 700.0 * (0.21 * second).sin() + 300.0 * (0.7 * second).sin();
    (speed, 80.0 + 60.0 * (0.33 * second + 1.0).sin())
}

/// A bench, an engine map, and a cycle of a minute with its demands.
pub(crate) fn campaign() -> Campaign {
    let campaign = Campaign::empty();
    campaign.write("bench.toml", BENCH.replace("[channels]", &format!("{LIMITS}\n[channels]")).as_bytes());
    campaign.write("engine.csv", MAP.as_bytes());
    let (mut cycle, mut demands) = (String::from("time [s],speed [rpm],torque [Nm]\n"), String::new());
    demands.push_str("time [s],dyno_speed_demand [rpm],engine_torque_demand [Nm]\n");
    for second in 0..=60 {
        let (speed, torque) = level(f64::from(second));
        writeln!(cycle, "{second},{speed:.4},{torque:.4}").unwrap();
    }
    for tick in 0..=6000_i32 {
        let (low, share) = (f64::from(tick / 100), f64::from(tick % 100) / 100.0);
        let (from, to) = (level(low), level(low + 1.0));
        let (speed, torque) = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
        writeln!(demands, "{},{speed:.4},{torque:.4}", f64::from(tick) / 100.0).unwrap();
    }
    campaign.write("cycle.csv", cycle.as_bytes());
    campaign.write("demands.csv", demands.as_bytes());
    campaign
}

fn recorded() -> Campaign {
    let campaign = campaign();
    let ran = campaign.run(&["experiment", "simulate", "bench.toml", "demands.csv", "--out", "run.mf4"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    campaign
}

#[test]
fn exact_a_recorded_run_passes_by_every_line() {
    let campaign = recorded();
    let arguments = ["can", "bench.toml", "cycle.csv", "--recorded", "run.mf4", "--plot", "run.html"];
    let ran = campaign.run(&arguments);
    assert_eq!(ran.code, Some(0), "{}", ran.stdout);
    assert!(ran.stdout.contains("PASS") && ran.stdout.contains("moved forward by 0 s"), "{}", ran.stdout);
    assert!(campaign.read("run.html").contains("Demanded and measured"));
    let json = campaign.run(&[&arguments[..5], &["--json"]].concat()).json();
    let result = &json["requirements"][0]["result"];
    assert_eq!(json["passes"].as_bool(), Some(true));
    assert!(json["start_s"].as_f64().is_some_and(|start| start.abs() < 0.06), "{}", json["start_s"]);
    assert_eq!((result["seconds"].as_u64(), result["checked"].as_array().map(Vec::len)), (Some(61), Some(12)));
    assert_eq!(result["omission"]["motoring"].as_bool(), Some(false));
}

#[test]
fn exact_a_recorded_run_that_misses_a_line_names_it() {
    let campaign = recorded();
    // The same run judged as one of a cycle with half of the torque.
    let halved: String = campaign
        .read("cycle.csv")
        .lines()
        .enumerate()
        .map(|(row, line)| match line.rsplit_once(',') {
            Some((rest, torque)) if row > 0 => format!("{rest},{}\n", 0.5 * torque.parse::<f64>().unwrap()),
            _ => format!("{line}\n"),
        })
        .collect();
    campaign.write("half.csv", halved.as_bytes());
    let ran = campaign.run(&["can", "bench.toml", "half.csv", "--recorded", "run.mf4"]);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    assert!(ran.stdout.contains("FAIL by slope a_1 of the torque (1065.514)"), "{}", ran.stdout);
}

/// The run of [`level`] as an emission cell exports it: the speed of the engine and the torque of its flange, every
/// `raster_s`, as means with the firing ripple of three cylinders. A function may change the rows.
fn exported_run(raster_s: f64, change: impl Fn(f64, &mut f64, &mut f64)) -> String {
    let mut text = String::from("time [s],N_Engine [rpm],M_Flange [Nm]\n");
    let (fine, mut phase) = (20, 0.0_f64);
    for row in 0..=(60.0 / raster_s).round() as i32 {
        let time = f64::from(row) * raster_s;
        let (mut speed, mut torque) = (0.0, 0.0);
        for part in 0..fine {
            let at = (time + raster_s * (f64::from(part) / f64::from(fine) - 0.5)).clamp(0.0, 60.0);
            let (low, share) = (at.floor(), at.fract());
            let (from, to) = (level(low), level(low + 1.0));
            let straight = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
            phase += std::f64::consts::TAU * 1.5 * straight.0 / 60.0 * raster_s / f64::from(fine);
            speed += (straight.0 + 30_000.0 / straight.0 * phase.sin()) / f64::from(fine);
            torque += (straight.1 + 40.0 * phase.sin()) / f64::from(fine);
        }
        change(time, &mut speed, &mut torque);
        writeln!(text, "{time:.3},{speed:.4},{torque:.4}").unwrap();
    }
    text
}

/// Words that a command printed, without the ends of its lines.
fn words(printed: &str) -> String {
    printed.split_whitespace().collect::<Vec<_>>().join(" ")
}

const NEITHER: fn(f64, &mut f64, &mut f64) = |_, _, _| {};

/// A bench file with no number of the bench, and these channels.
fn judging(channels: &str) -> Campaign {
    let campaign = campaign();
    campaign.write("bench.toml", format!("[channels]\n{channels}").as_bytes());
    campaign
}

#[test]
fn exact_a_run_needs_only_the_channels_that_its_statistics_use() {
    for channels in [
        "engine_speed = \"N_Engine\"\nflange_torque = \"M_Flange\"\n",
        "dyno_speed = \"N_Engine\"\nload_cell_torque = \"M_Flange\"\n",
        "dyno_speed = \"N_Engine\"\nengine_speed = \"N_Engine\"\nflange_torque = \"M_Flange\"\ndyno_torque_demand = \"absent\"\n",
    ] {
        let campaign = judging(channels);
        for raster_s in [0.02, 0.1, 0.2, 1.0] {
            campaign.write("run.csv", exported_run(raster_s, NEITHER).as_bytes());
            let ran = campaign.run(&["can", "bench.toml", "cycle.csv", "--recorded", "run.csv"]);
            assert_eq!(ran.code, Some(0), "{raster_s} s: {}{}", ran.stdout, ran.stderr);
            let said = words(&ran.stdout);
            assert!(said.contains("PASS") && !said.contains("in ms"), "{said}");
            assert_eq!(said.contains("mean of data at 5 Hz or more"), raster_s > 0.2, "{said}");
        }
    }
    // A set of the speed alone takes no torque, and a missing speed is asked for by name.
    let campaign = judging("engine_speed = \"N_Engine\"\n");
    campaign.write("run.csv", exported_run(0.1, NEITHER).as_bytes());
    let ran = campaign.run(&["can", "bench.toml", "cycle.csv", "--recorded", "run.csv", "--by", "1036.545"]);
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
    let ran = campaign.run(&["can", "bench.toml", "cycle.csv", "--recorded", "run.csv"]);
    ran.assert_refused(3, &["run.csv", "flange_torque", "[channels]"]);
    let campaign = judging("flange_torque = \"M_Flange\"\n");
    campaign.write("run.csv", exported_run(0.1, NEITHER).as_bytes());
    let ran = campaign.run(&["can", "bench.toml", "cycle.csv", "--recorded", "run.csv"]);
    ran.assert_refused(3, &["run.csv", "engine_speed, dyno_speed", "[channels]"]);
}

#[test]
fn exact_what_is_left_out_of_a_run_is_named() {
    let campaign = judging("engine_speed = \"N_Engine\"\nflange_torque = \"M_Flange\"\n");
    let judge = || campaign.run(&["can", "bench.toml", "cycle.csv", "--recorded", "run.csv"]);
    campaign.write("run.csv", exported_run(0.02, NEITHER).as_bytes());
    assert!(!judge().stdout.contains("spike"), "the ripple of firing is no spike");
    let spike = |time: f64, speed: &mut f64, _: &mut f64| {
        if (time - 31.0).abs() < 1e-6 {
            *speed = 30_000.0;
        }
    };
    campaign.write("run.csv", exported_run(0.02, spike).as_bytes());
    let ran = judge();
    assert!(
        ran.code == Some(0) && words(&ran.stdout).contains("One sample is a spike"),
        "{}{}",
        ran.stdout,
        ran.stderr
    );
    // A gap of two seconds leaves a part of the run, and the refusal says which and why.
    let whole = exported_run(0.02, NEITHER);
    let is_kept = |line: &&str| {
        !line.split(',').next().and_then(|time| time.parse().ok()).is_some_and(|time: f64| (20.0..22.0).contains(&time))
    };
    campaign
        .write("run.csv", whole.lines().filter(is_kept).map(|line| format!("{line}\n")).collect::<String>().as_bytes());
    judge().assert_refused(3, &["the feedback covers", "gap", "2", "only the stretch from 22"]);
}

#[test]
fn exact_what_limits_refer_to_is_stated() {
    let campaign = judging("engine_speed = \"N_Engine\"\nflange_torque = \"M_Flange\"\n");
    campaign.write("run.csv", exported_run(0.1, NEITHER).as_bytes());
    let judge = |more: &[&str]| {
        let ran = campaign.run(&[&["can", "bench.toml", "cycle.csv", "--recorded", "run.csv"], more].concat());
        words(&ran.stdout)
    };
    let (own, map) = (judge(&[]), judge(&["--engine-map", "engine.csv"]));
    assert!(own.contains("Without an engine map these are the lowest speed and the largest values"), "{own}");
    assert!(map.contains("700 rpm at warm idle") && map.contains("the lowest one of the engine map"), "{map}");
    let stated = judge(&["--idle", "650"]);
    assert!(stated.contains("650 rpm at warm idle"), "{stated}");
    let json = campaign.run(&["can", "bench.toml", "cycle.csv", "--recorded", "run.csv", "--json"]).json();
    assert_eq!(json["limits_refer_to"]["of"].as_str(), Some("cycle"));
}

/// An experiment has no map either, and its limits refer to the idle speed that is stated.
#[test]
fn regress_a_stated_idle_speed_counts_for_an_experiment_too() {
    let campaign = campaign();
    let simulate = ["experiment", "simulate", "bench.toml", "BS_T_NT", "--set", "duration=21", "--out", "bs.mf4"];
    assert_eq!(campaign.run(&simulate).code, Some(0));
    let judge = ["can", "bench.toml", "BS_T_NT", "--set", "duration=20", "--recorded", "bs.mf4", "--by", "1065.514"];
    let judged = |more: &[&str]| words(&campaign.run(&[&judge[..], more].concat()).stdout);
    assert!(judged(&[]).contains("or state the idle speed with --idle"), "{}", judged(&[]));
    let stated = judged(&["--idle", "650"]);
    assert!(stated.contains("650 rpm at warm idle") && !stated.contains("state the idle speed"), "{stated}");
}

#[test]
fn exact_requirements_of_ones_own_judge_a_recording() {
    let campaign = recorded();
    let judge = |require: &str| {
        let arguments = ["can", "bench.toml", "cycle.csv", "--recorded", "run.mf4", "--require", require, "--quiet"];
        campaign.run(&arguments).code
    };
    assert_eq!(judge("speed within 300 rpm for 100 %"), Some(0));
    assert_eq!(judge("speed within 0.1 rpm for 95 %"), Some(1));
}

#[test]
fn regress_a_recording_that_is_too_short_is_refused() {
    let campaign = recorded();
    let arguments = ["can", "bench.toml", "whtc", "--engine-map", "engine.csv", "--recorded", "run.mf4"];
    campaign.run(&arguments).assert_refused(3, &["run.mf4", "covers", "1800"]);
}

/// The per cent that a text begins with.
fn percent(text: &str) -> u32 {
    text.split(' ').next().and_then(|number| number.parse().ok()).unwrap_or_default()
}

#[test]
fn exact_a_cycle_is_predicted_with_its_requirements() {
    let campaign = campaign();
    let arguments = ["can", "bench.toml", "cycle.csv", "--engine-map", "engine.csv", "--samples", "72"];
    let ran = campaign.run(&[&arguments[..], &["--plot", "can.html"]].concat());
    assert_eq!(ran.code, Some(0), "{}", ran.stdout);
    // An engine that gives a torque off by some per cent misses a statistic now and then.
    let share = ran.stdout.strip_prefix("cycle.csv, 60 s: yes, ").map(percent);
    assert!(share.is_some_and(|share| share >= 90), "{}", ran.stdout);
    assert!(campaign.read("can.html").contains("Can this bench run this test?"));
    let json = campaign.run(&[&arguments[..], &["--json"]].concat()).json();
    assert_eq!((json["answer"].as_str(), json["samples"].as_u64()), (Some("yes"), Some(72)));
    assert_eq!(json["limits"].as_array().map(Vec::len), Some(8));
}

#[test]
fn exact_a_limit_gives_a_no_with_a_way_out_and_unstated_limits_are_named() {
    let campaign = campaign();
    let bench =
        campaign.read("bench.toml").replace("speed_gradient = \"6000 rpm/s\"", "speed_gradient = \"1500 rpm/s\"");
    campaign.write("bench.toml", bench.replace("power = \"150 kW\"\n", "").as_bytes());
    let ran = campaign.run(&["can", "bench.toml", "gear-shift", "--samples", "72", "--set", "torque=20"]);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    for words in [
        "no: speed gradient at",
        "reached on 100 % of benches",
        "Yes if: the whole test",
        "no limit of power",
        "(`power`)",
        "--allow-unchecked",
    ] {
        assert!(ran.stdout.contains(words), "`{words}` is not in {}", ran.stdout);
    }
    // A yes with limits that are not stated says so, and is no 0, unless it is asked for.
    let tip_in = |more: &[&str]| campaign.run(&[&["can", "bench.toml", "tip-in", "--samples", "72"], more].concat());
    let (asked, allowed) = (tip_in(&[]), tip_in(&["--allow-unchecked"]));
    assert_eq!((asked.code, allowed.code), (Some(1), Some(0)));
    assert!(asked.stdout.contains("yes for 7 of 8 limits, 100 %"), "{}", asked.stdout);
}

#[test]
fn exact_a_no_of_several_limits_names_the_first_and_counts_the_others() {
    let campaign = campaign();
    let bench = campaign
        .read("bench.toml")
        .replace("torque_slew = \"30000 Nm/s\"", "torque_slew = \"100 Nm/s\"")
        .replace("power = \"150 kW\"", "power = \"9 kW\"")
        .replace("speed_gradient = \"6000 rpm/s\"", "speed_gradient = \"100 rpm/s\"");
    campaign.write("bench.toml", bench.as_bytes());
    let ran = campaign.run(&["can", "bench.toml", "cycle.csv", "--engine-map", "engine.csv", "--samples", "72"]);
    let title = ran.stdout.lines().take(2).collect::<Vec<_>>().join(" ");
    assert!(title.contains("reached on 100 % of benches like yours; 2 others fail, too (tables)"), "{title}");
    // The statistics are met, and the line says that they are not all.
    let met = ran.stdout.lines().skip_while(|line| !line.contains("of the benches meet these statistics")).take(3);
    let met = met.collect::<Vec<_>>().join(" ");
    assert!(percent(&met) >= 90 && met.contains("also contains the limits of the bench"), "{met}");
    assert!(!ran.stdout.contains("All of it together"), "{}", ran.stdout);
}

#[test]
fn exact_without_limits_a_shape_is_not_judged() {
    let campaign = campaign();
    campaign.write("bench.toml", BENCH.replace("[channels]", "[shaft]\nresonance = \"18 Hz\"\n[channels]").as_bytes());
    let tip_in = |more: &[&str]| campaign.run(&[&["can", "bench.toml", "tip-in", "--samples", "72"], more].concat());
    let asked = tip_in(&[]);
    assert_eq!(asked.code, Some(1));
    for words in ["not judged: no limit is stated", "(`shaft_torque`)", "[limits]", "--allow-unchecked"] {
        assert!(asked.stdout.contains(words), "`{words}` is not in {}", asked.stdout);
    }
    assert!(!asked.stdout.contains("yes"), "{}", asked.stdout);
    let json = tip_in(&["--json"]).json();
    assert_eq!((json["answer"].as_str(), tip_in(&["--allow-unchecked"]).code), (Some("not_judged"), Some(0)));
    let required = tip_in(&["--require", "speed within 500 rpm for 95 %"]);
    assert!(required.stdout.contains("yes by the requirements alone"), "{}", required.stdout);
    tip_in(&["--recorded", "run.mf4"]).assert_refused(2, &["nothing to judge", "--by", "--require"]);
    campaign.run(&["can", "bench.toml", "tip-in", "--samples", "71"]).assert_refused(2, &["72"]);
    tip_in(&["--seed", "99999999999999999999"]).assert_refused(2, &["from 0 to 18446744073709551615"]);
}

#[test]
fn exact_the_requirements_of_the_documentation_work() {
    let campaign = campaign();
    let documentation = include_str!("../../../../../docs/src/can.md");
    let requirements = documentation.lines().filter_map(|line| line.strip_prefix("--require \"")?.strip_suffix('"'));
    let requirements: Vec<&str> = requirements.collect();
    assert!(requirements.iter().any(|one| one.contains("phase at") && one.ends_with("deg")), "{requirements:?}");
    for requirement in requirements {
        // A test that shows it.
        let test = match requirement.split(' ').take(2).collect::<Vec<_>>()[..] {
            ["speed", "overshoot"] => "speed-step",
            ["torque", "rise" | "settling"] => "torque-step",
            _ => "sine-sweep",
        };
        let ran = campaign.run(&["can", "bench.toml", test, "--samples", "72", "--json", "--require", requirement]);
        assert_eq!(ran.json()["own"].as_array().map(Vec::len), Some(1), "{requirement}: {}", ran.stderr);
    }
}

#[test]
fn regress_what_a_test_does_not_show_and_what_no_engine_does_is_refused() {
    let campaign = campaign();
    let can =
        |test: &str, more: &[&str]| campaign.run(&[&["can", "bench.toml", test, "--samples", "72"], more].concat());
    for (test, requirement) in [
        ("tip-in", "speed overshoot below 5 %"),
        ("tip-in", "torque phase at 5 Hz below 60 deg"),
        ("coast-down", "torque rise below 1 ms"),
    ] {
        let ran = can(test, &["--require", requirement]);
        assert!(ran.code != Some(0) && ran.stderr.contains("its demand"), "{test}, {requirement}: {}", ran.stderr);
    }
    for requirement in ["speed within -5 rpm for 95 %", "speed within 10 rpm for 0 %", "torque rise below 0 ms"] {
        can("speed-step", &["--require", requirement]).assert_refused(2, &["is no requirement", "above 0"]);
    }
    let backwards = can("tip-in", &["--speed", "-1500"]);
    assert!(backwards.code != Some(0) && backwards.stderr.contains("turns forwards"), "{}", backwards.stderr);
    let check = campaign.run(&["experiment", "check", "bench.toml", "BS_T_NT", "--speed", "-1500", "--samples", "72"]);
    assert!(check.code != Some(0) && check.stderr.contains("turns forwards"), "{}", check.stderr);
    campaign.run(&["can", "bench.toml", "map", "--speed", "-1500"]).assert_refused(2, &["turns forwards"]);
}

#[test]
fn regress_a_torque_beyond_the_map_is_the_engine_s() {
    let campaign = campaign();
    let rows = [(0, 2000, 50), (1, 2000, 50), (2, 2000, 320), (3, 2000, 50), (4, 2000, 50)];
    let table: String = rows.iter().map(|(time, speed, torque)| format!("{time},{speed},{torque}\n")).collect();
    campaign.write("beyond.csv", format!("time [s],speed [rpm],torque [Nm]\n{table}").as_bytes());
    let arguments = ["can", "bench.toml", "beyond.csv", "--engine-map", "engine.csv", "--samples", "72"];
    let ran = campaign.run(&arguments);
    assert_eq!(ran.code, Some(1), "{}", ran.stderr);
    let title = ran.stdout.lines().take(2).collect::<Vec<_>>().join(" ");
    assert!(title.contains("the engine gives 190 Nm at 2000 rpm, and the test asks it for 320 Nm"), "{title}");
    let json = campaign.run(&[&arguments[..], &["--json"]].concat()).json();
    assert_eq!(json["beyond"][0]["numbers"]["of"].as_str(), Some("engine_torque"), "{json}");
    assert_eq!(json["friction"]["from"].as_str(), Some("assumed"));
}

#[test]
#[ignore = "slow: half an hour of a cycle on 72 benches; every_command.rs has the first minute"]
fn exact_the_command_of_the_readme_runs() {
    let campaign = campaign();
    let readme = include_str!("../../../../../README.md");
    let command = readme.split('`').find(|text| text.starts_with("dynoid can bench.toml")).unwrap();
    let arguments: Vec<&str> = command.split(' ').skip(1).collect();
    let ran = campaign.run(&[&arguments[..], &["--samples", "72"]].concat());
    assert!(ran.code.is_some_and(|code| code <= 1) && ran.stdout.contains("WHTC"), "{command}: {}", ran.stderr);
}

/// T_d at 4 ms and T_d* at 1 ms, or at 4 ms as well: the phase of the recording is that of the model.
#[test]
fn exact_the_phase_of_a_recording_does_not_depend_on_its_rasters() {
    let campaign = campaign();
    let mut demands = String::from("time [s],engine_speed_demand [rpm],dyno_torque_demand [Nm]\n");
    for tick in 0..=2000 {
        let time = f64::from(tick) * 0.01;
        let torque = 60.0 + 15.0 * (std::f64::consts::TAU * (5.0 * time + 0.25 * time * time)).sin();
        writeln!(demands, "{time},2500,{torque:.6}").unwrap();
    }
    campaign.write("sweep.csv", demands.as_bytes());
    let phase = |arguments: &[&str], of: &str| {
        let can = [
            "can",
            "bench.toml",
            "sweep.csv",
            "--samples",
            "72",
            "--json",
            "--require",
            "torque phase at 12 Hz below 90 deg",
        ];
        let ran = campaign.run(&[&can[..], arguments].concat());
        ran.json()["own"][0][of].as_f64().unwrap_or_else(|| panic!("{}", ran.stderr)).to_degrees()
    };
    let expected = phase(&[], "median");
    let bench = campaign.read("bench.toml");
    let simulate = ["experiment", "simulate", "bench.toml", "sweep.csv", "--overwrite", "--out", "sweep.mf4"];
    for (decimation, demand_ms) in [(1, 1.0), (4, 1.0)] {
        let clocks = format!("{bench}\n[virtual_bench.clocks]\ntorque_decimation = {decimation}\n");
        campaign.write("bench.toml", clocks.as_bytes());
        assert_eq!(campaign.run(&simulate).code, Some(0));
        let found = phase(&["--recorded", "sweep.mf4"], "value");
        assert!((found - expected).abs() < 1.0, "T_d every {decimation} ms: {found}, {expected}");
        let open = phase(&["--recorded", "sweep.mf4"], "uncertain_by");
        let raster = 0.5 * 360.0 * 12.0 * demand_ms * 1e-3;
        assert!((raster - 1e-6..raster + 1.0).contains(&open), "{open}, of the raster {raster}");
    }
}

#[test]
fn exact_the_map_names_what_binds() {
    let campaign = campaign();
    let ran = campaign.run(&["can", "bench.toml", "map", "--samples", "72", "--json"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let json = ran.json();
    assert_eq!(json["maps"].as_array().map(Vec::len), Some(2));
    assert_eq!(json["maps"][1]["of"].as_str(), Some("torque"));
    assert!(json["maps"][0]["places"][0][4]["binds"].is_string() && json["gradients"][0]["up_rad_s2"][0].is_number());
    assert!(json["maps"][0]["bandwidths"]["three_db_hz"][1].is_number());
    let ran = campaign.run(&["can", "bench.toml", "map", "--samples", "72", "--set", "to=3"]);
    ran.assert_refused(2, &["--set to=3", "torque"]);
}

#[test]
fn regress_a_map_without_limits_says_so_and_gives_no_yes() {
    let campaign = campaign();
    campaign.write("bench.toml", BENCH.replace("[channels]", "[shaft]\nresonance = \"18 Hz\"\n[channels]").as_bytes());
    let map = ["can", "bench.toml", "map", "--samples", "72", "--want", "20 rpm at 2 Hz"];
    let (asked, allowed) = (campaign.run(&map), campaign.run(&[&map[..], &["--allow-unchecked"]].concat()));
    assert_eq!((asked.code, allowed.code), (Some(1), Some(0)), "{}", asked.stderr);
    assert!(asked.stderr.contains("shaft_torque") && asked.stderr.contains("[limits]"), "{}", asked.stderr);
}

#[test]
fn exact_a_wanted_sine_and_gradient_are_answered() {
    let campaign = campaign();
    let map = ["can", "bench.toml", "map", "--samples", "72"];
    let ran = campaign.run(&[&map[..], &["--want", "20 rpm at 2 Hz", "--plot", "map.html"]].concat());
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stdout.contains("sine of the speed demand, 20 rpm at 2 Hz: yes"), "{}", ran.stdout);
    assert!(campaign.read("map.html").contains("wanted, yes"));
    let ran = campaign.run(&[&map[..], &["--want", "90000 rpm/s", "--json"]].concat());
    let place = &ran.json()["wanted"][0]["places"][0];
    assert_eq!((ran.code, place["kept"]["count"].as_u64()), (Some(1), Some(0)));
    assert!(place["binds"].is_string());
    campaign.run(&[&map[..], &["--want", "much"]].concat()).assert_refused(2, &["--want", "`much`", "rpm/s"]);
    campaign.run(&["can", "bench.toml", "tip-in", "--want", "4000 rpm/s"]).assert_refused(2, &["--want", "map"]);
}

#[test]
fn exact_a_cycle_of_ones_own_may_have_awkward_input() {
    let campaign = campaign();
    let can = |file: &str, more: &[&str]| {
        let arguments = ["can", "bench.toml", file, "--samples", "72", "--allow-unchecked"];
        campaign.run(&[&arguments[..], more].concat())
    };
    let median = |json: &serde_json::Value, of: &str| {
        let limits = json["limits"].as_array().unwrap();
        limits.iter().find(|one| one["of"] == of).unwrap()["median"].as_f64().unwrap()
    };
    // A peak between the seconds, at 10 Hz, counts.
    let mut fast = String::from("time [s],speed [rpm],torque [Nm]\n");
    for tick in 0..=200 {
        let peak = 300.0 - 100.0 * f64::from(tick - 105_i32).abs().min(3.0);
        writeln!(fast, "{},{},60", f64::from(tick) * 0.1, 2000.0 + peak).unwrap();
    }
    campaign.write("fast.csv", fast.as_bytes());
    let ran = can("fast.csv", &["--json", "--by", "1036.545"]);
    let json = ran.json();
    assert_eq!((json["duration_s"].as_f64(), ran.stderr.contains("gap")), (Some(20.0), false), "{}", ran.stderr);
    assert!(median(&json, "speed") > 2200.0, "{}", median(&json, "speed"));
    // German numbers and names, torque in % of the full load, motoring marked, and a gap.
    let mut german = String::from("Zeit [s];Drehzahl [1/min];Drehmoment [%]\n");
    for second in (0..=40).filter(|second| !(20..25).contains(second)) {
        let torque = if second > 30 { "m".to_owned() } else { "50,5".to_owned() };
        writeln!(german, "{second},0;2000,0;{torque}").unwrap();
    }
    campaign.write("german.csv", german.as_bytes());
    let ran = can("german.csv", &["--engine-map", "engine.csv", "--json", "--require", "torque within 30 Nm for 95 %"]);
    assert!(ran.stderr.contains("a gap of 6 s after row 20"), "{}", ran.stderr);
    // 50.5 % of 190 Nm, and then −40 % of it.
    let own = &ran.json()["own"][0];
    assert!(own["median"].as_f64().is_some_and(|error| error < 30.0), "{own}");
    assert!(ran.json()["duration_s"].as_f64() == Some(40.0));
    can("german.csv", &[]).assert_refused(3, &["german.csv", "--engine-map"]);
    campaign.write("hole.csv", b"time [s],speed [rpm],torque [Nm]\n0,1000,5\n1,1100,\n2,1200,5\n3,1200,5\n");
    can("hole.csv", &[]).assert_refused(3, &["hole.csv", "line 3", "`torque`", "missing", "write m"]);
    campaign.write("hole.csv", b"# a cycle\n\ntime [s],speed [rpm],torque [Nm]\n0,1000,5\n1,,5\n2,1200,5\n3,1200,5\n");
    can("hole.csv", &[]).assert_refused(3, &["hole.csv", "line 5", "`speed`", "fill it in"]);
    campaign.write("hole.csv", b"speed [rpm],torque [Nm]\n700,120\n1000,\n1500,175\n");
    can("german.csv", &["--engine-map", "hole.csv"])
        .assert_refused(3, &["hole.csv", "line 3", "`torque`", "delete the row"]);
}

#[test]
fn exact_phase_amplitude_and_heat_of_the_drive_are_judged() {
    let campaign = campaign();
    let heat =
        "power = \"150 kW\"\ncontinuous_torque = \"70 Nm\"\noverload_torque = \"140 Nm\"\noverload_time = \"4 s\"\n";
    campaign.write("bench.toml", campaign.read("bench.toml").replace("power = \"150 kW\"\n", heat).as_bytes());
    let arguments = ["can", "bench.toml", "sine-sweep", "--samples", "72", "--allow-unchecked", "--set", "torque=80"];
    let wanted =
        ["--require", "torque phase at 5 Hz below 60 deg", "--require", "shaft_torque amplitude at 5 Hz below 1 Nm"];
    let ran = campaign.run(&[&arguments[..], &wanted].concat());
    for words in
        ["heat of the drive, I²t", "phase at 5 Hz below 60°", "amplitude of the shaft torque at 5 Hz below 1 Nm"]
    {
        assert!(ran.stdout.contains(words), "`{words}` is not in {}", ran.stdout);
    }
    let json = campaign.run(&[&arguments[..], &wanted, &["--json"]].concat()).json();
    let heat = json["limits"].as_array().unwrap().iter().find(|one| one["of"] == "drive_heat").unwrap().clone();
    // (80/70)² = 131 %, from the start on.
    assert!(heat["median"].as_f64().is_some_and(|value| (value - 131.0).abs() < 3.0), "{heat}");
    assert_eq!((heat["limit"].as_f64(), heat["reached"]["count"].as_u64()), (Some(100.0), Some(72)));
    assert_eq!(json["own"][0]["kept"]["count"].as_u64(), Some(72));
    assert!(json["own"][1]["margin"].as_f64().is_some_and(|margin| margin < 0.0), "{}", json["own"][1]);
    let absent = ["--require", "speed phase at 5 Hz below 60 deg"];
    campaign.run(&[&arguments[..], &absent].concat()).assert_refused(3, &["speed phase", "no part at 5 Hz"]);
}

#[test]
fn exact_a_vehicle_runs_its_schedule() {
    let campaign = campaign();
    campaign.write("car.toml", CAR.as_bytes());
    let ran = campaign.run(&["can", "bench.toml", "udds", "--vehicle", "car.toml", "--samples", "72", "--json"]);
    assert!(matches!(ran.code, Some(0 | 1)), "{}", ran.stderr);
    let json = ran.json();
    assert_eq!(
        (json["duration_s"].as_f64(), json["requirements"][0]["name"].as_str()),
        (Some(1369.0), Some("1036.545"))
    );
    campaign.run(&["can", "bench.toml", "udds"]).assert_refused(2, &["--vehicle"]);
}

#[test]
fn regress_wrong_names_and_missing_files_have_a_remedy() {
    let campaign = campaign();
    let run = |arguments: &[&str]| campaign.run(&[&["can", "bench.toml"], arguments].concat());
    run(&["whtk"]).assert_refused(2, &["`whtk`", "`whtc`"]);
    run(&["whtc"]).assert_refused(2, &["whtc", "--engine-map"]);
    run(&["whtc", "--engine-map", "engine.csv", "--by", "86"]).assert_refused(2, &["`86`", "1065.514"]);
    run(&["tip-in", "--require", "speed nice"]).assert_refused(2, &["`speed nice`", "within"]);
    run(&["tip-in", "--set", "height=3"]).assert_refused(2, &["height"]);
    campaign.write("bad.csv", b"speed [rpm],torque [Nm]\n1000,10\n900,10\n1100,10\n");
    run(&["whtc", "--engine-map", "bad.csv"]).assert_refused(3, &["bad.csv", "row 2", "sort"]);
    campaign.write("units.csv", b"speed [m],torque [Nm]\n1000,10\n1100,10\n1200,10\n");
    run(&["whtc", "--engine-map", "units.csv"]).assert_refused(3, &["units.csv", "`speed`"]);
}
