use cycle::{CycleError, Driver, Gearbox, Vehicle, builtin};
use units::RPM_RAD_S;

use crate::support::assert_close;

fn car() -> (Vehicle, Gearbox) {
    let vehicle = Vehicle {
        mass_kg: 1500.0,
        rotating_mass_kg: 60.0,
        rolling_resistance: 0.01,
        drag_area_m2: 0.65,
        tyre_radius_m: 0.31,
        axle_ratio: 3.9,
        efficiency: 0.955,
    };
    let ratios = vec![3.5, 2.0, 1.35, 1.0, 0.8];
    (vehicle, Gearbox { ratios, up_rpm: 2400.0, down_rpm: 1100.0, idle_rpm: 800.0 })
}

#[test]
fn exact_one_step_of_the_vehicle() {
    let (vehicle, _) = car();
    let load = 1500.0 * 9.80665 * 0.01 + 0.5 * 1.1845 * 0.65 * 400.0;
    assert_close(vehicle.road_load_n(20.0, 0.0), load, 1e-12);
    assert_close(vehicle.next_speed_m_s(20.0, 1000.0, 0.0, 0.01), 20.0 + 0.01 * (1000.0 - load) / 1560.0, 1e-12);
    assert_close(vehicle.input_speed_rad_s(20.0), 3.9 * 20.0 / 0.31, 1e-12);
    // Uphill the weight pulls back, and a vehicle does not roll back.
    assert!(vehicle.road_load_n(20.0, 0.05) > load + 700.0);
    assert_eq!(vehicle.next_speed_m_s(0.0, -1e5, 0.0, 0.1), 0.0);
}

#[test]
fn exact_the_driver_follows_the_urban_schedule() {
    let (vehicle, gears) = car();
    let schedule = builtin("udds").unwrap().vehicle_speed_m_s().unwrap();
    let run = vehicle.follow(&schedule, &gears, &Driver::of(&vehicle)).unwrap();
    assert_eq!(run.speed_m_s.len(), schedule.len());
    let worst = schedule.iter().zip(&run.speed_m_s).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 2.0 * 0.44704, "{worst} m/s");
    let idle = 800.0 * RPM_RAD_S;
    assert!(run.reference.speed_rad_s.iter().all(|speed| *speed >= idle && *speed < 3000.0 * RPM_RAD_S));
    assert_eq!((run.gear.iter().min(), run.gear.iter().max()), (Some(&1), Some(&5)));
    assert!(run.reference.torque_nm.iter().all(|torque| torque.abs() < 400.0));
}

#[test]
fn regress_data_that_cannot_be_are_named() {
    let (vehicle, gears) = car();
    let bad = Vehicle { mass_kg: 0.0, ..vehicle };
    let error = bad.follow(&[0.0, 1.0], &gears, &Driver::of(&vehicle)).unwrap_err();
    assert!(matches!(error, CycleError::Vehicle { name: "mass_kg", .. }), "{error}");
    let bad = Gearbox { up_rpm: 900.0, ..gears };
    assert!(vehicle.follow(&[0.0, 1.0], &bad, &Driver::of(&vehicle)).is_err());
}
