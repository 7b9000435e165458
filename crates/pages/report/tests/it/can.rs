//! Pages of judged runs.

use cycle::{Checked, Omission, RequirementSet, Scales, Signal, Statistic, Validation, requirement};
use report::can::{AlignedOn, RecordedRun, Referred, ScalesOf, recorded};

/// The page of a run with this number, which may be at most so large, as words with single spaces.
fn page(set: &RequirementSet, value: f64, high: f64) -> String {
    let passes = value <= high;
    let checked = Checked {
        signal: Signal::Power,
        statistic: Statistic::Intercept,
        value,
        low: None,
        high: Some(high),
        passes,
        use_of_limit: value / high,
    };
    let validation = Validation {
        passes,
        shift_s: 0.0,
        omission: Omission::NONE,
        omitted: [0; 3],
        seconds: 1800,
        regressions: [None; 3],
        checked: vec![checked],
        tried: 1,
    };
    let scales = Scales {
        idle_rad_s: 80.0,
        maximum_test_speed_rad_s: 400.0,
        maximum_torque_nm: 200.0,
        maximum_power_w: 50.0 * high,
    };
    let sets = [(set.clone(), validation)];
    let run = RecordedRun {
        file: "run.mf4",
        test: "WHTC",
        start_s: 0.0,
        aligned_on: AlignedOn::Given,
        signals: (Some("engine speed".to_owned()), None),
        has_demand: true,
        sample_time_s: 0.1,
        referred: Referred { scales, of: ScalesOf::Map },
        remarks: &[],
        sets: &sets,
        own: &[],
        time_s: &[],
        speed_rad_s: None,
        torque_nm: None,
    };
    page::markdown(&recorded(&run)).split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn exact_a_number_differs_in_print_from_the_limit_that_it_misses() {
    let set = requirement("1065.514").unwrap();
    for (value, shown, limit) in [
        (1819.0, "1.819 kW", "at most 1.8 kW"),
        (1800.04, "1.80004 kW", "at most 1.8 kW"),
        (1799.96, "1.79996 kW", "at most 1.8 kW"),
    ] {
        let text = page(&set, value, 1800.0);
        assert!(text.contains(shown) && text.contains(limit), "{text}");
        assert_eq!(text.contains("FAIL"), value > 1800.0, "{text}");
    }
    let equal = page(&set, 1800.0, 1800.0);
    assert!(equal.contains("PASS") && equal.contains("| 1.8 kW |"), "{equal}");
}
