use cycle::{BandTolerance, Course, ModeTolerance, Own, Signal, speed_band, steady_modes};
use units::RPM_RAD_S;

use crate::support::assert_close;

/// A step at 0.1 s to 10, followed by a first-order lag of 50 ms, in ms.
fn step() -> (Vec<f64>, Vec<f64>) {
    let demand: Vec<f64> = (0..1000).map(|k| if k < 100 { 0.0 } else { 10.0 }).collect();
    let lag = |k: i32| if k < 100 { 0.0 } else { 10.0 * (1.0 - (-f64::from(k - 100) / 50.0).exp()) };
    (demand, (0..1000).map(lag).collect())
}

fn judge(text: &str, (demand, value): &(Vec<f64>, Vec<f64>)) -> cycle::Judged {
    text.parse::<Own>().unwrap().judge(&Course { sample_time_s: 1e-3, demand, value })
}

#[test]
fn exact_a_lag_has_the_rise_and_settling_of_a_lag() {
    let step = step();
    let rise = judge("torque rise below 120 ms", &step);
    assert!((rise.value - 0.05 * 9.0_f64.ln()).abs() < 1.1e-3 && rise.passes(), "{rise:?}");
    let settling = judge("torque settling within 2 % below 0.19 s", &step);
    assert!((settling.value - 0.05 * 50.0_f64.ln()).abs() < 1.1e-3 && !settling.passes(), "{settling:?}");
    assert_eq!(judge("torque overshoot below 1 %", &step).value, 0.0);
}

#[test]
fn exact_overshoot_and_share_of_the_time() {
    let (demand, mut value) = step();
    value[400] = 11.5;
    assert_close(judge("speed overshoot below 10 %", &(demand.clone(), value.clone())).value, 0.15, 1e-12);
    let flat = (vec![0.0; 1000], (0..1000).map(|k| if k < 50 { 2.0 } else { 0.5 }).collect::<Vec<_>>());
    assert!(judge("torque within 1 Nm for 95 %", &flat).passes());
    assert!(!judge("torque within 1 Nm for 96 %", &flat).passes());
}

#[test]
fn exact_texts_are_read_with_their_units() {
    let own: Own = "speed within 10 rpm for 95 %".parse().unwrap();
    let Own::Within { signal: Signal::Speed, error, share } = own else { panic!("{own:?}") };
    assert_close(error, 10.0 * RPM_RAD_S, 1e-12);
    assert_close(share, 0.95, 1e-12);
    for (text, problem) in [
        ("power within 1 W for 95 %", "speed"),
        ("speed within 10 Nm for 95 %", "Nm"),
        ("speed within 10 rpm", "for"),
        ("speed faster than light", "after the signal"),
        ("torque rise 50 ms", "below"),
        ("speed within 1 rpm for 150 %", "share"),
    ] {
        let error = text.parse::<Own>().unwrap_err().to_string();
        assert!(error.contains(problem) && error.contains(text), "{error}");
    }
}

#[test]
fn exact_a_vehicle_may_leave_its_band_for_two_seconds() {
    let tolerance = BandTolerance { mph: 2.0, around_s: 1.0, excursion_s: 2.0 };
    let schedule: Vec<f64> = (0..60).map(|k| f64::from(k).min(20.0)).collect();
    let run = |beyond: f64, seconds: f64| -> Vec<f64> {
        let at = |k: i32| {
            let time = f64::from(k) * 0.1;
            time.min(20.0) + if time >= 40.0 && time < 40.0 + seconds { beyond } else { 0.0 }
        };
        (0..590).map(at).collect()
    };
    let found = |beyond, seconds| speed_band(&schedule, (0.1, &run(beyond, seconds)), &tolerance).unwrap();
    assert!(found(0.89, 10.0).is_empty(), "2 mph are 0.894 m/s");
    let short = found(0.9, 1.95);
    assert!(short.len() == 1 && short[0].is_allowed && (short[0].start_s - 40.0).abs() < 1e-9, "{short:?}");
    assert!(!found(0.9, 2.25)[0].is_allowed);
    // A second early or late on a slope is no excursion.
    let late: Vec<f64> = (0..590).map(|k| (f64::from(k) * 0.1 - 1.0).clamp(0.0, 20.0)).collect();
    assert!(speed_band(&schedule, (0.1, &late), &tolerance).unwrap().is_empty());
}

#[test]
fn exact_tolerances_of_modes_are_the_greater_of_two() {
    let tolerance = ModeTolerance { speed_percent: 1.0, speed_rpm: 3.0, torque_percent: 2.0 };
    let slow = steady_modes((20.2, 100.0), (20.0, 100.0), (25.0, 500.0), &tolerance);
    assert_close(slow.speed_limit_rad_s, 3.0 * RPM_RAD_S, 1e-12);
    assert!(slow.passes());
    let fast = steady_modes((202.0, 111.0), (200.0, 100.0), (250.0, 500.0), &tolerance);
    assert_eq!((fast.speed_limit_rad_s, fast.torque_limit_nm), (2.5, 10.0));
    assert!(!fast.passes());
}
