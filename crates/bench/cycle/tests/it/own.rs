use std::f64::consts::TAU;

use cycle::{BandTolerance, Course, ModeTolerance, Own, Samples, Signal, speed_band, steady_modes};
use units::RPM_RAD_S;

use crate::support::assert_close;

/// A step at 0.1 s to 10, followed by a first-order lag of 50 ms, in ms.
fn step() -> (Vec<f64>, Vec<f64>) {
    let demand: Vec<f64> = (0..1000).map(|k| if k < 100 { 0.0 } else { 10.0 }).collect();
    let lag = |k: i32| if k < 100 { 0.0 } else { 10.0 * (1.0 - (-f64::from(k - 100) / 50.0).exp()) };
    (demand, (0..1000).map(lag).collect())
}

fn judge(text: &str, (demand, value): &(Vec<f64>, Vec<f64>)) -> cycle::Judged {
    text.parse::<Own>().unwrap().judge(&Course { sample_time_s: 1e-3, demand, value, timed_demand: None })
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
        ("speed within -5 rpm for 95 %", "error"),
        ("speed within 0 rpm for 95 %", "error"),
        ("speed within 10 rpm for 0 %", "share"),
        ("torque rise below 0 ms", "time"),
        ("torque settling within 0 % below 1 s", "band"),
        ("torque settling within 2 % below -1 s", "time"),
        ("speed overshoot below -1 %", "overshoot"),
        ("torque phase at 5 Hz below 0 deg", "angle"),
        ("torque amplitude at 5 Hz below 0 Nm", "amplitude"),
    ] {
        let error = text.parse::<Own>().unwrap_err().to_string();
        assert!(error.contains(problem) && error.contains(text), "{error}");
    }
}

/// Checks that a demand that is followed exactly can be judged.
fn checked(text: &str, demand: &[f64]) -> Result<(), String> {
    let course = Course { sample_time_s: 1e-3, demand, value: demand, timed_demand: None };
    text.parse::<Own>().unwrap().check(&course).map_err(|error| error.to_string())
}

#[test]
fn regress_what_needs_a_step_is_refused_where_the_demand_has_none() {
    let (step, _) = step();
    let flat = vec![5.0; 1000];
    let there_and_back: Vec<f64> = (0..1000).map(|k| if (300..600).contains(&k) { 1.0 } else { 0.0 }).collect();
    let sweep: Vec<f64> = (0..1000).map(|k| 3.0 * (TAU * 5.3e-3 * f64::from(k)).sin()).collect();
    for text in ["torque rise below 50 ms", "torque overshoot below 5 %", "torque settling within 2 % below 0.5 s"] {
        assert!(checked(text, &step).is_ok(), "{text}");
        for (demand, problem) in [(&flat, "no step"), (&there_and_back, "no step"), (&sweep, "is no step")] {
            let error = checked(text, demand).unwrap_err();
            let signal = text.split(" below").next().unwrap();
            assert!(error.contains(problem) && error.contains(signal), "{error}");
        }
        assert!(checked("torque within 1 Nm for 95 %", &flat).is_ok());
    }
}

#[test]
fn regress_a_phase_is_refused_where_the_demand_has_the_frequency_once() {
    let ramp: Vec<f64> = (0..4000).map(|k| 50.0 + 100.0 * ((f64::from(k) - 1000.0) / 150.0).clamp(0.0, 1.0)).collect();
    let error = checked("torque phase at 5 Hz below 60 deg", &ramp).unwrap_err();
    assert!(error.contains("no part at 5 Hz that lasts"), "{error}");
    let (sweep, _) = sweep();
    for text in ["torque phase at 3 Hz below 60 deg", "torque phase at 15 Hz below 60 deg"] {
        assert!(checked(text, &sweep).is_ok(), "{text}");
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
    let found = |beyond, seconds| speed_band(&schedule, 0.1, &run(beyond, seconds), &tolerance).unwrap();
    assert!(found(0.89, 10.0).is_empty(), "2 mph are 0.894 m/s");
    let short = found(0.9, 1.95);
    assert!(short.len() == 1 && short[0].is_allowed && (short[0].start_s - 40.0).abs() < 1e-9, "{short:?}");
    assert!(!found(0.9, 2.25)[0].is_allowed);
    // A second early or late on a slope is no excursion.
    let late: Vec<f64> = (0..590).map(|k| (f64::from(k) * 0.1 - 1.0).clamp(0.0, 20.0)).collect();
    assert!(speed_band(&schedule, 0.1, &late, &tolerance).unwrap().is_empty());
}

#[test]
fn exact_tolerances_of_modes_are_the_greater_of_two() {
    let tolerance = ModeTolerance { speed_percent: 1.0, speed_rpm: 3.0, torque_percent: 2.0 };
    let slow = steady_modes(20.2, 100.0, 20.0, 100.0, 25.0, 500.0, &tolerance);
    assert_close(slow.speed_limit_rad_s, 3.0 * RPM_RAD_S, 1e-12);
    assert!(slow.passes());
    let fast = steady_modes(202.0, 111.0, 200.0, 100.0, 250.0, 500.0, &tolerance);
    assert_eq!((fast.speed_limit_rad_s, fast.torque_limit_nm), (2.5, 10.0));
    assert!(!fast.passes());
}

/// A sweep of 1 … 20 Hz within 20 s about 5, and what a first-order lag of 50 ms makes of it, exactly.
fn sweep() -> (Vec<f64>, Vec<f64>) {
    let growth = 20.0_f64.ln() / 20.0;
    let turns = |t: f64| ((growth * t).exp() - 1.0) / growth;
    let demand: Vec<f64> = (0..20_000).map(|k| 5.0 + 3.0 * (TAU * turns(f64::from(k) * 1e-3)).sin()).collect();
    let (stays, mut held) = ((-1e-3_f64 / 0.05).exp(), 5.0);
    let value = demand.iter().map(|wanted| {
        let before = held;
        held = wanted + (held - wanted) * stays;
        before
    });
    let value = value.collect();
    (demand, value)
}

#[test]
fn exact_phase_and_amplitude_of_a_lag() {
    let course = sweep();
    for (hz, time_s) in [(2.0_f64, 4.6), (8.0, 13.9)] {
        let lag = (TAU * hz * 0.05).atan();
        let phase = judge(&format!("torque phase at {hz} Hz below 60 deg"), &course);
        // A value held for a millisecond is half of it late.
        assert!((phase.value - lag - TAU * hz * 0.5e-3).abs() < 0.02, "{hz} Hz: {phase:?}, {lag}");
        assert_eq!(phase.passes(), hz < 5.0);
        assert!((phase.time_s - time_s).abs() < 0.5, "{phase:?}");
        let amplitude = judge(&format!("torque amplitude at {hz} Hz below 2 Nm"), &course);
        assert!((amplitude.value / (3.0 * lag.cos()) - 1.0).abs() < 0.05, "{hz} Hz: {amplitude:?}");
    }
    // A step has every frequency.
    let phase = judge("torque phase at 4 Hz below 60 deg", &step());
    assert!((phase.value - (TAU * 4.0 * 0.05_f64).atan()).abs() < 0.02, "{phase:?}");
    let sine: Vec<f64> = (0..2000).map(|k| 7.0 + 2.5 * (TAU * 3.0 * f64::from(k) * 1e-3 + 0.4).sin()).collect();
    assert_close(judge("shaft_torque amplitude at 3 Hz below 2 Nm", &(sine.clone(), sine)).value, 2.5, 1e-3);
}

/// A demand that is held for 10 ms, and a delay of 6 ms with a lag of 2 ms, known at any time.
#[test]
fn exact_a_phase_does_not_depend_on_the_rasters() {
    let held = |k: i32| 5.0 * (TAU * f64::from(k) * 0.01 * (1.0 + 0.5 * f64::from(k) * 0.01)).sin();
    // What a lag makes of the steps, from one to the next.
    let mut lagged = vec![0.0];
    for k in 0..2000 {
        let before = lagged[k as usize];
        lagged.push(held(k) + (before - held(k)) * (-0.01_f64 / 0.002).exp());
    }
    let value_at = |time_s: f64| {
        let since_s = (time_s - 0.006).max(0.0);
        let step = (since_s / 0.01 + 1e-9).floor() as i32;
        held(step) + (lagged[step as usize] - held(step)) * (-(since_s - f64::from(step) * 0.01) / 0.002).exp()
    };
    let phase_deg = |demand_ms: i32, value_ms: i32, hz: f64, is_held: bool| {
        let at = |step_ms: i32| (0..20_000 / step_ms).map(move |k| f64::from(k * step_ms) * 1e-3);
        let demand: Vec<f64> = at(demand_ms).map(|time_s| held((time_s / 0.01 + 1e-9).floor() as i32)).collect();
        let value: Vec<f64> = at(value_ms).map(value_at).collect();
        let timed = Samples { start_s: 0.0, sample_time_s: f64::from(demand_ms) * 1e-3, values: &demand, is_held };
        let text = format!("torque phase at {hz} Hz below 60 deg");
        let sample_time_s = f64::from(value_ms) * 1e-3;
        let course = Course { sample_time_s, demand: &value, value: &value, timed_demand: Some(timed) };
        text.parse::<Own>().unwrap().judge(&course).value.to_degrees()
    };
    for hz in [5.0, 12.0] {
        let exact = 360.0 * hz * 0.006 + (TAU * hz * 0.002).atan().to_degrees();
        for value_ms in [1, 4] {
            let found = phase_deg(1, value_ms, hz, true);
            // Every 4 ms, what the lag leaves of the steps is folded to this frequency.
            assert!((found - exact).abs() < 1.0, "{hz} Hz, value at {value_ms} ms: {found}, {exact}");
        }
        // A slow raster leaves the moment of a step open by half of its time at most.
        let found = phase_deg(4, 1, hz, false);
        assert!((found - exact).abs() < 360.0 * hz * 0.002, "{hz} Hz, demand at 4 ms: {found}, {exact}");
    }
}

/// A white demand that is held for 10 ms, a lag of 2 ms 6 ms later, and noise: the interval has the true phase as often
/// as it says, and the samples every 4 ms, which fold the steps, do not change that.
#[test]
fn stat_the_scatter_of_a_phase_holds() {
    let mut state = 7_u64;
    let mut normal = || {
        let uniform = |state: &mut u64| {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform(&mut state)).sum::<f64>() - 6.0
    };
    let hz = 12.0;
    let exact = TAU * hz * 0.006 + (TAU * hz * 0.002).atan();
    let (draws, mut held, mut widths) = (300, 0_u32, Vec::new());
    for _ in 0..draws {
        let steps: Vec<f64> = (0..2400).map(|_| 10.0 * normal()).collect();
        let demand: Vec<f64> = (0..24_000).map(|k| steps[k / 10]).collect();
        let (mut lagged, mut value) = (0.0, Vec::new());
        for tick in 0..24_000_usize {
            if tick % 4 == 0 {
                value.push(lagged + 2.0 * normal());
            }
            let now = if tick < 6 { 0.0 } else { steps[(tick - 6) / 10] };
            lagged = now + (lagged - now) * (-0.5_f64).exp();
        }
        let timed = Samples { start_s: 0.0, sample_time_s: 1e-3, values: &demand, is_held: true };
        let course = Course { sample_time_s: 4e-3, demand: &value, value: &value, timed_demand: Some(timed) };
        let own: Own = format!("torque phase at {hz} Hz below 60 deg").parse().unwrap();
        let scatter = own.scatter(&course).unwrap();
        held += u32::from((own.judge(&course).value - exact).abs() < scatter);
        widths.push(scatter.to_degrees());
    }
    widths.sort_by(f64::total_cmp);
    assert!((0.92..=0.98).contains(&(f64::from(held) / f64::from(draws))), "{held} of {draws}, ± {}°", widths[150]);
    assert!(widths[150] < 5.0, "{}", widths[150]);
}

#[test]
fn regress_a_frequency_that_the_test_lacks_is_named() {
    let (demand, value) = sweep();
    let problem = |text: &str, demand: &[f64], value: &[f64]| {
        let course = Course { sample_time_s: 1e-3, demand, value, timed_demand: None };
        text.parse::<Own>().unwrap().check(&course).map_err(|error| error.to_string())
    };
    let phase = "torque phase at 60 Hz below 60 deg";
    assert!(problem("torque phase at 8 Hz below 60 deg", &demand, &value).is_ok());
    assert!(problem(phase, &demand, &value).unwrap_err().contains("no part at 60 Hz"));
    assert!(
        problem("torque phase at 8 Hz below 60 deg", &[1.0; 2000], &value).unwrap_err().contains("no part at 8 Hz")
    );
    assert!(problem("torque amplitude at 400 Hz below 1 Nm", &demand, &value).unwrap_err().contains("5 samples"));
    assert!(
        problem("engine_speed amplitude at 8 Hz below 1 rpm", &demand, &[]).unwrap_err().contains("no engine_speed")
    );
    for (text, problem) in [
        ("torque phase at 8 below 60 deg", "Hz"),
        ("torque phase at 8 Hz below 60 Nm", "Nm"),
        ("shaft_torque phase at 8 Hz below 60 deg", "amplitude"),
        ("flange amplitude at 8 Hz below 60 Nm", "shaft_torque"),
        ("torque amplitude at 0 Hz below 60 Nm", "above 0 Hz"),
    ] {
        let error = text.parse::<Own>().unwrap_err().to_string();
        assert!(error.contains(problem) && error.contains(text), "{error}");
    }
}
