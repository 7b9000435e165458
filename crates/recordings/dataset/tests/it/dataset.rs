//! Named channels of recordings become data on one clock.

use dataset::{Adjustment, CommonClock, DatasetError, DatasetOptions, Resampling, dataset};
use ident::Intersample;
use recording::{Recording, Selection};

fn options(inputs: &[&str], outputs: &[&str]) -> DatasetOptions {
    let names = |list: &[&str]| list.iter().map(ToString::to_string).collect();
    DatasetOptions { inputs: names(inputs), outputs: names(outputs), ..Default::default() }
}

fn recorded(text: &str) -> Recording {
    recording::decode("x.csv", text.as_bytes(), &Selection::All).unwrap()
}

/// Columns u and y every 0.1 s, as functions of time.
fn table(samples: usize, u: impl Fn(f64) -> String, y: impl Fn(f64) -> String) -> Recording {
    let rows = (0..samples).map(|n| 0.1 * n as f64).map(|t| format!("{t},{},{}\n", u(t), y(t)));
    recorded(&format!("time [s],u [V],y [Nm]\n{}", rows.collect::<String>()))
}

#[test]
fn exact_same_clock_is_taken_as_it_is() {
    let recording = table(50, |t| format!("{t}"), |t| format!("{}", 2.0 * t));
    let (data, adjustments) = dataset(&[("x.csv", &recording)], &options(&["u"], &["y"])).unwrap();
    assert_eq!(adjustments, []);
    assert_eq!((data.samples(), data.input_labels()[0].unit.as_str()), (50, "V"));
    assert!((data.sample_time_s() - 0.1).abs() < 1e-12);
    assert_eq!(data.experiments()[0].output(0)[30], recording.channel("y").unwrap().samples[30]);
}

#[test]
fn exact_cut_in_time_keeps_the_clock() {
    let recording = table(50, |t| format!("{t}"), |t| format!("{t}"));
    let cut = DatasetOptions { from_s: Some(1.0), to_s: Some(2.05), ..options(&["u"], &["y"]) };
    let (data, _) = dataset(&[("x.csv", &recording)], &cut).unwrap();
    let experiment = &data.experiments()[0];
    assert_eq!(experiment.len(), 11);
    assert!((experiment.start_s - 1.0).abs() < 1e-9 && (experiment.input(0)[0] - 1.0).abs() < 1e-9);
}

#[test]
fn exact_gap_and_nan_are_missing_samples() {
    let text = "time [s],u,y\n0,1,1\n0.1,1,\n0.2,1,3\n0.3,1,4\n0.7,1,8\n0.8,1,9\n0.9,1,10\n";
    let (data, adjustments) = dataset(&[("x.csv", &recorded(text))], &options(&[], &["y"])).unwrap();
    let y = data.experiments()[0].output(0);
    assert_eq!(y.len(), 10);
    assert!([1, 4, 5, 6].iter().all(|i: &usize| y[*i].is_nan()), "{y:?}");
    assert_eq!((y[3], y[7]), (4.0, 8.0));
    assert_eq!(adjustments, [Adjustment::Missing { channel: "y".into(), count: 4, of: 10 }]);
}

#[test]
fn exact_slower_clock_of_two_is_the_datas() {
    let fast: String = (0..=2000).map(|n| 0.005 * f64::from(n)).map(|t| format!("{t},{}\n", (3.0 * t).sin())).collect();
    let slow: Vec<String> =
        (0..=500).map(|n| 0.02 * f64::from(n)).map(|t| format!("{t},{}", (3.0 * t).cos())).collect();
    let mut slow = slow.into_iter();
    let rows = fast.lines().map(|line| format!("{line},{}\n", slow.next().unwrap_or_else(|| ",".into())));
    let text = format!("time [s],u,time 2 [s],y\n{}", rows.collect::<String>());
    // An input that is held lags half of its own sample behind the wave that was sampled.
    let ways =
        [(Intersample::ZeroOrderHold, 0.0025), (Intersample::FirstOrderHold, 0.0), (Intersample::BandLimited, 0.0)];
    for (intersample, late_s) in ways {
        let asked = DatasetOptions { intersample, ..options(&["u"], &["y"]) };
        let (data, adjustments) = dataset(&[("x.csv", &recorded(&text))], &asked).unwrap();
        assert!((data.sample_time_s() - 0.02).abs() < 1e-9);
        assert!(matches!(&adjustments[..], [Adjustment::Resampled { channel, .. }] if channel == "u"));
        assert_eq!(data.intersample(), Intersample::BandLimited);
        let u = data.experiments()[0].input(0);
        for k in 50..450 {
            assert!((u[k] - (3.0 * (0.02 * k as f64 - late_s)).sin()).abs() < 1e-4, "{intersample:?}: sample {k}");
        }
    }
}

/// A lag of 20 rad/s under an input that is held for 10 ms, every 50 ms and every 20 ms of it.
#[test]
fn regress_filtered_inputs_are_band_limited() {
    let (mut u, mut y, mut seed, mut rows) = (0.0, 0.0, 12_345_u64, String::new());
    for k in 0..6000 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        if (seed >> 33).is_multiple_of(4) {
            u = (seed >> 40) as f64 / f64::from(1 << 24) - 0.5;
        }
        rows += &format!("{},{u},{y}\n", f64::from(k) / 100.0);
        y = (-0.2_f64).exp() * y + (1.0 - (-0.2_f64).exp()) * u;
    }
    let recording = recorded(&format!("time [s],u,y\n{rows}"));
    for sample_time_s in [0.05, 0.02] {
        let every = DatasetOptions { clock: CommonClock::Every(sample_time_s), ..options(&["u"], &["y"]) };
        let (data, adjustments) = dataset(&[("x.csv", &recording)], &every).unwrap();
        assert!(!adjustments.iter().any(|a| matches!(a, Adjustment::Mixed { .. })), "{adjustments:?}");
        assert_eq!(data.intersample(), Intersample::BandLimited);
        let fit = ident::ContinuousTransferFunction::new(0, 1).fit(&data).unwrap();
        let (pole, error) = (fit.model.transfer_function(0, 0).unwrap().den()[1], fit.standard_errors()[1]);
        assert!((pole - 20.0).abs() < 0.3 && error < 0.3, "{sample_time_s}: {pole} ± {error}");
    }
}

#[test]
fn exact_inputs_of_which_one_is_filtered_are_named() {
    let fast: Vec<String> =
        (0..400).map(|n| format!("{},{}", 0.005 * f64::from(n), (0.3 * f64::from(n)).sin())).collect();
    let rows = fast.iter().enumerate().map(|(n, row)| match n {
        0..200 => format!("{row},{},{n},{n}\n", 0.01 * n as f64),
        _ => format!("{row},,,\n"),
    });
    let recording = recorded(&format!("time [s],u,time 2 [s],v,y\n{}", rows.collect::<String>()));
    let (data, adjustments) = dataset(&[("x.csv", &recording)], &options(&["u", "v"], &["y"])).unwrap();
    assert_eq!(data.intersample(), Intersample::BandLimited);
    assert!(adjustments.contains(&Adjustment::Mixed { filtered: "u".into(), other: "v".into() }), "{adjustments:?}");
    let (alone, _) = dataset(&[("x.csv", &recording)], &options(&["v"], &["y"])).unwrap();
    assert_eq!(alone.intersample(), Intersample::ZeroOrderHold);
}

#[test]
fn regress_a_recording_filtered_among_others_is_named() {
    let every = |step_s: f64| {
        let row = |n: u32| format!("{},{},{n}\n", step_s * f64::from(n), (0.3 * f64::from(n)).sin());
        recorded(&format!("time [s],u,y\n{}", (0..400).map(row).collect::<String>()))
    };
    let (fast, slow) = (every(0.005), every(0.01));
    let clock = DatasetOptions { clock: CommonClock::Every(0.01), ..options(&["u"], &["y"]) };
    let (_, adjustments) = dataset(&[("fast.csv", &fast), ("slow.csv", &slow)], &clock).unwrap();
    let mixed = Adjustment::Mixed { filtered: "u, fast.csv".into(), other: "u, slow.csv".into() };
    assert!(adjustments.contains(&mixed), "{adjustments:?}");
}

#[test]
fn regress_impossible_requests_are_refused_with_names() {
    let recording = table(50, |t| format!("{t}"), |t| format!("{t}"));
    let refused = |options: DatasetOptions| dataset(&[("x.csv", &recording)], &options).unwrap_err();
    let message = refused(options(&["v"], &["y"])).to_string();
    assert!(message.contains("x.csv") && message.contains("\"v\"") && message.contains('u'), "{message}");
    let late = DatasetOptions { from_s: Some(100.0), ..options(&["u"], &["y"]) };
    let nothing = refused(late);
    assert!(matches!(nothing, DatasetError::NothingLeft { .. }) && nothing.to_string().ends_with("from 100 s on"));
    for sample_time_s in [0.0, -1.0, f64::NAN, 1e-12, 100.0] {
        let odd = DatasetOptions { clock: CommonClock::Every(sample_time_s), ..options(&["u"], &["y"]) };
        assert!(matches!(refused(odd), DatasetError::SampleTime { .. }), "{sample_time_s}");
    }
    let apart = recorded("time [s],u,time [s],y\n0,1,60,1\n0.1,1,60.1,1\n0.2,1,60.2,3\n");
    let message = dataset(&[("x.csv", &apart)], &options(&["u"], &["y"])).unwrap_err().to_string();
    assert!(message.contains("\"u\" ends at 0.2 s, and \"y\" begins at 60 s"), "{message}");
    let backwards = recorded("time [s],u,y\n0,1,1\n0.2,1,1\n0.1,1,3\n");
    let error = dataset(&[("x.csv", &backwards)], &options(&["u"], &["y"])).unwrap_err();
    assert!(matches!(error, DatasetError::TimeNotRising { sample: 2, .. }), "{error}");
}

#[test]
fn exact_slow_output_on_a_fast_clock_is_known_where_it_was_measured() {
    let rows: String = (0..=400)
        .map(|n| {
            let t = 0.01 * f64::from(n);
            let slow = if n <= 100 { format!("{},{}", 0.04 * f64::from(n), n) } else { ",".into() };
            format!("{t},{},{slow}\n", (3.0 * t).sin())
        })
        .collect();
    let text = format!("time [s],u,time 2 [s],y\n{rows}");
    let fast = DatasetOptions { clock: CommonClock::Every(0.01), ..options(&["u"], &["y"]) };
    let (data, adjustments) = dataset(&[("x.csv", &recorded(&text))], &fast).unwrap();
    let y = data.experiments()[0].output(0);
    for (k, value) in y.iter().enumerate() {
        match k % 4 {
            0 => assert!((value - k as f64 / 4.0).abs() < 1e-9, "sample {k}: {value}"),
            _ => assert!(value.is_nan(), "sample {k} was never measured: {value}"),
        }
    }
    assert!(matches!(&adjustments[..], [Adjustment::Sparse { channel, .. }] if channel == "y"), "{adjustments:?}");
}

#[test]
fn regress_recordings_in_different_units_are_not_mixed() {
    let rows = (0..50).map(|n| format!("{},1,{n}\n", 0.1 * f64::from(n))).collect::<String>();
    let in_unit = |unit: &str| recorded(&format!("time [s],u [Nm],y [{unit}]\n{rows}"));
    let mixed = |a: &str, b: &str| {
        let (a, b) = (in_unit(a), in_unit(b));
        dataset(&[("a.csv", &a), ("b.csv", &b)], &options(&["u"], &["y"])).map(|_| ())
    };
    let error = mixed("rpm", "rad/s").unwrap_err();
    let text = error.to_string();
    assert!(text.starts_with("b.csv: \"y\"") && text.contains("rpm") && text.contains("rad/s"), "{text}");
    mixed("rpm", "1/min").unwrap();
    mixed("rpm", "").unwrap();
    mixed("furlongs", "Furlongs").unwrap();
    assert!(mixed("furlongs", "V").is_err());
}

#[test]
fn regress_channels_of_one_name_are_not_chosen_from() {
    let twice = recorded("time [s],u,u,y\n0,1,2,3\n0.1,2,3,4\n0.2,1,1,5\n");
    let error = dataset(&[("x.csv", &twice)], &options(&["u"], &["y"])).unwrap_err();
    assert!(matches!(&error, DatasetError::Ambiguous { count: 2, .. }), "{error}");
}

/// u every 0.04 s and y every 0.01 s, or the other way round.
fn two_rasters(fast: &str, slow: &str) -> Recording {
    let rows: String = (0..=400)
        .map(|n| {
            let slow = if n <= 100 { format!("{},{}", 0.04 * f64::from(n), (n * n) % 17) } else { ",".into() };
            format!("{},{},{slow}\n", 0.01 * f64::from(n), f64::from(n).sin())
        })
        .collect();
    recorded(&format!("time [s],{fast},time 2 [s],{slow}\n{rows}"))
}

#[test]
fn exact_fastest_clock_leaves_every_channel_unfiltered() {
    let fastest = DatasetOptions { clock: CommonClock::Fastest, ..options(&["u"], &["y"]) };
    let (data, adjustments) = dataset(&[("x.csv", &two_rasters("u", "y"))], &fastest).unwrap();
    assert_eq!(data.sample_time_s(), 0.01);
    assert!(matches!(&adjustments[..], [Adjustment::Sparse { channel, .. }] if channel == "y"), "{adjustments:?}");
    let u = data.experiments()[0].input(0);
    assert!((0..=400).all(|k| u[k] == f64::from(k as u32).sin()));
}

#[test]
fn exact_slow_input_is_continued_as_inputs_behave() {
    let recording = two_rasters("y", "u");
    let of = |intersample| {
        let fastest = DatasetOptions { clock: CommonClock::Fastest, intersample, ..options(&["u"], &["y"]) };
        dataset(&[("x.csv", &recording)], &fastest).unwrap()
    };
    let value = |n: usize| ((n * n) % 17) as f64;
    let (held, adjustments) = of(Intersample::ZeroOrderHold);
    assert!(matches!(&adjustments[..], [Adjustment::Resampled { how: Resampling::Held, .. }]), "{adjustments:?}");
    assert_eq!(held.intersample(), Intersample::ZeroOrderHold);
    for (k, u) in held.experiments()[0].input(0).iter().enumerate() {
        assert_eq!(*u, value(k / 4), "sample {k}");
    }
    let (straight, _) = of(Intersample::FirstOrderHold);
    for (k, u) in straight.experiments()[0].input(0).iter().enumerate().take(400) {
        let share = (k % 4) as f64 / 4.0;
        let expected = value(k / 4) * (1.0 - share) + value(k / 4 + 1) * share;
        assert!((u - expected).abs() < 1e-9, "sample {k}: {u} is not {expected}");
    }
}

#[test]
fn exact_a_held_input_ends_where_its_gap_begins() {
    let rows: String = (0..=40)
        .map(|n| {
            let slow = match n {
                3 => "0.12,".to_owned(),
                n if n <= 10 => format!("{},{n}", 0.04 * f64::from(n)),
                _ => ",".into(),
            };
            format!("{},{},{slow}\n", 0.01 * f64::from(n), n)
        })
        .collect();
    let recording = recorded(&format!("time [s],y,time 2 [s],u\n{rows}"));
    let fastest = DatasetOptions { clock: CommonClock::Fastest, ..options(&["u"], &["y"]) };
    let (data, adjustments) = dataset(&[("x.csv", &recording)], &fastest).unwrap();
    let u = data.experiments()[0].input(0);
    // The third sample, at 0.12 s, is no number: from there to 0.16 s nothing is known.
    assert_eq!((u[11], u[16]), (2.0, 4.0));
    assert!((12..16).all(|k| u[k].is_nan()), "{:?}", &u[8..20]);
    assert!(adjustments.iter().any(|a| matches!(a, Adjustment::Missing { of: 41, .. })), "{adjustments:?}");
}

#[test]
fn exact_missing_samples_of_a_slow_output_are_counted_on_its_own_clock() {
    let rows: String = (0..=40)
        .map(|n| {
            let slow = match n {
                3 => "0.12,".to_owned(),
                n if n <= 10 => format!("{},{n}", 0.04 * f64::from(n)),
                _ => ",".into(),
            };
            format!("{},{},{slow}\n", 0.01 * f64::from(n), n)
        })
        .collect();
    let recording = recorded(&format!("time [s],u,time 2 [s],y\n{rows}"));
    let fastest = DatasetOptions { clock: CommonClock::Fastest, ..options(&["u"], &["y"]) };
    let (_, adjustments) = dataset(&[("x.csv", &recording)], &fastest).unwrap();
    let missing = Adjustment::Missing { channel: "y".into(), count: 1, of: 11 };
    assert!(adjustments.contains(&missing), "{adjustments:?}");
}

#[test]
fn exact_sample_times_carry_no_rounding_of_the_stamps() {
    let rows = (0..302).map(|n| format!("{},{n},{n}\n", 0.01 * f64::from(n)));
    let recording = recorded(&format!("time [s],u,y\n{}", rows.collect::<String>()));
    let (data, _) = dataset(&[("x.csv", &recording)], &options(&["u"], &["y"])).unwrap();
    assert_eq!(data.sample_time_s(), 0.01);
}

/// Stamps with ten digits, and a clock that differs from theirs in the tenth: the last row is still on it.
#[test]
fn regress_the_last_row_stays_on_a_clock_that_differs_by_the_digits_of_the_stamps() {
    let rows: String = (0..20_001).map(|n| format!("{:.10},{n},{n}\n", f64::from(n) / 610.35)).collect();
    let recording = recorded(&format!("time [s],u,y\n{rows}"));
    let clock = CommonClock::Every(1.0 / 610.35 * (1.0 + 1e-9));
    let asked = DatasetOptions { clock, ..options(&["u"], &["y"]) };
    let (data, _) = dataset(&[("x.csv", &recording)], &asked).unwrap();
    let last = data.experiments()[0].output(0).last().copied().unwrap();
    assert!(data.samples() == 20_001 && (last - 20_000.0).abs() < 1e-6, "{} {last}", data.samples());
}
