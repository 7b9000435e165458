//! Tests of residuals: what they found, in words, in numbers and as figures.

use ident::distributions::normal_quantile;
use ident::validate::{Independence, JointTest, ResidualReport, Whiteness};
use ident::{Dataset, Label};
use numerics::null::nan_if_null;
use page::decimal::probability;
use page::{Abscissa, Axis, Block, Figure, Finding, Layer, Page, Panel, Prose, Style, Tone, rounded};
use serde::{Deserialize, Serialize};

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

/// Tests of the residuals of a model on data, in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ResidualFacts {
    /// The tests.
    #[serde(flatten)]
    pub tests: TestFacts,
    /// The inputs of the model.
    pub inputs: Vec<Label>,
    /// The outputs of the model.
    pub outputs: Vec<Label>,
}

impl ResidualFacts {
    /// Of a report on data.
    pub fn of(report: &ResidualReport, data: &Dataset) -> Self {
        let (inputs, outputs) = (data.input_labels().to_vec(), data.output_labels().to_vec());
        ResidualFacts { tests: TestFacts::of(report), inputs, outputs }
    }
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

/// Tests of residuals in numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestFacts {
    /// Confidence of the regions.
    pub level: f64,
    /// Tests of each output for whiteness.
    pub whiteness: Vec<WhitenessFacts>,
    /// Tests of each output for independence of each input.
    pub independence: Vec<Vec<IndependenceFacts>>,
    /// Number of samples that were tested.
    pub samples: usize,
    /// Number of samples that there are.
    pub samples_given: usize,
}

/// Test for whiteness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WhitenessFacts {
    /// All lags together.
    pub joint: JointFacts,
    /// Autocorrelations from lag 0 on.
    #[serde(deserialize_with = "nan_if_null")]
    pub auto: Vec<f64>,
    /// Their regions; none at lags without pairs.
    #[serde(deserialize_with = "nan_if_null")]
    pub bounds: Vec<f64>,
}

/// Test for independence of an input.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IndependenceFacts {
    /// Correlation that missing dynamics cause.
    pub dynamics: JointFacts,
    /// Correlation with the past of the input.
    pub past: JointFacts,
    /// Correlation with the future of the input.
    pub feedback: JointFacts,
    /// Correlations, those of negative lags first.
    #[serde(deserialize_with = "nan_if_null")]
    pub cross: Vec<f64>,
    /// Their regions; none at lags without pairs.
    #[serde(deserialize_with = "nan_if_null")]
    pub bounds: Vec<f64>,
}

/// Test of several lags together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointFacts {
    /// Probability of such correlations by chance.
    #[serde(deserialize_with = "nan_if_null")]
    pub p_value: f64,
    /// True where it passed.
    pub passed: bool,
}

impl TestFacts {
    pub(crate) fn of(report: &ResidualReport) -> Self {
        let independence = |row: &Vec<Independence>| row.iter().map(IndependenceFacts::of).collect();
        TestFacts {
            level: REGION,
            whiteness: report.whiteness.iter().map(WhitenessFacts::of).collect(),
            independence: report.independence.iter().map(independence).collect(),
            samples: report.samples,
            samples_given: report.samples_given,
        }
    }
}

impl WhitenessFacts {
    fn of(test: &Whiteness) -> Self {
        WhitenessFacts { joint: JointFacts::of(&test.joint), auto: test.auto.clone(), bounds: test.bounds.clone() }
    }
}

impl IndependenceFacts {
    fn of(test: &Independence) -> Self {
        IndependenceFacts {
            dynamics: JointFacts::of(&test.dynamics),
            past: JointFacts::of(&test.past),
            feedback: JointFacts::of(&test.feedback),
            cross: test.cross.clone(),
            bounds: test.bounds.clone(),
        }
    }
}

impl JointFacts {
    fn of(test: &JointTest) -> Self {
        JointFacts { p_value: test.p_value, passed: test.passes(REGION) }
    }
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
