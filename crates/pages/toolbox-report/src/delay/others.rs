//! Results of the methods that look for the delay alone.

use ident::delay::{
    ArxDelay, DelayCandidate, DelayEstimate, DelayRanking, FractionalDelay, ImpulseDelay, ImpulseResponseStart,
    PhaseDelay,
};
use ident::distributions::normal_quantile;
use ident::validate::{ResidualTest, TestData};
use ident::{Arx, ArxOrders, Dataset, IdentError, Intersample, Label, StructureError};
use page::decimal::{digits, range, significant};
use page::{Abscissa, Axis, Figure, Layer, Panel, Rounded, Style, Table, rounded};

use super::facts::{ArxDelayFacts, Attempt, CandidateFacts, DelayEstimateFacts};
use super::level::DATED;
use crate::blocks::name;
use crate::figures::figure;
use crate::level::LEVEL;

/// Stretches between gaps that are shorter than this, in samples, show no phase.
const SHORTEST: usize = 20;
/// Delays listed in numbers.
const LISTED: usize = 10;
/// Delays of less weight than this are out of the question.
const WEIGHT: f64 = 0.05;
/// Confidence with which the errors of an ARX model are taken for white.
const WHITE: f64 = 0.99;

type Fine = Option<Result<DelayEstimate, IdentError>>;

/// Results of these methods.
pub(super) struct Others {
    /// Not there where the output is not known every so many samples.
    ranking: Option<DelayRanking>,
    /// True if the errors of the best ARX model look white, so that its comparison can be relied on; none where that is
    /// not known.
    is_white: Option<bool>,
    /// Not there where the inputs excite fewer orders than there are lags, as held ones may.
    starts: Result<Vec<ImpulseResponseStart>, IdentError>,
    /// The methods of one input and one output.
    phase: Fine,
    fraction: Fine,
    longest: usize,
    intersample: Intersample,
}

impl Others {
    pub(super) fn of(data: &Dataset, spacing: Option<usize>, longest: usize) -> Result<Self, IdentError> {
        let uneven = || IdentError::from(StructureError::UnevenOutput);
        let intersample = data.intersample();
        let Some(spacing) = spacing else {
            let (ranking, starts) = (None, Err(uneven()));
            return Ok(Others { ranking, is_white: None, starts, phase: None, fraction: None, longest, intersample });
        };
        let runs = intersample != Intersample::ZeroOrderHold;
        // A coefficient for each sample from one output to the next, during which the input may have changed; one that
        // runs on between samples enters through the samples on both sides.
        let nb = ArxDelay::default().nb + spacing - 1 + usize::from(runs);
        let arx = ArxDelay { highest: longest, spacing, nb, ..ArxDelay::default() };
        let ranking = arx.estimate(data)?;
        let is_single = data.inputs() == 1 && data.outputs() == 1 && spacing == 1;
        // The others see through gaps of the output.
        let without_gaps = || data.without_gaps(SHORTEST);
        Ok(Others {
            is_white: if spacing == 1 { is_white(data, &arx, &ranking) } else { None },
            ranking: Some(ranking),
            starts: ImpulseDelay { lags: longest, spacing, ..ImpulseDelay::default() }.estimate(data),
            phase: is_single
                .then(|| PhaseDelay { highest: longest, ..PhaseDelay::default() }.estimate(&without_gaps()?)),
            // Values between samples of a held input are not made up.
            fraction: (is_single && runs).then(|| {
                FractionalDelay(ArxDelay { highest: longest, ..ArxDelay::default() }).estimate(&without_gaps()?)
            }),
            longest,
            intersample,
        })
    }

    /// The delays of an input that have weight in the comparison of ARX models, from the shortest to the longest.
    fn compared(ranking: &DelayRanking, input: usize) -> (usize, usize) {
        let best = ranking.delays[input];
        let likely = ranking.candidates.iter().filter(|c| c.weight >= WEIGHT).map(|c| c.delays[input]);
        likely.fold((best, best), |(low, high), d| (low.min(d), high.max(d)))
    }

    /// The dead times, in samples, that the comparison of ARX models leaves where it can be relied on. A held input
    /// that shows `n` samples after it moved has a dead time between n − 1 and n. One that runs on straight to its next
    /// sample shows by it, and has one between n and n + 1; a smooth one shows a sample sooner or later still.
    pub(super) fn allowed(&self, input: usize) -> Option<(f64, f64)> {
        let ranking = self.ranking.as_ref().filter(|_| self.starts.is_ok() && self.is_white == Some(true))?;
        let (low, high) = Self::compared(ranking, input);
        let (before, after) = match self.intersample {
            Intersample::ZeroOrderHold => (1.0, 0.0),
            Intersample::FirstOrderHold => (0.0, 1.0),
            Intersample::BandLimited => (1.0, 1.0),
        };
        Some(((low as f64 - before).max(0.0), high as f64 + after))
    }

    /// By how many samples the output is ahead of the input, from the least to the most, where the phase shows that: a
    /// straight one, and further ahead than a stamp is uncertain.
    pub(super) fn ahead(&self) -> Option<(f64, f64)> {
        let phase = self.phase.as_ref()?.as_ref().ok().filter(|phase| phase.standard_error.is_finite())?;
        let (low, high) = interval(phase);
        (high < -DATED).then_some((-high, -low))
    }

    pub(super) fn rows(&self, data: &Dataset, table: &mut Table) {
        let seconds = |samples: f64| significant(samples * data.sample_time_s());
        for (input, label) in data.input_labels().iter().enumerate() {
            let Some(ranking) = &self.ranking else { break };
            let delay = ranking.delays[input];
            let remark = self.certainty(ranking, input);
            let comparison = name(&format!("ARX comparison, {}", label.name));
            table.row([comparison, delay.to_string().into(), seconds(delay as f64).into(), remark.into()]);
        }
        if let Err(reason) = &self.starts {
            table.row(["impulse response".into(), "–".into(), "–".into(), reason.to_string().into()]);
        }
        for (input, start) in self.starts.iter().flatten().enumerate() {
            let response = format!("impulse response, {}", data.input_labels()[input % data.inputs()].name);
            let (samples, time) =
                start.delay.map_or(("–".into(), "–".into()), |d| (d.to_string(), seconds(d as f64)));
            table.row([name(&response), samples.into(), time.into(), "first coefficient that is significant".into()]);
        }
        for (method, estimate) in [("phase of the response", &self.phase), ("ARX, below a sample", &self.fraction)] {
            match estimate {
                Some(Ok(e)) => {
                    let remark = match e.standard_error.is_finite() {
                        true => format!("95 % interval {} samples", range(Some(interval(e)))),
                        false => "no interval: the data are not what this method is for".to_owned(),
                    };
                    table.row([method.into(), digits(e.samples, 5).into(), seconds(e.samples).into(), remark.into()]);
                }
                Some(Err(reason)) => table.row([method.into(), "–".into(), "–".into(), reason.to_string().into()]),
                None => {}
            }
        }
    }

    fn certainty(&self, ranking: &DelayRanking, input: usize) -> String {
        let (low, high) = Self::compared(ranking, input);
        match (low == high, self.is_white) {
            _ if self.starts.is_err() => "the data cannot separate the lags: no more than a hint".to_owned(),
            (_, Some(false)) => "its errors are not white: no more than a hint".to_owned(),
            (true, _) => "whole samples; no rival among the delays tried".to_owned(),
            (false, _) => format!("whole samples; {low} to {high} fit nearly as well"),
        }
    }

    /// Doubts that the methods leave about inputs of whose delay nothing is claimed.
    pub(super) fn doubts(&self, data: &Dataset, is_claimed: impl Fn(usize) -> bool) -> Vec<String> {
        // What is ahead of its input answers to no past one.
        let Some(ranking) = self.ranking.as_ref().filter(|_| self.ahead().is_none()) else { return Vec::new() };
        let mut all = Vec::new();
        for (input, label) in data.input_labels().iter().enumerate().filter(|(input, _)| !is_claimed(*input)) {
            let name = &label.name;
            if ranking.delays[input] == self.longest {
                all.push(format!(
                    "the delay of \"{name}\" in the ARX comparison is the longest that was looked for; try --longest {}",
                    2 * self.longest
                ));
            }
            if self.starts.iter().flatten().nth(input).is_some_and(|start| start.delay.is_none()) {
                all.push(format!(
                    "no coefficient of the impulse response to \"{name}\" is significant: it may have no effect, and then \
                     no delay means anything"
                ));
            }
        }
        all
    }

    pub(super) fn arx_facts(&self) -> Option<ArxDelayFacts> {
        self.ranking.as_ref().map(|ranking| ArxDelayFacts {
            samples: ranking.delays.clone(),
            errors_are_white: self.is_white,
            candidates: ranking.candidates.iter().take(LISTED).map(CandidateFacts::of).collect(),
        })
    }

    pub(super) fn impulse_response_facts(&self) -> Attempt<Vec<Option<usize>>> {
        Attempt::of(self.starts.as_ref(), |starts| starts.iter().map(|start| start.delay).collect())
    }

    pub(super) fn phase_facts(&self) -> Option<Attempt<DelayEstimateFacts>> {
        fine_facts(&self.phase)
    }

    pub(super) fn fraction_facts(&self) -> Option<Attempt<DelayEstimateFacts>> {
        fine_facts(&self.fraction)
    }

    /// For each input the error over the delay and the coefficients of past inputs, with what the models say shaded.
    pub(super) fn figures(&self, data: &Dataset, interval: impl Fn(usize) -> Option<(f64, f64)>) -> Vec<Figure> {
        let Some(ranking) = &self.ranking else { return Vec::new() };
        let of_models = |input: usize| {
            let said = |(low, high)| Layer::XRegion {
                low: Rounded(low),
                high: Rounded(high),
                label: "dead time by a model, 95 %".into(),
            };
            interval(input).map(said).into_iter()
        };
        let one = |(input, label): (usize, &Label)| {
            let errors = of_models(input).chain(self.errors(ranking, input)).collect();
            let mut panels = vec![Panel::new(Axis::log("mean squared error", ""), 180, errors)];
            if let Some(start) = self.starts.iter().flatten().nth(input) {
                let layers = of_models(input).chain(coefficients(start)).collect();
                panels.push(Panel::new(Axis::linear("coefficient of the past input", ""), 180, layers));
            }
            figure(&format!("Delay of {}", label.name), Axis::linear("delay", "samples"), panels)
        };
        data.input_labels().iter().enumerate().map(one).collect()
    }

    /// The least error of each delay of an input.
    fn errors(&self, ranking: &DelayRanking, input: usize) -> Vec<Layer> {
        let of = |c: &DelayCandidate| Some((*c.delays.get(input)? as f64, c.loss));
        let mut pairs: Vec<(f64, f64)> = ranking.candidates.iter().filter_map(of).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        pairs.dedup_by_key(|pair| pair.0);
        let (x, y): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        vec![
            Layer::curve("ARX comparison", Style::Modelled, &x, &y),
            Layer::dots("ARX comparison", Style::Modelled, &x, &y),
        ]
    }
}

fn fine_facts(estimate: &Fine) -> Option<Attempt<DelayEstimateFacts>> {
    estimate.as_ref().map(|estimate| Attempt::of(estimate.as_ref(), DelayEstimateFacts::of))
}

/// Coefficients with the bars beyond which they matter.
fn coefficients(start: &ImpulseResponseStart) -> Vec<Layer> {
    let name = || "impulse response".to_owned();
    let lags: Vec<f64> = (0..start.coefficients.len()).map(|lag| lag as f64).collect();
    let bar = |sign: f64| {
        let ends = start.coefficients.iter().zip(&start.standard_errors);
        Some(rounded(&ends.map(|(b, error)| b + sign * start.threshold * error).collect::<Vec<_>>()))
    };
    let dots = Layer::Points {
        name: name(),
        style: Style::Other,
        x: Abscissa::Values(rounded(&lags)),
        y: rounded(&start.coefficients),
        low: bar(-1.0),
        high: bar(1.0),
    };
    let first = start
        .delay
        .map(|lag| Layer::VerticalMarks { x: vec![Rounded(lag as f64)], label: "first that is significant".into() });
    let zero = Layer::HorizontalMark { y: Rounded(0.0), label: String::new() };
    [Some(zero), Some(dots), first].into_iter().flatten().collect()
}

/// Returns true if the errors of the best ARX model look white; none where the test cannot be made.
fn is_white(data: &Dataset, arx: &ArxDelay, ranking: &DelayRanking) -> Option<bool> {
    let orders =
        ArxOrders { na: vec![vec![arx.na]], nb: vec![vec![arx.nb; data.inputs()]], nk: vec![ranking.delays.clone()] };
    let fit = Arx::with_orders(orders).fit(data).ok()?;
    let report = ResidualTest::default().run(&fit, data, TestData::Own).ok()?;
    Some(report.joint_whiteness.passes(WHITE))
}

/// The interval of an estimate, in samples.
fn interval(estimate: &DelayEstimate) -> (f64, f64) {
    let reach = normal_quantile(0.5 + LEVEL / 2.0) * estimate.standard_error;
    (estimate.samples - reach, estimate.samples + reach)
}
