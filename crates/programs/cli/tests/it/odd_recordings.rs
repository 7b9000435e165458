//! Recordings with odd names, in odd places, and with odd stamps.

use crate::support::{BENCH, Campaign, bs};

#[cfg(unix)]
#[test]
fn regress_a_recording_whose_name_is_not_utf_8_is_read() {
    use std::os::unix::ffi::OsStrExt;
    let campaign = Campaign::empty();
    let name = std::ffi::OsStr::from_bytes(b"BS_T_NT_Pr\xfcfstand.mf4");
    std::fs::write(campaign.path("recordings").join(name), recording::encode_mdf4(&bs()).unwrap()).unwrap();
    let shown = "recordings/BS_T_NT_Pr\u{fffd}fstand.mf4";
    for files in ["recordings/*.mf4", "recordings", "**/BS*.mf4", shown] {
        let bench = BENCH.replace("recordings/*.mf4", files);
        campaign.write("bench.toml", bench.as_bytes());
        let study = campaign.run(&["study", "bench.toml", "--json"]).study();
        assert_eq!(study["recordings"][0]["file"], shown, "{files}");
    }
    let proposed = campaign.run(&["init", "recordings", "--out", "new.toml", "--json"]);
    assert_eq!(proposed.code, Some(0), "{}", proposed.stderr);
    let converted = campaign.run(&["convert", "recordings", "--to", "csv", "--out", "converted"]);
    assert_eq!(converted.code, Some(0), "{}", converted.stderr);
    let kept = std::ffi::OsStr::from_bytes(b"BS_T_NT_Pr\xfcfstand.csv");
    assert!(campaign.path("converted").join(kept).is_file());
}

#[cfg(unix)]
#[test]
fn regress_links_that_lead_back_end_the_search_for_recordings() {
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &bs());
    std::os::unix::fs::symlink("..", campaign.path("recordings/up")).unwrap();
    std::os::unix::fs::symlink(".", campaign.path("recordings/self")).unwrap();
    campaign.write("bench.toml", BENCH.replace("recordings/*.mf4", "recordings/**/*.mf4").as_bytes());
    let study = campaign.run(&["study", "bench.toml", "--json"]).study();
    assert_eq!(study["recordings"].as_array().map(Vec::len), Some(1));
}

/// As a logger that writes in batches stamps them: four samples at once every 4 ms.
#[test]
fn regress_stamps_in_bursts_are_refused_by_file_and_channel() {
    for step_s in [1e-10, 1e-6] {
        let mut recording = bs();
        for raster in &mut recording.rasters {
            let stamp = |(k, time_s): (usize, &mut f64)| *time_s = 0.004 * (k / 4) as f64 + step_s * (k % 4) as f64;
            raster.time_s.iter_mut().enumerate().for_each(stamp);
        }
        let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &recording);
        for command in ["study", "lines", "shaft", "controller", "torque-signals", "torque-control", "engine"] {
            let ran = campaign.run(&[command, "bench.toml"]);
            assert_eq!(ran.code, Some(3), "{command}: {}{}", ran.stdout, ran.stderr);
            for words in ["BS_T_NT_1200.mf4", "Speed", "bursts"] {
                assert!(ran.stderr.contains(words), "{command}: `{words}` is not in {}", ran.stderr);
            }
        }
    }
}
