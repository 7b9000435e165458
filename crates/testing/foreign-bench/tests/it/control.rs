//! Controllers, drive and sensors against their formulas.

use foreign_bench::{Mode, run};

use crate::support::{RPM, mean, quiet, steady};

/// T_d* of both kinds of delay, from the recorded speeds alone.
#[test]
fn exact_the_controller_is_a_delayed_pi_with_feed_forward() {
    for delays_demand in [true, false] {
        let mut bench = quiet(7);
        (bench.controller.delay_ms, bench.controller.delays_demand) = (2, delays_demand);
        let mut demand = steady(Mode::Speed, 1500.0 * RPM, 60.0, 1000);
        demand.speed_rad_s[500..].fill(1530.0 * RPM);
        let ran = run(&bench, &demand, 1);
        let pi = &bench.controller;
        let speed = |k: usize| demand.speed_rad_s[k];
        let error = |k: usize| ran.dyno_speed_rad_s[k - 2] - if delays_demand { speed(k - 2) } else { speed(k) };
        let without_integral = |k: usize| {
            ran.torque_demand_nm[k]
                - pi.proportional_nm_s_per_rad * error(k)
                - pi.speed_gain_nm_s_per_rad * speed(k)
                - pi.acceleration_gain_nm_s2_per_rad * (speed(k) - speed(k - 1)) / 1e-3
        };
        for k in 10..999 {
            let gained = without_integral(k + 1) - without_integral(k);
            let wanted = pi.integral_nm_per_rad * 1e-3 * error(k);
            // The limit cuts the kick of the feed-forward.
            let is_cut = ran.torque_demand_nm[k].abs().max(ran.torque_demand_nm[k + 1].abs()) >= bench.drive.limit_nm;
            assert!(is_cut || (gained - wanted).abs() < 1e-8, "{k}: {gained} {wanted}");
        }
    }
}

/// A held demand arrives after d and then as 1 − e^{−ωt}; the load cell has the same mean.
#[test]
fn exact_the_drive_is_late_and_lags() {
    let bench = quiet(8);
    let mut demand = steady(Mode::Torque, 1500.0 * RPM, 60.0, 1500);
    demand.torque_nm[100..].fill(85.0);
    let ran = run(&bench, &demand, 1);
    for k in 95..160 {
        let since_s = (1e-3 * (k as f64 - 100.0) - bench.drive.delay_s).max(0.0);
        let wanted = 60.0 + 25.0 * (1.0 - (-bench.drive.bandwidth_rad_s * since_s).exp());
        assert!((ran.computed_torque_nm[k] - wanted).abs() < 1e-6, "{k}");
    }
    assert!((mean(&ran.cell_torque_nm[1000..]) - 85.0).abs() < 1e-6);
    let largest = ran.cell_torque_nm.iter().fold(0.0_f64, |most, torque| most.max(*torque));
    assert!(largest > 90.0, "the load cell swings: {largest}");
}

/// An encoder shows the mean speed over a millisecond: turned angle over time. Slits give the same on the average.
#[test]
fn exact_encoders_show_mean_speeds() {
    let exact = quiet(9);
    let demand = steady(Mode::Speed, 1200.0 * RPM, 60.0, 2000);
    let ran = run(&exact, &demand, 1);
    for k in 1..2000 {
        let turned = ran.truth.crank_angle_rad[k] - ran.truth.crank_angle_rad[k - 1];
        assert!((ran.engine_speed_rad_s[k] - turned / 1e-3).abs() < 1e-6, "{k}");
    }
    let mut with_slits = exact.clone();
    with_slits.sensors.slits = Some(1024);
    let slits = run(&with_slits, &demand, 1);
    let apart: Vec<f64> =
        slits.engine_speed_rad_s.iter().zip(&slits.truth.engine_speed_rad_s).map(|(a, b)| a - b).collect();
    assert!(mean(&apart).abs() < 0.01 * RPM, "{}", mean(&apart));
    let mut with_error = exact;
    with_error.sensors.pitch_error_rad = [3e-4, 0.0];
    let uneven = run(&with_error, &demand, 1);
    let apart = |k: usize| {
        let truth = &uneven.truth;
        let turned = |k: usize| truth.crank_angle_rad[k] - truth.twist_rad[k];
        uneven.dyno_speed_rad_s[k] - (turned(k) - turned(k - 1)) / 1e-3
    };
    let largest = (1..2000).map(apart).fold(0.0, f64::max);
    let speed = 1200.0 * RPM;
    assert!((largest / (3e-4 * speed) - 1.0).abs() < 0.1, "{largest}");
}
