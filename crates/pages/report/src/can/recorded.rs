//! A run of a cycle that was recorded, and whether it is valid.

use cycle::{Judged, Own, RequirementSet, Scales, Validation};
use page::{Align, Axis, Block, Blocks, Cell, Figure, Finding, Layer, Page, Panel, Style, Table, Tone};
use serde::Serialize;
use units::RPM_RAD_S;

use super::words;
use crate::figures::COURSE_HEIGHT;
use crate::wording::number;

/// Longest time between values that may be values of an instant, s: 40 CFR 1065.202, Table 1, asks for 5 Hz.
const SLOWEST_S: f64 = 0.2;

/// How the beginning of the cycle was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AlignedOn {
    /// By the recorded demand of the speed.
    SpeedDemand,
    /// By the measured speed.
    Speed,
    /// It was given.
    Given,
    /// The recording's first sample.
    FirstSample,
}

/// Where the speeds, the torque and the power are from that limits in per cent refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ScalesOf {
    /// An engine map, whose lowest speed counts as warm idle.
    Map,
    /// An engine map, and a stated idle speed.
    MapAndStatedIdle,
    /// The cycle itself, whose lowest speed counts as warm idle.
    Cycle,
    /// The cycle itself, and a stated idle speed.
    CycleAndStatedIdle,
}

/// Reference of limits in per cent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Referred {
    /// The numbers.
    #[serde(flatten)]
    pub scales: Scales,
    /// Where they are from.
    pub of: ScalesOf,
}

/// A requirement of one's own with what a recording makes of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JudgedOwn {
    /// The requirement.
    pub own: Own,
    /// The number with its limit.
    pub judged: Judged,
    /// By how much the raster of the recording and what does not follow the demand leave the number open, up or down,
    /// in its unit.
    pub uncertain_by: Option<f64>,
}

impl JudgedOwn {
    /// Tells whether the recording cannot decide.
    fn is_open(&self) -> bool {
        self.uncertain_by.is_some_and(|by| (self.judged.value - self.judged.limit).abs() < by)
    }
}

/// A recorded run with its judgements.
#[derive(Debug, Clone)]
pub struct RecordedRun<'a> {
    /// The recording.
    pub file: &'a str,
    /// The test.
    pub test: &'a str,
    /// When the test begins in the recording, s.
    pub start_s: f64,
    /// How that was found.
    pub aligned_on: AlignedOn,
    /// Which signals were taken as speed and torque, in words; none where no requirement uses it.
    pub signals: (Option<String>, Option<String>),
    /// True where the operator's demand was recorded.
    pub has_demand: bool,
    /// Time between the values that were compared, s.
    pub sample_time_s: f64,
    /// Reference of limits in per cent.
    pub referred: Referred,
    /// Left-out parts of the recording with the reasons, and its other faults.
    pub remarks: &'a [String],
    /// Requirement sets, judged.
    pub sets: &'a [(RequirementSet, Validation)],
    /// Requirements of one's own, judged.
    pub own: &'a [JudgedOwn],
    /// Time on the clock of the test, s, with demanded and measured speed (rad/s) and torque (Nm).
    pub time_s: &'a [f64],
    /// Demanded and measured speed, rad/s, where a requirement uses it.
    pub speed_rad_s: Option<(&'a [f64], &'a [f64])>,
    /// Demanded and measured torque, Nm, where a requirement uses it.
    pub torque_nm: Option<(&'a [f64], &'a [f64])>,
}

impl RecordedRun<'_> {
    /// Tells whether everything is met.
    pub fn passes(&self) -> bool {
        self.sets.iter().all(|(_, validation)| validation.passes) && self.own.iter().all(|one| one.judged.passes())
    }
}

/// The verdict, by which line, and the courses.
pub fn page(run: &RecordedRun<'_>) -> Page {
    let (tone, verdict) = if run.passes() { (Tone::Good, "PASS") } else { (Tone::Bad, "FAIL") };
    let mut all = Blocks::from(Block::Callout {
        tone,
        kicker: "Validation of a run".to_owned(),
        title: format!("{}, {}: {verdict}{}", run.test, run.file, because(run)),
        blocks: vec![Block::paragraph(begins(run))],
    });
    all.push(run.sets.iter().map(|(set, validation)| judged(set, validation)).collect::<Blocks>());
    if !run.own.is_empty() {
        all.push(Block::heading("Your requirements"));
        all.push(own(run.own));
        all.push(run.own.iter().filter(|one| one.is_open()).map(open).collect::<Blocks>());
    }
    if !run.has_demand && run.sets.iter().any(|(set, _)| set.omission) {
        let words = "The recording has no operator demand. It counts as least where the cycle motors the engine or lets it idle, and \
                     never as most. Give `throttle` in [channels] if it was recorded.";
        all.push(Block::Finding(Finding::new(Tone::Caution, "assumed", words)));
    }
    all.push(doubts(run));
    all.push(figure(run).map(Block::figure).into_iter().collect::<Blocks>());
    Page::new(format!("{}, {}", run.test, run.file), all.into_vec())
}

/// The lines that are missed.
fn because(run: &RecordedRun<'_>) -> String {
    let sets = run.sets.iter().flat_map(|(set, validation)| {
        validation.checked.iter().filter(|one| !one.passes).map(move |one| {
            format!("{} of the {} ({})", words::statistic(one.statistic), words::signal(one.signal).0, set.name)
        })
    });
    let own = run.own.iter().filter(|one| !one.judged.passes()).map(|one| words::own(&one.own));
    let missed: Vec<String> = sets.chain(own).collect();
    if missed.is_empty() { String::new() } else { format!(" by {}", crate::wording::join(&missed, "and")) }
}

fn begins(run: &RecordedRun<'_>) -> String {
    let how = match run.aligned_on {
        AlignedOn::SpeedDemand => "found by the recorded speed demand",
        AlignedOn::Speed => "found by the measured speed, which contains its own lateness",
        AlignedOn::Given => "as given",
        AlignedOn::FirstSample => "the first sample",
    };
    let taken = |what: &str, signal: &Option<String>| {
        signal.as_ref().map_or_else(String::new, |signal| format!(" {what}: {signal}."))
    };
    format!(
        "The test begins at {} of the recording ({how}).{}{}",
        number::time(run.start_s),
        taken("Speed", &run.signals.0),
        taken("Torque", &run.signals.1)
    )
}

/// Assumptions of the judgement, and faults of the recording.
fn doubts(run: &RecordedRun<'_>) -> Blocks {
    let finding = |tone, severity, words: &str| Block::Finding(Finding::new(tone, severity, words));
    let mut all: Blocks = run.remarks.iter().map(|words| finding(Tone::Caution, "recording", words)).collect();
    if run.sets.is_empty() {
        return all;
    }
    let (tone, severity, words) = referred(&run.referred);
    all.push(finding(tone, severity, &words));
    if run.sample_time_s > SLOWEST_S {
        let words = format!(
            "A value every {} must be a mean of data at 5 Hz or more (40 CFR 1065.202, Table 1). The recording does not show \
             whether it is.",
            number::measure(run.sample_time_s, "s")
        );
        all.push(finding(Tone::Caution, "assumed", &words));
    }
    all
}

/// Reference of limits in per cent, stated or taken for granted.
fn referred(referred: &Referred) -> (Tone, &'static str, String) {
    let scales = &referred.scales;
    let rpm = |speed: f64| number::significant(speed / RPM_RAD_S, 5);
    let all = format!(
        "Limits in per cent refer to {} rpm at warm idle, {} rpm as the maximum test speed, {} Nm and {} kW.",
        rpm(scales.idle_rad_s),
        rpm(scales.maximum_test_speed_rad_s),
        number::significant(scales.maximum_torque_nm, 5),
        number::significant(1e-3 * scales.maximum_power_w, 5)
    );
    match referred.of {
        ScalesOf::Map => (
            Tone::Plain,
            "scales",
            format!("{all} The idle speed is the lowest one of the engine map; state another one with --idle."),
        ),
        ScalesOf::MapAndStatedIdle => {
            (Tone::Plain, "scales", format!("{all} The engine map has all but the idle speed, which is stated."))
        }
        ScalesOf::Cycle => (
            Tone::Caution,
            "assumed",
            format!(
                "{all} Without an engine map these are the lowest speed and the largest values of the cycle. Give \
                 --engine-map, or state the idle speed with --idle."
            ),
        ),
        ScalesOf::CycleAndStatedIdle => (
            Tone::Caution,
            "assumed",
            format!(
                "{all} Without an engine map all but the idle speed are the largest values of the cycle. Give --engine-map."
            ),
        ),
    }
}

fn judged(set: &RequirementSet, validation: &Validation) -> Blocks {
    let mut table = Table::new(&[
        ("", Align::Left),
        ("", Align::Left),
        ("value", Align::Right),
        ("allowed", Align::Left),
        ("", Align::Left),
    ]);
    for one in &validation.checked {
        let (tone, word) = if one.passes { (Tone::Good, "pass") } else { (Tone::Bad, "fail") };
        let (value, allowed) = words::compared(one);
        table.row([
            words::signal(one.signal).0.into(),
            words::statistic(one.statistic).into(),
            value.into(),
            allowed.into(),
            Cell::toned(word, tone),
        ]);
    }
    let [speed, torque, power] = validation.omitted;
    let used = format!(
        "{} seconds compared, feedback moved forward by {}. Left out: {}. That is {speed} points of the speed, {torque} of the \
         torque, and {power} of the power. That is the best of {} choices of shift and of what is left out.",
        validation.seconds,
        number::measure(validation.shift_s, "s"),
        words::omission(&validation.omission),
        validation.tried
    );
    [
        Block::heading(set.title.as_str()),
        Block::Table(table),
        Block::paragraph(used),
        Block::Finding(words::required(set)),
    ]
    .into_iter()
    .collect()
}

fn own(own: &[JudgedOwn]) -> Table {
    let mut table =
        Table::new(&[("", Align::Left), ("value", Align::Right), ("worst at", Align::Right), ("", Align::Left)]);
    for one in own {
        let (tone, word) = if one.judged.passes() { (Tone::Good, "pass") } else { (Tone::Bad, "fail") };
        table.row([
            words::own(&one.own).into(),
            value(one).into(),
            number::time(one.judged.time_s).into(),
            Cell::toned(word, tone),
        ]);
    }
    table
}

/// A number with what the samples leave open, to the digits that separate it from its limit.
fn value(one: &JudgedOwn) -> String {
    let value = words::own_value_beside(&one.own, one.judged.value, one.judged.limit);
    one.uncertain_by.map_or_else(|| value.clone(), |by| format!("{value} ± {}", words::own_value(&one.own, by)))
}

fn open(one: &JudgedOwn) -> Block {
    let words = format!(
        "{}: {}. The limit is within that uncertainty. Record the demand on a faster raster, or longer.",
        words::own(&one.own),
        value(one)
    );
    Block::Finding(Finding::new(Tone::Caution, "uncertain", words))
}

fn figure(run: &RecordedRun<'_>) -> Option<Figure> {
    let rpm = |values: &[f64]| values.iter().map(|value| value / RPM_RAD_S).collect::<Vec<_>>();
    let panel = |label: &str, unit: &str, (demand, value): (&[f64], &[f64])| {
        let layers = vec![
            Layer::curve("demanded", Style::Modelled, run.time_s, demand),
            Layer::curve("measured", Style::Measured, run.time_s, value),
        ];
        Panel::new(Axis::linear(label, unit), COURSE_HEIGHT, layers)
    };
    let speed = run.speed_rad_s.map(|(demand, value)| panel("speed", "rpm", (&rpm(demand), &rpm(value))));
    let torque = run.torque_nm.map(|both| panel("torque", "Nm", both));
    let panels: Vec<Panel> = speed.into_iter().chain(torque).collect();
    let caption = "Time counts from the beginning of the test.";
    (!panels.is_empty()).then(|| Figure::new("Demanded and measured", Axis::time(), panels).with_caption(caption))
}
