//! Process models from step tests of every rest, size, level and length, beside a search of the test's own.
#![allow(clippy::print_stdout)]

use faer::Mat;
use ident::{Dataset, Doubt, Parametric, ProcessFit};
use lti::ProcessModel;

use crate::noise::Noise;

/// A step test: a plant that answers to an input at rest at first.
struct StepTest {
    name: &'static str,
    truth: ProcessModel,
    sample_time_s: f64,
    input: Vec<f64>,
    output: Vec<f64>,
}

/// Samples of the answer of a channel without delay to a unit step at time zero, from `late` on: by the matrix
/// exponential.
fn step_response(channel: &ProcessModel, late: f64, sample_time_s: f64, count: usize) -> Vec<f64> {
    let system = channel.to_transfer_function().unwrap().with_delay(0.0).unwrap().to_state_space().unwrap();
    let n = system.states();
    let motion = |time: f64| {
        let generator = Mat::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) => time * system.a()[(i, j)],
            (true, false) => time * system.b()[(i, 0)],
            _ => 0.0,
        });
        lti::expm(generator.as_ref()).unwrap()
    };
    let output = Mat::from_fn(1, n + 1, |_, j| if j < n { system.c()[(0, j)] } else { system.d()[(0, 0)] });
    let (each, mut state) = (motion(sample_time_s), motion(late) * Mat::from_fn(n + 1, 1, |i, _| f64::from(i == n)));
    let mut at = || {
        let now = (&output * &state)[(0, 0)];
        state = &each * &state;
        now
    };
    (0..count).map(|_| at()).collect()
}

/// The answer of a channel with a delay in seconds to an input that steps now and then, and has always been what it is
/// at first.
fn answer(channel: &ProcessModel, delay_s: f64, input: &[f64], sample_time_s: f64) -> Vec<f64> {
    let (mut y, samples) = (vec![0.0; input.len()], delay_s / sample_time_s);
    for step in (1..input.len()).filter(|k| input[*k] != input[k - 1]) {
        let first = (step as f64 + samples).ceil() as usize;
        let late = (first as f64 - step as f64 - samples) * sample_time_s;
        let response = step_response(channel, late, sample_time_s, input.len().saturating_sub(first));
        y.iter_mut().skip(first).zip(&response).for_each(|(y, r)| *y += (input[step] - input[step - 1]) * r);
    }
    y
}

const STRUCTURES: [&str; 9] = ["P0", "P1", "P1D", "P2D", "P2DU", "P2DZ", "P3D", "P1DI", "P3DU"];

fn draw(random: &mut Noise) -> StepTest {
    let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
    let name = STRUCTURES[between(0.0, STRUCTURES.len() as f64) as usize];
    let t = [0.01, 0.1, 0.5, 2.0][between(0.0, 4.0) as usize];
    let sign = if between(0.0, 1.0) < 0.5 { -1.0 } else { 1.0 };
    let longest = t * between(4.0, 25.0);
    let mut truth = ProcessModel::new(sign * between(0.2, 5.0)).unwrap();
    let poles = usize::from(name.as_bytes()[1] - b'0');
    let lags = if name.contains('U') { poles - 2 } else { poles };
    if name.contains('U') {
        truth = truth.with_pair(longest * between(0.3, 1.0), between(0.15, 0.8)).unwrap();
    }
    let ratios = [1.0, between(0.3, 0.6), between(0.08, 0.15)];
    truth = truth.with_lags(ratios[..lags].iter().map(|r| r * longest).collect()).unwrap();
    if name.contains('Z') {
        truth = truth.with_zero(longest * between(-1.0, 0.8)).unwrap();
    }
    if name.contains('I') {
        truth = truth.with_integrator();
    }
    let delay_s = if name.contains('D') { t * between(0.0, 12.0) } else { 0.0 };
    if name.contains('D') {
        truth = truth.with_delay(delay_s).unwrap();
    }
    let (rest, settled) = (between(1.0, 61.0) as usize, (between(4.0, 9.0) * longest / t) as usize);
    let (from, by) = (between(-5.0, 5.0), sign * between(0.1, 4.0));
    let from = if name.contains('I') { 0.0 } else { from };
    let input: Vec<f64> = (0..rest + settled + 25).map(|k| if k < rest { from } else { from + by }).collect();
    let clean = answer(&truth, delay_s, &input, t);
    let (offset, mean) = (between(-20.0, 20.0), clean.iter().sum::<f64>() / clean.len() as f64);
    let size = (clean.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / clean.len() as f64).sqrt();
    let noise = size * between(0.002, 0.03);
    // What the gain makes of the first level is part of the offset as far as anyone can see.
    let at_rest = if name.contains('I') { 0.0 } else { truth.gain() * from };
    let output = clean.iter().map(|y| y + at_rest + offset + noise * random.normal()).collect();
    StepTest { name, truth, sample_time_s: t, input, output }
}

/// Residual of `y` beside the columns: by Gram and Schmidt, twice over, columns that follow from others left out.
fn left_over(y: &[f64], columns: Vec<Vec<f64>>) -> f64 {
    let along = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let without = |x: &mut Vec<f64>, basis: &[Vec<f64>]| {
        for q in basis.iter().chain(basis) {
            let part = along(q, x);
            x.iter_mut().zip(q).for_each(|(x, q)| *x -= part * q);
        }
    };
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let size = along(&column, &column).sqrt();
        without(&mut column, &basis);
        let rest = along(&column, &column).sqrt();
        if rest > 1e-9 * size {
            column.iter_mut().for_each(|v| *v /= rest);
            basis.push(column);
        }
    }
    let mut rest = y.to_vec();
    without(&mut rest, &basis);
    along(&rest, &rest)
}

impl StepTest {
    fn data(&self) -> Dataset {
        Dataset::siso(self.sample_time_s, &self.input, &self.output).unwrap()
    }

    /// The smallest sum of squares at time constants, damping and delay: gain, zero, offset and initial state enter
    /// linearly.
    fn cost(&self, nonlinear: &[f64]) -> f64 {
        let has_delay = self.truth.delay_s().is_some();
        let (times, delay_s) = nonlinear.split_at(nonlinear.len() - usize::from(has_delay));
        let delay_s = delay_s.first().copied().unwrap_or(0.0);
        let (pair, lags) = times.split_at(if self.truth.pair().is_some() { 2 } else { 0 });
        let longest = 10.0 * self.input.len() as f64 * self.sample_time_s;
        let is_process = |t: &f64| (0.01 * self.sample_time_s..=longest).contains(t);
        let damped = pair.get(1).is_none_or(|damping| (0.0..=10.0).contains(damping));
        if delay_s < 0.0 || !damped || !pair.iter().take(1).chain(lags).all(is_process) {
            return f64::INFINITY;
        }
        let mut channel = ProcessModel::new(1.0).unwrap().with_lags(lags.to_vec()).unwrap();
        if let [time, damping] = pair {
            channel = channel.with_pair(*time, *damping).unwrap();
        }
        channel = if self.truth.integrates() { channel.with_integrator() } else { channel };
        let mut columns = vec![answer(&channel, delay_s, &self.input, self.sample_time_s), vec![1.0; self.input.len()]];
        if self.truth.zero_s().is_some() {
            let zero = channel.clone().with_zero(1.0).unwrap();
            columns.push(answer(&zero, delay_s, &self.input, self.sample_time_s));
        }
        columns.extend(free_responses(&channel, self.sample_time_s, self.input.len()));
        left_over(&self.output, columns)
    }

    /// The parameters that enter nonlinearly.
    fn nonlinear(&self) -> Vec<f64> {
        let (pair, delay) = (self.truth.pair(), self.truth.delay_s());
        let pair = pair.into_iter().flat_map(|pair| [pair.time_constant_s, pair.damping]);
        pair.chain(self.truth.lags_s().iter().copied()).chain(delay).collect()
    }

    /// The smallest sum of squares found from the truth and from random starts.
    fn reference(&self, starts: usize, random: &mut Noise) -> f64 {
        let truth = self.nonlinear();
        if truth.is_empty() {
            return self.cost(&truth);
        }
        let mut best = descend(&truth, |p| self.cost(p));
        for _ in 0..starts {
            let start: Vec<f64> = truth.iter().map(|v| v * (3.0 * random.uniform() - 1.5).exp()).collect();
            best = best.min(descend(&start, |p| self.cost(p)));
        }
        best
    }
}

/// Contributions of the states of a channel to its output on their own.
fn free_responses(channel: &ProcessModel, sample_time_s: f64, count: usize) -> Vec<Vec<f64>> {
    let system = channel.to_transfer_function().unwrap().to_state_space().unwrap();
    let each = lti::expm((faer::Scale(sample_time_s) * system.a()).as_ref()).unwrap();
    let mut columns = vec![Vec::with_capacity(count); system.states()];
    let mut row = system.c().to_owned();
    for _ in 0..count {
        columns.iter_mut().enumerate().for_each(|(j, column)| column.push(row[(0, j)]));
        row = &row * &each;
    }
    columns
}

/// The lowest value that the simplex of Nelder and Mead finds, in the logarithms of the parameters.
fn descend(start: &[f64], cost: impl Fn(&[f64]) -> f64) -> f64 {
    let n = start.len();
    let value = |p: &[f64]| cost(&p.iter().map(|v| v.exp()).collect::<Vec<_>>());
    let at = |p: Vec<f64>| (value(&p), p);
    let origin: Vec<f64> = start.iter().map(|v| v.max(1e-9).ln()).collect();
    let mut simplex = vec![at(origin.clone())];
    for j in 0..n {
        let mut corner = origin.clone();
        corner[j] += 0.2;
        simplex.push(at(corner));
    }
    for _ in 0..200 * n {
        simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
        if simplex[n].0 - simplex[0].0 <= 1e-7 * simplex[0].0 {
            break;
        }
        let middle: Vec<f64> = (0..n).map(|j| simplex[..n].iter().map(|(_, p)| p[j]).sum::<f64>() / n as f64).collect();
        let worst = simplex[n].1.clone();
        let along = |by: f64| at(middle.iter().zip(&worst).map(|(m, w)| m + by * (m - w)).collect());
        let mut next = along(1.0);
        if next.0 < simplex[0].0 {
            let further = along(2.0);
            next = if further.0 < next.0 { further } else { next };
        } else if next.0 >= simplex[n - 1].0 {
            let nearer = along(if next.0 < simplex[n].0 { 0.5 } else { -0.5 });
            next = if nearer.0 < next.0 { nearer } else { next };
        }
        if next.0 < simplex[n].0 {
            simplex[n] = next;
            continue;
        }
        let best = simplex[0].1.clone();
        for corner in &mut simplex[1..] {
            *corner = at(corner.1.iter().zip(&best).map(|(c, b)| 0.5 * (c + b)).collect());
        }
    }
    simplex.into_iter().map(|(cost, _)| cost).fold(f64::INFINITY, f64::min)
}

/// Intervals with those of lags in the order that the truth has: which is called the first is a matter of the search.
fn longest_first(intervals: &[(f64, f64)], truth: &ProcessModel) -> Vec<(f64, f64)> {
    let (mut ordered, first) = (intervals.to_vec(), 1 + 2 * usize::from(truth.pair().is_some()));
    ordered[first..first + truth.lags_s().len()].sort_by(|a, b| (b.0 + b.1).total_cmp(&(a.0 + a.1)));
    ordered
}

/// Counts over many step tests.
#[derive(Default)]
struct Tally {
    tests: usize,
    /// Costs more than 1 % above that of the reference.
    above: usize,
    intervals: usize,
    held: usize,
    /// Gains off by more than 30 % whose interval is narrower.
    sure_and_wrong: usize,
}

fn judge(seeds: std::ops::Range<u64>, starts: usize) -> Tally {
    let mut tally = Tally::default();
    for seed in seeds {
        let mut random = Noise::new(seed);
        let test = draw(&mut random);
        tally.tests += 1;
        let reference = test.reference(starts, &mut random);
        let fit = match ProcessFit::named(test.name).unwrap().with_offset().fit(&test.data()) {
            Ok(fit) => fit,
            Err(error) => {
                println!("{seed} {}: {error}", test.name);
                tally.above += 1;
                continue;
            }
        };
        let rest = test.input.iter().position(|u| *u != test.input[0]).unwrap();
        let (cost, truth) = (fit.loss * fit.samples as f64, test.truth.parameters());
        if fit.samples != test.input.len() || cost > 1.01 * reference {
            tally.above += 1;
            println!(
                "{seed} {} rest {rest}: cost {cost} of {reference}, {:?} of {truth:?}",
                test.name,
                fit.parameters()
            );
        }
        let intervals = longest_first(&fit.intervals(0.95), &test.truth);
        for (j, ((low, high), wanted)) in intervals.iter().zip(&truth).enumerate() {
            if low.is_nan() {
                continue;
            }
            let is_held = low <= wanted && wanted <= high;
            tally.intervals += 1;
            tally.held += usize::from(is_held);
            if !is_held {
                println!("{seed} {} rest {rest} {j}: {low} {wanted} {high}, {:?}", test.name, fit.doubts);
            }
            let is_wrong = j == 0 && (fit.parameters()[0] / wanted - 1.0).abs() > 0.3;
            tally.sure_and_wrong += usize::from(is_wrong && !is_held);
        }
    }
    println!(
        "{} tests, {} above, {} of {}, {}",
        tally.tests, tally.above, tally.held, tally.intervals, tally.sure_and_wrong
    );
    tally
}

#[test]
fn stat_step_tests_of_every_kind_come_to_the_least_cost() {
    let tally = judge(0..24, 0);
    assert!(tally.above == 0 && tally.sure_and_wrong == 0);
    // 95 % of 80 intervals are 76, with a deviation of 2; those of one test go together.
    assert!(tally.held as f64 >= 0.86 * tally.intervals as f64);
}

#[test]
#[ignore = "slow"]
fn stat_many_step_tests_come_to_the_least_cost_and_intervals_hold() {
    let tally = judge(1000..1400, 6);
    assert!(100 * tally.above <= tally.tests && tally.sure_and_wrong == 0);
    let share = tally.held as f64 / tally.intervals as f64;
    assert!((0.93..=0.97).contains(&share), "{share}");
}

/// A step after 5 s of rest, and a delay: the range that is searched is longer than the rest.
#[test]
fn regress_a_rest_shorter_than_the_longest_delay_is_enough() {
    let truth = ProcessModel::new(2.0).unwrap().with_lags(vec![6.0]).unwrap();
    let input: Vec<f64> = (0..200).map(|k| f64::from(k >= 10)).collect();
    for seed in 0..4 {
        let mut noise = Noise::new(seed);
        let output =
            answer(&truth, 2.3, &input, 0.5).iter().map(|y| 7.0 + y + 0.01 * noise.normal()).collect::<Vec<_>>();
        let data = Dataset::siso(0.5, &input, &output).unwrap();
        let process = ProcessFit::named("P1D").unwrap().with_offset().fit(&data).unwrap();
        let found = process.parameters();
        assert!(
            (found[0] - 2.0).abs() < 0.03 && (found[1] - 6.0).abs() < 0.2 && (found[2] - 2.3).abs() < 0.1,
            "{found:?}"
        );
        assert!(process.samples == 200 && process.doubts.contains(&Doubt::HeldBefore), "{:?}", process.doubts);
        let tf = ident::ContinuousTransferFunction::new(0, 1).with_delay_between(&[(0.0, 9.0)]).with_offset();
        let found = tf.fit(&data).unwrap().model.channel(0, 0).unwrap().parameters();
        assert!((found[0] / found[1] - 2.0).abs() < 0.03 && (found[2] - 2.3).abs() < 0.1, "{found:?}");
    }
}

/// The record begins shortly after a step that the output has not answered to yet: the rest is none.
#[test]
fn stat_a_rest_that_the_output_refutes_is_not_taken_for_one() {
    let truth = ProcessModel::new(2.0).unwrap().with_lags(vec![3.0]).unwrap();
    // Steps at 40, 50, 70, 100, …; the first 42 samples are cut off.
    let input: Vec<f64> = (0..400).map(|k| if k < 40 { -2.0 } else { f64::from((k / 50 + k / 70) % 3) }).collect();
    let mut noise = Noise::new(5);
    let output: Vec<f64> = answer(&truth, 1.23, &input, 0.1).iter().map(|y| y + 0.01 * noise.normal()).collect();
    let data = Dataset::siso(0.1, &input[42..], &output[42..]).unwrap();
    let fit = ProcessFit::named("P1D").unwrap().with_offset().fit(&data).unwrap();
    let late = fit.doubts.iter().any(|doubt| matches!(doubt, Doubt::RowsLeftOut { rows: 30, .. }));
    assert!(late && !fit.doubts.contains(&Doubt::HeldBefore), "{:?}", fit.doubts);
    for ((low, high), wanted) in fit.intervals(0.99).iter().zip([2.0, 3.0, 1.23]) {
        assert!(*low <= wanted && wanted <= *high, "{low} {wanted} {high}");
    }
}

/// The record begins one sample after a step, and only its last rows do not depend on the input before.
#[test]
fn regress_a_rest_that_is_refuted_and_needed_is_a_doubt() {
    let truth = ProcessModel::new(2.0).unwrap().with_lags(vec![0.5]).unwrap();
    let input: Vec<f64> = (0..67).map(|k| f64::from(u8::from(k >= 40) + u8::from(k >= 60))).collect();
    let mut noise = Noise::new(8);
    let output: Vec<f64> = answer(&truth, 0.33, &input, 0.1).iter().map(|y| y + 1e-6 * noise.normal()).collect();
    let data = Dataset::siso(0.1, &input[41..], &output[41..]).unwrap();
    let fit = ProcessFit::named("P1D").unwrap().with_delay_between(&[(0.0, 2.0)]).fit(&data).unwrap();
    let refuted = fit.doubts.contains(&Doubt::HeldBeforeRefuted);
    assert!(refuted && !fit.doubts.contains(&Doubt::HeldBefore), "{:?} {:?}", fit.parameters(), fit.doubts);
}
