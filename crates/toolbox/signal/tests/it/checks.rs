//! Clocks, quality, hold and excitation.

use signal::clock::check_clock;
use signal::excitation::{Random, Step, Timing, held_noise, levels, random_binary};
use signal::quality::{QualityOptions, check_quality};
use signal::resample::hold;
use signal::{Signal, SignalError};

#[test]
fn exact_rounded_stamps_give_the_true_sample_time() {
    // 300 Hz stamped to the millisecond: intervals of 3 and 4 ms.
    let stamps: Vec<f64> = (0..5000).map(|i| (f64::from(i) / 0.3).round() / 1e3).collect();
    let check = check_clock(&stamps).unwrap();
    assert!((check.sample_time_s - 1.0 / 300.0).abs() < 1e-6);
    assert!(check.gaps.is_empty() && check.non_monotonic.is_empty());
    assert!(check.is_uniform(0.21) && !check.is_uniform(0.1));
}

#[test]
fn exact_gaps_and_steps_back_are_located() {
    let stamps = [0.0, 0.1, 0.2, 0.3, 0.3, 0.4, 0.9, 0.85, 0.95, 1.05, 1.15];
    let check = check_clock(&stamps).unwrap();
    assert_eq!(check.non_monotonic, vec![4, 7]);
    assert_eq!((check.gaps[0].between.clone(), check.gaps[0].missing), (5..6, 4));
    assert_eq!(check.missing_samples, 4);
    assert!(!check.is_uniform(0.1));
    assert!(matches!(check_clock(&[1.0]), Err(SignalError::TooShort { .. })));
    assert!(matches!(check_clock(&[1.0, 1.0]), Err(SignalError::TooShort { .. })));
}

/// Stamps k + ε, without those of `left_out`; ε is spread evenly over ±`jitter` as the fractions of multiples of k² are
/// (Weyl).
fn shaky(samples: u32, jitter: f64, left_out: &[u32], seed: u32) -> Vec<f64> {
    let spread = |k: f64| (k * k * f64::from(seed).sqrt() * 0.618_033_988_749_895).fract();
    let stamps = (0..samples).map(|k| 0.001 * (f64::from(k) + jitter * (2.0 * spread(f64::from(k)) - 1.0)));
    (0..samples).zip(stamps).filter(|(k, _)| !left_out.contains(k)).map(|(_, t)| t).collect()
}

#[test]
fn stat_early_and_late_stamps_are_not_missing_samples() {
    for (seed, jitter) in [(2, 0.1), (3, 0.3), (5, 0.4), (7, 0.4)] {
        let check = check_clock(&shaky(6000, jitter, &[], seed)).unwrap();
        assert!((check.sample_time_s / 0.001 - 1.0).abs() < 1e-3, "{jitter}: {}", check.sample_time_s);
        assert!(check.gaps.is_empty(), "{jitter}: {:?}", check.gaps);
    }
    let left_out = [1000, 2000, 2001, 2002, 4000];
    let check = check_clock(&shaky(6000, 0.3, &left_out, 13)).unwrap();
    let found: Vec<(usize, usize)> = check.gaps.iter().map(|g| (g.between.start, g.missing)).collect();
    assert_eq!(found, [(999, 1), (1998, 3), (3995, 1)]);
}

#[test]
fn exact_one_late_stamp_is_no_gap_and_a_clock_may_start_anew() {
    let late: Vec<f64> = (0..100).map(|k| f64::from(k) + if k == 50 { 0.7 } else { 0.0 }).collect();
    assert_eq!(check_clock(&late).unwrap().missing_samples, 0);
    let anew: Vec<f64> = late.iter().map(|t| if *t > 80.0 { t + 7.5 } else { *t }).collect();
    let check = check_clock(&anew).unwrap();
    assert_eq!((check.gaps.len(), check.gaps[0].between.start), (1, 80));
}

#[test]
fn regress_gaps_that_no_number_counts() {
    let check = check_clock(&[0.0, 0.001, 0.002, 0.003, 0.004, 1e18, 2e18, 3e18]).unwrap();
    assert_eq!((check.gaps.len(), check.missing_samples), (3, usize::MAX));
}

#[test]
fn exact_clipping_and_constancy_are_found() {
    let x: Vec<f64> = (0..200).map(|i| (0.1 * f64::from(i)).sin().min(0.9)).collect();
    let found = check_quality(&x, &QualityOptions::default()).unwrap();
    assert_eq!(found.clipped_high.len(), 3);
    assert!(found.clipped_high.iter().all(|run| x[run.clone()].iter().all(|v| *v == 0.9)));
    assert!(found.clipped_low.is_empty() && found.spikes.is_empty());
    assert!(check_quality(&[2.0; 50], &QualityOptions::default()).unwrap().constant);
    assert!(check_quality(&[], &QualityOptions::default()).unwrap().constant);
}

/// Steps of a command depart from their surroundings; a spike among them departs much further.
#[test]
fn exact_one_wild_sample_among_steps_is_a_spike() {
    let mut x: Vec<f64> = (0..2000).map(|t: usize| ((t / 7 % 2) as f64 - 0.5) + 0.01 * (t as f64).sin()).collect();
    x[777] = 1e6;
    assert_eq!(check_quality(&x, &QualityOptions::default()).unwrap().spikes, [777]);
}

/// Gaussian noise behind lags in series, which colours it.
fn filtered(seed: u64, length: usize, poles: &[f64]) -> Vec<f64> {
    let mut random = Random::new(seed);
    let mut state = vec![0.0; poles.len()];
    let mut next = || {
        let mut v = random.normal();
        for (x, pole) in state.iter_mut().zip(poles) {
            *x = pole * *x + (1.0 - pole.abs()) * v;
            v = *x;
        }
        v
    };
    (0..200).for_each(|_| _ = next());
    (0..length).map(|_| next()).collect()
}

const COLOURS: [&[f64]; 7] = [&[], &[0.5], &[0.9], &[0.5, 0.5], &[0.8, 0.8], &[0.9, 0.9, 0.9], &[-0.5]];

/// Nominally one series in a thousand; of 2100 series, 8 or more alarms have a probability of 0.2 %.
#[test]
fn stat_gaussian_data_of_any_colour_have_no_spikes() {
    for length in [300, 3000] {
        let has_spike = |x: &[f64]| !check_quality(x, &QualityOptions::default()).unwrap().spikes.is_empty();
        let alarms = |poles: &[f64]| (0..300).filter(|seed| has_spike(&filtered(*seed, length, poles))).count();
        let found: Vec<usize> = COLOURS.iter().map(|poles| alarms(poles)).collect();
        assert!(found.iter().all(|count| *count <= 3), "more than 1 %: {found:?} of 300");
        assert!(found.iter().sum::<usize>() < 8, "{found:?}");
    }
}

#[test]
fn stat_a_spike_of_ten_deviations_is_found_among_data_of_any_colour() {
    for poles in COLOURS {
        for length in [300, 3000] {
            let is_found = |seed: &u64| {
                let mut x = filtered(*seed, length, poles);
                let deviation = (x.iter().map(|v| v * v).sum::<f64>() / length as f64).sqrt();
                let at = 20 + (*seed as usize * 37) % (length - 40);
                x[at] += if seed.is_multiple_of(2) { 10.0 } else { -10.0 } * deviation;
                check_quality(&x, &QualityOptions::default()).unwrap().spikes == [at]
            };
            let found = (0..100).filter(is_found).count();
            assert!(found >= 97, "{found} of 100 behind {poles:?}, {length} samples");
        }
    }
}

#[test]
fn exact_a_spike_of_three_samples_is_found_whole() {
    let mut x = filtered(3, 500, &[0.9]);
    x[100..103].fill(30.0);
    assert_eq!(check_quality(&x, &QualityOptions::default()).unwrap().spikes, [100, 101, 102]);
}

/// The speed of an engine in a cycle, rpm: corners at seconds, and the firing ripple of so many cylinders (four
/// strokes), whose amplitude is that of the load over inertia and speed. With a gate the samples are means over their
/// raster.
fn cycle_with_ripple(seed: u64, raster_s: f64, cylinders: f64, has_gate: bool) -> Vec<f64> {
    let mut random = Random::new(seed);
    let seconds = 240;
    let mut speed = 900.0;
    let mut corners = Vec::new();
    for second in 0..=seconds {
        // A third of the time the engine idles, as in a cycle of a town.
        let idles = second / 20 % 3 == 0;
        speed = if idles { 850.0 } else { (speed + 250.0 * random.normal()).clamp(850.0, 4800.0) };
        corners.push((speed, if idles { 8.0 } else { 20.0 + 120.0 * random.uniform() }));
    }
    let fine_s = 1e-3;
    let mut phase = 0.0;
    let fine: Vec<f64> = (0..(f64::from(seconds) / fine_s) as usize)
        .map(|k| {
            let time = k as f64 * fine_s;
            let (low, share) = (time as usize, time.fract());
            let between = |a: f64, b: f64| a + share * (b - a);
            let (rpm, load) =
                (between(corners[low].0, corners[low + 1].0), between(corners[low].1, corners[low + 1].1));
            phase += std::f64::consts::TAU * 0.5 * cylinders * rpm / 60.0 * fine_s;
            let ripple = 900.0 * load / (rpm * cylinders) * (phase.sin() + 0.3 * (2.0 * phase).sin());
            rpm + ripple + 0.3 * random.normal()
        })
        .collect();
    let per = (raster_s / fine_s).round() as usize;
    fine.chunks_exact(per).map(|cell| if has_gate { cell.iter().sum::<f64>() / per as f64 } else { cell[0] }).collect()
}

const RASTERS_S: [f64; 8] = [0.005, 0.008, 0.01, 0.02, 0.025, 0.05, 0.1, 0.2];

/// Where a sample lasts 0.2 s, an engine may turn round within one: of such a raster two samples in 1200 may be taken
/// for a spike.
#[test]
fn exact_the_ripple_of_firing_has_no_spikes_on_any_raster() {
    for raster_s in RASTERS_S {
        for cylinders in [3.0, 4.0, 5.0, 6.0] {
            for has_gate in [true, false] {
                let x = cycle_with_ripple(7, raster_s, cylinders, has_gate);
                let found = check_quality(&x, &QualityOptions::default()).unwrap().spikes;
                let most = if raster_s > 0.1 { 2 } else { 0 };
                assert!(found.len() <= most, "{raster_s} s, {cylinders} cylinders, means {has_gate}: {found:?}");
            }
        }
    }
}

/// A spike beside a corner may take a sample of the corner with it.
#[test]
fn exact_spikes_among_the_ripple_of_firing_are_found() {
    for raster_s in RASTERS_S {
        for cylinders in [3.0, 6.0] {
            let mut x = cycle_with_ripple(7, raster_s, cylinders, true);
            let planted: Vec<usize> = (1..6).map(|part| part * x.len() / 6 + part).collect();
            for (number, at) in planted.iter().enumerate() {
                let far = if number % 2 == 0 { 20_000.0 } else { 0.0 };
                x[*at] = far - x[*at];
            }
            let found = check_quality(&x, &QualityOptions::default()).unwrap().spikes;
            // From 0.1 s on most samples of the ramps are the median of their window, as those of a held signal are.
            // The deviation of all then serves, which the large spikes make larger than a wrong sign. These alone have
            // to be found there.
            let every = if raster_s < 0.1 { 1 } else { 2 };
            let is_found = planted.iter().step_by(every).all(|at| found.contains(at));
            assert!(is_found && found.len() <= planted.len() + 2, "{raster_s} s, {cylinders} cylinders: {found:?}");
        }
    }
}

/// Where every other sample of a stretch stands out, the raster folds an oscillation.
#[test]
fn exact_a_stretch_that_alternates_is_no_spike() {
    let mut x = filtered(3, 3000, &[0.9]);
    for k in 1500..1520 {
        x[k] += if k % 2 == 0 { 12.0 } else { -12.0 };
    }
    assert!(check_quality(&x, &QualityOptions::default()).unwrap().spikes.is_empty());
}

#[test]
fn exact_commands_of_levels_have_no_spikes() {
    let timing = Timing { sample_time_s: 1.0, length: 2000 };
    let x = random_binary(&mut Random::new(5), timing, [0.0, 1.0], 1.0, 0.5).unwrap();
    assert!(check_quality(&x.samples, &QualityOptions::default()).unwrap().spikes.is_empty());
}

#[test]
fn exact_hold_takes_the_last_sample_despite_rounding() {
    let x = Signal::new(0.0, 0.1, (0..100).map(f64::from).collect()).unwrap();
    let times: Vec<f64> = (0..100).map(|i| x.time_s(i)).collect();
    assert_eq!(hold(&x, &times).unwrap(), x.samples);
    assert!(matches!(hold(&x, &[-0.01]), Err(SignalError::OutsideRecord { .. })));
}

#[test]
fn exact_slices_side_by_side_share_and_lose_nothing() {
    let x = Signal::new(5.0, 0.1, (0..50).map(f64::from).collect()).unwrap();
    let (left, right) = (x.slice(0.0, 7.3), x.slice(7.3, 100.0));
    assert_eq!([left.samples, right.samples].concat(), x.samples);
    assert!((right.start_s - 7.3).abs() < 1e-12);
    assert!(x.slice(7.0, 6.0).is_empty() && x.slice(f64::NAN, f64::NAN).is_empty());
}

/// The first numbers after seeding with zero, from the test of `Xoshiro256PlusPlus` in the `rand` crate.
#[test]
fn ref_generator_numbers() {
    let mut random = Random::new(0);
    for expected in [5_987_356_902_031_041_503_u64, 7_051_070_477_665_621_255, 6_633_766_593_972_829_180] {
        assert_eq!(random.uniform(), (expected >> 11) as f64 / 2.0_f64.powi(53));
    }
}

#[test]
fn stat_noise_has_the_moments_asked_for() {
    let timing = Timing { sample_time_s: 1e-3, length: 200_000 };
    let x = held_noise(&mut Random::new(9), timing, 3.0, 2.0, 2e-3).unwrap();
    let mean = x.mean().unwrap();
    let variance = x.map(|v| (v - mean).powi(2)).mean().unwrap();
    // Four standard deviations of each estimate for 100 000 independent values.
    assert!((mean - 3.0).abs() < 4.0 * 2.0 / 1e5_f64.sqrt());
    assert!((variance - 4.0).abs() < 4.0 * 4.0 * (2.0 / 1e5_f64).sqrt());
}

#[test]
fn exact_levels_last_as_long_as_asked() {
    let step = |value, duration_s| Step { value, duration_s };
    let x = levels(0.5, &[step(1.0, 1.0), step(4.0, 1.5)]).unwrap();
    assert_eq!(x.samples, vec![1.0, 1.0, 4.0, 4.0, 4.0]);
    assert!(levels(0.5, &[step(1.0, -1.0)]).is_err());
}
