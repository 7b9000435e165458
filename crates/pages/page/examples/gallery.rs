//! Draws one figure of each kind: `cargo run -p page --example gallery -- FOLDER`.
#![allow(clippy::unwrap_used, clippy::disallowed_methods)]

use page::{Abscissa, Axis, Figure, Layer, Marker, Panel, Rounded, Style, rounded};

fn main() {
    let folder = std::path::PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".into()));
    let figures = [bode(), complex_plane(), correlations(), response()];
    std::fs::write(folder.join("gallery.svg"), page::svg(&figures)).unwrap();
    std::fs::write(folder.join("gallery.png"), page::png(&figures).unwrap()).unwrap();
    std::fs::write(
        folder.join("gallery.html"),
        page::html(&page::Page::of_figures("Gallery", figures.to_vec()), "gallery"),
    )
    .unwrap();
}

fn bode() -> Figure {
    let hz: Vec<f64> = (0..300).map(|n| 10f64.powf(-1.0 + n as f64 / 75.0)).collect();
    let gain = |f: &f64| -10.0 * ((1.0 - (f / 18.0).powi(2)).powi(2) + (0.05 * f / 18.0).powi(2)).log10();
    let magnitude: Vec<f64> = hz.iter().map(gain).collect();
    let phase: Vec<f64> = hz.iter().map(|f| -(0.05 * f / 18.0).atan2(1.0 - (f / 18.0).powi(2)).to_degrees()).collect();
    let shifted = |by: f64| rounded(&magnitude.iter().map(|m| m + by).collect::<Vec<_>>());
    let x = || Abscissa::Values(rounded(&hz));
    let band =
        Layer::Band { name: "model".into(), style: Style::Modelled, x: x(), low: shifted(-3.0), high: shifted(3.0) };
    let marks = Layer::VerticalMarks { x: vec![Rounded(18.0)], label: "resonance ω_n".into() };
    Figure::new(
        "Bode plot of T_d → T_shaft",
        Axis::frequency(),
        vec![
            Panel::new(
                Axis::linear("magnitude", "dB"),
                190,
                vec![
                    band,
                    Layer::curve("model", Style::Modelled, &hz, &magnitude),
                    Layer::dots("measured", Style::Measured, &hz[..200], &magnitude[..200]),
                    marks,
                ],
            ),
            Panel::new(Axis::linear("phase", "°"), 120, vec![Layer::curve("model", Style::Modelled, &hz, &phase)]),
        ],
    )
}

fn complex_plane() -> Figure {
    let turn: Vec<f64> = (0..=200).map(|n| n as f64 * std::f64::consts::TAU / 200.0).collect();
    let circle = |radius: f64, at: (f64, f64), name: &str, style| Layer::Path {
        name: name.into(),
        style,
        x: turn.iter().map(|t| Rounded(at.0 + radius * t.cos())).collect(),
        y: turn.iter().map(|t| Rounded(at.1 + radius * t.sin())).collect(),
    };
    let markers = |marker, name: &str, style, x: &[f64], y: &[f64]| Layer::Markers {
        name: name.into(),
        style,
        marker,
        x: rounded(x),
        y: rounded(y),
    };
    let layers = vec![
        circle(1.0, (0.0, 0.0), "unit circle", Style::Measured),
        circle(0.05, (0.75, 0.37), "99 % region", Style::Modelled),
        circle(0.05, (0.75, -0.37), "99 % region", Style::Modelled),
        markers(Marker::Cross, "poles", Style::Modelled, &[0.75, 0.75], &[0.37, -0.37]),
        markers(Marker::Ring, "zeros", Style::Other, &[-0.5], &[0.0]),
    ];
    Figure::new(
        "Poles and zeros",
        Axis::linear("real part", ""),
        vec![Panel::new(Axis::linear("imaginary part", ""), 420, layers)],
    )
    .with_equal_axes()
}

fn correlations() -> Figure {
    let lags: Vec<f64> = (-25..=25).map(f64::from).collect();
    let values: Vec<f64> = lags.iter().map(|k| 0.05 * (k * 1.7).sin()).collect();
    let region = Layer::YRegion { low: Rounded(-0.06), high: Rounded(0.06), label: "99 % region".into() };
    let stems = Layer::Stems {
        name: "correlation".into(),
        style: Style::Other,
        x: Abscissa::Values(rounded(&lags)),
        y: rounded(&values),
    };
    let panel = Panel::new(Axis::linear("residual with u", ""), 110, vec![region, stems]);
    Figure::new("Residual test", Axis::linear("lag", "samples"), vec![panel])
}

fn response() -> Figure {
    let y: Vec<f64> = (0..5000).map(|n| 1.0 - (-(n as f64) / 700.0).exp() * (n as f64 / 60.0).cos()).collect();
    let noisy: Vec<f64> = y.iter().enumerate().map(|(n, v)| v + 0.1 * (n as f64 * 12.9898).sin()).collect();
    let panel = Panel::new(
        Axis::linear("torque", "Nm"),
        190,
        vec![
            Layer::trace("measured", Style::Measured, (0.0, 0.001), &noisy),
            Layer::trace("modelled", Style::Modelled, (0.0, 0.001), &y),
        ],
    );
    Figure::new("Measured and modelled", Axis::time(), vec![panel])
}
