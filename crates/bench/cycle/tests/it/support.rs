//! Data and functions that several tests share.

use cycle::EngineMap;
use units::RPM_RAD_S;

/// A heavy engine: idle 600 rpm, 1100 Nm, rated near 2000 rpm.
pub(crate) fn map() -> EngineMap {
    let rpm = [600.0, 900.0, 1100.0, 1300.0, 1500.0, 1700.0, 1900.0, 2100.0, 2300.0];
    let torque = [600.0, 900.0, 1080.0, 1100.0, 1090.0, 1020.0, 930.0, 780.0, 300.0];
    let speed: Vec<f64> = rpm.iter().map(|rpm| rpm * RPM_RAD_S).collect();
    EngineMap::new(&speed, &torque, None, None).unwrap()
}

pub(crate) fn assert_close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} where {expected} is expected");
}
