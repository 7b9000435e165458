//! Dead times of models with dynamics, and what is claimed of them.

use dataset::{Adjustment, Resampling};
use ident::delay::{DelayFault, DelayModel, DelayModels, ModelledDelay, single_line};
use ident::{Dataset, IdentError, Intersample};
use page::decimal::{probability, range, significant};
use page::{Block, Table, Tone};
use signal::distributions::normal_quantile;

use super::facts::{Attempt, ClaimFacts, DelayModelFacts};
use super::others::Others;
use crate::blocks::{finding, name};
use crate::level::LEVEL;
use crate::words::counted;

/// A share of samples that differ from the one before above this is that of an input that is not held for longer.
const RESTLESS: f64 = 0.5;

/// Data, and what was done to bring them onto their clock.
pub(super) type Clocked<'a> = (&'a Dataset, &'a [Adjustment]);

/// Result of the models, and the reasons where no interval is claimed.
pub(super) struct Modelled {
    found: Result<DelayModels, IdentError>,
    /// For each input, why no interval is given; none where one is.
    unclaimed: Vec<Option<String>>,
    /// The least and the greatest delay that any method allows, of each input.
    span: Vec<(f64, f64)>,
}

impl Modelled {
    /// On data of which it was said, or not, what inputs do between samples.
    pub(super) fn of(
        options: &ModelledDelay,
        (data, adjustments): Clocked<'_>,
        others: &Others,
        is_said: bool,
    ) -> Self {
        let found = options.estimate(data);
        let ahead = ahead(others, data);
        let one = |input: usize| match unexcited(found.as_ref(), data, input).or_else(|| ahead.clone()) {
            Some(reason) => (Some(reason), (f64::NEG_INFINITY, f64::INFINITY)),
            None => {
                let reason = reason(found.as_ref(), (data, adjustments), others, input);
                let reason = reason.or_else(|| unknown_between(data, input).filter(|_| !is_said));
                (reason, span(found.as_ref().ok(), others, options.longest, input))
            }
        };
        let (unclaimed, span) = (0..data.inputs()).map(one).unzip();
        Modelled { found, unclaimed, span }
    }

    /// Returns true if a delay of this input is claimed.
    pub(super) fn is_claimed(&self, input: usize) -> bool {
        self.unclaimed[input].is_none()
    }

    /// By what part more data could shorten the intervals of the dead times at most, if a model can be relied on,
    /// whatever keeps an interval from being claimed: the instants are uncertain by `dating` samples, and a gain under
    /// a held input leaves one sample open.
    pub(super) fn could_shrink_by(&self, dating: f64) -> Option<f64> {
        let claimed = self.found.as_ref().ok().and_then(DelayModels::claimed)?;
        let left = if claimed.poles == 0 { dating.hypot(1.0 / 12f64.sqrt()) } else { dating };
        let least = 2.0 * normal_quantile(0.5 + 0.5 * LEVEL) * left;
        Some(claimed.intervals.iter().map(|(low, high)| 1.0 - least / (high - low)).fold(0.0, f64::max))
    }

    /// Interval of an input by the best model, in samples, claimed or not.
    pub(super) fn interval(&self, input: usize) -> Option<(f64, f64)> {
        self.found.as_ref().ok().map(|found| found.best().intervals[input])
    }

    fn models(&self) -> &[DelayModel] {
        self.found.as_ref().map_or(&[], |found| &found.models)
    }

    /// One row a model and input.
    pub(super) fn rows(&self, data: &Dataset, table: &mut Table) {
        for (index, model) in self.models().iter().enumerate() {
            for (input, dead) in model.dead_times.iter().enumerate() {
                let named = format!("{}, {}", structure(model), data.input_labels()[input].name);
                let seconds = digits(dead.samples * data.sample_time_s());
                table.row([
                    name(&named),
                    digits(dead.samples).into(),
                    seconds.into(),
                    self.remark(index, input).into(),
                ]);
            }
        }
        if let Err(reason) = &self.found {
            table.row(["dead time beside lags".into(), "–".into(), "–".into(), name(&reason.to_string())]);
        }
    }

    fn remark(&self, index: usize, input: usize) -> String {
        let Ok(found) = &self.found else { return String::new() };
        let model = &found.models[index];
        let interval = || format!("95 % interval {} samples", range(Some(model.intervals[input])));
        match model.faults.first() {
            // A pole and a zero that cancel leave nothing to converge to.
            Some(DelayFault::NotConverged) if index > found.best => "no better; its search did not converge".to_owned(),
            Some(fault) => words(fault, ""),
            None if index == found.best && self.unclaimed[input].is_none() => interval(),
            None if index > found.best => format!("no better; {}", interval()),
            None => interval(),
        }
    }

    /// Claim about each input, or that there is none.
    pub(super) fn claims(&self, data: &Dataset) -> Vec<Block> {
        let t = data.sample_time_s();
        let claim = |(input, label): (usize, &ident::Label)| {
            let name = &label.name;
            if let Some(reason) = &self.unclaimed[input] {
                let (low, high) = self.span[input];
                let between = match low.is_finite() && high.is_finite() {
                    true => format!("; the methods leave {} s", range(Some((low * t, high * t)))),
                    false => String::new(),
                };
                let text = format!("of \"{name}\" no interval is claimed: {reason}{between}");
                return finding(Tone::Caution, "delay", &text);
            }
            let Ok(found) = &self.found else { return finding(Tone::Caution, "delay", "") };
            let model = found.best();
            let (low, high) = model.intervals[input];
            let dead = digits(model.dead_times[input].samples.clamp(low, high) * t);
            let ends = range(Some((low * t, high * t)));
            // One below zero is no lag of a causal system.
            let late = model.late_by[input].as_ref().filter(|late| late.samples >= 0.0);
            let late = late.map_or(String::new(), |late| {
                let ends = model.late_intervals[input].map(|(low, high)| (low.max(0.0) * t, high * t));
                let ends = format!("95 % interval {} s", range(ends));
                format!("; with it slow changes come out {} s late ({ends})", digits(late.samples * t))
            });
            let beside = beside(model);
            let text = format!("of \"{name}\" {dead} s (95 % interval {ends} s): the dead time {beside}{late}");
            finding(Tone::Strong, "delay", &text)
        };
        data.input_labels().iter().enumerate().map(claim).collect()
    }

    pub(super) fn claim_facts(&self, data: &Dataset) -> Vec<ClaimFacts> {
        let t = data.sample_time_s();
        let claim = |(input, label): (usize, &ident::Label)| {
            let best = self.found.as_ref().ok().map(DelayModels::best);
            let claimed = best.filter(|_| self.unclaimed[input].is_none());
            let (low, high) = self.span[input];
            ClaimFacts {
                input: label.name.clone(),
                delay_s: claimed.map(|model| {
                    let (low, high) = model.intervals[input];
                    model.dead_times[input].samples.clamp(low, high) * t
                }),
                interval_95_s: claimed.map(|model| seconds(model.intervals[input], t)),
                model: claimed.map(structure),
                unclaimed: self.unclaimed[input].clone(),
                range_of_methods_s: (low.is_finite() && high.is_finite()).then_some([low * t, high * t]),
            }
        };
        data.input_labels().iter().enumerate().map(claim).collect()
    }

    pub(super) fn facts(&self, data: &Dataset) -> Attempt<Vec<DelayModelFacts>> {
        let t = data.sample_time_s();
        let one = |model: &DelayModel| DelayModelFacts {
            zeros: model.zeros,
            poles: model.poles,
            loss: model.loss,
            fit_percent: model.fit_percent,
            ripple_hz: model.ripple_hz.clone(),
            dead_time_s: model.dead_times.iter().map(|d| d.samples * t).collect(),
            standard_error_s: model.dead_times.iter().map(|d| d.standard_error * t).collect(),
            interval_95_s: model.intervals.iter().map(|ends| seconds(*ends, t)).collect(),
            late_by_s: model.late_by.iter().map(|late| late.map(|d| d.samples * t)).collect(),
            late_by_interval_95_s: model.late_intervals.iter().map(|ends| ends.map(|ends| seconds(ends, t))).collect(),
            faults: model.faults.iter().map(|fault| words(fault, "")).collect(),
        };
        Attempt::of(self.found.as_ref(), |found| found.models.iter().map(one).collect())
    }

    /// Notes about quantities that were estimated beside the delays.
    pub(super) fn notes(&self) -> Vec<String> {
        let ripple = |found: &DelayModels| found.best().ripple_hz.first().copied();
        let said = |hz: f64| {
            format!(
                "the output has ripple that no input has, at {} Hz; it was estimated too, as additive and as proportional",
                significant(hz)
            )
        };
        self.found.as_ref().ok().and_then(ripple).map(said).into_iter().collect()
    }
}

/// Why an input excites too little to separate a delay from a phase shift.
fn unexcited(found: Result<&DelayModels, &IdentError>, data: &Dataset, input: usize) -> Option<String> {
    let name = &data.input_labels()[input].name;
    if let Some(hz) = single_line(data, input) {
        return Some(format!(
            "\"{name}\" is one sine of {} Hz, which cannot separate a delay from a phase shift; excite with steps or noise",
            digits(hz)
        ));
    }
    let is_it = |fault: &&DelayFault| matches!(fault, DelayFault::FewLines { input: of, .. } if *of == input);
    found.ok()?.best().faults.iter().find(is_it).map(|fault| words(fault, name))
}

/// That the output moves before the input.
fn ahead(others: &Others, data: &Dataset) -> Option<String> {
    let (least, most) = others.ahead()?;
    let t = data.sample_time_s();
    Some(format!(
        "the output is ahead of the input by {} s (95 % interval {} s); no system does that: their clocks start at different \
         times, or the two channels are swapped",
        digits(0.5 * (least + most) * t),
        range(Some((least * t, most * t)))
    ))
}

/// That an input may or may not be held between its samples, where that makes a difference.
fn unknown_between(data: &Dataset, input: usize) -> Option<String> {
    let is_open = data.intersample() == Intersample::ZeroOrderHold && is_restless(data, input);
    is_open.then(|| {
        format!(
            "\"{}\" changes with nearly every sample; held values and straight lines between the samples differ by \
             half a sample of delay; choose with --between held or --between straight",
            data.input_labels()[input].name
        )
    })
}

/// Returns true if an input changes with most samples.
fn is_restless(data: &Dataset, input: usize) -> bool {
    let steps = || data.experiments().iter().flat_map(|e| e.input(input).windows(2));
    let moves = steps().filter(|w| w[0] != w[1]).count();
    moves as f64 > RESTLESS * steps().count() as f64
}

/// Why nothing is claimed of an input.
fn reason(
    found: Result<&DelayModels, &IdentError>,
    (data, adjustments): Clocked<'_>,
    others: &Others,
    input: usize,
) -> Option<String> {
    let filtered = filtered(adjustments);
    if !filtered.is_empty() {
        return Some(format!(
            "\"{}\" went through a low-pass filter to get onto this clock, which blurs when it moves; leave out --sample-time",
            filtered.join("\", \"")
        ));
    }
    let model = match found {
        Ok(found) => found.best(),
        Err(error) => return Some(format!("no model could be fitted ({error})")),
    };
    let name = &data.input_labels()[input].name;
    if let Some(fault) = model.faults.first() {
        return Some(words(fault, name));
    }
    let (low, high) = model.intervals[input];
    let (from, to) = others.allowed(input)?;
    (to < low || from > high).then(|| {
        format!(
            "the methods disagree: {} samples by the model, {} by the comparison of ARX models, whose errors are white too",
            range(Some((low, high))),
            range(Some((from, to)))
        )
    })
}

/// From the shortest to the longest delay that the best model allows, or that another model or method takes for the
/// best.
fn span(found: Option<&DelayModels>, others: &Others, longest: usize, input: usize) -> (f64, f64) {
    let models = found.map_or(&[][..], |found| &found.models);
    let best = models.iter().map(|m| m.dead_times[input].samples);
    let allowed = found.into_iter().flat_map(|found| <[f64; 2]>::from(found.best().intervals[input]));
    let ranked = others.allowed(input).into_iter().flat_map(<[f64; 2]>::from);
    let all = best.chain(allowed).chain(ranked).map(|samples| samples.clamp(0.0, longest as f64));
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// An interval in samples of so many seconds.
fn seconds((low, high): (f64, f64), sample_time_s: f64) -> [f64; 2] {
    [low * sample_time_s, high * sample_time_s]
}

fn structure(model: &DelayModel) -> String {
    match (model.zeros, model.poles) {
        (_, 0) => "gain alone".to_owned(),
        (0, poles) => counted(poles, "pole"),
        (zeros, poles) => format!("{}, {}", counted(zeros, "zero"), counted(poles, "pole")),
    }
}

fn beside(model: &DelayModel) -> String {
    match (model.zeros, model.poles) {
        (_, 0) => "of a gain, without any lag".to_owned(),
        (0, 1) => "beside a lag of first order".to_owned(),
        _ => format!("beside dynamics with {}", structure(model)),
    }
}

fn digits(value: f64) -> String {
    page::decimal::digits(value, 4)
}

/// A fault, of an input by this name where that matters.
fn words(fault: &DelayFault, name: &str) -> String {
    let of = if name.is_empty() { String::new() } else { format!(" of \"{name}\"") };
    match fault {
        DelayFault::Outdone => "a richer model fits better".to_owned(),
        DelayFault::NotConverged => "the search did not converge".to_owned(),
        DelayFault::AtLongest { tried, .. } => format!(
            "the interval{of} ends at the longest delay that was looked for, {tried} samples, and the true delay may be longer; \
             type --longest {}",
            2 * tried
        ),
        DelayFault::Undetermined { .. } => {
            format!(
                "the data cannot show the delay{of}: the input may have no effect, or too little of it is in the output"
            )
        }
        DelayFault::FewLines { lines, needed, strongest_hz, .. } => format!(
            "the input{of} has only {} in the output, the strongest at {} Hz; with these dynamics a delay needs {needed}, \
             otherwise it looks like a phase shift; excite with steps or noise",
            counted(*lines, "line"),
            digits(*strongest_hz)
        ),
        DelayFault::TooEarly { .. } => format!(
            "the output answers at once, or before the input{of} moves: the input acts directly, as with a lead, or the clocks \
             differ, or the input is not held (--between), or the output acts on it"
        ),
        DelayFault::DynamicsMissing { p_value } => {
            format!("its residuals depend on past inputs: dynamics are missing ({})", probability(*p_value))
        }
        DelayFault::Feedback { p_value } => {
            format!("its residuals depend on future inputs, as in a closed loop ({})", probability(*p_value))
        }
        DelayFault::Untested => "too few data to test its residuals".to_owned(),
        other => format!("{other:?}"),
    }
}

/// The channels that went through a low-pass filter on their way to the clock.
fn filtered(adjustments: &[Adjustment]) -> Vec<&str> {
    let filtered = adjustments.iter().filter_map(|adjustment| match adjustment {
        Adjustment::Resampled { channel, how: Resampling::Filtered, .. } => Some(channel.as_str()),
        _ => None,
    });
    filtered.collect()
}
