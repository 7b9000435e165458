use faer::Mat;
use ident::{Channel, Dataset, ExcitationOptions, Experiment, IdentError, Intersample, Trend, TrendScope, TrendShape};
use lti::TransferFunction;
use proptest::prelude::*;
use signal::Sos;
use signal::filter::Section;

use crate::noise::Noise;

fn two_experiments(seed: u64) -> Dataset {
    let mut noise = Noise::new(seed);
    let mut part = |name: &str, start_s: f64, rows: usize| Experiment {
        name: name.into(),
        start_s,
        inputs: Mat::from_fn(rows, 2, |_, _| noise.normal()),
        outputs: Mat::from_fn(rows, 1, |i, _| 5.0 + 0.1 * i as f64),
    };
    let first = part("a", 0.0, 200);
    let data = Dataset::new(0.1, first.inputs, first.outputs).unwrap();
    data.with_experiment(part("b", 100.0, 50)).unwrap()
}

#[test]
fn exact_parts_keep_their_clock_and_their_rows() {
    let data = two_experiments(1);
    let parts = data.split(0.6).unwrap();
    assert_eq!((parts.estimation.samples(), parts.validation.samples()), (150, 100));
    let late = &parts.validation.experiments()[1];
    assert!((late.start_s - 103.0).abs() < 1e-9);
    assert_eq!(late.input(1), &data.experiments()[1].input(1)[30..]);
    let merged = data.only_experiments(&[1]).unwrap().merge(&data.only_experiments(&[0]).unwrap()).unwrap();
    assert_eq!(merged.experiments()[0], data.experiments()[1]);
    assert_eq!(data.rows(60..80).unwrap().experiments().len(), 1);
    assert_eq!(data.channels(&[], &[0]).unwrap().rows(3..5).unwrap().samples(), 4);
}

#[test]
fn regress_bad_selections_are_named() {
    let data = two_experiments(2);
    assert!(matches!(data.channels(&[2], &[0]), Err(IdentError::Lti(lti::LtiError::Index { index: 2, .. }))));
    assert_eq!(data.channels(&[0], &[]), Err(IdentError::NoOutput));
    assert!(matches!(data.rows(500..600), Err(IdentError::TooFewSamples { .. })));
    assert!(matches!(data.split(f64::NAN), Err(IdentError::Signal(_))));
    assert!(matches!(data.split(1.0), Err(IdentError::TooFewSamples { .. })));
    let other = Dataset::new(0.2, Mat::zeros(3, 2), Mat::zeros(3, 1)).unwrap();
    assert!(matches!(data.merge(&other), Err(IdentError::Lti(lti::LtiError::SampleTimesDiffer { .. }))));
    let linear = data.clone().with_intersample(Intersample::FirstOrderHold);
    assert!(matches!(data.merge(&linear), Err(IdentError::Structure { .. })));
}

#[test]
fn exact_a_line_is_found_whatever_is_missing_and_put_back_on_simulated_outputs() {
    let mut y: Vec<f64> = (0..100).map(|i| 1e6 + 3.0 * (i as f64 * 0.1)).collect();
    y[7] = f64::NAN;
    let data = Dataset::siso(0.1, &[0.5; 100], &y).unwrap();
    let trend = Trend::estimate(&data, TrendShape::Line, TrendScope::PerExperiment).unwrap();
    let line = trend.outputs(0)[0];
    assert!((line.slope_per_s - 3.0).abs() < 1e-9 && (line.at(0.0) - 1e6).abs() < 1e-6);
    let flat = trend.remove(&data).unwrap();
    assert!(flat.experiments()[0].output(0).iter().all(|v| v.is_nan() || v.abs() < 1e-6));
    let later = trend.restore_outputs(Mat::zeros(2, 1).as_ref(), 0, 20.0, 0.1).unwrap();
    assert!((later[(1, 0)] - (1e6 + 60.3)).abs() < 1e-6);
    let silent = Dataset::siso(0.1, &[0.0; 3], &[f64::NAN; 3]).unwrap();
    let nothing = Trend::estimate(&silent, TrendShape::Mean, TrendScope::Common);
    assert!(matches!(nothing, Err(IdentError::TooFewSamples { .. })));
}

#[test]
fn exact_a_common_trend_leaves_the_difference_between_experiments() {
    let level = |v: f64| Experiment {
        name: String::new(),
        start_s: 0.0,
        inputs: Mat::zeros(10, 1),
        outputs: Mat::full(10, 1, v),
    };
    let data = Dataset::siso(1.0, &[0.0; 10], &[1.0; 10]).unwrap().with_experiment(level(3.0)).unwrap();
    let common = Trend::estimate(&data, TrendShape::Mean, TrendScope::Common).unwrap().remove(&data).unwrap();
    assert_eq!((common.experiments()[0].output(0)[0], common.experiments()[1].output(0)[0]), (-1.0, 1.0));
    let own = Trend::estimate(&data, TrendShape::Mean, TrendScope::PerExperiment).unwrap();
    assert_eq!(own.remove(&data).unwrap().experiments()[1].output(0)[0], 0.0);
    // A trend of two experiments belongs to no other number of them.
    assert!(matches!(own.remove(&data.only_experiments(&[0]).unwrap()), Err(IdentError::Length { .. })));
    assert!(matches!(Trend::offsets(&[1.0], &[]).unwrap().remove(&data), Err(IdentError::Length { .. })));
}

proptest! {
    #[test]
    fn prop_a_trend_that_was_removed_comes_back(levels in prop::collection::vec(-1e6..1e6, 20)) {
        let data = Dataset::siso(0.5, &levels, &levels).unwrap();
        for shape in [TrendShape::Mean, TrendShape::Line] {
            let trend = Trend::estimate(&data, shape, TrendScope::PerExperiment).unwrap();
            let back = trend.restore(&trend.remove(&data).unwrap()).unwrap();
            for (a, b) in back.experiments()[0].output(0).iter().zip(&levels) {
                prop_assert!((a - b).abs() < 1e-8);
            }
        }
    }
}

#[test]
fn exact_filters_commute_with_the_system() {
    // y = 0.5 y(t−1) + u(t−1): filtered data obey the same equation.
    let u = Noise::new(3).normals(300);
    let mut y = vec![0.0; 300];
    (1..300).for_each(|t| y[t] = 0.5 * y[t - 1] + u[t - 1]);
    let data = Dataset::siso(0.01, &u, &y).unwrap();
    let band = Sos::butterworth_bandpass(2, 5.0, 20.0, 0.01).unwrap();
    let ratio = TransferFunction::discrete(vec![1.0, -0.4], vec![1.0, -0.3, 0.2], 0.01).unwrap();
    for filtered in [data.prefilter(band).unwrap(), data.prefilter(ratio).unwrap(), data.difference().unwrap()] {
        let e = &filtered.experiments()[0];
        let worst = (200..e.len()).map(|t| (e.output(0)[t] - 0.5 * e.output(0)[t - 1] - e.input(0)[t - 1]).abs());
        assert!(worst.fold(0.0, f64::max) < 1e-12);
    }
    assert!((data.difference().unwrap().experiments()[0].start_s - 0.01).abs() < 1e-15);
}

#[test]
fn exact_a_ratio_and_a_section_are_the_same_filter() {
    let x = Noise::new(4).normals(50);
    let data = Dataset::siso(0.1, &x, &x).unwrap();
    let section = Section { b: [0.3, -0.2, 0.1], a: [-0.5, 0.3] };
    let ratio = TransferFunction::discrete(vec![0.6, -0.4, 0.2], vec![2.0, -1.0, 0.6], 0.1).unwrap();
    let (a, b) = (data.prefilter(Sos::new(vec![section], 0.1).unwrap()).unwrap(), data.prefilter(ratio).unwrap());
    for (a, b) in a.experiments()[0].output(0).iter().zip(b.experiments()[0].output(0)) {
        assert!((a - b).abs() < 1e-14);
    }
}

#[test]
fn regress_filters_refuse_what_they_cannot_do() {
    let gap = Dataset::siso(0.1, &[0.0; 40], &[&[0.0; 39][..], &[f64::NAN]].concat()).unwrap();
    let low = Sos::butterworth_lowpass(2, 1.0, 0.1).unwrap();
    assert!(matches!(gap.prefilter(low.clone()), Err(IdentError::Missing { index: 39, .. })));
    assert!(matches!(gap.resample(1, 2), Err(IdentError::Missing { .. })));
    let data = Dataset::siso(0.2, &[0.0; 40], &[0.0; 40]).unwrap();
    assert!(matches!(data.prefilter(low), Err(IdentError::Lti(_))));
    let integrator = TransferFunction::discrete(vec![1.0], vec![1.0, -1.0], 0.2).unwrap();
    assert!(matches!(data.prefilter(integrator), Err(IdentError::Structure { .. })));
    assert!(data.resample(0, 1).is_err() && data.delay_input(0, f64::INFINITY).is_err());
    assert!(matches!(data.delay_input(0, 50.0), Err(IdentError::TooFewSamples { .. })));
    assert!(data.resample(1, 7).unwrap().samples() == 6);
}

#[test]
fn exact_resampling_keeps_slow_sines_and_holds_held_inputs() {
    let wave = |t: f64| (0.7 * t).sin();
    let x: Vec<f64> = (0..600).map(|i| wave(i as f64 * 0.1)).collect();
    let data = Dataset::siso(0.1, &x, &x).unwrap();
    for (up, down) in [(3, 1), (1, 4), (3, 2), (2, 6)] {
        let changed = data.resample(up, down).unwrap();
        let e = &changed.experiments()[0];
        let middle = e.len() / 4..3 * e.len() / 4;
        let worst =
            middle.map(|i| (e.output(0)[i] - wave(i as f64 * changed.sample_time_s())).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-3, "{up}/{down}: {worst}");
    }
    let finer = data.resample(2, 1).unwrap();
    assert_eq!(finer.intersample(), Intersample::ZeroOrderHold);
    assert_eq!(finer.experiments()[0].input(0)[101], x[50]);
    for (intersample, late) in
        [(Intersample::ZeroOrderHold, 0.05), (Intersample::FirstOrderHold, 0.0), (Intersample::BandLimited, 0.0)]
    {
        let coarser = data.clone().with_intersample(intersample).resample(1, 2).unwrap();
        assert_eq!(coarser.intersample(), Intersample::BandLimited);
        // What is held lags half a sample behind what was sampled; both holds weaken it, by (ωT)²/24 and twice that.
        let u = coarser.experiments()[0].input(0);
        assert!((80..220).all(|i| (u[i] - wave(0.2 * i as f64 - late)).abs() < 1e-3), "{intersample:?}");
    }
    assert_eq!(data.resample(5, 5).unwrap(), data);
}

#[test]
fn exact_inputs_are_delayed_by_whole_and_broken_samples() {
    let wave = |t: f64| (0.3 * t).sin();
    let x: Vec<f64> = (0..300).map(|i| wave(i as f64)).collect();
    let data = Dataset::siso(1.0, &x, &x).unwrap().with_intersample(Intersample::BandLimited);
    for d in [-2.4, -1.0, -0.3, 0.0, 0.7, 3.0, 5.25] {
        let delayed = data.delay_input(0, d).unwrap();
        let e = &delayed.experiments()[0];
        assert_eq!(e.len(), 300 - d.abs().ceil() as usize);
        for i in 100..200 {
            assert!((e.input(0)[i] - wave(e.start_s + i as f64 - d)).abs() < 1e-5, "{d}");
            assert_eq!(e.output(0)[i], wave((e.start_s + i as f64).round()));
        }
    }
}

#[test]
fn exact_gaps_are_found_filled_and_split_at() {
    let nan = f64::NAN;
    let u = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, nan];
    let y = [nan, 1.0, nan, 3.0, nan, nan, 6.0];
    let data = Dataset::siso(1.0, &u, &y).unwrap();
    let gaps: Vec<_> = data.gaps().into_iter().map(|g| (g.channel, g.rows)).collect();
    let output = Channel::Output(0);
    assert_eq!(gaps, [(Channel::Input(0), 6..7), (output, 0..1), (output, 2..3), (output, 4..6)]);
    let filled = data.fill_gaps(1).unwrap();
    assert_eq!(filled.experiments()[0].output(0)[2], 2.0);
    assert_eq!(filled.gaps().len(), 3);
    let parts = filled.without_gaps(2).unwrap();
    assert_eq!(parts.experiments().len(), 1);
    assert_eq!((parts.experiments()[0].start_s, parts.experiments()[0].len()), (1.0, 3));
    assert!(matches!(data.without_gaps(9), Err(IdentError::TooFewSamples { samples: 1, parameters: 9 })));
}

#[test]
fn exact_excitation_counts_sines() {
    let sines = |count: usize, size: f64| -> Vec<f64> {
        let at = |t: usize| (1..=count).map(|k| size * (0.4 * k as f64 * t as f64 + k as f64).sin()).sum();
        (0..2000).map(at).collect()
    };
    for count in 1..=5 {
        for size in [1e-9, 1.0, 1e9] {
            let u = sines(count, size);
            let found = ExcitationOptions::default().of_inputs(&Dataset::siso(1.0, &u, &u).unwrap()).unwrap();
            assert_eq!((found.order, found.at_least), (2 * count, false), "{:?}", found.levels);
        }
    }
    let white = Noise::new(5).normals(2000);
    let found = ExcitationOptions::default().of_inputs(&Dataset::siso(1.0, &white, &white).unwrap()).unwrap();
    assert!(found.at_least && found.levels[29] > 0.5);
    // With noise in the input, what the noise alone excites does not count.
    let noisy: Vec<f64> = sines(2, 1.0).iter().zip(&white).map(|(s, w)| s + 0.01 * w).collect();
    let noisy = Dataset::siso(1.0, &noisy, &noisy).unwrap();
    assert_eq!(ExcitationOptions { noise: vec![0.01], ..Default::default() }.of_inputs(&noisy).unwrap().order, 4);
    assert!(ExcitationOptions::default().of_inputs(&noisy).unwrap().at_least);
}

#[test]
fn exact_proportional_inputs_and_silent_loops_excite_nothing() {
    let u = Noise::new(6).normals(500);
    let inputs = Mat::from_fn(500, 2, |i, j| u[i] * [1e-6, 3e6][j]);
    let twins = Dataset::new(1.0, inputs, Mat::zeros(500, 1)).unwrap();
    assert_eq!(ExcitationOptions::default().of_inputs(&twins).unwrap().order, 0);
    let zero = Dataset::siso(1.0, &[0.0; 50], &[0.0; 50]).unwrap();
    assert_eq!(ExcitationOptions::default().of_inputs(&zero).unwrap().order, 0);
    // u = −2 y without a reference: input and output tell nothing apart.
    let back: Vec<f64> = u.iter().map(|y| -2.0 * y).collect();
    let looped = Dataset::siso(1.0, &back, &u).unwrap();
    assert_eq!(ExcitationOptions::default().of_inputs_and_outputs(&looped).unwrap().order, 0);
    assert!(ExcitationOptions::default().of_inputs(&looped).unwrap().order == 30);
    let short = Dataset::siso(1.0, &[1.0], &[1.0]).unwrap();
    assert!(matches!(ExcitationOptions::default().of_inputs(&short), Err(IdentError::TooFewSamples { .. })));
}
