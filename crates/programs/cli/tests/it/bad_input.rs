//! Mistakes of users, and what the program says to them.

use recording::encode_mdf4;

use crate::support::{BENCH, Campaign, bs, channel};

const STUDY: [&str; 2] = ["study", "bench.toml"];

#[test]
fn regress_bench_files_that_cannot_be_read() {
    let campaign = Campaign::empty();
    campaign.run(&["study", "cell.toml"]).assert_refused(3, &["cell.toml", "no such file"]);
    campaign.run(&["study", "."]).assert_refused(3, &["folder", "did you mean", "bench.toml"]);
    campaign.run(&["study", "recordings"]).assert_refused(3, &["folder", "dynoid init"]);
    campaign.write("bench.toml", &[0xff, 0xfe, 0x00, b'x']);
    campaign.run(&STUDY).assert_refused(3, &["bench.toml", "UTF-8"]);
    campaign.write("bench.toml", b"[bench\n");
    campaign.run(&STUDY).assert_refused(3, &["bench.toml", "line 1", "TOML"]);
}

#[test]
fn regress_a_byte_order_mark_does_no_harm() {
    let campaign = Campaign::whole();
    campaign.write("bench.toml", format!("\u{feff}{BENCH}").as_bytes());
    campaign.run(&["study", "bench.toml", "--json"]).study();
}

#[test]
fn regress_no_recordings() {
    let campaign = Campaign::empty();
    campaign.run(&STUDY).assert_refused(3, &["bench.toml", "recordings/*.mf4", "matches no file in"]);
    campaign.write("bench.toml", BENCH.replace("files = [\"recordings/*.mf4\"]", "").as_bytes());
    campaign.run(&STUDY).assert_refused(3, &["bench.toml", "lists no recordings", "files ="]);
    campaign.write("bench.toml", BENCH.replace("recordings/*.mf4", "recordings").as_bytes());
    campaign.run(&STUDY).assert_refused(3, &["recordings", "this folder has no recordings"]);
    campaign.write("bench.toml", BENCH.replace("recordings/*.mf4", "rec***/x").as_bytes());
    campaign.run(&STUDY).assert_refused(3, &["rec***/x", "not a valid pattern"]);
    assert!(!campaign.path("study").exists(), "no folder for results that are not there");
}

#[test]
fn regress_an_inertia_in_the_wrong_unit() {
    let campaign = Campaign::whole();
    campaign.write("bench.toml", BENCH.replace("0.6 kg m²", "6000 kg m²").as_bytes());
    campaign.run(&STUDY).assert_refused(3, &["line 6", "dynamometer_inertia", "looks like kg cm²"]);
}

#[test]
fn regress_a_wrong_inertia_is_doubted() {
    let campaign = Campaign::whole();
    campaign.write("bench.toml", BENCH.replace("0.6 kg m²", "1.2 kg m²").as_bytes());
    let found = campaign.findings_about("WhiteNoise_T_TN_1200.mf4");
    assert!(found.contains("inertia J_d of 1.2 kg m²"), "{found}");
}

#[test]
fn regress_a_truncated_recording_is_left_out_and_named() {
    let campaign = Campaign::whole();
    let bytes = encode_mdf4(&bs()).unwrap();
    campaign.write("recordings/BS_T_NT_3000.mf4", &bytes[..bytes.len() / 2]);
    let found = campaign.findings_about("BS_T_NT_3000.mf4");
    assert!(found.starts_with("error"), "{found}");
}

#[test]
fn regress_a_missing_channel_is_named_with_the_closest() {
    let mut recording = bs();
    channel(&mut recording, "DynoTorqueCalc").name = "DynoTorqueCalculated".to_owned();
    let campaign = Campaign::whole().with("BS_T_NT_3000.mf4", &recording);
    let found = campaign.findings_about("BS_T_NT_3000.mf4");
    assert!(found.contains("DynoTorqueCalculated"), "{found}");
}

#[test]
fn regress_a_unit_that_does_not_fit_is_named() {
    let mut recording = bs();
    channel(&mut recording, "DynoTorqueCalc").unit = "rpm".to_owned();
    let campaign = Campaign::whole().with("BS_T_NT_3000.mf4", &recording);
    let found = campaign.findings_about("BS_T_NT_3000.mf4");
    assert!(found.contains("“rpm” does not fit"), "{found}");
}

#[test]
fn regress_samples_that_are_no_numbers_are_counted() {
    let mut recording = bs();
    channel(&mut recording, "DynoSpeed").samples[500] = f64::NAN;
    let campaign = Campaign::whole().with("BS_T_NT_1200.mf4", &recording);
    let found = campaign.findings_about("BS_T_NT_1200.mf4");
    assert!(found.contains("One sample is not a number"), "{found}");
}

#[test]
fn regress_a_gap_is_found() {
    let mut recording = bs();
    for raster in &mut recording.rasters {
        raster.time_s.iter_mut().filter(|time| **time >= 8.0).for_each(|time| *time += 3.0);
    }
    let campaign = Campaign::whole().with("BS_T_NT_1200.mf4", &recording);
    let found = campaign.findings_about("BS_T_NT_1200.mf4");
    assert!(found.contains("3 s") || found.contains("3.0"), "{found}");
}

#[test]
fn regress_a_command_on_one_part_warns_of_clipped_samples() {
    let mut recording = bs();
    channel(&mut recording, "DynoTorqueCalc").samples.iter_mut().for_each(|torque| *torque = torque.clamp(40.0, 50.0));
    let campaign = Campaign::whole().with("BS_T_NT_1200.mf4", &recording);
    let ran = campaign.run(&["controller", "bench.toml", "recordings/BS_T_NT_1200.mf4"]);
    assert!(ran.stderr.contains("warning") && ran.stderr.contains("extreme value"), "{}", ran.stderr);
}

#[test]
fn regress_a_torque_of_the_wrong_sign_is_noticed() {
    let mut recording = bs();
    for name in ["DynoTorqueCalc", "DynoTorqueMeas"] {
        channel(&mut recording, name).samples.iter_mut().for_each(|torque| *torque = -*torque);
    }
    let campaign = Campaign::whole().with("BS_T_NT_1200.mf4", &recording);
    let found = campaign.findings_about("BS_T_NT_1200.mf4");
    assert!(found.contains("negative sign"), "{found}");
}

#[test]
fn regress_two_recordings_of_one_name_are_kept_apart_and_twins_are_used_once() {
    let campaign = Campaign::whole();
    std::fs::create_dir(campaign.path("recordings/more")).unwrap();
    let campaign = campaign.with("more/BS_T_NT_1200.mf4", &bs());
    let both = r#"files = ["recordings/*.mf4", "recordings/more/*.mf4"]"#;
    campaign.write("bench.toml", BENCH.replace(r#"files = ["recordings/*.mf4"]"#, both).as_bytes());
    let found = campaign.findings_about("more/BS_T_NT_1200.mf4");
    assert!(found.contains("the same as recordings/BS_T_NT_1200.mf4"), "{found}");
}

#[test]
fn regress_a_recording_without_a_label_is_left_out_and_named() {
    let campaign = Campaign::whole().with("monday.mf4", &{
        let mut recording = bs();
        recording.comment = Some("another".to_owned());
        recording
    });
    let found = campaign.findings_about("monday.mf4");
    assert!(found.contains("which experiment this is"), "{found}");
}
