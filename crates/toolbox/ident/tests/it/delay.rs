use faer::Mat;
use ident::delay::{ArxDelay, FractionalDelay, ImpulseDelay, PeakDelay, PhaseDelay};
use ident::{Dataset, IdentError, Intersample, Trend, TrendScope, TrendShape};

use crate::noise::Noise;
use testdata::shared;

#[allow(clippy::disallowed_methods)]
fn recorded(name: &str, rows: std::ops::Range<usize>) -> Option<Dataset> {
    let text = std::fs::read_to_string(shared(name)?).unwrap();
    let numbers = |line: &str| -> Vec<f64> { line.split(',').map(|v| v.trim().parse().unwrap()).collect() };
    let table: Vec<Vec<f64>> = text.lines().skip(1).map(numbers).collect();
    let column = |j: usize| -> Vec<f64> { table.iter().map(|r| r[j]).collect() };
    let data = Dataset::siso(1.0, &column(0), &column(1)).unwrap().rows(rows).unwrap();
    Some(Trend::estimate(&data, TrendShape::Mean, TrendScope::Common).unwrap().remove(&data).unwrap())
}

#[test]
fn ref_the_hair_dryer_has_a_delay_of_three() {
    let Some(data) = recorded("reference/peers/dryer_slicot.csv", 0..300) else { return };
    let arx = ArxDelay { na: 2, nb: 2, lowest: 0, highest: 10, ..Default::default() }.estimate(&data).unwrap();
    assert_eq!(arx.delays, [3], "{:?}", &arx.candidates[..3]);
    assert!(arx.standard_errors[0] < 0.1);
    let start = &ImpulseDelay { na: 4, spacing: 1, lags: 12, level: 0.99 }.estimate(&data).unwrap()[0];
    assert_eq!(start.delay, Some(3), "{start:?}");
}

#[test]
fn ref_the_gas_furnace_has_a_delay_of_three() {
    let Some(data) = recorded("reference/peers/gas_furnace_seriesJ.csv", 0..296) else { return };
    let arx = ArxDelay { na: 2, nb: 3, lowest: 0, highest: 10, ..Default::default() }.estimate(&data).unwrap();
    assert_eq!(arx.delays, [3], "{:?}", &arx.candidates[..3]);
    // The slow input leaves single coefficients uncertain; the one at lag 3 stands out most.
    let start = &ImpulseDelay { na: 4, spacing: 1, lags: 12, level: 0.99 }.estimate(&data).unwrap()[0];
    let size = |i: &usize| (start.coefficients[*i] / start.standard_errors[*i]).abs();
    assert_eq!((0..12).max_by(|a, b| size(a).total_cmp(&size(b))), Some(3), "{start:?}");
    // The whitened correlation peaks at the largest response, later than the first.
    let peak = PeakDelay { whitening_order: 3, highest: 20 }.estimate(&data).unwrap();
    assert!(peak.delay.samples > 3.5 && peak.delay.samples < 6.0, "{peak:?}");
}

/// Three inputs with delays 1, 7 and 12 and a common pole.
fn three_inputs(seed: u64, rows: usize, scale: f64) -> Dataset {
    let mut noise = Noise::new(seed);
    let inputs = Mat::from_fn(rows, 3, |_, _| noise.normal());
    let mut y = vec![0.0; rows];
    for t in 12..rows {
        let fed: f64 = [(0, 1), (1, 7), (2, 12)].iter().map(|(k, d)| inputs[(t - d, *k)]).sum();
        y[t] = 0.8 * y[t - 1] + fed + 0.5 * noise.normal();
    }
    let scaled = Mat::from_fn(rows, 3, |t, k| inputs[(t, k)] * scale.powi(k as i32));
    Dataset::new(1.0, scaled, Mat::from_fn(rows, 1, |t, _| y[t] / scale)).unwrap()
}

#[test]
fn stat_delays_of_several_inputs_are_found_jointly_and_in_turns() {
    for scale in [1.0, 1e-6, 1e6] {
        let data = three_inputs(1, 1500, scale);
        // 13³ combinations are too many for a joint comparison, 3³ are not.
        let turns = ArxDelay { na: 1, nb: 1, lowest: 0, highest: 15, ..Default::default() }.estimate(&data).unwrap();
        assert_eq!(turns.delays, [1, 7, 12]);
        assert!(turns.candidates.len() < 1000);
        let starts = ImpulseDelay { na: 2, spacing: 1, lags: 16, level: 0.99 }.estimate(&data).unwrap();
        assert_eq!(starts.iter().map(|s| s.delay).collect::<Vec<_>>(), [Some(1), Some(7), Some(12)]);
    }
    let two = three_inputs(2, 1500, 1.0).channels(&[0, 1], &[0]).unwrap();
    let joint = ArxDelay { na: 1, nb: 1, lowest: 0, highest: 10, ..Default::default() }.estimate(&two).unwrap();
    assert_eq!((joint.delays, joint.candidates.len()), (vec![1, 7], 121));
}

#[test]
fn exact_the_ranking_weighs_models_as_separate_fits_would() {
    let data = three_inputs(3, 400, 1.0).channels(&[0], &[0]).unwrap();
    let ranking = ArxDelay { na: 1, nb: 2, lowest: 0, highest: 3, ..Default::default() }.estimate(&data).unwrap();
    let e = &data.experiments()[0];
    for candidate in &ranking.candidates {
        let nk = candidate.delays[0];
        // All models are compared on the rows that the longest delay leaves.
        let rows: Vec<usize> = (4..400).collect();
        let phi = Mat::from_fn(rows.len(), 3, |i, j| match j {
            0 => e.output(0)[rows[i] - 1],
            _ => e.input(0)[rows[i] - nk - (j - 1)],
        });
        let y: Vec<f64> = rows.iter().map(|t| e.output(0)[*t]).collect();
        let fit = ident::least_squares(phi.as_ref(), &y).unwrap();
        assert!((fit.cost / rows.len() as f64 / candidate.loss - 1.0).abs() < 1e-10);
    }
    assert!((ranking.candidates.iter().map(|c| c.weight).sum::<f64>() - 1.0).abs() < 1e-12);
}

/// A sum of sines below 0.4 of the sample rate that can be evaluated at any instant.
fn band_limited(seed: u64) -> impl Fn(f64) -> f64 {
    let mut noise = Noise::new(seed);
    let waves: Vec<[f64; 2]> = (0..60).map(|_| [2.2 * noise.uniform(), 6.3 * noise.uniform()]).collect();
    move |t| waves.iter().map(|[f, p]| (f * t + p).sin()).sum::<f64>() / 30.0_f64.sqrt()
}

#[test]
#[ignore = "slow"]
fn stat_subsample_delays_are_unbiased_and_as_certain_as_they_say() {
    let (rows, truth) = (1500, 3.3);
    let mut normalised = [Vec::new(), Vec::new(), Vec::new()];
    for seed in 0..60 {
        let wave = band_limited(seed);
        let mut noise = Noise::new(1000 + seed);
        let u: Vec<f64> = (0..rows).map(|t| wave(t as f64)).collect();
        let y: Vec<f64> = (0..rows).map(|t| -wave(t as f64 - truth) + 0.5 * noise.normal()).collect();
        let data = Dataset::siso(1.0, &u, &y).unwrap().with_intersample(Intersample::BandLimited);
        let phase = PhaseDelay { segment: 64, highest: 10, band_hz: Some((0.01, 0.34)) }.estimate(&data).unwrap();
        let arx = FractionalDelay(ArxDelay { na: 0, nb: 1, lowest: 0, highest: 6, ..Default::default() })
            .estimate(&data)
            .unwrap();
        let white = noise.normals(rows);
        let delayed: Vec<f64> = (0..rows).map(|t| if t < 3 { 0.0 } else { white[t - 3] } + noise.normal()).collect();
        let peak = PeakDelay { whitening_order: 5, highest: 10 };
        let peak = peak.estimate(&Dataset::siso(1.0, &white, &delayed).unwrap()).unwrap().delay;
        for (list, (found, truth)) in normalised.iter_mut().zip([(phase, truth), (arx, truth), (peak, 3.0)]) {
            list.push((found.samples - truth) / found.standard_error);
        }
    }
    for (name, list) in ["phase", "arx", "peak"].iter().zip(&normalised) {
        let mean = list.iter().sum::<f64>() / 60.0;
        let power = list.iter().map(|v| v * v).sum::<f64>() / 60.0;
        // The mean of 60 normal values stays below 0.39, their mean square between 0.6 and 1.5, in 99.7 % of cases.
        assert!(mean.abs() < 0.39 && power > 0.55 && power < 1.6, "{name}: {mean} {power}");
    }
}

#[test]
fn stat_a_fraction_that_numerators_can_make_up_for_is_called_uncertain() {
    let wave = band_limited(7);
    let mut noise = Noise::new(7);
    let u: Vec<f64> = (0..800).map(|t| wave(t as f64)).collect();
    let y: Vec<f64> = (0..800).map(|t| wave(t as f64 - 2.4) + 0.1 * noise.normal()).collect();
    let data = Dataset::siso(1.0, &u, &y).unwrap().with_intersample(Intersample::BandLimited);
    let error = |nb: usize| {
        FractionalDelay(ArxDelay { na: 0, nb, lowest: 0, highest: 5, ..Default::default() })
            .estimate(&data)
            .unwrap()
            .standard_error
    };
    assert!(error(6) > 5.0 * error(1), "{} {}", error(6), error(1));
}

#[test]
fn stat_the_peak_is_biased_by_a_lag_and_the_first_lag_is_not() {
    // A second-order lag after two samples of delay: the response is largest later.
    let mut noise = Noise::new(8);
    let u = noise.normals(4000);
    let mut y = vec![0.0; 4000];
    (3..4000).for_each(|t| y[t] = 1.6 * y[t - 1] - 0.64 * y[t - 2] + u[t - 3] + noise.normal());
    let data = Dataset::siso(1.0, &u, &y).unwrap();
    assert!(PeakDelay::default().estimate(&data).unwrap().delay.samples > 4.0);
    assert_eq!(ImpulseDelay::default().estimate(&data).unwrap()[0].delay, Some(3));
    assert_eq!(ArxDelay::default().estimate(&data).unwrap().delays, [3]);
}

#[test]
fn stat_no_delay_is_seen_where_there_is_no_effect() {
    // Level 0.99: about one of a hundred.
    let mut noise = Noise::new(9);
    let mut alarms = 0;
    for _ in 0..100 {
        let data = Dataset::siso(1.0, &noise.normals(400), &noise.normals(400)).unwrap();
        alarms += usize::from(ImpulseDelay::default().estimate(&data).unwrap()[0].delay.is_some());
    }
    assert!(alarms <= 5, "{alarms}");
}

#[test]
fn regress_unusable_data_are_named() {
    let flat = Dataset::siso(1.0, &[1.0; 500], &[0.0; 500]).unwrap();
    assert!(matches!(ArxDelay::default().estimate(&flat), Err(IdentError::Constant { .. })));
    assert!(matches!(ImpulseDelay::default().estimate(&flat), Err(IdentError::Constant { .. })));
    assert!(PeakDelay::default().estimate(&flat).is_err());
    assert!(PhaseDelay::default().estimate(&flat).is_err());
    let short = Dataset::siso(1.0, &[1.0, 2.0], &[0.0, 1.0]).unwrap();
    assert!(matches!(ArxDelay::default().estimate(&short), Err(IdentError::TooFewSamples { .. })));
    assert!(ImpulseDelay::default().estimate(&short).is_err() && FractionalDelay::default().estimate(&short).is_err());
    assert!(PeakDelay::default().estimate(&short).is_err() && PhaseDelay::default().estimate(&short).is_err());
    let two = three_inputs(1, 100, 1.0);
    assert!(matches!(PhaseDelay::default().estimate(&two), Err(IdentError::Structure { .. })));
    // Rows with missing samples cost themselves alone.
    let mut noise = Noise::new(10);
    let u = noise.normals(600);
    let y: Vec<f64> = (0..600)
        .map(|t| {
            if t % 50 == 7 {
                f64::NAN
            } else if t < 5 {
                0.0
            } else {
                u[t - 5]
            }
        })
        .collect();
    let gaps = Dataset::siso(1.0, &u, &y).unwrap();
    assert_eq!(
        ArxDelay { na: 0, nb: 1, lowest: 0, highest: 9, ..Default::default() }.estimate(&gaps).unwrap().delays,
        [5]
    );
    assert!(matches!(PeakDelay::default().estimate(&gaps), Err(IdentError::Missing { .. })));
}

#[test]
fn stat_the_delay_of_an_output_that_is_slower_than_its_input_is_found() {
    let mut noise = crate::noise::Noise::new(21);
    let u = noise.normals(12_000);
    let mut x = vec![0.0; 12_000];
    (7..12_000).for_each(|t| x[t] = 0.9 * x[t - 1] + 0.1 * u[t - 7]);
    // Known every fourth sample alone.
    let y: Vec<f64> = (0..12_000).map(|t| if t % 4 == 0 { x[t] + 0.01 * noise.normal() } else { f64::NAN }).collect();
    let data = Dataset::siso(0.001, &u, &y).unwrap();
    let arx = ArxDelay { spacing: 4, nb: 5, ..Default::default() }.estimate(&data).unwrap();
    assert_eq!((arx.delays[0], arx.samples > 2900), (7, true), "{:?}", arx.samples);
    let starts = ImpulseDelay { spacing: 4, ..Default::default() }.estimate(&data).unwrap();
    assert_eq!(starts[0].delay, Some(7));
}

#[test]
fn regress_the_phase_of_a_delay_is_straight_where_the_input_has_power() {
    let mut noise = Noise::new(21);
    let rows = 4000;
    // Next to nothing of the input above a third of the band.
    let low = signal::Sos::butterworth_lowpass(6, 1.0 / 6.0, 1.0).unwrap();
    let u = low.filter(&noise.normals(rows), &mut low.state_at_rest());
    let y: Vec<f64> = (0..rows).map(|t| if t < 5 { 0.0 } else { u[t - 5] } + 0.05 * noise.normal()).collect();
    let found = PhaseDelay::default().estimate(&Dataset::siso(1.0, &u, &y).unwrap()).unwrap();
    assert!((found.samples - 5.0).abs() < 4.0 * found.standard_error && found.standard_error < 0.05, "{found:?}");
}
