//! A page of figures of what a simulated bench shows before any model is made of it.

use demo::effects::{Effects, Gains, ShaftZeros, ShownTrace, Spectrum};
use page::{Abscissa, Axis, Figure, Layer, Page, Panel, Rounded, Style, rounded};

/// Height of a panel on the page.
const HEIGHT: u32 = 180;

/// The page: one HTML file that needs no network.
pub fn page(effects: &Effects, zeros: &ShaftZeros) -> Page {
    Page::of_figures("What the simulated bench shows", figures(effects, zeros).into())
}

fn figures(effects: &Effects, shaft_zeros: &ShaftZeros) -> [Figure; 7] {
    let spectra = |title: &str, unit: &str, spectra: &[Spectrum]| {
        let panel = |s: &Spectrum| {
            let layer = Layer::curve(&s.name, Style::Measured, &s.frequency_hz, &s.amplitude);
            Panel::new(Axis::linear(&s.name, unit), HEIGHT, vec![layer])
        };
        let axis = Axis::linear("frequency", "Hz").within(0.0, 200.0);
        Figure::new(title, axis, spectra.iter().map(panel).collect())
    };
    let traces = |title: &str, shown: &[ShownTrace]| {
        let layer = |(index, t): (usize, &ShownTrace)| {
            Layer::trace(&t.name, Style::of_model(index), (t.start_s, t.sample_time_s), &t.values)
        };
        let layers = shown.iter().enumerate().map(layer).collect();
        Figure::new(
            title,
            Axis::linear("time after the step", "s"),
            vec![Panel::new(Axis::linear("torque", "Nm"), 260, layers)],
        )
    };
    [
        spectra("Firing follows the speed", "rpm", &effects.firing).with_caption(
            "Four cylinders and four strokes fire twice a turn: 40, 100 and 150 Hz. Unequal cylinders add half and a \
             quarter of that.",
        ),
        spectra("Firing at 4500 rpm: the alias of 150 Hz is at 100 Hz", "Nm", &effects.folding).with_caption(
            "Recorded at 250 Hz, everything above 125 Hz appears below it. The drive's own ripple is off here.",
        ),
        spectra("A sine of 8 Hz comes with lines at 92 and 108 Hz", "Nm", &effects.side_lines).with_caption(
            "Two causes: a demand held for 10 ms has them in T_d* already; a ripple in proportion to the torque puts \
             them into T_d alone. The line at 100 Hz is the ripple itself.",
        ),
        gains(&effects.gains),
        traces("The load cell is late, the computed torque is not", &effects.step).with_caption(
            "T_d,calc follows T_d* within one of its samples of 4 ms; T_d,meas comes later and rings near 75 Hz.",
        ),
        traces("The system's own shaft torque is late", &effects.shaft_torque).with_caption(
            "Its part of the inertia goes through a moving average of 16 ms, which makes it 7.5 ms late. The engine's \
             firing is in both.",
        ),
        zeros(shaft_zeros),
    ]
}

fn gains(gains: &Gains) -> Figure {
    let name = "|T_shaft / T_d|";
    let layers = vec![
        Layer::HorizontalMark { y: Rounded(gains.at_rest), label: "J_e/(J_d + J_e)".into() },
        Layer::VerticalMarks { x: vec![Rounded(gains.resonance_hz)], label: "resonance by the parameters".into() },
        Layer::curve(name, Style::Measured, &gains.frequency_hz, &gains.gain),
        Layer::dots(name, Style::Measured, &gains.frequency_hz, &gains.gain),
    ];
    let panel = Panel::new(Axis::linear("gain", ""), HEIGHT, layers);
    Figure::new("From T_d to T_shaft: below one, and a resonance", Axis::linear("frequency", "Hz"), vec![panel])
        .with_caption(
            "One sine after another at 3000 rpm. Below the resonance the shaft carries no more than what turns the engine; \
             at 18 Hz a torque that was safe trips the bench.",
        )
}

fn zeros(zeros: &ShaftZeros) -> Figure {
    let skew_ms: Vec<f64> = zeros.skew_s.iter().map(|skew_s| 1e3 * skew_s).collect();
    let naive = zeros.naive.iter().enumerate().flat_map(|(index, naive)| {
        let style = Style::of_model(index + 1);
        [
            Layer::curve(&naive.band, style, &skew_ms, &naive.zero),
            Layer::dots(&naive.band, style, &skew_ms, &naive.zero),
        ]
    });
    let ends = |end: fn(&(f64, f64, f64)) -> f64| rounded(&zeros.estimated.iter().map(end).collect::<Vec<_>>());
    let estimated = Layer::Points {
        name: "dynoid, 95 %".into(),
        style: Style::Modelled,
        x: Abscissa::Values(rounded(&skew_ms)),
        y: ends(|e| e.0),
        low: Some(ends(|e| e.1)),
        high: Some(ends(|e| e.2)),
    };
    let truth = Layer::HorizontalMark { y: Rounded(zeros.truth), label: "truth".into() };
    let layers = [truth].into_iter().chain(naive).chain([estimated]).collect();
    let panel = Panel::new(Axis::linear("zero −K/B", "rad/s"), 260, layers);
    Figure::new(
        "The shaft's zero, with an engine speed that is stamped late",
        Axis::linear("stamped late by", "ms").within(-0.6, 0.6),
        vec![panel],
    )
    .with_caption(
        "Least squares on one common clock shifts the zero with every fraction of a millisecond, and with the \
             frequency band. dynoid estimates the delay along with stiffness and damping.",
    )
}
