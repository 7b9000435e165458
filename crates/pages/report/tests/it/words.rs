//! Words and colours that readers take for numbers.

use page::{Layer, Style};
use part_lines::lines::{CurvePoint, OrderCurve, OverSpeed};
use report::wording::{capitalised, finding, number};
use rig::results::{Parameter, Quantity};
use rig::{Finding, Role};

#[test]
fn exact_symbols_and_files_begin_as_they_are() {
    for text in ["k N_d* + m", "m, the constant part", "K_p is known", "bs.mf4: no T_d*", "τ: late"] {
        assert_eq!(capitalised(text), text);
    }
    assert_eq!(capitalised("a lag is seen"), "A lag is seen");
    assert_eq!(capitalised("no shaft"), "No shaft");
}

#[test]
fn exact_an_early_signal_is_before_and_a_late_one_behind() {
    let words = |late_s| finding(&Finding::LateSignal { role: Role::EngineSpeed, late_s, standard_error_s: 1e-4 });
    assert!(words(-7.2e-3).contains("7.20 ± 0.20 ms before N_d"), "{}", words(-7.2e-3));
    assert!(words(7.2e-3).contains("7.20 ± 0.20 ms behind N_d"), "{}", words(7.2e-3));
}

#[test]
fn exact_a_number_at_its_limit_is_said_to_be_there() {
    let exact = |value| number::parameter(Parameter::new(Quantity::Damping, value, 0.0, 10.0));
    assert_eq!(exact(0.0), "0 Nm s/rad, the least possible");
    assert_eq!(exact(5.0), "5 Nm s/rad, exact");
}

fn over_speed(orders: &[f64]) -> OverSpeed {
    let point =
        |k: usize| CurvePoint { speed_rad_s: 100.0 + k as f64, amplitude: 1.0, standard_error: 0.1, phase_rad: None };
    let curve = |order: &f64| OrderCurve { order: *order, is_firing: false, points: (0..5).map(point).collect() };
    OverSpeed {
        role: Role::DynoSpeed,
        sample_time_s: 1e-3,
        speed_rad_s: [100.0, 105.0],
        map: vec![vec![1.0; 4]; 5],
        orders: orders.iter().map(curve).collect(),
        staying: Vec::new(),
    }
}

#[test]
fn exact_no_two_orders_share_a_colour() {
    let signals = [
        over_speed(&[0.5, 5.5, 2.0, 7.0, 12.0]),
        over_speed(&[1.0, 6.0, 11.0, 0.5, 3.0]),
        over_speed(&[1.5, 6.5, 11.5, 16.5, 21.5]),
    ];
    let figures = report::lines::over_speed_figures("All", &signals);
    let amplitudes = figures.iter().find(|figure| figure.title.contains("orders over the speed")).unwrap();
    let mut seen: Vec<(String, Style)> = Vec::new();
    for layer in amplitudes.panels.iter().flat_map(|panel| &panel.layers) {
        if let Layer::Line { name, style, .. } = layer
            && !seen.iter().any(|(other, _)| other == name)
        {
            assert!(seen.iter().all(|(_, other)| other != style), "{name} has the colour of another: {seen:?}");
            seen.push((name.clone(), *style));
        }
    }
    assert_eq!(seen.len(), 10);
}
