//! Changes that would make a test possible, and recordings that would settle a doubt.

use capability::{Answer, Change, Doubt, Easier, Uncertain, Verdict};
use page::{Align, Block, Blocks, Cell, Table};

use super::words;
use crate::wording::number;

/// Doubts that are named.
const NAMED: usize = 4;

/// The least change of each kind with the answer it gives.
pub(super) fn easier(verdict: &Verdict, easier: &[Easier]) -> Blocks {
    if verdict.answer != Answer::No {
        return Blocks::default();
    }
    let mut all = Blocks::from(Block::heading("What would make it possible"));
    if easier.is_empty() {
        let tried = "No single change gives a yes. Slower and smaller demands, a filter, the gains, the feed-forward, the shaft and the \
                     inertia were tried.";
        all.push(Block::paragraph(tried));
        return all;
    }
    let item =
        |one: &Easier| format!("Yes if: {}. Then: {}.", change(one.change), words::yes(verdict, &one.kept)).into();
    all.push(Block::List { items: easier.iter().map(item).collect() });
    all
}

/// A change, in words.
pub fn change(change: Change) -> String {
    let times = |factor: f64| number::significant(factor, 3);
    match change {
        Change::Slower { factor } => format!("the whole test takes {} times as long", times(factor)),
        Change::Smaller { factor } => {
            format!("all changes of the demands are {} of what they are", number::share(factor))
        }
        Change::Filter { corner_hz } => {
            format!("a low-pass of first order at {} Hz is put before the bench", number::significant(corner_hz, 2))
        }
        Change::Gains { factor } => format!("K_p and K_i of the speed controller are {} times as large", times(factor)),
        Change::FeedForward { acceleration_nm_s2_per_rad } => format!(
            "the speed controller has a feed-forward of the acceleration, k_a = {} Nm s²/rad",
            number::significant(acceleration_nm_s2_per_rad, 3)
        ),
        Change::Stiffness { factor } if factor >= 1.0 => format!("the shaft is {} times as stiff", times(factor)),
        Change::Stiffness { factor } => format!("the shaft has {} of its stiffness", number::share(factor)),
        Change::DynoInertia { factor } => {
            format!("J_d is {} times as large, as with a flywheel", times(factor))
        }
    }
}

/// Numbers that decide between yes and no, and the recording that shows each.
pub(super) fn doubts(verdict: &Verdict) -> Blocks {
    if verdict.answer != Answer::Perhaps {
        return Blocks::default();
    }
    let mut all = Blocks::from(Block::heading("What would settle it"));
    let Some(first) = verdict.doubts.first() else {
        let none = "No single number of the model decides between yes and no. `dynoid experiment next` shows what each recording narrows.";
        all.push(Block::paragraph(none));
        return all;
    };
    let mut table = Table::new(&[
        ("", Align::Left),
        ("decides", Align::Right),
        ("lowest fifth", Align::Left),
        ("highest fifth", Align::Left),
        ("settled by", Align::Left),
    ]);
    for one in verdict.doubts.iter().take(NAMED) {
        let fifth = |k: usize| format!("{}: {} keep everything", value(one, k), number::share(one.kept[k]));
        let by = one.settled_by.as_ref().map_or_else(|| "a measurement of it".to_owned(), ToString::to_string);
        table.row([
            name(one.of).into(),
            number::share(one.explained).into(),
            fifth(0).into(),
            fifth(1).into(),
            by.into(),
        ] as [Cell; 5]);
    }
    all.push(Block::paragraph(match &first.settled_by {
        Some(label) => format!("{} decides most. Record {label}: it estimates this number.", name(first.of)),
        None => format!("{} decides most. No experiment of the method estimates it.", name(first.of)),
    }));
    all.push(table);
    all
}

fn name(of: Uncertain) -> String {
    match of {
        Uncertain::Parameter(parameter) => parameter.symbol().to_owned(),
        Uncertain::EngineSpeedControl => "speed control of the engine".to_owned(),
    }
}

fn value(doubt: &Doubt, place: usize) -> String {
    match doubt.of {
        Uncertain::Parameter(parameter) => {
            let notation = parameter.quantity().notation();
            format!("{} {}", number::significant(notation.per_si * doubt.values[place], 3), notation.unit)
        }
        Uncertain::EngineSpeedControl => format!("{} of its bandwidth", number::share(doubt.values[place])),
    }
}
