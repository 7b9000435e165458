use cycle::{Feedback, Omission, Reference, Signal, Statistic, builtin, requirement, validate};

use crate::support::map;

/// The WHTC as a bench runs it: late by `delay_s`, with a gain of the torque.
fn run(delay_s: f64, gain: f64) -> (Reference, Feedback) {
    let reference = builtin("whtc").unwrap().reference(&map()).unwrap();
    let time = |k: usize| k as f64 * 0.1 - delay_s;
    let samples = 18_021;
    let feedback = Feedback {
        start_s: 0.0,
        sample_time_s: 0.1,
        speed_rad_s: (0..samples).map(|k| reference.speed_at(time(k))).collect(),
        torque_nm: (0..samples).map(|k| gain * reference.torque_at(time(k))).collect(),
        demand: None,
    };
    (reference, feedback)
}

#[test]
fn exact_a_run_on_time_passes_without_shift_or_omission() {
    let (reference, feedback) = run(0.0, 1.0);
    let found = validate(&reference, &feedback, &requirement("1065.514").unwrap()).unwrap();
    assert!(found.passes);
    assert_eq!((found.shift_s, found.omission, found.omitted, found.seconds), (0.0, Omission::NONE, [0; 3], 1800));
    assert_eq!(found.checked.len(), 12);
}

#[test]
fn exact_a_late_run_is_moved_forward() {
    let (reference, feedback) = run(1.0, 1.0);
    let mut set = requirement("1065.514").unwrap();
    // Limits that only a run on time keeps.
    set.torque = set.torque.map(|torque| cycle::Criterion { determination: 0.985, ..torque });
    let found = validate(&reference, &feedback, &set).unwrap();
    assert!(found.passes && found.shift_s > 0.4, "{found:?}");
    set.shift_s = 0.0;
    set.omission = false;
    let late = validate(&reference, &feedback, &set).unwrap();
    assert!(!late.passes);
    assert_eq!(late.tried, 1);
}

#[test]
fn exact_a_torque_that_is_too_small_fails_by_its_slope() {
    let (reference, feedback) = run(0.0, 0.8);
    let found = validate(&reference, &feedback, &requirement("1065.514").unwrap()).unwrap();
    assert!(!found.passes);
    let failed: Vec<_> =
        found.checked.iter().filter(|one| !one.passes).map(|one| (one.signal, one.statistic)).collect();
    assert_eq!(failed, [(Signal::Torque, Statistic::Slope), (Signal::Power, Statistic::Slope)]);
    assert_eq!(found.tried, 36 * 11);
}

#[test]
fn exact_slopes_are_rounded_to_the_decimals_of_their_limits() {
    // A shift or an omission may make a slope smaller.
    let of = |name: &str| cycle::RequirementSet { shift_s: 0.0, omission: false, ..requirement(name).unwrap() };
    let passes = |name: &str, gain: f64| {
        let (reference, feedback) = run(0.0, gain);
        let found = validate(&reference, &feedback, &of(name)).unwrap();
        let slope = found.checked.iter().find(|one| one.signal == Signal::Torque).unwrap();
        assert_eq!(slope.statistic, Statistic::Slope);
        (slope.value, slope.passes)
    };
    assert_eq!(passes("1065.514", 1.0304), (1.03, true));
    assert_eq!(passes("1065.514", 1.0306), (1.031, false));
    // No text of the other regulations was seen that rounds.
    let found = passes("nrtc", 1.0304);
    assert!((found.0 - 1.0304).abs() < 1e-4 && !found.1, "{found:?}");
}

/// A limit in per cent is exact, and what it limits is not rounded: 40 CFR 1090.50(c).
#[test]
fn exact_limits_in_per_cent_are_exact() {
    let set = cycle::RequirementSet { shift_s: 0.0, omission: false, ..requirement("1065.514").unwrap() };
    // 2 % of the largest torque is 22 Nm.
    let passes = |offset_nm: f64| {
        let (reference, mut feedback) = run(0.0, 1.0);
        feedback.torque_nm.iter_mut().for_each(|torque| *torque += offset_nm);
        let found = validate(&reference, &feedback, &set).unwrap();
        let is_it = |one: &&cycle::Checked| (one.signal, one.statistic) == (Signal::Torque, Statistic::Intercept);
        let checked = *found.checked.iter().find(is_it).unwrap();
        assert!((checked.value - offset_nm).abs() < 0.05 && checked.high == Some(22.0), "{checked:?}");
        checked.passes
    };
    assert!(passes(21.9));
    // This is 2.01 %, which is 2.0 % to one decimal.
    assert!(!passes(22.11));
}

/// A filter of the feedback acts on the statistics and on the work alike: 40 CFR 1065.514 asks for that.
#[test]
fn exact_the_work_is_that_of_the_feedback_that_is_compared() {
    let set = cycle::RequirementSet { shift_s: 0.0, omission: false, ..requirement("nrtc").unwrap() };
    let (reference, feedback) = run(0.0, 1.0);
    let of = |feedback: &Feedback| {
        let found = validate(&reference, feedback, &set).unwrap();
        let value = |signal: Signal, statistic: Statistic| {
            found.checked.iter().find(|one| (one.signal, one.statistic) == (signal, statistic)).unwrap().value
        };
        (value(Signal::Torque, Statistic::Determination), value(Signal::Power, Statistic::Work))
    };
    let means = |values: &[f64]| -> Vec<f64> {
        let mean = |k: usize| {
            let around = &values[k.saturating_sub(50)..(k + 51).min(values.len())];
            around.iter().sum::<f64>() / around.len() as f64
        };
        (0..values.len()).map(mean).collect()
    };
    let filtered = Feedback {
        speed_rad_s: means(&feedback.speed_rad_s),
        torque_nm: means(&feedback.torque_nm),
        ..feedback.clone()
    };
    let (whole, less) = (of(&feedback), of(&filtered));
    assert!(whole.0 > 0.99 && (whole.1 - 1.0).abs() < 5e-3, "{whole:?}");
    assert!(less.0 < 0.9 && less.1 < whole.1 - 5e-3, "{less:?}");
}

#[test]
fn exact_points_left_out_can_make_a_run_valid() {
    // The bench does not motor: torque is 0 where the reference is negative, with the pedal released.
    let (reference, mut feedback) = run(0.0, 1.0);
    feedback.torque_nm.iter_mut().for_each(|torque| *torque = torque.max(0.0));
    let mut set = requirement("1065.514").unwrap();
    let valid = validate(&reference, &feedback, &set).unwrap();
    assert!(valid.passes && valid.omission != Omission::NONE, "{valid:?}");
    assert!(valid.omitted[1] > 300 && valid.omitted[2] >= valid.omitted[1] && valid.omitted[0] == 0, "{valid:?}");
    set.omission = false;
    assert!(!validate(&reference, &feedback, &set).unwrap().passes);
}

#[test]
fn exact_a_reference_of_constant_speed_is_judged_by_its_standard_error() {
    let speed: Vec<f64> = (0..100).map(|k| 150.0 + f64::from(k % 7)).collect();
    let reference = Reference::of_itself(0.0, speed.clone(), vec![100.0; 100]);
    let feedback = Feedback {
        start_s: 0.0,
        sample_time_s: 0.1,
        speed_rad_s: (0..1000).map(|k| reference.speed_at(f64::from(k) * 0.1) + 1.0).collect(),
        torque_nm: vec![100.0; 1000],
        demand: None,
    };
    let found = validate(&reference, &feedback, &requirement("1036.545").unwrap()).unwrap();
    let checked: Vec<Statistic> = found.checked.iter().map(|one| one.statistic).collect();
    assert_eq!(checked, [Statistic::StandardError]);
    assert!(found.passes, "{found:?}");
}

#[test]
fn regress_a_feedback_that_ends_early_is_refused() {
    let (reference, mut feedback) = run(0.0, 1.0);
    feedback.speed_rad_s.truncate(15_000);
    feedback.torque_nm.truncate(15_000);
    let error = validate(&reference, &feedback, &requirement("whtc").unwrap()).unwrap_err().to_string();
    assert!(error.contains("1499.9"), "{error}");
    let (reference, mut feedback) = run(0.0, 1.0);
    feedback.torque_nm[77] = f64::NAN;
    let error = validate(&reference, &feedback, &requirement("whtc").unwrap()).unwrap_err().to_string();
    assert!(error.contains("torque, sample 77"), "{error}");
}

/// The reference 1000, 1100, 1000 with a value each second, and a feedback of 1 kHz that is straight between them.
fn roof() -> (Reference, Feedback) {
    let reference = Reference::of_itself(0.0, vec![1000.0, 1100.0, 1000.0], vec![0.0, 80.0, 0.0]);
    let time = |k: usize| k as f64 * 1e-3;
    let feedback = Feedback {
        start_s: 0.0,
        sample_time_s: 1e-3,
        speed_rad_s: (0..=2000).map(|k| reference.speed_at(time(k))).collect(),
        torque_nm: (0..=2000).map(|k| reference.torque_at(time(k))).collect(),
        demand: None,
    };
    (reference, feedback)
}

#[test]
fn exact_means_over_a_second_by_hand() {
    let (reference, feedback) = roof();
    let set = |reference_means| cycle::RequirementSet {
        shift_s: 0.0,
        omission: false,
        reference_means,
        ..requirement("1065.514").unwrap()
    };
    // Means over 0 … 0.5, 0.5 … 1.5 and 1.5 … 2 s: 1025, 1075, 1025, of both. The feedback has a sample half before its
    // start.
    let found = validate(&reference, &feedback, &set(true)).unwrap();
    let [speed, torque, _] = found.regressions.map(Option::unwrap);
    assert!((speed.slope - 1.0).abs() < 2e-3 && speed.standard_error < 0.05, "{speed:?}");
    assert!((torque.slope - 1.0).abs() < 2e-3 && torque.intercept.abs() < 0.05, "{torque:?}");
    // Against the values at the seconds, 1000, 1100, 1000, the slope is 50/100.
    let [speed, torque, _] = validate(&reference, &feedback, &set(false)).unwrap().regressions.map(Option::unwrap);
    assert!((speed.slope - 0.5).abs() < 1e-3 && (speed.intercept - 525.0).abs() < 1.0, "{speed:?}");
    assert!((torque.slope - 0.5).abs() < 1e-3 && (torque.intercept - 20.0).abs() < 0.05, "{torque:?}");
}

#[test]
fn exact_a_bench_without_error_has_a_slope_of_one() {
    let reference = builtin("nrtc").unwrap().reference(&map()).unwrap();
    let time = |k: usize| 1.0 + k as f64 * 0.01;
    let feedback = Feedback {
        start_s: 1.0,
        sample_time_s: 0.01,
        speed_rad_s: (0..123_701).map(|k| reference.speed_at(time(k))).collect(),
        torque_nm: (0..123_701).map(|k| reference.torque_at(time(k))).collect(),
        demand: None,
    };
    let speed = |name: &str| {
        let set = cycle::RequirementSet { shift_s: 0.0, omission: false, ..requirement(name).unwrap() };
        validate(&reference, &feedback, &set).unwrap().regressions[0].unwrap()
    };
    assert!((speed("1065.514").slope - 1.0).abs() < 1e-4, "{:?}", speed("1065.514"));
    assert!((speed("nrtc").slope - 1.0).abs() < 1e-4);
    // The WHTC's reference is the value at the second.
    assert!(speed("whtc").slope < 0.99, "{:?}", speed("whtc"));
}

#[test]
fn exact_a_reference_may_be_faster_than_a_second() {
    let (slow, feedback) = roof();
    let fine = |of: fn(&Reference, f64) -> f64| (0..=20).map(|k| of(&slow, f64::from(k) * 0.1)).collect::<Vec<_>>();
    let of_itself = Reference::of_itself(0.0, fine(Reference::speed_at), fine(Reference::torque_at));
    let fast = Reference { step_s: 0.1, ..of_itself };
    assert_eq!((fast.end_s(), fast.seconds().collect::<Vec<_>>()), (2.0, vec![0.0, 1.0, 2.0]));
    assert!((fast.work_j() / slow.work_j() - 0.8).abs() < 0.2);
    let set = requirement("1065.514").unwrap();
    let [a, b] = [&slow, &fast].map(|reference| validate(reference, &feedback, &set).unwrap().regressions[0].unwrap());
    assert!((a.slope - b.slope).abs() < 1e-9 && (a.intercept - b.intercept).abs() < 1e-6, "{a:?} {b:?}");
}
