//! A flywheel running down: the polynomial of its losses.

use faer::Mat;
use ident::least_squares;

use super::text;

/// Differences of the speed are taken over so many rows.
const REACH: usize = 54;

/// Mean over `width` rows about each, over fewer towards the ends.
fn smoothed(x: &[f64], width: usize) -> Vec<f64> {
    let half = |i: usize| (width / 2).min(i).min(x.len() - 1 - i);
    let mean = |i: usize| x[i - half(i)..=i + half(i)].iter().sum::<f64>() / (2 * half(i) + 1) as f64;
    (0..x.len()).map(mean).collect()
}

/// Time in s and speed in rad/s, single readings of zero replaced by the one before.
fn record() -> Option<(Vec<f64>, Vec<f64>)> {
    let text = text("inertia-dyno/unloaded_spindown.txt")?;
    let column = |line: &str, j: usize| line.split_whitespace().nth(j).unwrap().parse::<f64>().unwrap();
    let time = text.lines().map(|l| 1e-3 * column(l, 5)).collect();
    let mut speed: Vec<f64> = text.lines().map(|l| column(l, 3)).collect();
    for i in 1..speed.len() - 1 {
        if speed[i] == 0.0 && speed[i - 1] > 0.0 && speed[i + 1] > 0.0 {
            speed[i] = speed[i - 1];
        }
    }
    Some((time, smoothed(&speed, 21).iter().map(|v| v * std::f64::consts::TAU / 60.0).collect()))
}

#[test]
fn ref_run_down_losses() {
    let Some((time, speed)) = record() else { return };
    let top = (49..).find(|i| speed[i - 49] < speed[*i] && speed[*i] > speed[i + 49]).unwrap();
    let first = top + 200;
    let last = (first..).find(|i| speed[i - 49] < 4.0 && speed[*i] < 4.0).unwrap();
    let slope = |i: usize| (speed[i + REACH] - speed[i]) / (time[i + REACH] - time[i]);
    let target: Vec<f64> = (first..=last).map(slope).collect();
    let powers = Mat::from_fn(target.len(), 4, |i, j| speed[first + i].powi(3 - j as i32));
    let fit = least_squares(powers.as_ref(), &target).unwrap();
    let published = [-1.740_098_95e-7, 2.903_356_143_9e-5, -3.222_070_361_203e-3, -3.097_320_763_865_2e-2];
    for (found, published) in fit.parameters.iter().zip(published) {
        assert!((found / published - 1.0).abs() < 1e-8, "{:?}", fit.parameters);
    }
}
