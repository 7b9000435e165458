//! `dynoid data delay`: dead times beside dynamics, what other methods say, and what to make of it where they disagree.

mod modelled;
mod others;

use dataset::{Adjustment, CommonClock, Resampling};
use ident::Dataset;
use ident::delay::ModelledDelay;

use super::super::data::{Gaps, Loaded, check_movement, check_plot, read, say, take};
use super::super::judge::{picture, written};
use super::super::words::significant;
use crate::cli::identify::DelayArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;
use modelled::Modelled;
use others::Others;
use page::{Align, Table, Tone as Text};

/// Confidence of intervals.
const LEVEL: f64 = 0.95;
/// A time stamp is trusted to this part of the clock either way.
const DATED: f64 = 1.0 / 20.0;

/// `dynoid data delay`
pub(crate) fn delay(arguments: &DelayArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &[&arguments.data.recordings])?;
    if arguments.data.inputs.is_empty() {
        return Err(CliError::Usage { what: "a delay is one from an input: name it with --input".into() });
    }
    let files = read(&arguments.data, terminal)?;
    let loaded = take(&files, CommonClock::Fastest, &arguments.data)?;
    check_movement(&loaded)?;
    let spacing = spacing(&loaded.data);
    // Between samples of a slow output nothing is missing that could be there.
    let loaded = loaded.cut_at(if spacing == Some(1) { Gaps::OfAll } else { Gaps::OfInputs })?;
    say(&loaded.notes, &mut Vec::new(), terminal);
    let data = &loaded.data;
    check_longest(data, arguments.longest)?;
    let progress = terminal.progress(2);
    progress.say("comparing delays");
    let others = Others::of(data, spacing, arguments.longest)?;
    progress.step();
    progress.say("fitting models with a delay");
    let options = ModelledDelay { longest: arguments.longest, dating: dating(&loaded), level: LEVEL };
    let modelled = Modelled::of(&options, &loaded, &others, arguments.data.between.is_some());
    drop(progress);
    picture(&arguments.result, "Delay", || others.figures(data, |input| modelled.interval(input)))?;
    let notes = modelled.notes();
    let doubts = others.doubts(data, |input| modelled.is_claimed(input));
    if arguments.result.json {
        let mut result = others.json();
        result["sample_time_s"] = data.sample_time_s().into();
        result["clock"] = clock(data, &arguments.data.sample_time_s).into();
        result["delay"] = modelled.claims_json(data);
        result["models"] = modelled.json(data);
        result["notes"] = serde_json::json!(notes);
        result["doubts"] = serde_json::json!(doubts);
        terminal.json(&result)?;
    } else if !terminal.is_quiet() {
        terminal.line(&clock(data, &arguments.data.sample_time_s));
        let columns =
            [("method", Align::Left), ("samples", Align::Right), ("seconds", Align::Right), ("", Align::Left)];
        let mut table = Table::new(&columns);
        modelled.rows(data, &mut table);
        others.rows(data, &mut table);
        terminal.table(&table);
        for (mark, style, text) in modelled.claims(data) {
            terminal.item((mark, style), &text);
        }
        notes.iter().for_each(|note| terminal.item(("note:", Text::Plain), note));
        doubts.iter().for_each(|doubt| terminal.item(("doubt:", Text::Caution), doubt));
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

fn check_longest(data: &Dataset, longest: usize) -> Result<(), CliError> {
    let samples = data.experiments().iter().map(|e| e.len()).max().unwrap_or(0);
    if longest == 0 || longest >= samples / 2 {
        let what = format!("--longest {longest}: give at least 1, and less than half of the {samples} samples on end");
        return Err(CliError::Usage { what });
    }
    Ok(())
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

/// Which clock was taken, and why.
fn clock(data: &Dataset, given_s: &Option<f64>) -> String {
    let every = significant(data.sample_time_s());
    match given_s {
        Some(_) => format!("on the clock of {every} s that --sample-time gives"),
        None => format!("on the clock of the fastest channel, {every} s, so that nothing is filtered"),
    }
}

/// Standard uncertainty of instants, in samples: that of a stamp, uniform, and how far stamps lie off the clock.
fn dating(loaded: &Loaded) -> f64 {
    let jitter_s = loaded.adjustments.iter().filter_map(|adjustment| match adjustment {
        Adjustment::Jitter { largest_s, .. } => Some(*largest_s),
        _ => None,
    });
    let jitter = jitter_s.fold(0.0, f64::max) / loaded.data.sample_time_s();
    ((DATED * DATED + jitter * jitter) / 3.0).sqrt()
}

/// The channels that went through a low-pass filter on their way to the clock.
fn filtered(loaded: &Loaded) -> Vec<&str> {
    let filtered = loaded.adjustments.iter().filter_map(|adjustment| match adjustment {
        Adjustment::Resampled { channel, how: Resampling::Filtered, .. } => Some(channel.as_str()),
        _ => None,
    });
    filtered.collect()
}
