//! Sines and gradients that were asked for.

use capability::map::SineOf;
use capability::wanted::{Wanted, WantedAnswer, WantedPlace};
use page::{Align, Block, Blocks, Cell, Layer, Marker, Rounded, Style, Table, Tone, rounded};
use units::RPM_RAD_S;

use super::words::short;
use crate::wording::number;

/// A table of each, speed by speed; beyond the range of the model there is no plain yes.
pub(super) fn answers(wanted: &[WantedAnswer], is_beyond: bool) -> Blocks {
    let one = |answer: &WantedAnswer| {
        let (tone, verdict) = match (answer.is_yes(), answer.places.iter().any(WantedPlace::is_yes)) {
            (true, _) if is_beyond => (Tone::Caution, "not shown: yes by the model, but beyond its range"),
            (true, _) => (Tone::Good, "yes"),
            (false, true) => (Tone::Caution, "yes at some speeds"),
            (false, false) => (Tone::Bad, "no"),
        };
        Block::Callout {
            tone,
            kicker: "What you asked for".to_owned(),
            title: format!("{}: {verdict}", words(answer.wanted)),
            blocks: vec![Block::Table(table(answer))],
        }
    };
    wanted.iter().map(one).collect()
}

/// A wish, in words.
fn words(wanted: Wanted) -> String {
    match wanted {
        Wanted::Sine { of: SineOf::Speed, amplitude, frequency_hz } => format!(
            "sine of the speed demand, {} rpm at {}",
            number::significant(amplitude / RPM_RAD_S, 4),
            number::significant_with_unit(frequency_hz, 3, "Hz")
        ),
        Wanted::Sine { of: SineOf::Torque, amplitude, frequency_hz } => format!(
            "sine of the torque demand, {} Nm at {}",
            number::significant(amplitude, 4),
            number::significant_with_unit(frequency_hz, 3, "Hz")
        ),
        Wanted::Gradient { rad_s2 } => format!("gradient of {} rpm/s", number::significant(rad_s2 / RPM_RAD_S, 4)),
    }
}

fn unit(wanted: Wanted) -> (&'static str, f64) {
    match wanted {
        Wanted::Sine { of: SineOf::Torque, .. } => ("Nm", 1.0),
        Wanted::Sine { of: SineOf::Speed, .. } => ("rpm", RPM_RAD_S),
        Wanted::Gradient { .. } => ("rpm/s", RPM_RAD_S),
    }
}

fn table(answer: &WantedAnswer) -> Table {
    let (unit, si) = unit(answer.wanted);
    let mut table = Table::new(&[
        ("speed", Align::Right),
        ("benches that can (95 % interval)", Align::Left),
        ("95 % of them can", Align::Right),
        ("half of them", Align::Right),
        ("5 % of them", Align::Right),
        ("what binds", Align::Left),
    ]);
    for place in &answer.places {
        let tone = match place.kept.estimate {
            _ if place.is_yes() => Tone::Good,
            share if share > 0.5 => Tone::Caution,
            _ => Tone::Bad,
        };
        let most = |k: usize| match place.largest[k] {
            value if value.is_infinite() => "no limit stated".to_owned(),
            value => format!("{} {unit}", number::significant(value / si, 3)),
        };
        table.row([
            number::rpm(place.speed_rad_s).into(),
            Cell::toned(number::proportion(&place.kept), tone),
            most(0).into(),
            most(1).into(),
            most(2).into(),
            place.binds.map_or("no limit stated", short).into(),
        ]);
    }
    table
}

/// A cross in the map of its quantity.
pub(super) fn mark(answer: &WantedAnswer, of_map: SineOf, si: f64) -> Option<Layer> {
    let Wanted::Sine { of, amplitude, frequency_hz } = answer.wanted else { return None };
    (of == of_map).then(|| Layer::Markers {
        name: format!("wanted, {}", if answer.is_yes() { "yes" } else { "not at every speed" }),
        style: Style::Measured,
        marker: Marker::Cross,
        x: rounded(&[frequency_hz]),
        y: rounded(&[amplitude / si]),
    })
}

/// A line at the gradient.
pub(super) fn line(answer: &WantedAnswer) -> Option<Layer> {
    let Wanted::Gradient { rad_s2 } = answer.wanted else { return None };
    Some(Layer::HorizontalMark { y: Rounded(rad_s2 / RPM_RAD_S), label: "wanted".to_owned() })
}
