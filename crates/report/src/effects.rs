//! A page of figures of what a simulated bench shows before any model is made of it.

use bench::virtual_bench::{Effects, ShownTrace, Spectrum};
use plot::{Axis, Figure, Layer, Panel, Style};

/// Height of a panel on the page.
const HEIGHT: u32 = 180;

/// The page: one HTML file that needs no network.
pub fn page(effects: &Effects) -> String {
    plot::page("What the simulated bench shows", &figures(effects))
}

fn figures(effects: &Effects) -> [Figure; 5] {
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
        spectra("Firing at 4500 rpm folds from 150 to 100 Hz", "Nm", &effects.folding).with_caption(
            "Recorded at 250 Hz, everything above 125 Hz comes back below it. The drive's own ripple is off here.",
        ),
        spectra("A sine of 8 Hz comes with lines at 92 and 108 Hz", "Nm", &effects.side_lines).with_caption(
            "Two causes: a demand held for 10 ms has them in T_d* already; a ripple in proportion to the torque puts \
             them into T_d alone. The line at 100 Hz is the ripple itself.",
        ),
        traces("The load cell is late, the computed torque is not", &effects.step).with_caption(
            "T_d,calc follows T_d* within one of its samples of 4 ms; T_d,meas comes later and rings near 75 Hz.",
        ),
        traces("The system's own shaft torque is late", &effects.shaft_torque).with_caption(
            "Its part of the inertia goes through a moving average of 16 ms, which makes it 7.5 ms late. The engine's \
             firing is in both.",
        ),
    ]
}
