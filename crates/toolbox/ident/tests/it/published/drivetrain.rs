//! A geared laboratory drivetrain, two speeds and two torques under steps of the load (Aalto University), with a
//! published model of 22 inertias.

use std::f64::consts::TAU;

use faer::Mat;
use lti::StateSpace;
use signal::spectrum::{Welch, peaks, power_spectrum};

use super::text;

fn rows(path: &str) -> Option<Vec<Vec<f64>>> {
    let text = text(path)?;
    Some(text.lines().map(|line| line.split(',').map(|cell| cell.trim().parse().unwrap()).collect()).collect())
}

/// The frequencies of the model's slowest modes, by LAPACK. The published ones, of the inertias and stiffnesses alone,
/// are 28.0, 39.6 and 68.3 Hz: this model has gears and bearings damped and its motor's drive in it.
#[test]
fn ref_drivetrain_modes_of_the_model() {
    let Some(rows) = rows("aalto-drivetrain/models/tb_A.csv") else { return };
    let n = rows.len();
    let a = Mat::from_fn(n, n, |i, j| rows[i][j]);
    let system = StateSpace::continuous(a, Mat::zeros(n, 1), Mat::zeros(1, n), Mat::zeros(1, 1)).unwrap();
    let mut hertz: Vec<f64> = system.poles().unwrap().iter().filter(|p| p.im > 0.0).map(|p| p.norm() / TAU).collect();
    hertz.sort_by(f64::total_cmp);
    for (found, (lapack, published)) in hertz.iter().zip([(29.144, 28.0), (39.711, 39.6), (69.888, 68.3)]) {
        assert!((found - lapack).abs() < 1e-3 && (found / published - 1.0).abs() < 0.05, "{found}");
    }
}

/// The torque measured at either place has its first mode at 27.9 Hz.
#[test]
fn ref_drivetrain_peak_of_the_measured_torque() {
    let Some(rows) = rows("aalto-drivetrain/step_sensor.csv") else { return };
    let sample_time_s = (rows[rows.len() - 1][0] - rows[0][0]) / (rows.len() - 1) as f64;
    for torque in [3, 4] {
        let x: Vec<f64> = rows.iter().map(|row| row[torque]).collect();
        let power = power_spectrum(&x, sample_time_s, Welch::half_overlapping(4096)).unwrap();
        let intervals: Vec<(f64, f64)> =
            power.interval(0.95).unwrap().iter().map(|[low, high]| (*low, *high)).collect();
        let found = peaks(&power.freq_hz, &power.density, &intervals, 2, 2.0);
        let nearest = found
            .iter()
            .map(|peak| power.freq_hz[peak.index])
            .min_by(|a, b| (a - 27.9).abs().total_cmp(&(b - 27.9).abs()));
        assert!(nearest.is_some_and(|hz| (hz - 27.9).abs() < 0.25), "{nearest:?}");
    }
}
