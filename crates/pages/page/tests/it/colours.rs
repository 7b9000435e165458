//! Readers who see two primary colours only can distinguish the series of a figure.

use page::{Axis, Figure, Layer, Page, Panel, Style, html, svg};

/// Machado, Oliveira and Fernandes (2009), table 1, severity 1, on linear sRGB.
const PROTANOPIA: [[f64; 3]; 3] =
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]];
const DEUTERANOPIA: [[f64; 3]; 3] =
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]];
const USUAL: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

const NAMES: [&str; 11] =
    ["measured", "modelled", "other", "residual", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth"];

type Rgb = [f64; 3];

/// Linear sRGB of `#rrggbb`.
fn linear(colour: &str) -> Rgb {
    [1, 3, 5].map(|at| {
        let part = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
        if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
    })
}

fn seen(matrix: [[f64; 3]; 3], colour: Rgb) -> Rgb {
    matrix.map(|row| row.iter().zip(colour).map(|(m, c)| m * c).sum::<f64>().clamp(0.0, 1.0))
}

/// CIE 1976 L*a*b* with the white of D65.
fn lab([r, g, b]: Rgb) -> Rgb {
    let f = |t: f64| if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 };
    let x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
    let y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
    let z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn difference(a: Rgb, b: Rgb) -> f64 {
    lab(a).iter().zip(lab(b)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn contrast(a: Rgb, b: Rgb) -> f64 {
    let light = |[r, g, b]: Rgb| 0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05;
    let (a, b) = (light(a), light(b));
    a.max(b) / a.min(b)
}

/// The colour that a style sheet gives a name, first in the light and then in the dark.
fn of_page(name: &str) -> [String; 2] {
    let (page, name) = (html(&Page::default(), ""), format!("--{name}: "));
    let values = page.split(&name).skip(1).map(|rest| rest[..7].to_owned());
    values.collect::<Vec<_>>().try_into().unwrap()
}

fn assert_apart(colours: &[String], paper: &str, least_contrast: f64) {
    for (n, a) in colours.iter().enumerate() {
        let ratio = contrast(linear(a), linear(paper));
        assert!(ratio >= least_contrast, "{} on {paper}: {ratio:.2}", NAMES[n]);
        for (m, b) in colours.iter().enumerate().skip(n + 1) {
            for (matrix, eyes) in [(USUAL, "all"), (DEUTERANOPIA, "deuteranopia"), (PROTANOPIA, "protanopia")] {
                let apart = difference(seen(matrix, linear(a)), seen(matrix, linear(b)));
                assert!(apart >= 15.0, "{} and {} on {paper}, {eyes}: {apart:.1}", NAMES[n], NAMES[m]);
            }
        }
    }
}

#[test]
fn exact_colours_of_series_differ_for_readers_with_two_primary_colours() {
    let both: Vec<[String; 2]> = NAMES.iter().map(|name| of_page(name)).collect();
    let [light, dark] = [0, 1].map(|at| both.iter().map(|pair| pair[at].clone()).collect::<Vec<_>>());
    assert_apart(&light, &of_page("paper")[0], 3.0);
    assert_apart(&dark, &of_page("paper")[1], 4.0);
}

/// The stroke of the curve of a style in a drawing on its own: colour, width and dashes.
fn stroke(style: Style) -> (String, String) {
    let layer = Layer::curve("model", style, &[0.0, 1.0], &[0.0, 1.0]);
    let text = svg(&[Figure::new("", Axis::time(), vec![Panel::new(Axis::linear("y", ""), 100, vec![layer])])]);
    let line = text.lines().find(|line| line.starts_with("<path") && line.contains("stroke-linejoin")).unwrap();
    let colour = line.split("stroke=\"").nth(1).unwrap()[..7].to_owned();
    let form = line[line.find("stroke-width").unwrap()..].split("class=\"s-").collect::<Vec<_>>();
    let behind_class = form[1].split_once('"').unwrap().1;
    (colour, format!("{}{behind_class}", form[0]))
}

#[test]
fn exact_styles_of_series_differ_by_width_or_dashes_too() {
    let models = (0..10).map(Style::of_model);
    let strokes: Vec<(String, String)> = std::iter::once(Style::Measured).chain(models).map(stroke).collect();
    let mut forms: Vec<&String> = strokes.iter().map(|(_, form)| form).collect();
    forms.sort();
    forms.dedup();
    assert_eq!(forms.len(), 11, "{strokes:?}");
    for ((colour, _), name) in strokes.iter().zip(NAMES) {
        assert_eq!(*colour, of_page(name)[0], "a drawing on its own has the colour of the page: {name}");
    }
}
