//! Models without a noise model under feedback, and with an input of too few lines: what they are doubted for.

use ident::{ContinuousTransferFunction, Dataset, Doubt, Fit, OutputError, ProcessFit};

use crate::noise::Noise;

/// A lag under a disturbance that a proportional controller works against, `late` samples after it measures.
fn closed_loop(seed: u64, late: usize) -> Dataset {
    let mut noise = Noise::new(seed);
    let (mut u, mut y, mut v) = (vec![0.0; 2000], vec![0.0; 2000], 0.0);
    let mut x = 0.0;
    for t in 1..2000 {
        x = 0.9 * x + 0.2 * u[t - 1];
        v = 0.95 * v + 0.1 * noise.normal();
        y[t] = x + v;
        u[t] = -1.5 * y[t - late] + 0.02 * noise.normal();
    }
    Dataset::siso(0.01, &u, &y).unwrap()
}

/// A resonance in open loop that a lag does not describe, in coloured noise, its input held for `hold` samples.
fn open_loop(seed: u64, hold: usize) -> Dataset {
    let mut noise = Noise::new(seed);
    let levels = noise.normals(2000 / hold + 1);
    let (mut y, mut x, mut v) = (vec![0.0; 2000], [0.0; 2], 0.0);
    let u: Vec<f64> = (0..2000).map(|t| levels[t / hold]).collect();
    for t in 1..2000 {
        x = [1.6 * x[0] - 0.8 * x[1] + 0.2 * u[t - 1], x[0]];
        v = 0.9 * v + 0.1 * noise.normal();
        y[t] = x[0] + v;
    }
    Dataset::siso(0.01, &u, &y).unwrap()
}

fn doubts(data: &Dataset) -> [(&'static str, Vec<Doubt>); 3] {
    let of = |fit: Result<Vec<Doubt>, ident::IdentError>| fit.unwrap();
    [
        ("oe", of(OutputError::new(1, 1, 1).fit(data).map(|fit: Fit<_>| fit.doubts))),
        ("tf", of(ContinuousTransferFunction::new(0, 1).fit(data).map(|fit| fit.doubts))),
        ("process", of(ProcessFit::named("P1").unwrap().with_offset().fit(data).map(|fit| fit.doubts))),
    ]
}

#[test]
fn regress_output_errors_doubt_data_under_feedback() {
    for seed in 0..3 {
        for (name, found) in doubts(&closed_loop(seed, 1)) {
            assert!(found.contains(&Doubt::Feedback { output: 0, input: 0 }), "{name} {seed}: {found:?}");
        }
        // A controller without delay cannot be told from an input that acts at once.
        for (name, found) in doubts(&closed_loop(seed, 0)) {
            let is_warned = |d: &Doubt| matches!(d, Doubt::Feedback { .. } | Doubt::WithinSample { .. });
            assert!(found.iter().any(is_warned), "{name} {seed}: {found:?}");
        }
    }
}

#[test]
fn stat_models_that_are_too_simple_do_not_look_like_feedback() {
    for seed in 0..8 {
        for hold in [1, 7, 30] {
            for (name, found) in doubts(&open_loop(seed, hold)) {
                let is_warned = |d: &Doubt| matches!(d, Doubt::Feedback { .. } | Doubt::WithinSample { .. });
                assert!(!found.iter().any(is_warned), "{name} {seed} {hold}: {found:?}");
            }
        }
    }
}

#[test]
fn regress_one_sine_does_not_show_a_delay_beside_a_lag() {
    let mut noise = Noise::new(4);
    let wave = |t: f64| (std::f64::consts::TAU * t / 40.0).sin();
    let u: Vec<f64> = (0..1000).map(|t| wave(f64::from(t))).collect();
    let y: Vec<f64> = (0..1000).map(|t| 0.7 * wave(f64::from(t) - 6.2) + 0.02 * noise.normal()).collect();
    let data = Dataset::siso(0.01, &u, &y).unwrap();
    let is_named = |doubts: &[Doubt]| {
        doubts.iter().any(|d| matches!(d, Doubt::FewLines { input: 0, lines: 1, needed: 2, strongest_hz } if (strongest_hz - 2.5).abs() < 0.1))
    };
    let process = ProcessFit::named("P1D").unwrap().with_delay_between(&[(0.0, 0.2)]).fit(&data).unwrap();
    assert!(is_named(&process.doubts), "{:?}", process.doubts);
    let tf = ContinuousTransferFunction::new(0, 1).with_delay_between(&[(0.0, 0.2)]).fit(&data).unwrap();
    assert!(is_named(&tf.doubts), "{:?}", tf.doubts);
    // Gain and lag are two numbers, as one line gives.
    let lag = ProcessFit::named("P1").unwrap().fit(&data).unwrap();
    assert!(!lag.doubts.iter().any(|d| matches!(d, Doubt::FewLines { .. })), "{:?}", lag.doubts);
}
