//! The complex plane of poles and zeros, with lines of equal damping and frequency.

use std::f64::consts::{PI, TAU};

use ident::uncertainty::UncertainRoot;
use lti::Complex64;
use page::decimal::digits;
use page::{Axis, Figure, Layer, Marker, Panel, Style, rounded};

use super::model::Model;
use super::roots::Roots;
use crate::figures::figure;

/// Dampings of the lines drawn.
const DAMPINGS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// Parts of the Nyquist frequency, or of the largest in view, of the lines drawn.
const FREQUENCIES: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// Points of a line.
const POINTS: i32 = 120;
/// Discrete roots further from zero than this would make all others small: they are left out, and said to be.
const FURTHEST: f64 = 2.0;

/// One figure for discrete models, one for continuous ones.
pub(super) fn figures(roots: &[Roots], models: &[Model], level: f64) -> Vec<Figure> {
    let of_kind = |is_discrete: bool| {
        let chosen: Vec<usize> =
            (0..models.len()).filter(|n| models[*n].sample_time_s().is_some() == is_discrete).collect();
        (!chosen.is_empty()).then(|| plane(roots, models, &chosen, level, is_discrete))
    };
    [of_kind(true), of_kind(false)].into_iter().flatten().collect()
}

fn plane(roots: &[Roots], models: &[Model], chosen: &[usize], level: f64, is_discrete: bool) -> Figure {
    let own: Vec<&Roots> = roots.iter().filter(|set| chosen.contains(&set.model)).collect();
    let seen = |value: &Complex64| !is_discrete || value.norm() <= FURTHEST;
    let sizes = || own.iter().flat_map(|set| &set.roots).map(|root| root.value).filter(seen).map(|z| z.norm());
    let largest = sizes().fold(0.0, f64::max);
    let mut layers = if is_discrete { discrete_grid() } else { continuous_grid(largest) };
    for root in own.iter().flat_map(|set| set.roots.iter().map(|root| (set.model, root))) {
        let (model, root) = root;
        if let Some(points) = region(root, level).filter(|_| seen(&root.value)) {
            layers.push(path(&format!("{} % region", digits(100.0 * level, 6)), Style::of_model(model), &points));
        }
    }
    for &number in chosen {
        for (is_pole, marker, kind) in [(true, Marker::Cross, "poles"), (false, Marker::Ring, "zeros")] {
            let sets = own.iter().filter(|set| set.model == number && set.is_pole == is_pole);
            let places = sets.flat_map(|set| &set.roots).map(|root| root.value).filter(seen);
            let (x, y): (Vec<f64>, Vec<f64>) = places.map(|z| (z.re, z.im)).unzip();
            let name = format!("{kind} of {}", models[number].name);
            layers.push(Layer::Markers {
                name,
                style: Style::of_model(number),
                marker,
                x: rounded(&x),
                y: rounded(&y),
            });
        }
    }
    let unit = if is_discrete { "" } else { "rad/s" };
    let title = if is_discrete { "Poles and zeros, discrete" } else { "Poles and zeros, continuous" };
    let panel = Panel::new(Axis::linear("imaginary part", unit), 420, layers);
    let outside = own.iter().flat_map(|set| &set.roots).filter(|root| !seen(&root.value)).count();
    let mut caption = "Grey: equal damping 0.1, 0.3, 0.5, 0.7, 0.9, and equal natural frequency".to_owned();
    caption.push_str(if is_discrete { " at these parts of half the sample rate." } else { "." });
    if outside > 0 {
        let roots = if outside == 1 { "root" } else { "roots" };
        caption.push_str(&format!(" Not shown: {outside} {roots} further than {FURTHEST} from zero."));
    }
    figure(title, Axis::linear("real part", unit), vec![panel]).with_equal_axes().with_caption(caption)
}

/// The outline of the region that holds a root with this confidence, where there is one.
pub(super) fn region(root: &UncertainRoot, level: f64) -> Option<Vec<Complex64>> {
    let ellipse = root.ellipse(level);
    let is_region = ellipse.semi_major.is_finite() && ellipse.semi_major > 0.0 && !root.near_multiple;
    is_region.then(|| {
        let mut points = ellipse.points(90);
        points.extend(points.first().copied());
        points
    })
}

/// The unit circle and, within it, `z = e^{sT}` of equal damping and frequency.
fn discrete_grid() -> Vec<Layer> {
    let circle: Vec<Complex64> = (0..=360).map(|n| Complex64::cis(f64::from(n).to_radians())).collect();
    let along = |s: &dyn Fn(f64) -> Complex64, conjugate: bool| -> Vec<Complex64> {
        let points = (0..=POINTS).map(|n| s(f64::from(n) / f64::from(POINTS)).exp());
        points.map(|z| if conjugate { z.conj() } else { z }).collect()
    };
    let mut layers = Vec::new();
    for conjugate in [false, true] {
        for damping in DAMPINGS {
            // Up to where the line meets the negative real axis: ω_n √(1 − ζ²) T = π.
            let most = PI / (1.0 - damping * damping).sqrt();
            layers.push(guide(&along(&|part| at(damping, part * most), conjugate)));
        }
        for frequency in FREQUENCIES {
            layers.push(guide(&along(&|part| at(part, frequency * PI), conjugate)));
        }
    }
    layers.push(path("unit circle", Style::Measured, &circle));
    layers
}

/// The imaginary axis and, left of it, rays of equal damping and arcs of equal frequency.
fn continuous_grid(largest: f64) -> Vec<Layer> {
    let reach = if largest > 0.0 { 1.1 * largest } else { 1.0 };
    let mut layers = Vec::new();
    for damping in DAMPINGS {
        let end = at(damping, reach);
        layers.push(guide(&[end, Complex64::ZERO, end.conj()]));
    }
    for frequency in FREQUENCIES {
        let angle = |n: i32| 0.25 * TAU + 0.5 * TAU * f64::from(n) / f64::from(POINTS);
        let arc: Vec<Complex64> = (0..=POINTS).map(|n| frequency * reach * Complex64::cis(angle(n))).collect();
        layers.push(guide(&arc));
    }
    let axis = [Complex64::new(0.0, -reach), Complex64::new(0.0, reach)];
    layers.push(path("limit of stability", Style::Measured, &axis));
    layers
}

/// `s = −ζ ω_n + j ω_n √(1 − ζ²)`.
fn at(damping: f64, omega: f64) -> Complex64 {
    Complex64::new(-damping * omega, omega * (1.0 - damping * damping).max(0.0).sqrt())
}

fn guide(points: &[Complex64]) -> Layer {
    path("", Style::Guide, points)
}

fn path(name: &str, style: Style, points: &[Complex64]) -> Layer {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.re, p.im)).unzip();
    Layer::Path { name: name.to_owned(), style, x: rounded(&x), y: rounded(&y) }
}
