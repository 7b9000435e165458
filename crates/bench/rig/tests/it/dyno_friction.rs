//! Friction as it is expected from an estimate and from what is assumed.

use bench_testkit::benches::default_bench;
use proptest::prelude::*;
use rig::dyno_friction::{EstimatedFriction, ExpectedFriction};

const LIMIT_NM: f64 = 400.0;

/// An estimate by the friction at 50 rad/s and the slope, and by their standard deviations.
fn estimated((torque_nm, of_torque): (f64, f64), (slope, of_slope): (f64, f64)) -> EstimatedFriction {
    let (variance, of_slope) = (of_torque * of_torque, of_slope * of_slope);
    EstimatedFriction {
        coulomb_nm: torque_nm - 50.0 * slope,
        viscous_nm_s_per_rad: slope,
        covariance: [[variance + 2500.0 * of_slope, -50.0 * of_slope], [-50.0 * of_slope, of_slope]],
        speeds_rad_s: (10.0, 100.0),
        recordings: vec!["NoShaft_N_NT.mf4".to_owned()],
    }
}

fn expected(estimated: Option<&EstimatedFriction>) -> ExpectedFriction {
    ExpectedFriction::of(&default_bench(), LIMIT_NM, estimated)
}

#[test]
fn exact_a_poor_run_out_leaves_the_assumption_and_a_good_one_replaces_it() {
    let assumed = expected(None);
    assert!((assumed.mean_nm(100.0) - 1.8).abs() < 1e-12);
    let poor = expected(Some(&estimated((0.3, 100.0), (0.1, 5.0))));
    let good = expected(Some(&estimated((1.5, 1e-3), (0.01, 1e-5))));
    for speed in [0.0, 50.0, 100.0, 300.0] {
        let (mean, deviation) = (assumed.mean_nm(speed), assumed.deviation_nm(speed));
        assert!((poor.mean_nm(speed) - mean).abs() < 0.02 * deviation, "{speed}: {} {mean}", poor.mean_nm(speed));
        assert!((poor.deviation_nm(speed) / deviation - 1.0).abs() < 0.02, "{speed}");
    }
    // Of a good one the doubt of another day remains, 20 %.
    assert!((good.mean_nm(50.0) - 1.5).abs() < 0.05, "{good:?}");
    assert!((good.deviation_nm(50.0) / 0.3 - 1.0).abs() < 0.06, "{good:?}");
    // The class has 3.6 Nm at 100 rad/s at the most.
    let steep = expected(Some(&estimated((12.0, 0.1), (0.1, 1e-3))));
    assert!((steep.mean_nm(50.0) - 12.0).abs() < 1e-9 && (steep.deviation_nm(50.0) - 2.4).abs() < 0.01, "{steep:?}");
}

/// A sum that is well known stays as it is, even if one of its parts is likely below zero.
#[test]
fn exact_parts_below_zero_keep_the_sum() {
    let mut bench = default_bench();
    bench.dynamometer_friction_uncertainty_percent = Some(1.0);
    let found = estimated((1.0, 0.01), (0.024, 4e-3));
    assert!(found.coulomb_nm < 0.0);
    let joined = ExpectedFriction::of(&bench, LIMIT_NM, Some(&found));
    assert!((joined.mean_nm(50.0) - 1.0).abs() < 0.01, "{joined:?}");
    assert!(joined.deviation_nm(50.0) < 0.02, "{joined:?}");
}

#[test]
fn exact_beyond_the_speeds_of_run_outs_the_doubt_grows() {
    let mut bench = default_bench();
    bench.dynamometer_friction_uncertainty_percent = Some(1.0);
    let joined = ExpectedFriction::of(&bench, LIMIT_NM, Some(&estimated((1.0, 0.01), (0.002, 1e-4))));
    let deviations = [100.0, 110.0, 150.0, 200.0, 300.0].map(|speed| joined.deviation_nm(speed));
    assert!(deviations.is_sorted() && deviations[1] > 2.0 * deviations[0], "{deviations:?}");
    // Dry friction, and windage, which fits the line at 50 rad/s and no more.
    for speed in [110.0, 150.0, 200.0] {
        let last = joined.mean_nm(100.0);
        let reach = 2.0 * joined.deviation_nm(speed);
        assert!((joined.mean_nm(speed) - last).abs() < reach, "{speed}: {reach}");
    }
    let assumed = expected(None);
    assert!(deviations[4] <= assumed.deviation_nm(300.0) * (1.0 + 1e-9), "{deviations:?}");
    assert!(joined.deviation_nm(1.0) > joined.deviation_nm(10.0), "{joined:?}");
}

proptest! {
    /// No run-out that agrees with the assumption makes friction less known than without it, at any speed.
    #[test]
    fn prop_no_run_out_widens_the_assumption(
        share in 0.0..1.0, of_torque in 1e-4..50.0, slope in 0.0..0.02, of_slope in 1e-6..1.0, speed in 0.0..600.0,
    ) {
        let assumed = expected(None);
        let coulomb = share * 1.6;
        let joined = expected(Some(&estimated((coulomb + 50.0 * slope, of_torque), (slope, of_slope))));
        prop_assert!(joined.deviation_nm(speed) <= assumed.deviation_nm(speed) * (1.0 + 1e-6), "{joined:?}");
        prop_assert!(joined.covariance[0][0] >= 0.0 && joined.covariance[1][1] >= 0.0);
    }
}
