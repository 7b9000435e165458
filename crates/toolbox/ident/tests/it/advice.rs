use std::f64::consts::TAU;

use faer::Mat;
use ident::{Advice, Channel, Dataset, SampleIndex, advise};

use crate::noise::Noise;

/// `y = a y(t−1) + (1 − a) u(t−1) + e`, `u = r − f y`; there is more noise under feedback.
fn loop_data(seed: u64, rows: usize, pole: f64, feedback: f64) -> Dataset {
    let mut noise = Noise::new(seed);
    let (mut u, mut y) = (vec![0.0; rows], vec![0.0; rows]);
    for t in 1..rows {
        y[t] = pole * y[t - 1] + (1.0 - pole) * u[t - 1] + (0.1 + 0.4 * feedback) * noise.normal();
        u[t] = noise.normal() - feedback * y[t];
    }
    Dataset::siso(0.1, &u, &y).unwrap()
}

#[test]
fn stat_good_data_need_no_advice() {
    // At the level of 99.9 % two tests on each of a hundred data sets raise a false alarm about 0.2 times.
    let alarms = (0..100).map(|seed| advise(&loop_data(seed, 2000, 0.8, 0.0)).len()).sum::<usize>();
    assert!(alarms <= 2, "{alarms}");
}

#[test]
fn stat_feedback_is_seen_in_closed_loop_alone() {
    for seed in 0..20 {
        let found = advise(&loop_data(seed, 2000, 0.8, 1.0));
        assert!(found.iter().any(|a| matches!(a, Advice::Feedback { input: 0, output: 0, .. })), "{found:?}");
    }
}

/// The channels the wrong way round: what is called the output drives what is called the input.
#[test]
fn stat_what_drives_the_input_is_not_said_to_follow_it() {
    for seed in 0..20 {
        let mut noise = Noise::new(seed);
        let y = noise.coloured(1500, 1.0, 0.9);
        let (mut u, mut x) = (vec![0.0; 1500], 0.0);
        for t in 0..1500 {
            u[t] = x + 0.05 * noise.normal();
            x += 0.2 * (y[t] - x);
        }
        let found = advise(&Dataset::siso(0.01, &u, &y).unwrap());
        assert!(found.iter().any(|a| matches!(a, Advice::Feedback { input: 0, output: 0, .. })), "{found:?}");
        let is_response = |a: &Advice| {
            let of_rate = matches!(a, Advice::SampledTooFast { .. } | Advice::SampledTooSlowly { .. });
            of_rate || matches!(a, Advice::Feedthrough { .. } | Advice::Integrating { .. })
        };
        assert!(!found.iter().any(is_response), "{found:?}");
    }
}

/// Noise of the output hides a lightly damped mode from a short regression, which then reads a smooth input ahead.
#[test]
fn stat_an_input_that_repeats_exactly_is_not_said_to_follow() {
    for seed in 0..10 {
        let mut noise = Noise::new(seed);
        let phases: Vec<f64> = (0..60).map(|_| TAU * noise.normal()).collect();
        let sine = |t: usize, k: usize| (TAU * (k + 1) as f64 * t as f64 / 400.0 + phases[k]).cos();
        let u: Vec<f64> = (0..8000).map(|t| (0..60).map(|k| sine(t, k)).sum()).collect();
        let (mut x, mut before) = (vec![0.0; u.len()], 0.0);
        for t in 1..u.len() {
            let next = 1.86 * x[t - 1] - 0.95 * before + 0.1 * u[t - 1];
            before = x[t - 1];
            x[t] = next;
        }
        let spread = (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
        let y: Vec<f64> = x.iter().map(|x| x + 2.0 * spread * noise.normal()).collect();
        let found = advise(&Dataset::siso(0.001, &u, &y).unwrap());
        assert!(!found.iter().any(|a| matches!(a, Advice::Feedback { .. })), "{found:?}");
    }
}

#[test]
fn exact_one_outlier_is_counted_in_the_singular() {
    let of = |count: usize| {
        Advice::Outliers { channel: Channel::Input(0), at: vec![SampleIndex { experiment: 0, row: 3 }; count] }
            .to_string()
    };
    assert_eq!(of(1), "input 1 has 1 sample that stands out");
    assert_eq!(of(7), "input 1 has 7 samples that stand out");
}

#[test]
fn stat_the_sample_rate_is_held_against_the_rise() {
    let fast = advise(&loop_data(1, 20_000, 0.98, 0.0));
    assert!(fast.iter().any(|a| matches!(a, Advice::SampledTooFast { rise_samples, .. } if *rise_samples > 60.0)));
    let slow = advise(&loop_data(2, 2000, 0.1, 0.0));
    assert!(slow.iter().any(|a| matches!(a, Advice::SampledTooSlowly { .. })), "{slow:?}");
}

#[test]
fn stat_feedthrough_is_seen() {
    let mut noise = Noise::new(3);
    let u = noise.normals(500);
    let mut y = vec![0.0; 500];
    (1..500).for_each(|t| y[t] = 0.8 * y[t - 1] + 0.2 * u[t] + 0.1 * noise.normal());
    let found = advise(&Dataset::siso(0.1, &u, &y).unwrap());
    assert!(found.iter().any(|a| matches!(a, Advice::Feedthrough { input: 0, output: 0, .. })));
    assert!(!found.iter().any(|a| matches!(a, Advice::Feedback { .. })));
}

#[test]
fn exact_faults_of_channels_are_named() {
    let mut noise = Noise::new(4);
    let rows = 1000;
    let u = noise.normals(rows);
    let (first, second, third) = (Channel::Input(0), Channel::Input(1), Channel::Output(0));
    let inputs = Mat::from_fn(rows, 3, |t, k| [u[t], 2.0 * u[t] + 1e-3 * (t as f64).sin(), 4.0][k]);
    let mut y: Vec<f64> = (0..rows).map(|t| (noise.normal() + 1.0).clamp(-0.5, 2.5) + 0.01 * t as f64).collect();
    (y[10], y[500]) = (f64::NAN, 1e3);
    let data = Dataset::new(0.1, inputs, Mat::from_fn(rows, 1, |t, _| y[t])).unwrap();
    let found = advise(&data);
    assert!(found.contains(&Advice::Missing { channel: third, samples: 1, of: rows }));
    assert!(found.contains(&Advice::Constant { channel: Channel::Input(2) }));
    assert!(found.contains(&Advice::Outliers { channel: third, at: vec![SampleIndex { experiment: 0, row: 500 }] }));
    assert!(
        found.iter().any(|a| matches!(a, Advice::Collinear { inputs: [0, 1], correlation } if *correlation > 0.99))
    );
    assert!(
        !found.iter().any(|a| matches!(a, Advice::Constant { channel } if *channel == first || *channel == second))
    );
    // Every sentence names its channel.
    assert!(found.iter().all(|a| !a.to_string().is_empty()));
}

#[test]
fn exact_clipping_is_told_from_switching_and_drift_from_noise() {
    let mut noise = Noise::new(5);
    let binary: Vec<f64> = (0..600).map(|t| if (t / 7) % 2 == 0 { 1.0 } else { -1.0 }).collect();
    let clipped: Vec<f64> = (0..600).map(|t| (0.03 * t as f64).sin().min(0.8) + 0.0).collect();
    let found = advise(&Dataset::siso(0.1, &binary, &clipped).unwrap());
    assert!(found.iter().any(|a| matches!(a, Advice::Clipped { channel: Channel::Output(0), .. })));
    assert!(!found.iter().any(|a| matches!(a, Advice::Clipped { channel: Channel::Input(0), .. })));
    let drifting: Vec<f64> = (0..600).map(|t| noise.normal() + 0.01 * t as f64).collect();
    let found = advise(&Dataset::siso(0.1, &binary, &drifting).unwrap());
    assert!(found.iter().any(|a| matches!(a, Advice::Drift { channel: Channel::Output(0), .. })));
    assert!(found.iter().any(|a| matches!(a, Advice::Offset { channel: Channel::Output(0), .. })));
}

#[test]
fn exact_one_sine_excites_too_little() {
    // Whole periods, so that the mean is zero.
    let sine: Vec<f64> = (0..500).map(|t| (std::f64::consts::TAU * t as f64 / 20.0).sin()).collect();
    let found = advise(&Dataset::siso(0.1, &sine, &sine).unwrap());
    assert!(found.contains(&Advice::WeakExcitation { order: 2 }), "{found:?}");
}

#[test]
fn regress_poor_data_give_advice_and_no_panic() {
    let nan = f64::NAN;
    for (u, y) in
        [(vec![], vec![]), (vec![1.0], vec![2.0]), (vec![nan; 50], vec![nan; 50]), (vec![0.0; 50], vec![1.0; 50])]
    {
        let _ = advise(&Dataset::siso(0.1, &u, &y).unwrap());
    }
    let series = Dataset::new(0.1, Mat::zeros(0, 0), Mat::from_fn(0, 1, |_, _| 0.0)).unwrap();
    let _ = advise(&series);
    let short = loop_data(6, 30, 0.8, 0.0);
    assert!(advise(&short).contains(&Advice::Short { samples: 30, needed: 100 }));
}

/// `y = p y(t−1) + u(t−1)`, measured with noise, about its mean as `advise` takes it.
fn driven(seed: u64, rows: usize, pole: f64, mean: f64) -> Dataset {
    let mut noise = Noise::new(seed);
    let (mut u, mut y, mut x) = (vec![0.0; rows], vec![0.0; rows], 0.0);
    for t in 0..rows {
        u[t] = noise.normal() + mean;
        y[t] = x + 0.1 * noise.normal();
        x = pole * x + u[t];
    }
    Dataset::siso(0.1, &u, &y).unwrap()
}

#[test]
fn stat_integrators_are_seen_and_lags_are_not() {
    let seen = |data: &Dataset| advise(data).contains(&Advice::Integrating { input: 0, output: 0 });
    for rows in [300, 2000] {
        let found = (0..40).filter(|seed| seen(&driven(*seed, rows, 1.0, 0.0))).count();
        assert!(found >= 36, "{found} of 40 integrators of {rows} samples");
        // A lag of a twentieth of the record is none.
        let pole = 1.0 - 20.0 / rows as f64;
        let found = (0..40).filter(|seed| seen(&driven(*seed, rows, pole, 0.0))).count();
        assert!(found <= 2, "{found} of 40 lags of {rows} samples");
    }
    let found = (0..40).filter(|seed| seen(&driven(*seed, 1000, 1.0, 0.2))).count();
    assert!(found >= 30, "{found} of 40 integrators of an input with a mean");
    // A walk that no input drives integrates nothing that is known.
    let walk = |seed: u64| {
        let mut noise = Noise::new(seed);
        let mut y = noise.normals(1000);
        (1..1000).for_each(|t| y[t] += y[t - 1]);
        Dataset::siso(0.1, &noise.normals(1000), &y).unwrap()
    };
    assert!((0..40).filter(|seed| seen(&walk(*seed))).count() <= 1);
}

#[test]
fn regress_heavy_clipping_is_no_switching() {
    let mut noise = Noise::new(6);
    let steps = noise.normals(200);
    // A switch between two levels that takes a sample, as after an anti-alias filter.
    let mut binary: Vec<f64> = (0..2000).map(|t| if steps[t / 10] > 0.0 { 1.0 } else { -1.0 }).collect();
    (1..2000).filter(|t| t % 10 == 0 && steps[t / 10] * steps[t / 10 - 1] < 0.0).for_each(|t| binary[t] *= 0.3);
    let sine = |limit: f64| (0..2000).map(|t| (0.03 * f64::from(t)).sin().clamp(-limit, limit)).collect::<Vec<f64>>();
    let is_clipped = |u: &[f64], y: &[f64], wanted: Channel| {
        let found = advise(&Dataset::siso(0.1, u, y).unwrap());
        found.iter().any(|a| matches!(a, Advice::Clipped { channel, .. } if *channel == wanted))
    };
    let other = noise.normals(2000);
    assert!(!is_clipped(&binary, &other, Channel::Input(0)));
    assert!(is_clipped(&other, &binary, Channel::Output(0)), "no linear system answers with two levels");
    for limit in [0.05, 0.2, 0.8] {
        assert!(is_clipped(&sine(limit), &other, Channel::Input(0)), "{limit}");
    }
}

#[test]
fn exact_inputs_that_depend_on_others_are_named_with_what_they_are_made_of() {
    let mut noise = Noise::new(12);
    let (u, v) = (noise.normals(600), noise.normals(600));
    let y: Vec<f64> = (0..600).map(|t| if t == 0 { 0.0 } else { u[t - 1] + v[t - 1] + noise.normal() }).collect();
    let said = |columns: [&dyn Fn(usize) -> f64; 3]| -> Vec<String> {
        let inputs = Mat::from_fn(600, 3, |t, k| columns[k](t));
        let data = Dataset::new(0.1, inputs, Mat::from_fn(600, 1, |t, _| y[t])).unwrap();
        advise(&data).iter().map(ToString::to_string).collect()
    };
    let remedy = "so that no data can separate their effects; leave one of them out";
    let same = said([&|t| u[t], &|t| v[t], &|t| u[t]]);
    assert_eq!(same, [format!("input 3 is the same as input 1, {remedy}")]);
    let shifted = said([&|t| u[t], &|t| v[t], &|t| v[t] + 50.0]);
    assert!(shifted.contains(&format!("input 3 is the same as input 2 but for a constant, {remedy}")), "{shifted:?}");
    let scaled = said([&|t| u[t], &|t| -2.5e3 * u[t], &|t| v[t]]);
    assert_eq!(scaled, [format!("input 2 is -2500 times input 1, {remedy}")]);
    let mixed = said([&|t| u[t], &|t| v[t], &|t| u[t] - 0.5 * v[t]]);
    assert_eq!(mixed, [format!("input 3 is input 1 - 0.5 times input 2, {remedy}")]);
    let nearly = said([&|t| u[t], &|t| v[t], &|t| u[t] + 1e-3 * v[t].powi(3)]);
    assert!(nearly.iter().any(|text| text.contains("correlated")), "{nearly:?}");
}
