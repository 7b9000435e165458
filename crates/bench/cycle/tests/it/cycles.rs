use cycle::{CycleError, EngineMap, Kind, SpeedScale, all, builtin};

use crate::support::{assert_close, map};

#[test]
fn ref_worked_examples_of_the_regulations() {
    // 40 CFR 1065.610(c): 85 % between 650 and 2364 r/min; A, B and C between 1005 and 2385 r/min.
    assert_eq!(SpeedScale::between(650.0, 2364.0).speed_rad_s(85.0).round(), 2107.0);
    let [a, b, c] = [25.0, 50.0, 75.0].map(|percent| SpeedScale::between(1005.0, 2385.0).speed_rad_s(percent));
    assert_eq!((a, b, c), (1350.0, 1695.0, 2040.0));
    // Alternate maximum test speed: 105 % is the high idle of 2200 r/min.
    assert_eq!(SpeedScale::between(800.0, 2200.0).speed_rad_s(100.0 / 1.05).round(), 2133.0);
    // WHTC and NRTC, 43 %.
    assert_eq!(SpeedScale::whtc(1015.0, 1300.0, 2200.0, 600.0).speed_rad_s(43.0).round(), 1178.0);
    assert_eq!(SpeedScale::between(600.0, 2200.0).speed_rad_s(43.0).round(), 1288.0);
}

#[test]
fn exact_series_have_their_known_sums() {
    let whtc = builtin("WHTC").unwrap().normalised().unwrap();
    assert_eq!(whtc.len(), 1800);
    assert_eq!(whtc.iter().filter(|point| point.1.is_none()).count(), 401);
    assert_close(whtc.iter().map(|point| point.0).sum(), 66_745.6, 1e-12);
    assert_close(whtc.iter().filter_map(|point| point.1).sum(), 43_013.2, 1e-12);
    let nrtc = builtin("nrtc").unwrap().normalised().unwrap();
    assert_eq!((nrtc.len(), nrtc.iter().map(|point| point.0).sum::<f64>()), (1238, 83_774.0));
    assert_eq!(nrtc.iter().filter_map(|point| point.1).sum::<f64>(), 48_674.0);
    let wltc = builtin("wltc-3b").unwrap().vehicle_speed_m_s().unwrap();
    assert_close(wltc.iter().sum::<f64>() * 3.6, 83_758.6, 1e-12);
    let udds = builtin("udds").unwrap().vehicle_speed_m_s().unwrap();
    assert_eq!(udds.len(), 1370);
    assert_close(udds.iter().sum::<f64>() / 1609.344, 7.450, 2e-4);
}

#[test]
fn exact_cycles_last_as_long_as_they_should() {
    let lengths = [1800.0, 1238.0, 1895.0, 1800.0, 1200.0, 1800.0, 1800.0, 1369.0];
    for (cycle, length) in all().iter().zip(lengths) {
        assert_eq!(cycle.duration_s().unwrap(), length, "{}", cycle.name);
        assert!(cycle.source().unwrap().len() > 20, "{}", cycle.name);
    }
}

#[test]
fn ref_series_equal_those_of_the_reference_data() {
    let Some(folder) = testdata::shared("reference/cycles") else { return };
    let rows = |file: &str| -> Vec<Vec<String>> {
        let text = std::fs::read_to_string(folder.join(file)).unwrap();
        text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    for (name, file) in [("whtc", "whtc_normalised.csv"), ("nrtc", "nrtc_normalised.csv")] {
        let theirs: Vec<(f64, Option<f64>)> =
            rows(file).iter().map(|row| (row[1].parse().unwrap(), row[2].parse().ok())).collect();
        assert_eq!(builtin(name).unwrap().normalised().unwrap(), theirs);
    }
    for (name, file, unit) in [("wltc-3b", "wltc_class3b_speed.csv", 1.0 / 3.6), ("udds", "udds_speed.csv", 0.44704)] {
        let theirs: Vec<f64> = rows(file).iter().map(|row| row[1].parse::<f64>().unwrap() * unit).collect();
        assert_eq!(builtin(name).unwrap().vehicle_speed_m_s().unwrap(), theirs);
    }
}

#[test]
fn ref_ramped_modes_equal_those_of_the_reference_data() {
    let Some(folder) = testdata::shared("reference/cycles") else { return };
    let map = map();
    for name in ["c1", "d2", "g2"] {
        let course = builtin(&format!("{name}-rmc")).unwrap().reference(&map).unwrap();
        let text = std::fs::read_to_string(folder.join(format!("{name}_rmc.csv"))).unwrap();
        let speed = |set: &str| match set {
            "warm_idle" => map.idle_rad_s(),
            "intermediate_test_speed" => map.intermediate_test_speed_rad_s(),
            _ => map.maximum_test_speed_rad_s(),
        };
        let torque = |percent: &str, speed: f64| {
            let at = if name == "d2" { map.maximum_test_speed_rad_s() } else { speed };
            percent.parse::<f64>().unwrap() / 100.0 * map.full_load_nm(at)
        };
        let mut begins = 0.0;
        for row in text.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>()) {
            let length: f64 = row[2].parse().unwrap();
            for (into, share) in [(0.0, 0.0), (length / 2.0, 0.5)] {
                let (from, to) = (speed(row[3]), speed(row[4]));
                assert_close(course.speed_at(begins + into), from + share * (to - from), 1e-12);
                let (low, high) = (torque(row[5], from), torque(row[6], to));
                let found = course.torque_at(begins + into);
                assert!((found - (low + share * (high - low))).abs() < 1e-9, "{name} {}: {found}", row[0]);
            }
            begins += length;
        }
        assert_eq!(begins, builtin(&format!("{name}-rmc")).unwrap().duration_s().unwrap());
    }
}

#[test]
fn exact_motoring_is_marked_and_follows_the_map() {
    let map = map();
    let cycle = builtin("whtc").unwrap();
    let reference = cycle.reference(&map).unwrap();
    for ((percent, torque), k) in cycle.normalised().unwrap().into_iter().zip(0..) {
        let speed = reference.speed_rad_s[k];
        let expected = match torque {
            Some(torque) => 0.01 * torque * map.full_load_nm(speed),
            None => -0.4 * map.full_load_nm(speed),
        };
        assert_eq!(reference.torque_nm[k], expected, "{percent} %");
    }
    let motored = EngineMap::new(&[60.0, 150.0, 240.0], &[600.0, 900.0, 600.0], Some(&[-60.0, -80.0, -120.0]), None);
    assert_eq!(motored.unwrap().motoring_nm(195.0), -100.0);
}

#[test]
fn exact_speeds_of_a_map_with_a_flat_torque() {
    // Constant torque: power rises with speed, so its shares are shares of the highest speed.
    let map = EngineMap::new(&[50.0, 100.0, 200.0], &[400.0, 400.0, 400.0], None, None).unwrap();
    assert_close(map.lowest_with_power_rad_s(0.55), 110.0, 1e-4);
    assert_close(map.highest_with_power_rad_s(0.7), 200.0, 1e-12);
    assert_close(map.preferred_rad_s(), 50.0 + 0.51 * 150.0, 1e-3);
    // (n/200)² + (n/200)² ≥ 0.98 · 2.
    assert_close(map.maximum_test_speed_rad_s(), 0.5 * (200.0 + 200.0 * 0.98_f64.sqrt()), 1e-4);
    assert_close(map.intermediate_test_speed_rad_s(), 0.6 * map.maximum_test_speed_rad_s(), 1e-12);
}

#[test]
fn regress_bad_maps_name_the_row() {
    let bad = |speed: &[f64], torque: &[f64]| EngineMap::new(speed, torque, None, None).unwrap_err();
    assert!(matches!(bad(&[1.0, 3.0, 2.0], &[1.0, 1.0, 1.0]), CycleError::Map { row: 3, .. }));
    assert!(matches!(bad(&[1.0, 2.0, 3.0], &[1.0, -1.0, 1.0]), CycleError::Map { row: 2, .. }));
    assert!(matches!(bad(&[1.0, 2.0, 3.0], &[1.0, f64::NAN, 1.0]), CycleError::Map { row: 2, .. }));
    assert!(matches!(bad(&[1.0, 2.0], &[1.0, 1.0]), CycleError::Map { .. }));
    assert!(EngineMap::new(&[1.0, 2.0, 3.0], &[1.0, 1.0, 1.0], None, Some(4.0)).is_err());
}

#[test]
fn regress_names_that_do_not_exist_list_those_that_do() {
    let error = builtin("ftp").unwrap_err().to_string();
    assert!(error.contains("whtc") && error.contains("udds"), "{error}");
    let vehicle = builtin("udds").unwrap();
    assert_eq!(vehicle.kind, Kind::Vehicle);
    assert!(matches!(vehicle.reference(&map()), Err(CycleError::NeedsVehicle { name: "udds" })));
    assert!(matches!(builtin("whsc").unwrap().vehicle_speed_m_s(), Err(CycleError::NoVehicle { .. })));
}
