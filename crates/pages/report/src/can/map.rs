//! How large a sine may be, over frequency and speed.

use capability::gradient::GradientPlace;
use capability::map::{CapabilityMap, Place, SineOf};
use capability::wanted::WantedAnswer;
use capability::{Beyond, LimitOf};
use design::safety::FrictionSpread;
use page::{Abscissa, Align, Axis, Block, Cell, Figure, Layer, Page, Panel, Style, Table, rounded};
use rig::engine_pulses::KnownPulses;
use units::RPM_RAD_S;

use super::predicted::beyond;
use super::wanted;
use super::words::short;
use crate::assumptions::friction;
use crate::wording::{self, number};

/// Height of a panel on the page.
const HEIGHT: u32 = 260;

/// Content of a page of the map.
#[derive(Debug, Clone, Copy)]
pub struct MapPage<'a> {
    /// The bench and its mean torque.
    pub title: &'a str,
    /// Of speed and torque.
    pub maps: &'a [CapabilityMap],
    /// Frequencies of the table, Hz; the figure has all.
    pub in_table_hz: &'a [f64],
    /// The largest gradients.
    pub gradients: &'a [GradientPlace],
    /// Sines and gradients that were asked for.
    pub wanted: &'a [WantedAnswer],
    /// Knowledge of the engine's firing pulses.
    pub pulses: &'a KnownPulses,
    /// Where speeds and torque of the map leave the range of the recordings that the model is from.
    pub beyond: &'a [Beyond],
    /// Friction of the dynamometer.
    pub friction: FrictionSpread,
}

/// Answers to what was asked for, maps of speed and torque, and the largest gradients.
pub fn page(shown: &MapPage<'_>) -> Page {
    let mut all = wanted::answers(shown.wanted, !shown.beyond.is_empty());
    all.push(beyond(shown.beyond));
    all.push(friction(&shown.friction));
    all.push(Block::paragraph(wording::engine_pulses(shown.pulses)));
    for map in shown.maps {
        all.push(Block::heading(name(map.of)));
        all.push(bandwidths(map));
        all.push(table(map, shown.in_table_hz));
        all.push(Block::figure(figure(map, shown.wanted)));
    }
    all.push(Block::heading("Largest gradient of the speed, rpm/s"));
    all.push(of_gradients(shown.gradients));
    all.push(Block::figure(gradient_figure(shown.gradients, shown.wanted)));
    Page::new(shown.title, all.into_vec())
}

fn name(of: SineOf) -> &'static str {
    match of {
        SineOf::Speed => "Largest sine of N_d* in speed control (NT)",
        SineOf::Torque => "Largest sine of T_d* in torque control (TN)",
    }
}

fn unit(of: SineOf) -> (&'static str, f64) {
    match of {
        SineOf::Speed => ("rpm", RPM_RAD_S),
        SineOf::Torque => ("Nm", 1.0),
    }
}

fn bandwidths(map: &CapabilityMap) -> Table {
    let mut table = Table::new(&[
        ("the demand is followed", Align::Left),
        ("95 % of the benches", Align::Right),
        ("half of them", Align::Right),
        ("5 % of them", Align::Right),
    ]);
    let up_to = |hz: f64| match hz {
        hz if hz.is_infinite() => "300 Hz or more".to_owned(),
        hz if hz <= 0.1 => "nowhere".to_owned(),
        hz => format!("up to {}", number::significant_with_unit(hz, 3, "Hz")),
    };
    let of = &map.bandwidths;
    let kinds = [("within ±10 %", of.ten_per_cent_hz), ("within ±3 dB", of.three_db_hz), ("within 1 ms", of.one_ms_hz)];
    for (what, hz) in kinds {
        table.row([what.into(), up_to(hz[0]).into(), up_to(hz[1]).into(), up_to(hz[2]).into()] as [Cell; 4]);
    }
    let [short, half, long] = of.delay_s.map(|delay_s| number::significant_with_unit(delay_s * 1e3, 3, "ms"));
    table.row(["delay at 0.1 Hz, at most".into(), long.into(), half.into(), short.into()] as [Cell; 4]);
    table
}

/// Amplitudes that 95 % of the benches can do, with the limit that binds, at every other speed.
fn table(map: &CapabilityMap, in_table_hz: &[f64]) -> Table {
    let (unit, si) = unit(map.of);
    let speeds: Vec<String> = map.speed_rad_s.iter().step_by(2).map(|speed| number::rpm(*speed)).collect();
    let mut columns = vec![("frequency", Align::Right)];
    columns.extend(speeds.iter().map(|speed| (speed.as_str(), Align::Left)));
    let mut table = Table::new(&columns);
    let is_in_table = |hz: f64| in_table_hz.iter().any(|one| (one - hz).abs() < 1e-9 * hz);
    for (k, frequency_hz) in map.frequency_hz.iter().enumerate().filter(|(_, hz)| is_in_table(**hz)) {
        let cell = |row: &Vec<Place>| {
            let place = row[k];
            match (place.amplitude[0].is_finite(), place.binds) {
                (true, Some(of)) => {
                    format!("{} {unit}, {}", number::significant(place.amplitude[0] / si, 3), short(of))
                }
                _ => "no limit stated".to_owned(),
            }
        };
        let first = number::measure(*frequency_hz, "Hz");
        let cells = std::iter::once(first).chain(map.places.iter().step_by(2).map(cell));
        table.row(cells.map(Cell::from).collect::<Vec<_>>());
    }
    table
}

fn figure(map: &CapabilityMap, wanted: &[WantedAnswer]) -> Figure {
    let (unit, si) = unit(map.of);
    let mut layers = Vec::new();
    for (k, (speed, row)) in map.speed_rad_s.iter().zip(&map.places).enumerate() {
        let bound = |share: usize| row.iter().map(|place| place.amplitude[share] / si).collect::<Vec<_>>();
        if !bound(0).iter().all(|value| value.is_finite()) {
            continue;
        }
        let style = Style::of_model(k);
        layers.push(Layer::Band {
            name: String::new(),
            style,
            x: Abscissa::Values(rounded(&map.frequency_hz)),
            low: rounded(&bound(0)),
            high: rounded(&bound(2)),
        });
        layers.push(Layer::curve(&number::rpm(*speed), style, &map.frequency_hz, &bound(1)));
    }
    layers.extend(wanted.iter().filter_map(|one| wanted::mark(one, map.of, si)));
    let panel = Panel::new(Axis::log("amplitude", unit), HEIGHT, layers);
    Figure::new(name(map.of), Axis::frequency(), vec![panel]).with_caption(
        "Curves: half of the benches can do more. Bands: 90 % of the benches. Crosses: sines that are wanted.",
    )
}

/// At every speed and torque what 95 % of the benches can do, upwards and downwards.
fn of_gradients(gradients: &[GradientPlace]) -> Table {
    let mut torques: Vec<f64> = gradients.iter().map(|one| one.torque_nm).collect();
    torques.dedup();
    let names: Vec<String> =
        torques.iter().map(|torque| format!("at {} Nm", number::significant(*torque, 3))).collect();
    let mut columns = vec![("speed", Align::Right)];
    columns.extend(names.iter().map(|name| (name.as_str(), Align::Left)));
    let mut table = Table::new(&columns);
    let rows = gradients.len() / torques.len().max(1);
    for row in 0..rows {
        let places: Vec<&GradientPlace> = gradients.iter().skip(row).step_by(rows).collect();
        let first = places.first().map_or_else(String::new, |one| number::rpm(one.speed_rad_s));
        let cells = places.into_iter().map(gradient_cell);
        table.row(std::iter::once(first).chain(cells).map(Cell::from).collect::<Vec<_>>());
    }
    table
}

fn gradient_cell(one: &GradientPlace) -> String {
    let way = |value: f64, binds: Option<LimitOf>| match binds {
        Some(of) => format!("{} {}", number::significant(value / RPM_RAD_S, 3), short(of)),
        None => "no limit".to_owned(),
    };
    let (up, down) = (way(one.up_rad_s2[0], one.binds[0]), way(one.down_rad_s2[0], one.binds[1]));
    format!("+{up}, −{down}")
}

fn gradient_figure(gradients: &[GradientPlace], wanted: &[WantedAnswer]) -> Figure {
    let mut torques: Vec<f64> = gradients.iter().map(|one| one.torque_nm).collect();
    torques.dedup();
    let panel = |label: &str, of: fn(&GradientPlace) -> [f64; 3]| {
        let mut layers = Vec::new();
        for (k, torque) in torques.iter().enumerate() {
            let row: Vec<&GradientPlace> = gradients.iter().filter(|one| one.torque_nm == *torque).collect();
            let bound = |share: usize| row.iter().map(|one| of(one)[share] / RPM_RAD_S).collect::<Vec<_>>();
            if !bound(2).iter().all(|value| value.is_finite()) {
                continue;
            }
            let speeds: Vec<f64> = row.iter().map(|one| one.speed_rad_s / RPM_RAD_S).collect();
            let style = Style::of_model(k);
            let (low, high) = (rounded(&bound(0)), rounded(&bound(2)));
            let x = Abscissa::Values(rounded(&speeds));
            layers.push(Layer::Band { name: String::new(), style, x, low, high });
            layers.push(Layer::curve(&format!("{} Nm", number::significant(*torque, 3)), style, &speeds, &bound(1)));
        }
        layers.extend(wanted.iter().filter_map(wanted::line));
        Panel::new(Axis::linear(label, "rpm/s"), HEIGHT, layers)
    };
    let panels = vec![panel("upwards", |one| one.up_rad_s2), panel("downwards", |one| one.down_rad_s2)];
    Figure::new("Largest gradient of the speed", Axis::linear("speed", "rpm"), panels)
        .with_caption("Curves: half of the benches can do more. Bands: 90 % of the benches.")
}
