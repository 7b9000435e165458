//! `dynoid study --full`: one report of all analyses.

use std::sync::OnceLock;

use crate::support::{Campaign, dynoid, text, white_noise};

/// Figure or table of the thesis, the section that has its counterpart, and words of it. What needs no analysis is
/// looked for by the report's own tests.
const COUNTERPARTS: [(&str, &str, &str); 26] = [
    ("figure 3.3: the system’s shaft torque is late", "torque-signals", "moving average over 16 samples"),
    ("figure 4.2: binary sequence", "recorded", "BS_T_NT, recordings/BS_T_NT_1200.mf4"),
    ("figure 4.4: white noise", "recorded", "WhiteNoise_T_TN, recordings/WhiteNoise_T_TN_1200.mf4"),
    ("figure 4.5: step", "recorded", "Step_T_TN, recordings/Step_T_TN_1200.mf4"),
    ("figure 4.7: ramps", "recorded", "Ramp_N_NT, recordings/Ramp_N_NT_1200.mf4"),
    ("figure 4.10: sines", "recorded", "Sine_T_TN, recordings/Sine_T_TN_1200.mf4"),
    ("figure 5.1: firing in the shaft torque", "torque-signals", "BS_T_NT_3000.mf4: shaft torque rebuilt"),
    ("figures 5.2 to 5.5: spectra at 3000 rpm", "lines", "recordings/BS_T_NT_3000.mf4, 3000 rpm"),
    ("figure 6.1: torque signals at a step", "timing", "A step of T_d*, and what followed it"),
    ("figure 6.2: speed at a step", "timing", "recordings/Step_T_TN_1200.mf4"),
    ("figure 6.5: residuals of PI", "speed-control", "correlation of residual and T_d*"),
    ("figure 6.9: feed-forward over speed", "feed-forward", "static feed-forward over N_d*"),
    ("figure 6.12: poles and zeros", "torque-control", "poles and zeros of black boxes on T_d*"),
    ("figure 6.13: black boxes on white noise", "torque-control", "WhiteNoise_T_TN: T_d of models, from T_d* alone"),
    ("figure 6.14: black boxes on the binary sequence", "torque-control", "BS_T_NT: T_d of models, from T_d* alone"),
    ("figures 6.16, 6.17: the shaft by band", "shaft", "by band of frequencies"),
    ("§6.3.5.1: the shaft of a motored engine", "shaft", "Black box T_d → ω_d"),
    ("§6.3.5.3: the shaft in state space", "shaft", "State space (T_d, ω_e) → ω_d"),
    ("§4.8: friction", "friction", "Friction over speed"),
    ("table 7.1: what noise does to PI", "speed-control", "Table 7.1"),
    ("figures 7.1 to 7.3: PI on noise", "speed-control", "K_i over all draws: low-pass"),
    ("figure 7.4: speed control", "whole", "From N_d* to N_d"),
    ("figure 7.4: engine torque to speed", "whole", "From T_e to N_d"),
    ("figure 7.6: gains of sine tests", "whole", "Gain from T_d to T_shaft, sine by sine"),
    ("figure 7.7: replay in speed control", "replays", "Speed control (NT)"),
    ("figure 7.8: replay in torque control", "replays", "Torque control (TN)"),
];

/// The text of a section, symbols as in `T_d*`.
fn section(page: &str, id: &str) -> String {
    let from = page.split(&format!("<section id=\"{id}\">")).nth(1).unwrap_or_else(|| panic!("no section {id}"));
    text(from.split("</section>").next().unwrap_or_default())
}

#[test]
#[ignore = "slow"]
fn exact_every_figure_of_the_thesis_has_its_counterpart() {
    let folder = tempfile::tempdir().unwrap();
    dynoid(folder.path(), &["demo", "--quiet"]);
    let ran = dynoid(folder.path(), &["study", "dynoid-demo/bench.toml", "--full", "--quiet"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let page = std::fs::read_to_string(folder.path().join("dynoid-demo/study/report-full.html")).unwrap();
    for (figure, id, words) in COUNTERPARTS {
        assert!(section(&page, id).contains(words), "{figure}: `{words}` is not in section {id}");
    }
    assert!(section(&page, "shaft").contains("A comparison of whole recordings gives values"));
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
}

/// The full study of one recording.
pub(crate) fn white_noise_alone() -> &'static Campaign {
    static CAMPAIGN: OnceLock<Campaign> = OnceLock::new();
    CAMPAIGN.get_or_init(|| {
        let campaign = Campaign::empty().with("WhiteNoise_T_TN_1200.mf4", &white_noise());
        let ran = campaign.run(&["study", "bench.toml", "--full", "--quiet"]);
        assert!(matches!(ran.code, Some(0 | 1)), "{}", ran.stderr);
        campaign
    })
}

#[test]
fn regress_an_analysis_without_its_recording_costs_no_other() {
    let campaign = white_noise_alone();
    let page = campaign.read("study/report-full.html");
    for (id, words) in [
        ("known", "run NoShaft_N_NT"),
        ("timing", "run Step_T_TN"),
        ("friction", "there is no recording without shaft"),
        ("shaft", "Black box T_d → ω_d: not taken"),
        ("feed-forward", "Not estimated."),
        ("lines", "WhiteNoise_T_TN_1200.mf4"),
        ("torque-signals", "shaft torque rebuilt"),
        ("engine-torque", "T_e is known to"),
    ] {
        assert!(section(&page, id).contains(words), "`{words}` is not in section {id}:\n{}", section(&page, id));
    }
    campaign.run(&["study", "bench.toml", "--quiet"]);
    assert_eq!(campaign.read("study/report-full.html"), page, "a study without analyses leaves the full report alone");
    let quick = campaign.read("study/report.html");
    assert!(quick.len() < page.len() && !quick.contains("<section id=\"engine-torque\">"));
}
