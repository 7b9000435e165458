//! How large a sine may be, over frequency and speed.

use capability::LimitOf;
use capability::map::{CapabilityMap, Gradient, Place, SineOf};
use page::{Abscissa, Align, Axis, Block, Blocks, Cell, Figure, Layer, Page, Panel, Style, Table, rounded};
use units::RPM_RAD_S;

use super::words;
use crate::wording::number;

/// Height of a panel on the page.
const HEIGHT: u32 = 260;

/// Maps of speed and torque, and the largest gradients.
pub fn page(title: &str, maps: &[CapabilityMap], gradients: &[Gradient]) -> Page {
    let mut all = Blocks::default();
    for map in maps {
        all.push(Block::heading(name(map.of)));
        all.push(bandwidth(map));
        all.push(table(map));
        all.push(Block::Figure(figure(map)));
    }
    all.push(Block::heading("Largest gradient of the speed"));
    all.push(of_gradients(gradients));
    Page::new(title, all.into_vec())
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

fn bandwidth(map: &CapabilityMap) -> Block {
    let up_to = |hz: Option<f64>| hz.map_or_else(|| "300 Hz or more".to_owned(), |hz| number::measure(hz, "Hz"));
    let [ten, three] = map.bandwidth_hz;
    Block::paragraph(format!(
        "The demand is followed within ±10 % up to {}, within ±3 dB up to {}.",
        up_to(ten),
        up_to(three)
    ))
}

/// Amplitudes that 95 % of the benches can do, with the limit that binds, at every other speed.
fn table(map: &CapabilityMap) -> Table {
    let (unit, si) = unit(map.of);
    let speeds: Vec<String> = map.speed_rad_s.iter().step_by(2).map(|speed| number::rpm(*speed)).collect();
    let mut columns = vec![("frequency", Align::Right)];
    columns.extend(speeds.iter().map(|speed| (speed.as_str(), Align::Left)));
    let mut table = Table::new(&columns);
    for (k, frequency_hz) in map.frequency_hz.iter().enumerate() {
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

/// A limit in a word or two.
fn short(of: LimitOf) -> &'static str {
    match of {
        LimitOf::ShaftTorque => "shaft torque",
        LimitOf::ShaftTorqueSlew => "shaft slew",
        LimitOf::TorqueDemand => "T_d*",
        LimitOf::TorqueSlew => "T_d* slew",
        LimitOf::Speed => "speed",
        LimitOf::SpeedGradient => "gradient",
        LimitOf::Power => "power",
        LimitOf::TimeAtResonance => "resonance",
    }
}

fn figure(map: &CapabilityMap) -> Figure {
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
    let panel = Panel::new(Axis::log("amplitude", unit), HEIGHT, layers);
    Figure::new(name(map.of), Axis::frequency(), vec![panel])
        .with_caption("Curves: half of the benches can do more. Bands: 90 % of the benches.")
}

fn of_gradients(gradients: &[Gradient]) -> Table {
    let mut table = Table::new(&[("speed", Align::Right), ("up", Align::Left), ("down", Align::Left)]);
    for one in gradients {
        let cell = |value: f64, binds: Option<LimitOf>| match binds {
            Some(of) => format!("{} rpm/s, {}", number::significant(value / RPM_RAD_S, 4), words::limit_of(of).0),
            None => "no limit stated".to_owned(),
        };
        table.row([
            number::rpm(one.speed_rad_s).into(),
            cell(one.up_rad_s2, one.binds[0]).into(),
            cell(one.down_rad_s2, one.binds[1]).into(),
        ] as [Cell; 3]);
    }
    table
}
