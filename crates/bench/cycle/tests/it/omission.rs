//! The rows of the table of omissions, case by case.

use cycle::{Points, Rows, Scales};

const SCALES: Scales =
    Scales { idle_rad_s: 60.0, maximum_test_speed_rad_s: 250.0, maximum_torque_nm: 1000.0, maximum_power_w: 200_000.0 };

/// The rows of one point: reference, feedback, operator's demand.
fn rows((n_ref, t_ref): (f64, f64), (n, t): (f64, f64), demand: Option<f64>) -> Rows {
    let points = Points {
        time_s: vec![1.0],
        speed_reference_rad_s: vec![n_ref],
        torque_reference_nm: vec![t_ref],
        speed_rad_s: vec![n],
        torque_nm: vec![t],
        demand: demand.into_iter().collect(),
    };
    points.rows(&SCALES)[0]
}

const NONE: Rows = Rows { motoring: false, idle: false, above: false, below: false };

#[test]
fn exact_least_demand_motoring() {
    let found = rows((150.0, -100.0), (150.0, -120.0), Some(0.0));
    assert_eq!(found, Rows { motoring: true, ..NONE });
    // With pedal, nothing is left out.
    assert_eq!(rows((150.0, -100.0), (150.0, -120.0), Some(0.02)), NONE);
    // 1 % still counts as least demand; without a recorded demand the reference says so.
    assert!(rows((150.0, -100.0), (150.0, -120.0), Some(0.01)).motoring);
    assert!(rows((150.0, -100.0), (150.0, -120.0), None).motoring);
}

#[test]
fn exact_least_demand_idle() {
    assert_eq!(rows((60.0, 0.0), (60.0, -19.9), Some(0.0)), Rows { idle: true, ..NONE });
    // The torque must be within 2 % of the largest one.
    assert_eq!(rows((60.0, 0.0), (60.0, -20.1), Some(0.0)), NONE);
    // Not at idle speed, or a torque is asked for.
    assert!(!rows((70.0, 0.0), (70.0, 0.0), Some(0.0)).idle);
    assert!(!rows((60.0, 5.0), (60.0, 5.0), Some(0.0)).idle);
    assert!(rows((60.0, 0.0), (61.0, 1.0), None).idle);
}

#[test]
fn exact_least_demand_above_the_reference() {
    let least = |n: f64, t: f64| rows((100.0, 200.0), (n, t), Some(0.0)).above;
    assert!(least(100.5, 190.0), "speed above");
    assert!(least(99.0, 201.0), "torque above");
    assert!(!least(99.0, 199.0), "neither");
    assert!(least(102.0, 300.0), "both above, but the speed by no more than 2 %");
    assert!(least(110.0, 220.0), "both above, but the torque by no more than 2 % of the largest");
    assert!(!least(102.1, 220.1), "both far above");
    assert!(!rows((100.0, 200.0), (101.0, 200.0), None).above, "no demand recorded, and the reference asks for torque");
}

#[test]
fn exact_most_demand_below_the_reference() {
    let most = |n: f64, t: f64| rows((100.0, 200.0), (n, t), Some(1.0)).below;
    assert!(most(99.5, 210.0), "speed below");
    assert!(most(101.0, 199.0), "torque below");
    assert!(!most(101.0, 201.0), "neither");
    assert!(most(98.0, 100.0), "both below, but the speed by no more than 2 %");
    assert!(most(90.0, 180.0), "both below, but the torque by no more than 2 % of the largest");
    assert!(!most(97.9, 179.9), "both far below");
    assert!(rows((100.0, 200.0), (99.0, 200.0), Some(0.99)).below, "99 % counts as most");
    assert!(!rows((100.0, 200.0), (99.0, 200.0), Some(0.98)).below);
    assert!(!rows((100.0, 200.0), (99.0, 200.0), None).below);
}
