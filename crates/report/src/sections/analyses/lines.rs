//! Lines of the spectra.

use bench::look::{Cause, Line, Look, LookedSignal, OverSpeed};
use page::{Block, Blocks};

use super::{figures, heading, plain_table, sentence, untold};
use crate::look::{cause, figure, over_speed_figures, unit};
use crate::wording::number;

/// Lines of a signal that are looked at for those to mind, the strongest first.
const STRONGEST: usize = 8;
/// A part of a recording that is drawn; a sine test has many.
const DRAWN_PARTS: usize = 1;

/// The section on lines.
pub(crate) fn lines(looks: &[Look], signals: &[OverSpeed]) -> Blocks {
    let mut all = sentence(
        "What every signal holds at which frequency, before any model, each line named by what it follows: the crank angle \
         (orders), the demand, the mains. What is not plainly of the engine or demanded stands in the table",
    );
    all.push(to_mind(looks));
    all.push(figures(over_speed_figures("All recordings", signals)));
    looks.iter().for_each(|look| all.push(of_recording(look)));
    all
}

fn of_recording(look: &Look) -> Blocks {
    if look.parts.iter().all(|part| part.signals.is_empty()) {
        return untold(&format!("{} has no spectrum", look.file), "no speed is recorded, or every signal is too short");
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

/// Lines that fold, that come of the demand's hold or the drive, and those whose cause is not told.
fn to_mind(looks: &[Look]) -> Blocks {
    let rows: Vec<Vec<String>> = looks.iter().flat_map(rows_of).collect();
    if rows.is_empty() {
        return sentence("Every strong line is an engine order below half the sample rate, or demanded");
    }
    let mut all = heading("Lines to mind");
    all.push(plain_table(&["Recording", "The strongest of its kind", "At", "In"], rows));
    all
}

/// Of each kind to mind the strongest line of a recording, and the signals that have one.
fn rows_of(look: &Look) -> Vec<Vec<String>> {
    let signals = look.parts.iter().flat_map(|part| &part.signals);
    let lines = signals.flat_map(|signal| signal.lines.iter().take(STRONGEST).map(move |line| (signal, line)));
    let mut kinds: Vec<(&Line, Vec<(&LookedSignal, &Line)>)> = Vec::new();
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

fn row(look: &Look, first: &Line, of: &[(&LookedSignal, &Line)]) -> Vec<String> {
    let amplitude = |(signal, line): &(&LookedSignal, &Line)| {
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
