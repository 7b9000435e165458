//! Content of a drawing.

use page::{Abscissa, Axis, Figure, Layer, Panel, Style, rounded, svg};

const INDEX: &str = "<tspan dy=\"3\" font-size=\"9\">";

fn one(title: &str, x: Axis, y: Axis, layers: Vec<Layer>) -> Figure {
    Figure::new(title, x, vec![Panel::new(y, 150, layers)])
}

fn line(y: &[f64]) -> Layer {
    let x: Vec<f64> = (1..=y.len()).map(|n| n as f64).collect();
    Layer::curve("line", Style::Modelled, &x, y)
}

#[test]
fn regress_symbols_have_indices_and_file_names_have_none() {
    let drawn = |title: &str| svg(&[one(title, Axis::time(), Axis::linear("y", ""), vec![line(&[1.0, 2.0])])]);
    assert!(drawn("T_d → N_d, measured").contains(&format!("{INDEX}d</tspan>")));
    assert!(drawn("J_d.").contains(&format!("{INDEX}d</tspan>")), "a full stop ends a sentence");
    for name in ["WhiteNoise_T_TN_1200.mf4", "T_TN_1200.mf4", "T_d.csv", "a/T_d", "T_d-2"] {
        let text = drawn(name);
        assert!(text.contains(&format!(">{name}</text>")), "{name}: {text}");
    }
}

#[test]
fn snap_names_are_left_as_they_are_where_a_figure_has_no_symbols() {
    let figure = one("T_demand → N_dyno", Axis::time(), Axis::linear("N_dyno", "rpm"), vec![line(&[1.0, 2.0])]);
    let text = svg(&[figure.with_plain_text()]);
    assert!(text.contains(">T_demand → N_dyno</text>") && text.contains(">N_dyno [rpm]</text>"), "{text}");
    assert!(!text.contains(INDEX));
}

#[test]
fn regress_a_band_that_reaches_down_to_nothing_is_drawn_on_a_logarithmic_axis() {
    let x = Abscissa::Values(rounded(&[1.0, 2.0, 3.0]));
    let (low, high) = (rounded(&[0.0, 0.5, -1.0]), rounded(&[2.0, 2.0, 2.0]));
    let band = Layer::Band { name: "band".into(), style: Style::Modelled, x, low, high };
    let text = svg(&[one("", Axis::linear("x", ""), Axis::log("y", ""), vec![band, line(&[1.0, 1.0, 1.0])])]);
    let path = text.lines().find(|line| line.contains("fill-opacity=\"0.18\"")).unwrap();
    let d = path.split("d=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap();
    assert!(d.starts_with('M') && d.contains('L') && d.ends_with('Z'), "upper and lower corners: {path}");
    assert!(!path.contains("NaN") && !path.contains("inf"), "{path}");
}

#[test]
fn snap_a_band_widens_a_logarithmic_axis_by_little() {
    let x = || Abscissa::Values(rounded(&[1.0, 2.0]));
    let band = |low: f64| Layer::Band {
        name: "band".into(),
        style: Style::Modelled,
        x: x(),
        low: rounded(&[low, low]),
        high: rounded(&[2.0, 2.0]),
    };
    let drawn = |low| svg(&[one("", Axis::linear("x", ""), Axis::log("y", ""), vec![band(low), line(&[1.0, 1.0])])]);
    assert!(!drawn(1e-9).contains("1e−9") && !drawn(1e-9).contains(">0.001<"), "{}", drawn(1e-9));
    assert!(drawn(0.5).contains(">0.5<"));
}

#[test]
fn snap_degrees_are_marked_at_parts_of_a_turn() {
    let text = svg(&[one("", Axis::time(), Axis::angle("phase"), vec![line(&[170.0, -350.0])])]);
    for mark in ["−360", "−180", "0", "180"] {
        assert!(text.contains(&format!(">{mark}<")), "{mark}: {text}");
    }
    assert!(!text.contains(">−200<"));
    let small = svg(&[one("", Axis::time(), Axis::angle("phase"), vec![line(&[1.0, 2.0])])]);
    assert!(small.contains(">1.4<"), "round steps where the range is small: {small}");
}

#[test]
fn snap_lines_denser_than_pixels_are_thin_and_let_through_what_they_cover() {
    let drawn = |points: usize| {
        let y: Vec<f64> = (0..points).map(|n| (n % 7) as f64).collect();
        svg(&[one("", Axis::time(), Axis::linear("y", ""), vec![line(&y)])])
    };
    assert!(drawn(100).contains("stroke-width=\"1.2\""));
    let dense = drawn(3000);
    assert!(dense.contains("stroke-width=\"0.7\"") && dense.contains("stroke-opacity"), "thin");
}

#[test]
fn snap_captions_stand_below_in_lines() {
    let words = "word ".repeat(60);
    let figure = one("", Axis::time(), Axis::linear("y", ""), vec![line(&[1.0, 2.0])]).with_caption(words.trim());
    let text = svg(&[figure]);
    let lines = text.lines().filter(|line| line.contains("word word")).count();
    assert!(lines >= 2 && text.matches("word").count() == 60, "{lines} lines");
}

#[test]
fn snap_a_smooth_curve_of_many_points_keeps_its_dashes() {
    let x: Vec<f64> = (0..3000).map(f64::from).collect();
    let drawn = |y: &dyn Fn(f64) -> f64| {
        let y: Vec<f64> = x.iter().map(|x| y(*x)).collect();
        let layer = Layer::curve("model", Style::Sixth, &x, &y);
        svg(&[one("", Axis::time(), Axis::linear("y", ""), vec![layer])])
    };
    assert!(drawn(&|x| (-0.001 * x).exp()).contains("dasharray"));
    assert!(!drawn(&|x| (0.9 * x).sin()).contains("dasharray"), "an area has no dashes");
}

/// Where the texts of a drawing stand: x, y and what they say.
fn texts(drawing: &str) -> Vec<(f64, f64, String)> {
    let attribute = |tag: &str, name: &str| tag.split(name).nth(1)?.split('"').next()?.parse().ok();
    let text = |piece: &str| {
        let (tag, rest) = piece.split_once('>')?;
        let says = rest.split("</text>").next()?.replace("<tspan>", "").replace("</tspan>", "");
        Some((attribute(tag, "x=\"")?, attribute(tag, " y=\"")?, says))
    };
    drawing.split("<text ").skip(1).filter_map(text).collect()
}

#[test]
fn regress_names_of_marks_side_by_side_stand_below_each_other_and_inside() {
    let mark = |x: f64, label: &str| Layer::VerticalMarks { x: rounded(&[x]), label: label.to_owned() };
    let limit = |y: f64, label: &str| Layer::HorizontalMark { y: rounded(&[y])[0], label: label.to_owned() };
    let layers = vec![
        line(&[0.0, 1.0, 2.0, 3.0]),
        mark(1.0, "resonance"),
        mark(1.05, "firing"),
        mark(2.5, "mains"),
        limit(3.0, "upper"),
        limit(-50.0, "lower"),
    ];
    let y = Axis { range: rounded(&[0.0, 3.0]).try_into().ok(), ..Axis::linear("T_d", "Nm") };
    let texts = texts(&svg(&[one("Marks", Axis::linear("frequency", "Hz"), y, layers)]));
    let height = |name: &str| texts.iter().find(|(.., says)| says == name).map(|(_, y, _)| *y);
    assert_eq!(height("resonance"), height("mains"), "{texts:?}");
    assert!(height("firing") >= height("resonance").map(|y| y + 12.0), "{texts:?}");
    assert!(height("upper") > height("resonance"), "the name of the upper limit is cut off: {texts:?}");
    assert_eq!(height("lower"), None, "a limit out of view has no name");
}

/// The x and y of the points of each line of a drawing, in pixels.
fn points(text: &str) -> Vec<Vec<(f64, f64)>> {
    let of_path = |line: &str| {
        let d = line.split(" d=\"M").nth(1)?.split('"').next()?;
        let numbers: Vec<f64> = d.split([' ', 'l']).filter_map(|number| number.parse().ok()).collect();
        let (mut x, mut y) = (0.0, 0.0);
        let step = |pair: &[f64]| {
            (x, y) = (x + pair[0], y + pair[1]);
            (x, y)
        };
        Some(numbers.chunks_exact(2).map(step).collect())
    };
    let of_layer = |layer: &str| layer.lines().find_map(of_path);
    text.split("data-type=\"line\"").skip(1).filter_map(of_layer).collect()
}

#[test]
fn exact_what_is_drawn_of_a_residual_is_the_difference_of_what_is_drawn_of_its_signals() {
    let mut random = signal::excitation::Random::new(7);
    let mut measured: Vec<f64> = (0..20_000).map(|_| random.normal()).collect();
    measured[12_345] = 30.0;
    let modelled: Vec<f64> = measured.iter().map(|y| 0.8 * y + 0.1 * random.normal()).collect();
    let residual: Vec<f64> = measured.iter().zip(&modelled).map(|(y, m)| y - m).collect();
    let range = |axis: Axis| axis.within(-40.0, 40.0);
    let trace = |name: &str, values: &[f64]| Layer::trace(name, Style::Measured, (0.0, 0.001), values);
    let above = vec![trace("measured", &measured), trace("modelled", &modelled)];
    let figure = Figure::new(
        "",
        Axis::time(),
        vec![
            Panel::new(range(Axis::linear("T", "Nm")), 200, above),
            Panel::new(range(Axis::linear("T − model", "Nm")), 200, vec![trace("residual", &residual)]),
        ],
    );
    let text = svg(&[figure]);
    let [measured, modelled, residual] = points(&text).try_into().unwrap();
    assert!(measured.len() < 4100 && measured.len() > 1500, "{}", measured.len());
    assert!(text.contains(&format!("Drawn with {} of 20000 samples", measured.len())), "the caption states it");
    // 250 pixels for 80 Nm; a panel has its own zero.
    let value = |(_, y): (f64, f64), zero: f64| (zero - y) / 250.0 * 80.0;
    let zeros: Vec<f64> = text
        .split("data-frame=\"")
        .skip(1)
        .map(|rest| {
            let numbers: Vec<f64> = rest.split('"').next().unwrap().split(' ').map(|n| n.parse().unwrap()).collect();
            f64::midpoint(numbers[2], numbers[3])
        })
        .collect();
    let mut highest = f64::NEG_INFINITY;
    for ((y, m), r) in measured.iter().zip(&modelled).zip(&residual) {
        assert!((y.0 - m.0).abs() < 1e-6 && (y.0 - r.0).abs() < 1e-6, "the same samples");
        let left = value(*y, zeros[0]) - value(*m, zeros[0]) - value(*r, zeros[1]);
        assert!(left.abs() < 0.001, "{left}");
        highest = highest.max(value(*y, zeros[0]));
    }
    assert!((highest - 30.0).abs() < 0.001, "the peak is kept: {highest}");
}

#[test]
fn snap_a_start_transient_does_not_set_the_scale_and_is_counted() {
    let mut values: Vec<f64> = (0..2000).map(|n| f64::from(n % 10)).collect();
    values[..12].fill(900.0);
    let drawn = |values: &[f64]| svg(&[one("", Axis::time(), Axis::linear("y", ""), vec![line(values)])]);
    let text = drawn(&values);
    assert!(text.contains(">12 samples outside</text>") && text.contains("data-type=\"outside\""), "{text}");
    assert!(text.contains(">8</text>"), "{text}");
    values[..200].fill(900.0);
    let text = drawn(&values);
    assert!(!text.contains("outside") && !text.contains(">8</text>"), "a tenth of the samples is no transient");
    values[..200].fill(4.0);
    (0..10).for_each(|n| values[200 * n] = 900.0);
    assert!(!drawn(&values).contains("outside"), "what happens again and again sets the scale");
}

#[test]
fn snap_a_band_under_its_line_is_named_and_a_wide_one_is_not() {
    let x = [0.0, 1.0, 2.0];
    let drawn = |half: f64| {
        let (low, high) = (rounded(&x.map(|x| x - half)), rounded(&x.map(|x| x + half)));
        let band =
            Layer::Band { name: "model".into(), style: Style::Modelled, x: Abscissa::Values(rounded(&x)), low, high };
        let curve = Layer::curve("model", Style::Modelled, &x, &x);
        svg(&[one("", Axis::time(), Axis::linear("y", ""), vec![band, curve])])
    };
    assert!(drawn(1e-4).contains("band narrower than its line"));
    assert!(!drawn(0.3).contains("band narrower"));
}
