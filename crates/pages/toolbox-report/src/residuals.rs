//! Tests of residuals: what they found, in words, in numbers and as figures.

use ident::distributions::normal_quantile;
use ident::validate::{Independence, JointTest, ResidualReport, Whiteness};
use ident::{Dataset, Label};
use page::decimal::probability;
use page::{Abscissa, Axis, Block, Figure, Finding, Layer, Page, Panel, Prose, Style, Tone, rounded};
use serde_json::{Value, json};

use crate::blocks::line;
use crate::figures::figure;

/// Confidence of the regions of the tests.
pub const REGION: f64 = 0.99;
/// Correlations below this are rounding.
const ROUNDING: f64 = 1e-12;

/// Page of the tests on data.
pub fn page(report: &ResidualReport, data: &Dataset) -> Page {
    let mut blocks = findings(report, data.input_labels(), data.output_labels());
    blocks.extend(figures(report, data).into_iter().map(Block::figure));
    Page::new("Residuals", blocks)
}

/// The same in numbers.
pub fn json(report: &ResidualReport, data: &Dataset) -> Value {
    let mut tests = numbers(report);
    tests["inputs"] = json!(data.input_labels());
    tests["outputs"] = json!(data.output_labels());
    tests
}

/// Findings of the tests, output by output.
pub(crate) fn findings(report: &ResidualReport, inputs: &[Label], outputs: &[Label]) -> Vec<Block> {
    let mut all = Vec::new();
    if report.samples < report.samples_given {
        let (tested, given) = (report.samples, report.samples_given);
        all.push(line(format!(
            "residual tests: {tested} of {given} samples, spread over the data; they show correlations of {:.1} %",
            100.0 * normal_quantile(0.5 + REGION / 2.0) / (tested as f64).sqrt()
        )));
    }
    for (output, whiteness) in report.whiteness.iter().enumerate() {
        let name = &outputs[output].name;
        let (good, bad) = (format!("residuals of {name} are white"), format!("residuals of {name} are not white"));
        all.push(finding(&whiteness.joint, good, bad));
        for (input, test) in report.independence[output].iter().enumerate() {
            all.extend(of_input(test, &inputs[input].name, name));
        }
    }
    all
}

fn of_input(test: &Independence, input: &str, name: &str) -> [Block; 2] {
    let missing = match test.past.passes(REGION) {
        true => format!(
            "residuals of {name} depend only on {input} of the same sample: {input} acts at once, or follows {name} \
             within the sample, as a controller's output does"
        ),
        false => format!("residuals of {name} depend on past {input}: dynamics are missing"),
    };
    let captured = format!("residuals of {name} do not depend on past {input}: the dynamics are captured");
    // An input that remembers its past carries missing dynamics to its future too.
    let seen = match test.dynamics.passes(REGION) {
        true => "there is feedback",
        false => "feedback, or the missing dynamics again, as with an input that is not white",
    };
    let unseen = format!("residuals of {name} are not correlated with future {input}: no feedback");
    let seen = format!("residuals of {name} are correlated with future {input}: {seen}");
    [finding(&test.dynamics, captured, missing), finding(&test.feedback, unseen, seen)]
}

fn finding(test: &JointTest, good: String, bad: String) -> Block {
    let (tone, severity, words) =
        if test.passes(REGION) { (Tone::Good, "passed", good) } else { (Tone::Bad, "failed", bad) };
    let text = format!("{words} ({})", probability(test.p_value));
    Block::Finding(Finding::new(tone, severity, Prose::verbatim(text)))
}

/// The tests in numbers.
pub(crate) fn numbers(report: &ResidualReport) -> Value {
    let joint = |test: &JointTest| json!({"p_value": test.p_value, "passed": test.passes(REGION)});
    let of = |i: &Independence| {
        json!({"dynamics": joint(&i.dynamics), "past": joint(&i.past), "feedback": joint(&i.feedback),
            "cross": i.cross, "bounds": i.bounds})
    };
    let independence: Vec<Vec<_>> = report.independence.iter().map(|row| row.iter().map(of).collect()).collect();
    let whiteness: Vec<_> = report
        .whiteness
        .iter()
        .map(|w| json!({"joint": joint(&w.joint), "auto": w.auto, "bounds": w.bounds}))
        .collect();
    json!({"level": REGION, "whiteness": whiteness, "independence": independence,
        "samples": report.samples, "samples_given": report.samples_given})
}

/// Correlations of the residuals, a figure for each output.
pub(crate) fn figures(report: &ResidualReport, data: &Dataset) -> Vec<Figure> {
    // What an estimate holds of its own data varies from lag to lag; there is no region at lags without pairs.
    let band = |first: f64, bounds: &[f64]| {
        let there = bounds.iter().enumerate().filter(|(_, bound)| bound.is_finite());
        let (lags, high): (Vec<f64>, Vec<f64>) = there.map(|(n, bound)| (first + n as f64, *bound)).unzip();
        let low: Vec<f64> = high.iter().map(|bound| -bound).collect();
        let (name, x) = (format!("{} % region", 100.0 * REGION), Abscissa::Values(rounded(&lags)));
        Layer::Band { name, style: Style::Guide, x, low: rounded(&low), high: rounded(&high) }
    };
    let stems = |name: &str, style, first: f64, values: &[f64]| {
        // There is no number at lags without pairs, and but rounding where an estimate holds a correlation.
        let there = values.iter().enumerate().filter(|(_, value)| value.abs() > ROUNDING);
        let (lags, values): (Vec<f64>, Vec<f64>) = there.map(|(n, value)| (first + n as f64, *value)).unzip();
        Layer::Stems { name: name.to_owned(), style, x: Abscissa::Values(rounded(&lags)), y: rounded(&values) }
    };
    let own = |w: &Whiteness| {
        let past = |values: &[f64]| values.get(1..).unwrap_or_default().to_vec();
        let layers = vec![band(1.0, &past(&w.bounds)), stems("with itself", Style::Modelled, 1.0, &past(&w.auto))];
        Panel::new(Axis::linear("with itself", ""), 110, layers)
    };
    let other = |(input, independence): (usize, &Independence)| {
        let first = -((independence.cross.len() / 2) as f64);
        let layers =
            vec![band(first, &independence.bounds), stems("with an input", Style::Other, first, &independence.cross)];
        Panel::new(Axis::linear(&format!("with {}", data.input_labels()[input].name), ""), 110, layers)
    };
    let of_output = |(output, whiteness): (usize, &Whiteness)| {
        let inputs = report.independence[output].iter().enumerate().map(other);
        let panels = std::iter::once(own(whiteness)).chain(inputs).collect();
        let title = format!("Correlation of the residuals of {}", data.output_labels()[output].name);
        figure(&title, Axis::linear("lag", "samples"), panels).with_caption(
            "Positive lags: the input comes first. Negative lags: the output comes first, as with feedback.",
        )
    };
    report.whiteness.iter().enumerate().map(of_output).collect()
}
