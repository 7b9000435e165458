//! Long recordings in a page: what it holds of them, what it states of that, and how large it is.

use page::{Axis, Block, Figure, Layer, Page, Panel, Style, html};

/// Noise that is the same each time.
fn noise(count: usize) -> Vec<f64> {
    let mut random = signal::excitation::Random::new(3);
    (0..count).map(|_| random.normal()).collect()
}

fn figure(values: &[f64]) -> Figure {
    let layer = Layer::trace("measured", Style::Measured, (0.0, 0.001), values);
    Figure::new("Speed", Axis::time(), vec![Panel::new(Axis::linear("N_d", "rpm"), 120, vec![layer])])
}

/// The number of samples that the page holds of its lines, and that were recorded.
fn held(page: &str) -> Vec<(u64, u64)> {
    let headers = page.split("data-groups=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let groups = headers.flat_map(|header| {
        let header: serde_json::Value = serde_json::from_str(&header.replace("&quot;", "\"")).unwrap();
        header.as_array().unwrap().clone()
    });
    groups.map(|group| (group["count"].as_u64().unwrap(), group["of"].as_u64().unwrap())).collect()
}

#[test]
fn exact_a_page_holds_every_sample_where_there_is_room() {
    let page = html(&Page::new("", vec![Block::figure(figure(&noise(60_000)))]), "");
    assert_eq!(held(&page), [(60_000, 60_000)]);
    assert!(page.contains("of 60000 samples; every peak is kept."), "the drawing has fewer, and says so");
}

#[test]
fn exact_a_page_of_many_long_recordings_stays_below_three_megabytes_and_counts_what_it_has() {
    let values = noise(100_000);
    let page = html(&Page::new("", (0..40).map(|_| Block::figure(figure(&values))).collect()), "");
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
    let held = held(&page);
    assert_eq!(held.len(), 40);
    assert!(held.iter().all(|(count, of)| *count < 100_000 && *count > 5_000 && *of == 100_000), "{held:?}");
}

#[test]
fn exact_a_figure_of_hours_has_bounded_size_and_every_peak() {
    let mut values = noise(3_600_000);
    values[1_234_567] = 50.0;
    let Block::Figure(figure) = Block::figure(figure(&values)) else { panic!("a figure") };
    let Layer::Line { y, .. } = &figure.panels[0].layers[0] else { panic!("a line") };
    assert!(y.len() <= 250_100, "{} samples", y.len());
    assert!(y.iter().any(|y| y.0 == 50.0));
    assert_eq!(held(&html(&Page::new("", vec![Block::Figure(figure)]), ""))[0].1, 3_600_000);
}
