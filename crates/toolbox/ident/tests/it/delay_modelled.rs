//! Dead times beside dynamics, from the simulated output.
#![allow(clippy::print_stdout)]

use ident::delay::{DelayFault, ModelledDelay, single_line};
use ident::{Dataset, IdentError, Intersample};

use crate::noise::Noise;

/// Levels that are held for so many samples.
fn held(noise: &mut Noise, samples: usize, hold: usize) -> Vec<f64> {
    let levels = noise.normals(samples / hold + 1);
    (0..samples).map(|t| levels[t / hold]).collect()
}

/// The answer of lags in series to a held input, a dead time later; both in samples, the lags all different.
fn answer(u: &[f64], dead: f64, lags: &[f64]) -> Vec<f64> {
    let (whole, fraction) = (dead.floor() as usize, dead.fract());
    let at = |t: usize, back: usize| t.checked_sub(back).map_or(0.0, |t| u[t]);
    let mut y = vec![0.0; u.len()];
    for (i, lag) in lags.iter().enumerate() {
        let others = lags.iter().enumerate().filter(|(j, _)| *j != i);
        let share: f64 = others.map(|(_, other)| lag / (lag - other)).product();
        let (decay, late) = ((-1.0 / lag).exp(), (-(1.0 - fraction) / lag).exp());
        let mut x = 0.0;
        for (t, y) in y.iter_mut().enumerate() {
            x = decay * x + (late - decay) * at(t, whole + 2) + (1.0 - late) * at(t, whole + 1);
            *y += share * x;
        }
    }
    y
}

/// A demand held for ten samples, its answer with ripple that keeps time with it, coloured noise, every fourth sample.
fn rippled(seed: u64, samples: usize, dead: f64, lags: &[f64]) -> Dataset {
    let mut noise = Noise::new(seed);
    let u: Vec<f64> = held(&mut noise, samples, 10).iter().map(|v| 10.0 * v + 20.0).collect();
    let clean = answer(&u, dead, lags);
    let phase = std::f64::consts::TAU * noise.uniform();
    let mut coloured = 0.0;
    let y: Vec<f64> = (0..samples)
        .map(|t| {
            if t % 4 != 0 {
                return f64::NAN;
            }
            coloured = 0.7 * coloured + 0.2 * noise.normal();
            let wave = (std::f64::consts::TAU * 0.1 * t as f64 + phase).cos();
            clean[t] * (1.0 + 0.03 * wave) + 1.2 * wave + coloured + 0.1 * noise.normal()
        })
        .collect();
    Dataset::siso(0.001, &u, &y).unwrap()
}

/// How many of the claims hold the truth, how many there are, and the middle width of the intervals.
fn coverage(runs: u64, truth: f64, data: impl Fn(u64) -> Dataset) -> (usize, usize, f64) {
    let (mut holding, mut widths) = (0, Vec::new());
    for seed in 0..runs {
        let found = ModelledDelay::default().estimate(&data(seed)).unwrap();
        let Some(model) = found.claimed() else { continue };
        let (low, high) = model.intervals[0];
        widths.push(high - low);
        holding += usize::from(low <= truth && truth <= high);
    }
    widths.sort_by(f64::total_cmp);
    (holding, widths.len(), widths.get(widths.len() / 2).copied().unwrap_or(f64::INFINITY))
}

/// Of 30 intervals of 95 %, 26 or more hold the truth in 98.5 % of cases.
const RUNS: u64 = 30;
const LEAST: usize = 26;

#[test]
#[ignore = "slow"]
fn stat_intervals_hold_the_dead_time_under_ripple_and_coloured_noise() {
    let (holding, claims, width) = coverage(RUNS, 1.25, |seed| rippled(seed, 4000, 1.25, &[1.77]));
    assert!(claims >= 27 && width < 0.1, "{claims} claims of width {width}");
    assert!(holding + (RUNS as usize - LEAST) >= claims, "{holding} of {claims}");
}

#[test]
fn stat_a_gain_under_a_held_input_is_told_to_a_sample() {
    let mut noise = Noise::new(5);
    let u = held(&mut noise, 1500, 5);
    let y: Vec<f64> =
        (0..1500).map(|t: usize| 2.0 * t.checked_sub(4).map_or(0.0, |t| u[t]) + 0.1 * noise.normal()).collect();
    let found = ModelledDelay::default().estimate(&Dataset::siso(0.01, &u, &y).unwrap()).unwrap();
    let model = found.claimed().unwrap();
    assert_eq!((model.poles, model.intervals[0]), (0, (3.0, 4.0)));
}

#[test]
fn regress_an_output_that_answers_before_the_input_claims_nothing() {
    let mut noise = Noise::new(6);
    let u = held(&mut noise, 2000, 10);
    let clean = answer(&u, 0.3, &[3.0]);
    // A whole sample earlier than a held input allows.
    let y: Vec<f64> = (0..2000).map(|t| clean[(t + 1).min(1999)] + 0.01 * noise.normal()).collect();
    let found = ModelledDelay::default().estimate(&Dataset::siso(0.01, &u, &y).unwrap()).unwrap();
    assert!(found.claimed().is_none(), "{found:?}");
    assert!(found.best().faults.contains(&DelayFault::TooEarly { input: 0 }), "{found:?}");
}

#[test]
fn regress_constant_channels_are_named() {
    let mut noise = Noise::new(7);
    let moving = noise.normals(300);
    for (u, y) in [(vec![1.0; 300], moving.clone()), (moving, vec![2.0; 300])] {
        let found = ModelledDelay::default().estimate(&Dataset::siso(0.1, &u, &y).unwrap());
        assert!(matches!(found, Err(IdentError::Constant { .. })), "{found:?}");
    }
}

#[test]
fn regress_nothing_is_claimed_of_signals_without_relation() {
    for (seed, pole) in [(1, 0.0), (2, 0.9)] {
        let mut noise = Noise::new(seed);
        let coloured = |white: Vec<f64>| {
            let mut state = 0.0;
            let next = |v: f64| {
                state = pole * state + v;
                state
            };
            white.into_iter().map(next).collect::<Vec<f64>>()
        };
        let (u, y) = (coloured(noise.normals(1500)), coloured(noise.normals(1500)));
        let found = ModelledDelay::default().estimate(&Dataset::siso(1.0, &u, &y).unwrap()).unwrap();
        assert!(found.claimed().is_none(), "{pole}: {:?}", found.best());
    }
}

/// A sine of so many samples a period, and an answer later by `late` samples, in noise.
fn sines(seed: u64, periods: &[f64], late: f64, deviation: f64) -> Dataset {
    let mut noise = Noise::new(seed);
    let at = |t: f64| periods.iter().map(|period| (std::f64::consts::TAU * t / period).sin()).sum::<f64>();
    let u: Vec<f64> = (0..1000).map(|t| at(f64::from(t))).collect();
    let y: Vec<f64> = (0..1000).map(|t| 0.7 * at(f64::from(t) - late) + deviation * noise.normal()).collect();
    Dataset::siso(0.01, &u, &y).unwrap()
}

#[test]
fn regress_one_sine_tells_no_delay_from_a_phase() {
    for (seed, late) in [(1, 6.0), (3, 13.3)] {
        for deviation in [0.0, 0.02, 0.3] {
            let data = sines(seed, &[20.0], late, deviation);
            assert!((single_line(&data, 0).unwrap() - 5.0).abs() < 0.06);
            // Without noise there may be no model at all.
            let Ok(found) = ModelledDelay::default().estimate(&data) else { continue };
            let few = matches!(found.best().faults[0], DelayFault::FewLines { input: 0, lines: 1, needed: 2.., .. });
            assert!(found.claimed().is_none() && few, "{late} {deviation}: {:?}", found.best().faults);
        }
    }
}

#[test]
fn exact_lines_of_an_input_are_counted() {
    let data = |periods: &[f64]| sines(5, periods, 4.0, 0.05);
    assert!(single_line(&data(&[20.0, 7.3]), 0).is_none() && single_line(&data(&[20.0]), 1).is_none());
    let mut noise = Noise::new(6);
    for u in [noise.normals(500), held(&mut noise, 500, 10), (0..500).map(|t| f64::from(u8::from(t > 200))).collect()] {
        assert!(single_line(&Dataset::siso(0.1, &u, &u).unwrap(), 0).is_none());
    }
    // Two lines fit any gain, delay and two poles; they cannot refute them.
    let found = ModelledDelay::default().estimate(&data(&[20.0, 7.3])).unwrap();
    let needed = (found.best().zeros + found.best().poles + 2) / 2 + 1;
    let few = found.best().faults.iter().any(|fault| matches!(fault, DelayFault::FewLines { lines: 2, .. }));
    assert_eq!(few, needed > 2, "{:?}", found.best());
}

/// Lags in series in noise, 20 times weaker than the input.
fn lags_in_noise(seed: u64, samples: usize, lags: &[f64]) -> Dataset {
    let mut noise = Noise::new(seed);
    let u = held(&mut noise, samples, 5);
    let y: Vec<f64> = answer(&u, 2.4, lags).iter().map(|y| y + 0.05 * noise.normal()).collect();
    Dataset::siso(0.01, &u, &y).unwrap()
}

/// Of 40 intervals of 95 %, fewer than 34 hold the truth in 0.3 % of cases.
#[test]
#[ignore = "slow"]
fn stat_intervals_hold_by_how_much_slow_changes_are_late() {
    let (mut holding, mut widths) = (0, Vec::new());
    for seed in 0..40 {
        let found = ModelledDelay::default().estimate(&lags_in_noise(seed, 300, &[4.0])).unwrap();
        let Some(model) = found.claimed() else { continue };
        let (low, high) = model.late_intervals[0].unwrap();
        holding += usize::from(low <= 6.4 && 6.4 <= high);
        widths.push(high - low);
    }
    let claims = widths.len();
    widths.sort_by(f64::total_cmp);
    assert!(claims >= 37 && widths[claims / 2] < 0.6, "{claims} claims of width {}", widths[claims / 2]);
    assert!(holding + 6 >= claims, "{holding} of {claims}");
}

/// A pole more than there is leaves a pole and a zero that cancel, and a search that need not end.
#[test]
#[ignore = "slow"]
fn stat_a_pole_too_many_takes_no_claim_away() {
    for lags in [&[4.0][..], &[6.0, 2.5]] {
        let claims = |seed: &u64| {
            let found = ModelledDelay::default().estimate(&lags_in_noise(*seed, 400, lags)).unwrap();
            found.claimed().is_some_and(|model| model.poles >= lags.len())
        };
        let found = (0..15).filter(claims).count();
        assert!(found >= 14, "{found} of 15 beside {lags:?}");
    }
}

/// Points between two samples on which an input that runs straight is known.
const FINE: usize = 20;

/// The answer of a gain, or of a lag in samples, to an input that runs straight from sample to sample, in noise.
fn straight(seed: u64, dead: f64, lag: f64, deviation: f64) -> Dataset {
    let mut noise = Noise::new(seed);
    let u = noise.normals(1000);
    let step = 1.0 / FINE as f64;
    let delayed = |i: usize| {
        let t = (i as f64 * step - dead).max(0.0);
        let (whole, part) = (t.floor() as usize, t.fract());
        u[whole] + part * (u[(whole + 1).min(999)] - u[whole])
    };
    let (decay, mut x, mut y) = ((-step / lag).exp(), u[0], Vec::with_capacity(1000));
    for i in 0..1000 * FINE {
        let (before, after) = (delayed(i), delayed(i + 1));
        if i % FINE == 0 {
            y.push(1.5 * if lag > 0.0 { x } else { before } + deviation * noise.normal());
        }
        x = decay * x + (1.0 - decay) * before + (after - before) * (1.0 - lag * (1.0 - decay) * FINE as f64);
    }
    Dataset::siso(0.01, &u, &y).unwrap().with_intersample(Intersample::FirstOrderHold)
}

#[test]
fn exact_a_gain_under_an_input_that_runs_straight_tells_a_fraction_of_a_sample() {
    let found = ModelledDelay::default().estimate(&straight(3, 4.55, 0.0, 0.0)).unwrap();
    let model = found.claimed().unwrap();
    assert!(model.poles == 0 && (model.dead_times[0].samples - 4.55).abs() < 1e-6, "{model:?}");
}

#[test]
#[ignore = "slow"]
fn stat_intervals_hold_the_dead_time_of_an_input_that_runs_straight() {
    for (dead, lag, poles, most) in [(4.5, 0.0, 0, 0.1), (0.3, 0.0, 0, 0.1), (4.95, 3.0, 1, 0.5), (2.0, 3.0, 1, 0.5)] {
        let (holding, claims, width) = coverage(RUNS, dead, |seed| straight(seed, dead, lag, 0.3));
        assert!(claims >= 27 && width < most, "{dead}, {lag}: {claims} claims of width {width}");
        assert!(holding + (RUNS as usize - LEAST) >= claims, "{dead}, {lag}: {holding} of {claims}");
        let found = ModelledDelay::default().estimate(&straight(0, dead, lag, 0.3)).unwrap();
        assert_eq!(found.best().poles, poles, "{dead}, {lag}");
    }
}

/// Dynamics make up for what is lacking of a delay, up to the end of what was searched.
fn is_claimed_of_a_longer_search_alone((seed, hold, dead, lag): (u64, usize, f64, f64)) {
    let mut noise = Noise::new(seed);
    let u = held(&mut noise, 2000, hold);
    let y: Vec<f64> = answer(&u, dead, &[lag]).iter().map(|y| y + 0.1 * noise.normal()).collect();
    let data = Dataset::siso(0.01, &u, &y).unwrap();
    let found = ModelledDelay::default().estimate(&data).unwrap();
    assert!(found.claimed().is_none(), "{dead} {hold}: {:?}", found.best());
    let further = ModelledDelay { longest: 60, ..ModelledDelay::default() }.estimate(&data).unwrap();
    let (low, high) = further.claimed().unwrap().intervals[0];
    assert!(low - 0.2 <= dead && dead <= high + 0.2, "{dead}: {low} {high}");
}

#[test]
fn regress_a_delay_beyond_the_longest_is_not_claimed() {
    is_claimed_of_a_longer_search_alone((103, 60, 32.0, 1.5));
}

#[test]
#[ignore = "slow"]
fn stat_delays_beyond_the_longest_are_not_claimed() {
    for case in [(101, 5, 32.0, 5.0), (106, 5, 36.0, 8.0), (109, 150, 36.0, 2.0)] {
        is_claimed_of_a_longer_search_alone(case);
    }
}

/// The same data with every so manieth sample of the input missing, cut there.
fn with_gaps(data: &Dataset, every: usize) -> Dataset {
    let e = &data.experiments()[0];
    let known = |t: usize, u: f64| if t.is_multiple_of(every) { f64::NAN } else { u };
    let u: Vec<f64> = e.input(0).iter().enumerate().map(|(t, u)| known(t, *u)).collect();
    let data = Dataset::siso(data.sample_time_s(), &u, e.output(0)).unwrap().with_intersample(data.intersample());
    data.without_input_gaps(20).unwrap()
}

/// A lag and a dead time of two samples under an input that is another in each sample, in noise.
fn restless(seed: u64, samples: usize) -> Dataset {
    let mut noise = Noise::new(seed);
    let u = noise.normals(samples);
    let y: Vec<f64> = answer(&u, 2.0, &[4.5]).iter().map(|y| y + 0.05 * noise.normal()).collect();
    Dataset::siso(0.01, &u, &y).unwrap()
}

/// Every stretch between gaps has initial states of its own; with many poles they follow much of the noise.
#[test]
fn regress_initial_states_of_many_stretches_are_no_dynamics() {
    let found = ModelledDelay::default().estimate(&with_gaps(&restless(2, 3000), 100)).unwrap();
    let model = found.claimed().unwrap();
    let (low, high) = model.intervals[0];
    assert!(model.poles == 1 && low <= 2.0 && 2.0 <= high && high - low < 0.2, "{model:?}");
}

/// An input that is held for some samples looks at rest behind every gap, although it moved just before.
#[test]
fn regress_held_inputs_are_not_taken_to_have_rested_before_a_gap() {
    let holds = |seed: &u64| {
        let found =
            ModelledDelay::default().estimate(&with_gaps(&lags_in_noise(*seed, 3000, &[6.0, 2.5]), 60)).unwrap();
        let (low, high) = found.claimed().unwrap().intervals[0];
        println!("{seed}: {low} {high}");
        low <= 2.4 && 2.4 <= high
    };
    assert_eq!((0..3).filter(holds).count(), 3);
}

/// Of 30 claims of 95 %, and of 30 models whose errors are tested at 99 %, so many fewer are a matter of chance.
#[test]
#[ignore = "slow"]
fn stat_intervals_hold_the_dead_time_of_data_with_gaps() {
    for every in [60, 120, 350] {
        let check = |what: &str, truth: f64, most: f64, data: &dyn Fn(u64) -> Dataset| {
            let (holding, claims, width) = coverage(RUNS, truth, |seed| with_gaps(&data(seed), every));
            assert!(claims >= 27 && width < most, "{every}, {what}: {claims} claims of width {width}");
            assert!(holding + (RUNS as usize - LEAST) >= claims, "{every}, {what}: {holding} of {claims}");
        };
        check("a lag", 2.0, 0.2, &|seed| restless(seed, 3000));
        check("two lags", 2.4, 0.6, &|seed| lags_in_noise(seed, 3000, &[6.0, 2.5]));
        check("straight", 1.5, 0.5, &|seed| straight(seed, 1.5, 3.0, 0.1));
    }
}

/// It answers as the input moves: what is held leaves no dead time for that.
#[test]
fn regress_an_output_that_is_the_input_claims_nothing() {
    let u = Noise::new(8).normals(1500);
    let found = ModelledDelay::default().estimate(&Dataset::siso(0.01, &u, &u).unwrap()).unwrap();
    assert!(found.claimed().is_none(), "{found:?}");
    assert!(found.best().faults.contains(&DelayFault::TooEarly { input: 0 }), "{found:?}");
}

/// The model of a gain has a level for every recording, as those with a lag have: otherwise a lag would win by its
/// levels.
#[test]
fn regress_recordings_at_levels_of_their_own_are_one_gain() {
    let is_found = |seed: &u64| {
        let mut noise = Noise::new(*seed);
        let mut one = |level: f64| {
            let u = held(&mut noise, 800, 5);
            let delayed = (0..800_usize).map(|t| 2.0 * t.checked_sub(4).map_or(0.0, |t| u[t]));
            let y: Vec<f64> = delayed.map(|y| y + level + 0.1 * noise.normal()).collect();
            Dataset::siso(0.01, &u, &y).unwrap()
        };
        let data = one(0.0).merge(&one(30.0)).unwrap();
        let found = ModelledDelay::default().estimate(&data).unwrap();
        found.claimed().is_some_and(|model| model.poles == 0 && model.intervals[0] == (3.0, 4.0))
    };
    assert!((0..5).filter(is_found).count() >= 4);
}

/// A held input through lags and zeros with a dead time, all in samples, and noise of 3 % of the output.
fn zeros_and_lags(seed: u64, samples: usize, poles: usize, has_zero: bool) -> (f64, Dataset) {
    let mut noise = Noise::new(seed);
    let mut between = |low: f64, high: f64| low + (high - low) * noise.uniform();
    let dead = between(0.0, 12.0);
    let lags: Vec<f64> = (0..poles).map(|_| between(1.0, 9.0)).collect();
    let zero = if has_zero { between(-6.0, 6.0) } else { 0.0 };
    let mut u = Vec::new();
    while u.len() < samples {
        let (level, hold) = (between(-1.0, 1.0), between(3.0, 11.0) as usize);
        u.extend(vec![level; hold]);
    }
    u.truncate(samples);
    // The sum of lags with these weights, `Π 1/(1 + T s) (1 + T_z s)` in partial fractions.
    let weight = |i: usize| {
        let others = (0..poles).filter(|j| *j != i);
        others.map(|j| lags[i] / (lags[i] - lags[j])).product::<f64>() * (1.0 - zero / lags[i])
    };
    let mut y = vec![0.0; samples];
    for (i, lag) in lags.iter().enumerate() {
        let own = answer(&u, dead, &[*lag]);
        let weight = weight(i);
        y.iter_mut().zip(&own).for_each(|(y, own)| *y += weight * own);
    }
    let size = (y.iter().map(|y| y * y).sum::<f64>() / samples as f64).sqrt();
    y.iter_mut().for_each(|y| *y += 0.03 * size * noise.normal());
    (dead, Dataset::siso(0.1, &u, &y).unwrap())
}

/// Claims, and those that hold the dead time.
fn claims_of(poles: usize, has_zero: bool, seeds: std::ops::Range<u64>) -> (usize, usize) {
    let held = numerics::parallel::map(&Vec::from_iter(seeds), |seed| {
        let (dead, data) = zeros_and_lags(1000 * poles as u64 + seed, 1500, poles, has_zero);
        let found = ModelledDelay::default().estimate(&data).unwrap();
        let model = found.claimed()?;
        let (low, high) = model.intervals[0];
        let holds = low <= dead && dead <= high;
        let missed = || format!("{seed}: {dead} in {low} {high}, {} zeros {} poles", model.zeros, model.poles);
        Some((holds, if holds { String::new() } else { missed() }))
    });
    let claims: Vec<(bool, String)> = held.into_iter().flatten().collect();
    claims.iter().filter(|(holds, _)| !holds).for_each(|(_, missed)| println!("{poles} {has_zero} {missed}"));
    let holding = claims.iter().filter(|(holds, _)| *holds).count();
    println!("{poles} poles, zero {has_zero}: {holding} of {}", claims.len());
    (claims.len(), holding)
}

/// Zeros trade against the delay: with three poles an interval about one minimum missed every other dead time.
#[test]
fn stat_intervals_hold_the_dead_time_beside_three_poles() {
    let (claims, holding) = claims_of(3, false, 0..4);
    assert!(claims >= 3 && holding + 1 >= claims, "{holding} of {claims}");
}

/// Of 40 claims of 95 %, 35 or more hold in 98 % of cases. Beside four poles and a zero fewer hold, as the chapter on
/// limits states: a model with three explains such data about as well.
#[test]
#[ignore = "slow"]
fn stat_intervals_hold_the_dead_time_beside_one_to_four_poles_with_zeros_and_without() {
    for (poles, has_zero) in [(1, false), (2, false), (3, false), (4, false), (2, true), (3, true), (4, true)] {
        let (claims, holding) = claims_of(poles, has_zero, 0..40);
        let least = if (poles, has_zero) == (4, true) { 0.75 } else { 0.87 };
        assert!(claims >= 28 && holding as f64 >= least * claims as f64, "{poles} {has_zero}: {holding} of {claims}");
    }
}

/// An interval of no confidence has no width, from which no standard error follows.
#[test]
fn regress_intervals_of_no_confidence_are_refused_and_errors_do_not_depend_on_the_level() {
    let data = lags_in_noise(1, 300, &[4.0]);
    let at = |level: f64| ModelledDelay { level, ..ModelledDelay::default() }.estimate(&data);
    assert!(at(0.0).is_err());
    let error = |level: f64| at(level).unwrap().best().dead_times[0].standard_error;
    assert!((error(0.5) / error(0.99) - 1.0).abs() < 1e-9);
}
