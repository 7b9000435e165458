//! `dynoid inspect`.

use recording::Recording;

use crate::support::{Campaign, bs, channel};

/// A second of a recording.
fn short() -> Recording {
    let mut recording = bs();
    for channel in &mut recording.channels {
        let keep = recording.rasters[channel.raster].time_s.iter().filter(|time| **time < 1.0).count();
        channel.samples.truncate(keep);
    }
    for raster in &mut recording.rasters {
        raster.time_s.retain(|time| *time < 1.0);
    }
    recording
}

#[test]
fn snap_inspect() {
    let mut recording = short();
    channel(&mut recording, "DynoTorqueCalc").samples[10] = f64::NAN;
    let raster = channel(&mut recording, "EngineSpeed").raster;
    for time in &mut recording.rasters[raster].time_s[100..] {
        *time += 0.05;
    }
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &recording);
    let ran = campaign.run(&["inspect", "recordings/BS_T_NT_1200.mf4"]);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    insta::assert_snapshot!("inspect", ran.stdout);
}

#[test]
fn exact_json_holds_what_was_recorded() {
    let mut recording = short();
    channel(&mut recording, "DynoTorqueCalc").samples[10] = f64::NAN;
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &recording);
    let facts = campaign.run(&["inspect", "--json", "recordings"]).json();
    let file = &facts[0];
    assert_eq!((&file["format"], &file["label"]), (&"MDF 4.10".into(), &"BS_T_NT".into()));
    let fast = &file["rasters"][0];
    assert_eq!((&fast["samples"], &fast["gaps"]), (&1000.into(), &0.into()));
    assert!((fast["sample_time_s"].as_f64().unwrap() - 1e-3).abs() < 1e-9);
    let torque = &file["rasters"][2]["channels"][0];
    assert_eq!(
        (&torque["name"], &torque["unit"], &torque["not_a_number"]),
        (&"DynoTorqueCalc".into(), &"Nm".into(), &1.into())
    );
}

/// A raster whose stamps count 200 µs too much each second, told by the speed that is on both.
#[test]
fn regress_clocks_that_run_apart_are_said_with_what_to_do() {
    let rate = 2e-4;
    let mut recording = bs();
    let raster = channel(&mut recording, "EngineSpeed").raster;
    let (fast, speed) = {
        let speed = channel(&mut recording, "DynoSpeed");
        (speed.raster, speed.samples.clone())
    };
    let times_s = recording.rasters[fast].time_s.clone();
    let every_fourth = |values: &[f64]| values.iter().copied().step_by(4).collect::<Vec<_>>();
    recording.rasters[raster].time_s = every_fourth(&times_s);
    recording.channels.retain(|c| c.raster != raster || c.name == "EngineSpeed");
    channel(&mut recording, "EngineSpeed").samples = every_fourth(&speed);
    let campaign = Campaign::empty().with("together.mf4", &recording);
    let stamps = recording.rasters[raster].time_s.clone();
    if let [first, .., last] = &mut recording.rasters[raster].time_s[..] {
        (*first, *last) = (*first + 1e-3, *last - 1e-3);
    }
    let campaign = campaign.with("jittered.mf4", &recording);
    recording.rasters[raster].time_s = stamps.iter().map(|time| time * (1.0 + rate)).collect();
    let campaign = campaign.with("apart.mf4", &recording);
    for file in ["recordings/together.mf4", "recordings/jittered.mf4"] {
        let together = campaign.run(&["inspect", file]).stdout;
        assert!(!together.contains("runs apart"), "{together}");
    }
    let apart = campaign.run(&["inspect", "recordings/apart.mf4"]).stdout;
    for words in
        ["Its clock runs apart from that of raster", "EngineSpeed", "DynoSpeed", "ppm", "Synchronise the devices"]
    {
        assert!(apart.contains(words), "`{words}` is not in: {apart}");
    }
    let facts = campaign.run(&["inspect", "--json", "recordings/apart.mf4"]).json();
    let clocks = facts[0]["rasters"].as_array().unwrap();
    let found: Vec<_> = clocks.iter().filter_map(|clock| clock["runs_apart"]["rate"].as_f64()).collect();
    let [found] = found.as_slice() else { panic!("{found:?}") };
    assert!((found - rate).abs() < 0.05 * rate, "{found}");
}

#[test]
fn regress_a_clock_that_falls_is_said_to_go_back() {
    let mut recording = short();
    recording.rasters.iter_mut().for_each(|raster| raster.time_s.reverse());
    let campaign = Campaign::empty().with("back.mf4", &recording);
    let ran = campaign.run(&["inspect", "recordings/back.mf4"]);
    assert!(ran.stdout.contains("999 time stamps go back or repeat"), "{}", ran.stdout);
}

#[test]
fn regress_the_readable_files_are_shown_although_one_is_not() {
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &short());
    campaign.write("recordings/A.mf4", b"MDF     4.10    ");
    let ran = campaign.run(&["inspect", "recordings"]);
    assert_eq!(ran.code, Some(3));
    assert!(ran.stderr.contains("recordings/A.mf4"), "{}", ran.stderr);
    assert!(ran.stdout.contains("DynoSpeed"), "{}", ran.stdout);
}

#[test]
fn regress_nothing_to_inspect() {
    let campaign = Campaign::empty();
    campaign.run(&["inspect", "nowhere.mf4"]).assert_refused(3, &["nowhere.mf4", "no such file"]);
    campaign.run(&["inspect", "recordings"]).assert_refused(3, &["recordings", "this folder has no recordings"]);
}
