//! Spectra, correlations and delays.

use std::f64::consts::{PI, TAU};

use signal::correlation::{auto_correlation, cross_correlation, delay_by_correlation};
use signal::derivative::smoothed_derivative;
use signal::excitation::{Random, Timing, held_noise};
use signal::resample::{Interpolation, decimate, fractional_delay, interpolate_at};
use signal::spectrum::{Welch, cross_spectrum, dft_at, fft_frequencies_hz, fft_real, peaks, power_spectrum};
use signal::window::Window;
use signal::{Complex64, Signal, SignalError, Sos};

use crate::{assert_close, record};

/// SciPy 1.17: `x` the common record, `y[t] = 0.7 x[t−1] + 0.3 cos(0.9 t)` (circular);
/// `welch(x, 1000, nperseg=16)`, `csd(x, y, …)`, `coherence(x, y, …)`.
#[test]
fn ref_welch_spectra() {
    let x = record();
    let y: Vec<f64> = (0..60).map(|t| 0.7 * x[(t + 59) % 60] + 0.3 * (0.9 * t as f64).cos()).collect();
    let s = cross_spectrum(&x, &y, 1e-3, Welch::half_overlapping(16)).unwrap();
    let pxx = [
        0.000881716386138639,
        0.0035167492408390275,
        0.0005632463902562846,
        9.214240254432228e-05,
        0.0011655473906355266,
        0.0007306824483367027,
        1.1250867519937469e-05,
        3.91804542954771e-07,
        4.792813526761819e-08,
    ];
    let re = [
        0.0006143048360426449,
        0.002387587335503323,
        0.0004653601134777612,
        0.00012445719552212601,
        -5.10812952114799e-05,
        -7.426719201053333e-05,
        -6.275031883301156e-07,
        -5.121750942173655e-10,
        1.531100123640521e-09,
    ];
    let im = [
        0.0,
        -0.0007618136201141444,
        -0.00016724946936740536,
        -0.00012052231280804379,
        -0.0008293301020445446,
        -0.0005045274205624646,
        -7.910248315974837e-06,
        -2.662934337043046e-07,
        0.0,
    ];
    let coherence = [
        0.9338535586316541,
        0.9750754672168476,
        0.5023381504916453,
        0.9475191168217011,
        0.9994576636381933,
        0.9998732676135881,
        0.997529879926928,
        0.8924232929830165,
        0.001892303397933194,
    ];
    assert_close(&s.pxx, &pxx, 1e-16);
    assert_close(&s.pxy.iter().map(|v| v.re).collect::<Vec<_>>(), &re, 1e-16);
    assert_close(&s.pxy.iter().map(|v| v.im).collect::<Vec<_>>(), &im, 1e-16);
    assert_close(&s.coherence(), &coherence, 1e-10);
}

#[test]
fn exact_fourier_sum_equals_the_fast_transform() {
    let x: Vec<f64> = record().repeat(20);
    let fast = fft_real(&x).unwrap();
    let slow = dft_at(&x, 0.01, &fft_frequencies_hz(x.len(), 0.01)).unwrap();
    assert!(fast.iter().zip(&slow).all(|(a, b)| (a - b).norm() < 1e-9));
}

#[test]
fn exact_correlation_equals_its_definition() {
    let x = record();
    let y: Vec<f64> = x.iter().rev().copied().collect();
    let r = cross_correlation(&x, &y, 7).unwrap();
    for (lag, value) in r.lags().zip(&r.values) {
        let sum: f64 =
            (0..60_i64).filter(|t| (0..60).contains(&(t + lag))).map(|t| x[t as usize] * y[(t + lag) as usize]).sum();
        assert!((value - sum / 60.0).abs() < 1e-12, "lag {lag}");
    }
    let own = auto_correlation(&x, 5).unwrap();
    assert!((own.at(3) - own.at(-3)).abs() < 1e-14);
}

/// Noise of limited band; the second record is delayed exactly, in the frequency domain, by the sum of its tones.
#[test]
fn exact_sub_sample_delay_is_found_by_correlation() {
    let mut random = Random::new(3);
    let tones: Vec<[f64; 3]> =
        (0..60).map(|_| [0.3 * random.uniform(), random.normal(), TAU * random.uniform()]).collect();
    let at = |t: f64| tones.iter().map(|[f, a, p]| a * (TAU * f * t + p).sin()).sum::<f64>();
    let x: Vec<f64> = (0..20_000).map(|t| at(f64::from(t))).collect();
    for delay in [-4.75, 0.0, 0.31, 6.5] {
        let y: Vec<f64> = (0..20_000).map(|t| -2.0 * at(f64::from(t) - delay)).collect();
        let found = delay_by_correlation(&x, &y, 1e-3, 0.02).unwrap();
        assert!((found.delay_s * 1e3 - delay).abs() < 2e-3, "{} for {delay}", found.delay_s * 1e3);
        assert!(found.coefficient < -0.99 && !found.at_edge);
    }
    assert_eq!(delay_by_correlation(&x, &vec![1.0; 20_000], 1e-3, 0.02), Err(SignalError::Constant));
}

fn tone(freq: f64, length: usize) -> Signal {
    Signal::new(0.0, 1.0, (0..length).map(|t| (TAU * freq * t as f64).sin()).collect()).unwrap()
}

#[test]
fn exact_band_limited_interpolation_of_tones() {
    for (freq, tolerance) in [(0.05, 1e-5), (0.4, 1e-5), (0.45, 1e-4)] {
        let x = tone(freq, 400);
        let times: Vec<f64> = (0..200).map(|i| 100.0 + 0.937 * f64::from(i)).collect();
        let y = interpolate_at(&x, &times, Interpolation::BandLimited).unwrap();
        let truth: Vec<f64> = times.iter().map(|t| (TAU * freq * t).sin()).collect();
        assert_close(&y, &truth, tolerance);
    }
    let delayed = fractional_delay(&tone(0.1, 300), 2.5, Interpolation::BandLimited).unwrap();
    assert!((delayed.samples[150] - (TAU * 0.1 * 147.5).sin()).abs() < 1e-5);
}

#[test]
fn exact_instants_outside_the_record_are_refused() {
    let x = tone(0.1, 10);
    for time_s in [-0.1, 9.1, f64::NAN] {
        let result = interpolate_at(&x, &[time_s], Interpolation::Linear);
        assert!(matches!(result, Err(SignalError::OutsideRecord { .. })));
    }
}

#[test]
fn exact_decimation_keeps_low_tones_and_drops_high_ones() {
    let low = decimate(&tone(0.01, 2000), 5).unwrap();
    let truth: Vec<f64> = (0..400).map(|t| (TAU * 0.05 * f64::from(t)).sin()).collect();
    assert_eq!(low.sample_time_s, 5.0);
    assert_close(&low.samples[50..350], &truth[50..350], 1e-6);
    let high = decimate(&tone(0.2, 2000), 5).unwrap();
    assert!(high.samples[50..350].iter().all(|v| v.abs() < 1e-6));
}

#[test]
fn exact_smoothed_derivative_of_a_tone_in_the_pass_band() {
    let slope = smoothed_derivative(&tone(0.02, 2000), 0.2, 6).unwrap();
    let truth: Vec<f64> = (0..2000).map(|t| TAU * 0.02 * (TAU * 0.02 * f64::from(t)).cos()).collect();
    assert_close(&slope.samples[200..1800], &truth[200..1800], 1e-4 * TAU * 0.02);
}

#[test]
fn stat_response_estimate_finds_the_filter() {
    let timing = Timing { sample_time_s: 1e-3, length: 200_000 };
    let u = held_noise(&mut Random::new(11), timing, 0.0, 1.0, 1e-3).unwrap();
    let filter = Sos::butterworth_lowpass(2, 100.0, 1e-3).unwrap();
    let y = filter.filter(&u.samples, &mut filter.state_at_rest());
    let s = cross_spectrum(&u.samples, &y, 1e-3, Welch::half_overlapping(1024)).unwrap();
    let response = s.response_h1();
    let worst = response.iter().zip(&s.freq_hz).filter(|(_, f)| **f < 200.0);
    let worst = worst.map(|(h, f)| (h - filter.response(*f)).norm()).fold(0.0, f64::max);
    assert!(worst < 0.02, "{worst}");
    assert!(Complex64::norm(filter.response(100.0)) < 0.71);
}

/// SciPy 1.17: `welch(x, 1000, nperseg=16, noverlap=12, window='blackman')` of the common record.
#[test]
fn ref_welch_with_another_window() {
    let welch = Welch { segment: 16, overlap: 12, window: Window::Blackman };
    let psd = power_spectrum(&record(), 1e-3, welch).unwrap();
    let expected = [
        0.0009293376395731978,
        0.002964576919820773,
        0.000824696928364606,
        0.00020027108573460151,
        0.0010390549718747929,
        0.0007316523123705995,
        5.211331304761558e-05,
        2.9430137846198024e-08,
        1.436932203247142e-09,
    ];
    assert_close(&psd.density, &expected, 1e-16);
}

/// White noise: the scatter of the density is that of the stated degrees of freedom, and the interval holds the truth
/// as often as it says.
#[test]
fn stat_welch_degrees_of_freedom_and_intervals() {
    for (overlap, window) in [(0, Window::Hann), (32, Window::Hann), (48, Window::Blackman), (60, Window::Hamming)] {
        let (runs, mut inside, mut total, mut moments) = (400, 0, 0, [0.0; 2]);
        let mut freedom = 0.0;
        for run in 0..runs {
            let timing = Timing { sample_time_s: 1.0, length: 640 };
            let x = held_noise(&mut Random::new(run), timing, 0.0, 1.0, 1.0).unwrap();
            let psd = power_spectrum(&x.samples, 1.0, Welch { segment: 64, overlap, window }).unwrap();
            freedom = psd.degrees_of_freedom[1];
            // Every fourth frequency: neighbours share what the window smears.
            for k in (4..32).step_by(4) {
                let [low, high] = psd.interval(0.9).unwrap()[k];
                inside += usize::from(low < 2.0 && 2.0 < high);
                total += 1;
                moments[0] += psd.density[k];
                moments[1] += psd.density[k].powi(2);
            }
        }
        let [mean, square] = moments.map(|m| m / total as f64);
        let measured = 2.0 * mean * mean / (square - mean * mean);
        assert!((measured / freedom - 1.0).abs() < 0.12, "{measured} for {freedom}");
        let coverage = inside as f64 / total as f64;
        assert!((coverage - 0.9).abs() < 0.025, "{coverage}");
    }
}

/// Unrelated signals exceed the threshold as often as it says; the stated variance of the response is that measured.
#[test]
fn stat_coherence_threshold_and_response_variance() {
    let (runs, mut exceeded, mut total, mut spread, mut stated) = (300, 0, 0, 0.0, 0.0);
    for run in 0..runs {
        let timing = Timing { sample_time_s: 1.0, length: 960 };
        let mut random = Random::new(run);
        let x = held_noise(&mut random, timing, 0.0, 1.0, 1.0).unwrap();
        let v = held_noise(&mut random, timing, 0.0, 1.0, 1.0).unwrap();
        let y: Vec<f64> = x.samples.iter().zip(&v.samples).map(|(x, v)| 0.7 * x + v).collect();
        let unrelated = cross_spectrum(&x.samples, &v.samples, 1.0, Welch::half_overlapping(64)).unwrap();
        let related = cross_spectrum(&x.samples, &y, 1.0, Welch::half_overlapping(64)).unwrap();
        let threshold = unrelated.coherence_threshold(0.05).unwrap();
        let (coherence, variance) = (unrelated.coherence(), related.response_h1_variance());
        for k in (4..32).step_by(4) {
            exceeded += usize::from(coherence[k] > threshold);
            total += 1;
            spread += (related.response_h1()[k] - 0.7).norm_sqr();
            stated += variance[k];
        }
    }
    let rate = f64::from(exceeded as u32) / f64::from(total);
    assert!((rate - 0.05).abs() < 0.015, "{rate}");
    assert!((spread / stated - 1.0).abs() < 0.1, "{}", spread / stated);
}

/// White noise has no peaks: of 300 spectra at most a part of 5 % has one by chance, whatever its height. The bound is
/// four deviations of the binomial above that.
#[test]
fn stat_peaks_of_noise_are_rare_and_a_sine_in_noise_is_found() {
    let welch = Welch::half_overlapping(256);
    let found = |seed: u64, amplitude: f64| {
        let mut random = Random::new(seed);
        let x: Vec<f64> = (0..6000).map(|t| random.normal() + amplitude * (0.9 * t as f64).sin()).collect();
        let power = power_spectrum(&x, 1.0, welch).unwrap();
        let level = 1.0 - 2.0 * 0.05 / power.freq_hz.len() as f64;
        let ends: Vec<_> = power.interval(level).unwrap().iter().map(|[low, high]| (*low, *high)).collect();
        peaks(&power.freq_hz, &power.density, &ends, 2, 1.0).iter().map(|p| power.freq_hz[p.index]).collect::<Vec<_>>()
    };
    let false_alarms = (0..300).filter(|seed| !found(*seed, 0.0).is_empty()).count();
    assert!(false_alarms <= 15 + 4 * 4, "{false_alarms}");
    for seed in 0..20 {
        let at = found(seed, 0.7);
        assert!(at.iter().any(|f| (f - 0.9 / std::f64::consts::TAU).abs() < 1.0 / 256.0), "{at:?}");
    }
}

#[test]
fn exact_slopes_are_no_peaks_and_widths_count_once() {
    let freq_hz: Vec<f64> = (0..400).map(f64::from).collect();
    let mut power: Vec<f64> = freq_hz.iter().map(|f| 1.0 / (1.0 + f * f)).collect();
    for (offset, factor) in [(99, 8.0), (100, 20.0), (101, 9.0), (102, 10.0)] {
        power[offset] *= factor;
    }
    let sure: Vec<(f64, f64)> = power.iter().map(|p| (*p, *p)).collect();
    let places = |excess: f64| peaks(&freq_hz, &power, &sure, 2, excess).iter().map(|p| p.index).collect::<Vec<_>>();
    assert_eq!(places(4.0), [100]);
    assert!(places(30.0).is_empty());
    let unsure = vec![(0.0, f64::INFINITY); power.len()];
    assert!(peaks(&freq_hz, &power, &unsure, 2, 4.0).is_empty());
    assert!(peaks(&[], &[], &[], 2, 4.0).is_empty());
    // A dip in the middle of a bump makes two peaks of it where it is deep and certain.
    let bump: Vec<f64> = (0..400).map(|k| 1.0 + 50.0 * (-((f64::from(k) - 100.0) / 12.0).powi(2)).exp()).collect();
    let dipped = |factor: f64| {
        let mut values = bump.clone();
        values[100] *= factor;
        let ends: Vec<(f64, f64)> = values.iter().map(|v| (0.9 * v, 1.1 * v)).collect();
        peaks(&freq_hz, &values, &ends, 1, 4.0).len()
    };
    assert_eq!((dipped(0.8), dipped(0.3)), (1, 2));
}

/// White noise of a known coherence through a phase of π/2 of a delay at a quarter of the sample rate: intervals of
/// coherence, magnitude and phase hold the truth as often as they say.
#[test]
fn stat_intervals_of_coherence_and_cross_spectrum() {
    let cases = [(0.02, 640), (0.3, 640), (0.3, 4000), (0.9, 640), (0.99, 640)];
    for (coherence, length) in cases {
        let (mut total, mut held) = (0.0, [0.0; 3]);
        let gain = f64::sqrt(coherence / (1.0 - coherence));
        for run in 0..400_000 / length as u64 {
            let mut random = Random::new(run);
            let x: Vec<f64> = (0..length).map(|_| random.normal()).collect();
            let y: Vec<f64> = x.iter().map(|x| -gain * x + random.normal()).collect();
            let s = cross_spectrum(&x, &y, 1.0, Welch::half_overlapping(64)).unwrap();
            let intervals = [s.coherence_interval(0.95), s.magnitude_interval(0.95), s.phase_interval(0.95)];
            let intervals = intervals.map(Result::unwrap);
            for k in (4..32).step_by(4) {
                let phase = intervals[2][k];
                // The phase is π, or −π.
                let has_phase = [-1.0, 1.0].iter().any(|s| phase[0] <= s * PI && s * PI <= phase[1]);
                let inside =
                    |which: usize, truth: f64| intervals[which][k][0] <= truth && truth <= intervals[which][k][1];
                let here = [inside(0, coherence), inside(1, 2.0 * gain), has_phase];
                for (count, held) in held.iter_mut().zip(here) {
                    *count += f64::from(u8::from(held));
                }
                total += 1.0;
            }
        }
        let share = held.map(|h| h / total);
        let bound = 3.0 * (0.95_f64 * 0.05 / total).sqrt();
        assert!((share[0] - 0.95).abs() < bound + 0.01, "coherence {coherence}: {share:?}");
        // Those of magnitude and phase are approximations; frequencies of a record share what leaks.
        assert!(share[1..].iter().all(|s| (s - 0.95).abs() < bound + 0.01), "coherence {coherence}: {share:?}");
    }
}

#[test]
fn exact_intervals_where_nothing_or_everything_is_known() {
    let mut random = Random::new(3);
    let x: Vec<f64> = (0..640).map(|_| random.normal()).collect();
    let same = cross_spectrum(&x, &x, 1.0, Welch::half_overlapping(64)).unwrap();
    let [low, high] = same.coherence_interval(0.95).unwrap()[5];
    assert!(low > 1.0 - 1e-9 && high == 1.0, "{low} {high}");
    let [low, high] = same.phase_interval(0.95).unwrap()[5];
    assert!(low.abs() < 1e-6 && high.abs() < 1e-6);
    let power = power_spectrum(&x, 1.0, Welch::half_overlapping(64)).unwrap().interval(0.95).unwrap()[5];
    let magnitude = same.magnitude_interval(0.95).unwrap()[5];
    assert_close(&magnitude, &power, 1e-9 * power[1]);
    for k in [0, 32] {
        assert_eq!(same.coherence_interval(0.95).unwrap()[k], [0.0, 1.0]);
        assert_eq!(same.magnitude_interval(0.95).unwrap()[k], [0.0, f64::INFINITY]);
    }
    let one = cross_spectrum(&x, &x, 1.0, Welch::half_overlapping(640)).unwrap();
    assert_eq!(one.coherence_interval(0.95).unwrap()[5], [0.0, 1.0]);
    assert!(one.coherence_interval(1.0).is_err());
}
