//! The figures of the report, built from the study's curves.

use rig::results::{ResidualTest, Trace, Validation};

use crate::estimates::seconds;
use crate::wording::number;
use page::{Abscissa, Axis, Block, Figure, Layer, Panel, Rounded, Style, rounded};

/// Measured and modelled above, their difference below. `rival` is a second model's curve on the same data.
pub(crate) fn comparison(title: &str, validation: &Validation, rival: Option<(&str, &Validation)>) -> Figure {
    let mut layers = vec![trace_layer("measured", Style::Measured, &validation.measured)];
    let mut differences = Vec::new();
    if let Some((name, rival)) = rival {
        layers.push(trace_layer(name, Style::Other, &rival.modelled));
        differences.push(trace_layer(&format!("residual, {name}"), Style::Other, &difference(rival)));
    }
    layers.push(trace_layer("modelled", Style::Modelled, &validation.modelled));
    differences.push(trace_layer("residual", Style::Residual, &difference(validation)));
    let residual = format!("{} − model", validation.quantity);
    let panels = vec![
        Panel::new(Axis::linear(&validation.quantity, &validation.unit), 190, layers),
        Panel::new(Axis::linear(&residual, &validation.unit), 90, differences),
    ];
    Figure::new(title, Axis::time(), panels)
        .with_caption(comparison_caption(validation))
        .of_recording(&validation.stretch.file)
}

/// A trace of the study as a layer.
pub(crate) fn trace_layer(name: &str, style: Style, trace: &Trace) -> Layer {
    Layer::trace(name, style, (trace.start_s, trace.sample_time_s), &trace.values)
}

/// Measured minus modelled, for the plot of what is left over.
pub(crate) fn difference(validation: &Validation) -> Trace {
    let pairs = validation.measured.values.iter().zip(&validation.modelled.values);
    Trace { values: pairs.map(|(measured, modelled)| measured - modelled).collect(), ..validation.measured.clone() }
}

fn comparison_caption(validation: &Validation) -> String {
    let fit = number::fit(validation.fit_percent);
    let stretch = &validation.stretch;
    format!("Fit {fit}. {}, {}–{} s.", stretch.file, seconds(stretch.start_s), seconds(stretch.end_s),)
}

/// Half the height of the two panels of a correlation plot. Tests drawn with the same can be compared by eye.
#[derive(Clone, Copy)]
pub(crate) struct Extent {
    own: f64,
    cross: f64,
}

impl Extent {
    /// Holds the correlations of all tests.
    pub(crate) fn of(tests: &[&ResidualTest]) -> Self {
        let own = tests.iter().flat_map(|test| own_lags(test).iter().chain([&test.autocorrelation_bound]));
        let cross = tests.iter().flat_map(|test| test.cross_correlation.iter().chain([&test.cross_correlation_bound]));
        Extent { own: height(own), cross: height(cross) }
    }
}

/// A little more than the largest magnitude.
fn height<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    let largest = values.filter(|value| value.is_finite()).fold(0.0, |largest: f64, value| largest.max(value.abs()));
    (1.15 * largest).max(1e-3)
}

/// The autocorrelation without lag 0, where it is one by definition.
fn own_lags(test: &ResidualTest) -> &[f64] {
    test.autocorrelation.get(1..).unwrap_or_default()
}

/// Auto- and cross-correlation of residuals.
pub(crate) fn correlations(title: &str, test: &ResidualTest, extent: Extent) -> Figure {
    let level = number::share(test.level);
    let first_lag = -(test.cross_correlation.len() as f64 / 2.0).floor();
    let panel = |label: String, style: Style, height: f64, bound: f64, first: f64, values: &[f64]| {
        let region = Layer::YRegion { low: Rounded(-bound), high: Rounded(bound), label: format!("{level} region") };
        let (name, x) = ("correlation".to_owned(), lags(first, test.sample_time_s, values.len()));
        let stems = Layer::Stems { name, style, x, y: rounded(values) };
        Panel::new(Axis::linear(&label, "").within(-height, height), 110, vec![region, stems])
    };
    let (own, cross) = (own_lags(test), test.cross_correlation.as_slice());
    let (own_label, cross_label) = ("residual with itself".to_owned(), format!("residual with {}", test.input));
    let panels = vec![
        panel(own_label, Style::Modelled, extent.own, test.autocorrelation_bound, 1.0, own),
        panel(cross_label, Style::Other, extent.cross, test.cross_correlation_bound, first_lag, cross),
    ];
    Figure::new(title, Axis::linear("lag", "ms"), panels).with_caption(format!(
        "Outside the {level} region: {} with itself, {} with {}. Positive lags: the input comes first.",
        outside(own, test.autocorrelation_bound),
        outside(cross, test.cross_correlation_bound),
        test.input
    ))
}

/// How many lags of the cross-correlation lie outside its region, e.g. `3 of 61 lags`.
pub(crate) fn cross_outside(test: &ResidualTest) -> String {
    outside(&test.cross_correlation, test.cross_correlation_bound)
}

fn outside(values: &[f64], bound: f64) -> String {
    let count = values.iter().filter(|value| value.abs() > bound).count();
    format!("{count} of {} lags", values.len())
}

fn lags(first: f64, sample_time_s: f64, count: usize) -> Abscissa {
    Abscissa::Values((0..count).map(|n| Rounded(1e3 * sample_time_s * (first + n as f64))).collect())
}

/// A figure of a residual test on its own, or a remark where there is none.
pub(crate) fn residual_test(validation: &Validation) -> Block {
    match &validation.residuals {
        Some(test) => Block::figure(correlations("Correlation of the residuals", test, Extent::of(&[test]))),
        None => Block::note(format!(
            "No correlation test: the sampling of {} makes it meaningless here ({}).",
            validation.quantity,
            number::duration(validation.measured.sample_time_s)
        )),
    }
}
