//! `dynoid delay`: by several methods, and what to make of it where they disagree.

use bench::dataset::CommonClock;
use ident::delay::{
    ArxDelay, DelayEstimate, DelayRanking, FractionalDelay, ImpulseDelay, ImpulseResponseStart, PhaseDelay,
};
use ident::distributions::normal_quantile;
use ident::{Dataset, IdentError};
use plot::{Axis, Figure, Layer, Panel, Style};

use super::super::data::{Gaps, check_plot, read, say, take};
use super::super::figures::figure;
use super::super::judge::{picture, written};
use super::super::words::{digits, range, significant};
use crate::cli::identify::DelayArguments;
use crate::error::{CliError, Outcome};
use crate::table::{Align, Style as Text, Table};
use crate::terminal::Terminal;

/// Delays listed in numbers.
const LISTED: usize = 10;
/// Delays of less weight than this are out of the question.
const WEIGHT: f64 = 0.05;
/// Confidence of intervals.
const LEVEL: f64 = 0.95;

type Fine = Option<Result<DelayEstimate, IdentError>>;

/// What each method says.
struct Delays {
    ranking: DelayRanking,
    /// Not there where the inputs excite fewer orders than there are lags, as held ones may.
    starts: Result<Vec<ImpulseResponseStart>, IdentError>,
    /// The methods of one input and one output.
    phase: Fine,
    fraction: Fine,
    longest: usize,
}

/// `dynoid delay`
pub(crate) fn delay(arguments: &DelayArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &[&arguments.data.recordings])?;
    let (data, found) = found(arguments, terminal)?;
    picture(&arguments.result, "Delay", || vec![losses(&found.ranking)])?;
    let doubts = found.doubts(&data);
    if arguments.result.json {
        terminal.json(&json(&found, &data, &doubts))?;
    } else if !terminal.is_quiet() {
        terminal.table(&table(&found, &data));
        for doubt in &doubts {
            terminal.item(("doubt:", Text::Caution), doubt);
        }
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

/// The data on the clock of the fastest channel and what the methods say of them; on that of the slowest where the output is
/// not known every so many samples, or the inputs move too rarely to tell the lags between its samples apart.
fn found(arguments: &DelayArguments, terminal: &mut Terminal) -> Result<(Dataset, Delays), CliError> {
    if arguments.data.inputs.is_empty() {
        return Err(CliError::Usage { what: "a delay is one from an input: name it with --input".into() });
    }
    let files = read(&arguments.data, terminal)?;
    let fast = take(&files, CommonClock::Fastest, &arguments.data)?;
    let spacing = spacing(&fast.data);
    if let Some(spacing) = spacing {
        // Between samples of a slow output nothing is missing that could be there.
        let fast = fast.cut_at(if spacing > 1 { Gaps::OfInputs } else { Gaps::OfAll })?;
        let found = estimate(&fast.data, spacing, arguments.longest)?;
        if spacing == 1 || found.starts.is_ok() || arguments.data.sample_time_s.is_some() {
            say(&fast.notes, &mut Vec::new(), terminal);
            return Ok((fast.data, found));
        }
    }
    let slow = take(&files, CommonClock::Slowest, &arguments.data)?.cut_at(Gaps::OfAll)?;
    say(&slow.notes, &mut Vec::new(), terminal);
    let found = estimate(&slow.data, 1, arguments.longest)?;
    Ok((slow.data, found))
}

/// The samples from one known output to the next, gaps left aside; `None` where they are not always as many.
fn spacing(data: &Dataset) -> Option<usize> {
    let known = |e: &ident::Experiment| {
        let y = e.output(0).iter().enumerate();
        y.filter(|(_, v)| !v.is_nan()).map(|(i, _)| i).collect::<Vec<usize>>()
    };
    let all: Vec<Vec<usize>> = data.experiments().iter().map(known).collect();
    let steps = || all.iter().flat_map(|known| known.windows(2).map(|w| w[1] - w[0]));
    let least = steps().min()?;
    steps().all(|step| step % least == 0).then_some(least)
}

fn estimate(data: &Dataset, spacing: usize, longest: usize) -> Result<Delays, CliError> {
    let samples = data.experiments().iter().map(|e| e.len()).max().unwrap_or(0);
    if longest == 0 || longest >= samples / 2 {
        let what = format!("--longest {longest}: give at least 1, and less than half of the {samples} samples on end");
        return Err(CliError::Usage { what });
    }
    let failed = |source| CliError::identify("the delay", source);
    // A coefficient for each sample from one output to the next, during which the input may have changed.
    let nb = ArxDelay::default().nb + spacing - 1;
    let arx = ArxDelay { highest: longest, spacing, nb, ..ArxDelay::default() };
    let is_single = data.inputs() == 1 && data.outputs() == 1 && spacing == 1;
    Ok(Delays {
        ranking: arx.estimate(data).map_err(failed)?,
        starts: ImpulseDelay { lags: longest, spacing, ..ImpulseDelay::default() }.estimate(data),
        phase: is_single.then(|| PhaseDelay { highest: longest, ..PhaseDelay::default() }.estimate(data)),
        fraction: is_single.then(|| FractionalDelay(arx).estimate(data)),
        longest,
    })
}

impl Delays {
    /// The delays of an input that have weight in the comparison of ARX models, from the shortest to the longest.
    fn compared(&self, input: usize) -> (usize, usize) {
        let best = self.ranking.delays[input];
        let likely = self.ranking.candidates.iter().filter(|c| c.weight >= WEIGHT).map(|c| c.delays[input]);
        likely.fold((best, best), |(low, high), d| (low.min(d), high.max(d)))
    }

    /// What the methods contradict each other in, which one to trust, and why.
    fn doubts(&self, data: &Dataset) -> Vec<String> {
        let of_input = |(input, label): (usize, &ident::Label)| self.doubts_of(input, &label.name);
        let mut all: Vec<String> = data.input_labels().iter().enumerate().flat_map(of_input).collect();
        if let Err(IdentError::RankDeficient { .. }) = self.starts {
            all.insert(
                0,
                "the inputs move so rarely that neighbouring lags cannot be told apart: the delay may be off by several \
                 samples; let `fit tf --delay` or `fit process` find it beside the dynamics, or look at it on a longer \
                 --sample-time"
                    .to_owned(),
            );
        }
        let (low, high) = self.compared(0);
        // A whole number stands for all that is nearer to it than to the next.
        let (low, high) = (low as f64 - 0.5, high as f64 + 0.5);
        let outside = |estimate: &Fine| {
            let (from, to) = interval(estimate.as_ref()?.as_ref().ok()?);
            (to < low || from > high).then(|| range(Some((from, to))))
        };
        all.extend(outside(&self.phase).map(|ends| {
            format!(
                "the phase says {ends} samples: it takes every lag of the system for delay, and is right only where the \
                 output is the input, later; trust the ARX comparison, which has dynamics beside the delay"
            )
        }));
        all.extend(outside(&self.fraction).map(|ends| {
            format!(
                "ARX below a sample says {ends} samples: coefficients that are not needed, or an input that is not held, \
                 blur the fraction; trust the whole number of the ARX comparison, or let `fit tf --delay` or `fit process` \
                 find the fraction beside the dynamics"
            )
        }));
        all
    }

    fn doubts_of(&self, input: usize, name: &str) -> Vec<String> {
        let (low, high) = self.compared(input);
        let best = self.ranking.delays[input];
        let mut all = Vec::new();
        if best == self.longest {
            all.push(format!(
                "the delay of \"{name}\" is the longest that was looked for; try --longest {}",
                2 * self.longest
            ));
        }
        let starts = self.starts.as_deref().unwrap_or_default();
        all.extend(match starts.get(input).map(|start| start.delay) {
            Some(Some(start)) if start < low => Some(format!(
                "the impulse response to \"{name}\" starts at {start} already, the ARX comparison says {best}: a small \
                 early response that models of low order pass over; trust {best} for such a model, and {start} for one \
                 of high order"
            )),
            Some(Some(start)) if start > high => Some(format!(
                "the impulse response to \"{name}\" starts at {start} only, the ARX comparison says {best}: trust the \
                 comparison; a response that starts slowly is lost in noise at first"
            )),
            Some(None) => Some(format!(
                "no coefficient of the impulse response to \"{name}\" is significant: it may have no effect, and then no \
                 delay means anything"
            )),
            _ => None,
        });
        all
    }
}

/// The interval of an estimate, in samples.
fn interval(estimate: &DelayEstimate) -> (f64, f64) {
    let reach = normal_quantile(0.5 + LEVEL / 2.0) * estimate.standard_error;
    (estimate.samples - reach, estimate.samples + reach)
}

fn table(found: &Delays, data: &Dataset) -> Table {
    let seconds = |samples: f64| significant(samples * data.sample_time_s());
    let columns = [("method", Align::Left), ("samples", Align::Right), ("seconds", Align::Right), ("", Align::Left)];
    let mut table = Table::new(&columns);
    for (input, delay) in found.ranking.delays.iter().enumerate() {
        let (low, high) = found.compared(input);
        let certainty = match low == high {
            true if found.starts.is_err() => "lags cannot be told apart, see below".to_owned(),
            true => "no rival among the delays tried".to_owned(),
            false => format!("{low} to {high} fit nearly as well"),
        };
        let name = format!("ARX comparison, {}", data.input_labels()[input].name);
        table.row([name.into(), delay.to_string().into(), seconds(*delay as f64).into(), certainty.into()]);
    }
    if let Err(reason) = &found.starts {
        table.row(["impulse response".into(), "–".into(), "–".into(), reason.to_string().into()]);
    }
    for (input, start) in found.starts.iter().flatten().enumerate() {
        let name = format!("impulse response, {}", data.input_labels()[input % data.inputs()].name);
        let (samples, time) = start.delay.map_or(("–".into(), "–".into()), |d| (d.to_string(), seconds(d as f64)));
        table.row([name.into(), samples.into(), time.into(), "first coefficient that is significant".into()]);
    }
    for (name, estimate) in [("phase of the response", &found.phase), ("ARX, below a sample", &found.fraction)] {
        match estimate {
            Some(Ok(e)) => {
                let ends = format!("95 % interval {} samples", range(Some(interval(e))));
                table.row([name.into(), digits(e.samples, 5).into(), seconds(e.samples).into(), ends.into()]);
            }
            Some(Err(reason)) => table.row([name.into(), "–".into(), "–".into(), reason.to_string().into()]),
            None => {}
        }
    }
    table
}

fn json(found: &Delays, data: &Dataset, doubts: &[String]) -> serde_json::Value {
    let estimate = |e: &Fine| match e {
        Some(Ok(e)) => serde_json::json!({"samples": e.samples, "standard_error": e.standard_error}),
        Some(Err(reason)) => serde_json::json!({"error": reason.to_string()}),
        None => serde_json::Value::Null,
    };
    let candidate =
        |c: &ident::delay::DelayCandidate| serde_json::json!({"samples": c.delays, "loss": c.loss, "weight": c.weight});
    let candidates: Vec<_> = found.ranking.candidates.iter().take(LISTED).map(candidate).collect();
    let starts = match &found.starts {
        Ok(starts) => serde_json::json!(starts.iter().map(|start| start.delay).collect::<Vec<_>>()),
        Err(reason) => serde_json::json!({"error": reason.to_string()}),
    };
    serde_json::json!({
        "sample_time_s": data.sample_time_s(),
        "arx": {"samples": found.ranking.delays, "candidates": candidates},
        "impulse_response": starts,
        "phase": estimate(&found.phase),
        "arx_fraction": estimate(&found.fraction),
        "doubts": doubts,
    })
}

/// The error over the delay of the first input.
fn losses(ranking: &DelayRanking) -> Figure {
    let mut pairs: Vec<(f64, f64)> =
        ranking.candidates.iter().filter_map(|c| Some((*c.delays.first()? as f64, c.loss))).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    pairs.dedup_by_key(|pair| pair.0);
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
    let style = Style::Modelled;
    let layers = vec![Layer::curve("ARX", style, &x, &y), Layer::dots("ARX", style, &x, &y)];
    let panel = Panel::new(Axis::log("mean squared error", ""), 200, layers);
    figure("Delay by comparison of ARX models", Axis::linear("delay of the first input", "samples"), vec![panel])
}
