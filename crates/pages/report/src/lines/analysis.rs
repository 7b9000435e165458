//! Lines of the spectra.

use std::cmp::Ordering;

use page::{Align, Block, Blocks, Prose, Table};
use part_lines::lines::{BANDWIDTH_ORDERS, Cause, Line, OverSpeed, PartLines, RecordingLines, SignalLines, TURNS};

use rig::Role;

use super::words::{cause, figure, kind_of_cause, over_speed_figures, unit};
use crate::blocks::{figures, heading, no_result, plain_table, sentence};
use crate::wording::number;

/// Lines of a signal that are looked at for those to mind, the strongest first.
const STRONGEST: usize = 8;
/// A part of a recording that is drawn; a sine test has many.
const DRAWN_PARTS: usize = 1;

/// The section on lines.
pub(crate) fn analysis(looks: &[RecordingLines], signals: &[OverSpeed]) -> Blocks {
    let mut all = sentence(
        "The lines of every signal, found without a model. Each line is named after its cause: the crank angle (orders), the \
         demand, the mains. The table lists the lines that are not plainly of the engine or demanded",
    );
    all.push(to_mind(looks));
    all.push(figures(over_speed_figures("All recordings", signals)));
    looks.iter().for_each(|look| all.push(of_recording(look)));
    all
}

fn of_recording(look: &RecordingLines) -> Blocks {
    if look.parts.iter().all(|part| part.signals.is_empty()) {
        return no_result(
            &format!("{} has no spectrum", look.file),
            "no speed is recorded, or every signal is too short",
        );
    }
    let mut all = figures(look.parts.iter().take(DRAWN_PARTS).map(|part| figure(look, part)).collect());
    if look.parts.len() > DRAWN_PARTS {
        all.push(Block::note(format!(
            "The first of {} parts of {}; `dynoid lines` draws them all.",
            look.parts.len(),
            look.file
        )));
    }
    all
}

/// Aliases, lines from the demand's hold or the drive, and lines whose cause is not known.
fn to_mind(looks: &[RecordingLines]) -> Blocks {
    let rows: Vec<Vec<String>> = looks.iter().flat_map(rows_of).collect();
    if rows.is_empty() {
        return sentence("Every strong line is an engine order below half the sample rate, or demanded");
    }
    let mut all = heading("Lines to mind");
    all.push(plain_table(&["Recording", "The strongest of its kind", "At", "In"], rows));
    all
}

/// Of each kind to mind the strongest line of a recording, and the signals that have one.
fn rows_of(look: &RecordingLines) -> Vec<Vec<String>> {
    let signals = look.parts.iter().flat_map(|part| &part.signals);
    let lines = signals.flat_map(|signal| signal.lines.iter().take(STRONGEST).map(move |line| (signal, line)));
    let mut kinds: Vec<(&Line, Vec<(&SignalLines, &Line)>)> = Vec::new();
    for (signal, line) in lines.filter(|(_, line)| is_to_mind(&line.cause)) {
        let kind = std::mem::discriminant(&line.cause);
        match kinds.iter_mut().find(|(first, _)| std::mem::discriminant(&first.cause) == kind) {
            Some((_, of)) if of.iter().any(|(other, _)| other.role == signal.role) => {}
            Some((_, of)) => of.push((signal, line)),
            None => kinds.push((line, vec![(signal, line)])),
        }
    }
    kinds.into_iter().map(|(first, of)| row(look, first, &of)).collect()
}

fn is_to_mind(cause: &Cause) -> bool {
    !matches!(cause, Cause::Order { .. } | Cause::Demanded | Cause::OrderSideband { .. } | Cause::StructuralResonance)
}

fn row(look: &RecordingLines, first: &Line, of: &[(&SignalLines, &Line)]) -> Vec<String> {
    let amplitude = |(signal, line): &(&SignalLines, &Line)| {
        let (unit, per_si) = unit(signal.role);
        format!("{} {}", signal.role.symbol(), number::significant_with_unit(per_si * line.amplitude, 2, unit))
    };
    vec![
        look.file.clone(),
        cause(&first.cause),
        number::significant_with_unit(first.frequency_hz, 4, "Hz"),
        of.iter().map(amplitude).collect::<Vec<_>>().join(", "),
    ]
}

/// Every line of every recording, `most` a signal; zero shows all.
pub(crate) fn every_line(looks: &[RecordingLines], most: usize) -> Blocks {
    looks.iter().flat_map(|look| look.parts.iter().map(move |part| lines_of(look, part, most))).collect()
}

/// The lines of all recordings by their causes, of the `most` strongest of each signal; zero counts all.
pub(crate) fn summed_up(looks: &[RecordingLines], most: usize) -> Blocks {
    let mut kinds: Vec<Kind<'_>> = Vec::new();
    for (place, look) in looks.iter().enumerate() {
        for signal in look.parts.iter().flat_map(|part| &part.signals) {
            let counted = if most == 0 { signal.lines.len() } else { most };
            for line in signal.lines.iter().take(counted) {
                let name = kind_of_cause(&line.cause);
                match kinds.iter_mut().find(|kind| kind.name == name) {
                    Some(kind) => kind.seen.push((place, signal.role, line)),
                    None => kinds.push(Kind { name, seen: vec![(place, signal.role, line)] }),
                }
            }
        }
    }
    kinds.sort_by(|a, b| a.rank().partial_cmp(&b.rank()).unwrap_or(Ordering::Equal));
    let mut all = heading("The lines of all recordings, by their causes");
    let heads = ["What it is", "Hz", "Recordings", "Largest"];
    all.push(plain_table(&heads, kinds.iter().map(|kind| kind.row(looks.len()))));
    all.push(sentence("With `--each`, the lines of each signal of each recording are shown"));
    all
}

/// Lines of one cause, each with the place of its recording and its signal.
struct Kind<'a> {
    name: String,
    seen: Vec<(usize, Role, &'a Line)>,
}

impl Kind<'_> {
    /// Orders first, by their number; then what has another cause; then what has none.
    fn rank(&self) -> (u8, f64) {
        match self.seen.first().map(|(_, _, line)| &line.cause) {
            Some(Cause::Order { order, .. }) => (0, *order),
            Some(Cause::FoldedOrder { order, .. }) => (1, *order),
            Some(Cause::OrderSideband { order, .. }) => (2, *order),
            Some(Cause::Mains { multiple, .. }) => (3, f64::from(*multiple)),
            Some(Cause::Undecided { .. }) => (5, 0.0),
            Some(Cause::BroadHump) => (6, 0.0),
            Some(Cause::Unknown) | None => (7, 0.0),
            Some(_) => (4, 0.0),
        }
    }

    fn row(&self, recordings: usize) -> Vec<String> {
        let hertz = || self.seen.iter().map(|(_, _, line)| line.frequency_hz);
        let (low, high) = (hertz().fold(f64::INFINITY, f64::min), hertz().fold(0.0, f64::max));
        let [from, to] = [low, high].map(|hz| number::significant(hz, 4));
        let mut places: Vec<usize> = self.seen.iter().map(|(place, _, _)| *place).collect();
        places.dedup();
        vec![
            self.name.clone(),
            if from == to { from } else { format!("{from} … {to}") },
            format!("{} of {recordings}", places.len()),
            self.largest(),
        ]
    }

    /// The largest of a speed and the largest of a torque.
    fn largest(&self) -> String {
        let of = |wanted: &str| {
            let own = self.seen.iter().filter(|(_, role, _)| unit(*role).0 == wanted);
            let (_, role, line) = own.max_by(|a, b| a.2.amplitude.total_cmp(&b.2.amplitude))?;
            let amplitude = number::significant_with_unit(unit(*role).1 * line.amplitude, 3, wanted);
            Some(format!("{} {amplitude}", role.symbol()))
        };
        ["rpm", "Nm", "%"].into_iter().filter_map(of).collect::<Vec<_>>().join(", ")
    }
}

/// Tables, then the orders over the speed, then the figures.
pub(crate) fn with_figures(tables: Blocks, looks: &[RecordingLines], signals: &[OverSpeed]) -> Blocks {
    let over = match looks {
        [one] => one.file.clone(),
        _ => "All recordings".to_owned(),
    };
    let mut all = tables;
    all.push(orders(&over, signals));
    all.push(figures(over_speed_figures(&over, signals)));
    let spectra = looks.iter().flat_map(|look| look.parts.iter().map(move |part| figure(look, part)));
    all.push(figures(spectra.collect()));
    all
}

/// The lines of a part of a recording, the strongest first.
fn lines_of(look: &RecordingLines, part: &PartLines, most: usize) -> Blocks {
    let over = format!("{} to {} s", number::significant(part.start_s, 4), number::significant(part.end_s, 4));
    let mut all = Blocks::from(Block::heading(
        Prose::code(&look.file).then(format!(", {over}, {}", number::rpm(part.speed_rad_s))),
    ));
    let columns =
        [("Signal", Align::Left), ("Hz", Align::Right), ("Amplitude", Align::Right), ("What it is", Align::Left)];
    let mut table = Table::new(&columns);
    for signal in &part.signals {
        let (unit, per_si) = unit(signal.role);
        let shown = if most == 0 { signal.lines.len() } else { most };
        for (index, line) in signal.lines.iter().take(shown).enumerate() {
            let name = if index == 0 { signal.role.symbol() } else { "" };
            let amplitude = number::significant_with_unit(per_si * line.amplitude, 3, unit);
            let hz = format!("{:.2}", line.frequency_hz);
            table.row([name.into(), hz.into(), amplitude.into(), cause(&line.cause).into()]);
        }
        if signal.lines.len() > shown {
            let more = format!("{} weaker ones; --lines 0 shows them", signal.lines.len() - shown);
            table.row(["".into(), "".into(), "".into(), more.into()]);
        }
    }
    all.push(table);
    all
}

/// Each order with where it is largest.
fn orders(over: &str, signals: &[OverSpeed]) -> Blocks {
    let Some(first) = signals.first() else { return Blocks::default() };
    let [low, high] = first.speed_rad_s.map(number::rpm);
    let mut all = heading(&format!("{over}: orders over the speed, {low} to {high}"));
    let columns = [
        ("Signal", Align::Left),
        ("Order", Align::Left),
        ("Largest", Align::Right),
        ("Standard error", Align::Right),
        ("At", Align::Right),
        ("Hz", Align::Right),
    ];
    let mut table = Table::new(&columns);
    for signal in signals {
        let (unit, per_si) = unit(signal.role);
        for (index, curve) in signal.orders.iter().enumerate() {
            let Some(peak) = curve.peak() else { continue };
            let name = if index == 0 { signal.role.symbol() } else { "" };
            let firing = if curve.is_firing { ", firing" } else { "" };
            table.row([
                name.into(),
                format!("{}{firing}", curve.order).into(),
                number::significant_with_unit(per_si * peak.amplitude, 3, unit).into(),
                number::significant_with_unit(per_si * peak.standard_error, 2, unit).into(),
                number::rpm(peak.speed_rad_s).into(),
                format!("{:.1}", curve.at_hz(peak.speed_rad_s)).into(),
            ]);
        }
    }
    all.push(table);
    all.push(sentence(&format!("Least squares in windows of {TURNS} turns: a bandwidth of {BANDWIDTH_ORDERS} orders")));
    all
}
