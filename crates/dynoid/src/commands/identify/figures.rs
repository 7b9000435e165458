//! Pictures of data, models and their judgement.

use ident::Dataset;
use ident::prediction::Response;
use ident::validate::{Independence, ResidualReport, Whiteness};
use plot::{Abscissa, Axis, Figure, Layer, Panel, Rounded, Style, rounded};

/// Measured outputs and what models make of them, a figure for each recording and output.
pub(super) fn comparison(data: &Dataset, models: &[(String, &Response)]) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (number, experiment) in data.experiments().iter().enumerate() {
        for output in 0..data.outputs() {
            let label = &data.output_labels()[output];
            let clock = (experiment.start_s, data.sample_time_s());
            let measured = experiment.output(output);
            let mut layers = vec![Layer::trace("measured", Style::Measured, clock, measured)];
            let mut errors = Vec::new();
            for (index, (name, response)) in models.iter().enumerate() {
                let style = Style::of_model(index);
                let modelled = response.outputs[number].col_as_slice(output);
                layers.push(Layer::trace(name, style, clock, modelled));
                let difference: Vec<f64> = measured.iter().zip(modelled).map(|(y, m)| y - m).collect();
                errors.push(Layer::trace(name, style, clock, &difference));
            }
            let panels = vec![
                Panel::new(Axis::linear(&label.name, &label.unit), 200, layers),
                Panel::new(Axis::linear("measured − model", &label.unit), 90, errors),
            ];
            figures.push(Figure::new(&format!("{}, {}", label.name, experiment.name), Axis::time(), panels));
        }
    }
    figures
}

/// Correlations of the residuals, a figure for each output.
pub(super) fn residuals(report: &ResidualReport, data: &Dataset, level: f64) -> Vec<Figure> {
    let region = |bound: f64| Layer::YRegion {
        low: Rounded(-bound),
        high: Rounded(bound),
        label: format!("{} % region", 100.0 * level),
    };
    let stems = |style, first: f64, values: &[f64]| {
        let lags: Vec<f64> = (0..values.len()).map(|n| first + n as f64).collect();
        Layer::Stems { name: "correlation".into(), style, x: Abscissa::Values(rounded(&lags)), y: rounded(values) }
    };
    let own = |w: &Whiteness| {
        let layers = vec![region(w.bound), stems(Style::Modelled, 1.0, w.auto.get(1..).unwrap_or_default())];
        Panel::new(Axis::linear("with itself", ""), 110, layers)
    };
    let other = |(input, independence): (usize, &Independence)| {
        let first = -((independence.cross.len() / 2) as f64);
        let layers = vec![region(independence.bound), stems(Style::Other, first, &independence.cross)];
        Panel::new(Axis::linear(&format!("with {}", data.input_labels()[input].name), ""), 110, layers)
    };
    let figure = |(output, whiteness): (usize, &Whiteness)| {
        let inputs = report.independence[output].iter().enumerate().map(other);
        let panels = std::iter::once(own(whiteness)).chain(inputs).collect();
        let title = format!("Correlation of the residuals of {}", data.output_labels()[output].name);
        Figure::new(&title, Axis::linear("lag", "samples"), panels).with_caption(
            "Positive lags: the input comes first. Negative lags: the output comes first, as with feedback.",
        )
    };
    report.whiteness.iter().enumerate().map(figure).collect()
}
