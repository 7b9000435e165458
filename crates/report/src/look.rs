//! What recordings show before any model, in words and figures.

use bench::Role;
use bench::look::{Cause, Line, LookedPart, LookedSignal};
use bench::units::RPM_RAD_S;
use plot::{Abscissa, Axis, Figure, Layer, Panel, Style, rounded};

use crate::wording::{self, number};

/// Height of a panel on the page.
const HEIGHT: u32 = 150;

/// A cause in words.
pub fn cause(cause: &Cause) -> String {
    let hz = |value: f64| number::significant(value, 4);
    match cause {
        Cause::Order { order, is_firing: true } => format!("order {order}, firing"),
        Cause::Order { order, is_firing: false } => format!("order {order}"),
        Cause::FoldedOrder { order, from_hz } => format!("order {order}, folded from {} Hz", hz(*from_hz)),
        Cause::Demanded => "demanded".to_owned(),
        Cause::HoldImage { of_hz, held_hz } => {
            format!("image of {} Hz, by a demand that changes {} times a second", hz(*of_hz), hz(*held_hz))
        }
        Cause::RippleSideband { of_hz, ripple_hz } => {
            format!("the {} Hz ripple in proportion to a torque of {} Hz", hz(*ripple_hz), hz(*of_hz))
        }
        Cause::OrderSideband { order, demanded_hz } => {
            format!("order {order}, swinging with the demanded {} Hz", hz(*demanded_hz))
        }
        Cause::Mains { multiple: 1, mains_hz } => format!("mains, {mains_hz} Hz"),
        Cause::Mains { multiple, mains_hz } => format!("{multiple} × {mains_hz} Hz: mains, ripple of the drive"),
        Cause::StructuralResonance => "resonance of the shaft (broad)".to_owned(),
        Cause::SensorResonance => "resonance of the sensor (broad)".to_owned(),
        Cause::Undecided { between, repeat_at_rpm } => {
            let all: Vec<String> = between.iter().map(self::cause).collect();
            let remedy = match repeat_at_rpm {
                Some(rpm) => format!("repeat at {rpm} rpm to decide"),
                None => "no other speed decides".to_owned(),
            };
            format!("undecided, {}: {remedy}", wording::join(&all, "or"))
        }
        Cause::Unknown => "no known cause".to_owned(),
    }
}

/// What is drawn with one colour.
fn kind(cause: &Cause) -> (&'static str, Style) {
    match cause {
        Cause::Order { .. } | Cause::OrderSideband { .. } => ("engine orders", Style::Modelled),
        Cause::FoldedOrder { .. } => ("folded orders", Style::Other),
        Cause::Demanded => ("demanded", Style::Residual),
        Cause::HoldImage { .. } => ("images of the hold", Style::Fourth),
        Cause::RippleSideband { .. } | Cause::Mains { .. } => ("mains and ripple", Style::Fifth),
        Cause::StructuralResonance | Cause::SensorResonance => ("resonances", Style::Sixth),
        Cause::Undecided { .. } => ("undecided", Style::Seventh),
        Cause::Unknown => ("no known cause", Style::Eighth),
    }
}

/// The unit people read a signal in, and how much of it one SI unit is.
pub fn unit(role: Role) -> (&'static str, f64) {
    match role {
        Role::DynoSpeed | Role::EngineSpeed | Role::DynoSpeedDemand => ("rpm", 1.0 / RPM_RAD_S),
        Role::Throttle => ("%", 100.0),
        _ => ("Nm", 1.0),
    }
}

/// A part of a recording: the spectrum of each signal with its lines.
pub fn figure(file: &str, part: &LookedPart) -> Figure {
    let panels = part.signals.iter().map(panel).collect();
    let demanded = match part.demanded_hz[..] {
        [one] => format!(", {} Hz demanded", number::significant(one, 3)),
        _ => String::new(),
    };
    let title = format!("{file}, {}{demanded}", number::rpm(part.speed_rad_s));
    Figure::new(&title, Axis::linear("frequency", "Hz"), panels)
}

fn panel(signal: &LookedSignal) -> Panel {
    let (unit, per_si) = unit(signal.role);
    let scaled: Vec<f64> = signal.amplitude.iter().map(|a| a * per_si).collect();
    let mut layers = vec![Layer::curve("amplitude", Style::Measured, &signal.frequency_hz, &scaled)];
    let mut seen: Vec<&str> = Vec::new();
    for line in &signal.lines {
        let (name, style) = kind(&line.cause);
        if seen.contains(&name) {
            continue;
        }
        seen.push(name);
        let alike: Vec<&Line> = signal.lines.iter().filter(|other| kind(&other.cause).0 == name).collect();
        layers.push(Layer::Points {
            name: name.to_owned(),
            style,
            x: Abscissa::Values(rounded(&alike.iter().map(|l| l.frequency_hz).collect::<Vec<_>>())),
            y: rounded(&alike.iter().map(|l| l.amplitude * per_si).collect::<Vec<_>>()),
            low: None,
            high: None,
        });
    }
    // What lies under the weakest line is noise.
    let lowest = signal.lines.iter().map(|l| l.amplitude * per_si).fold(f64::INFINITY, f64::min);
    let highest = scaled.iter().copied().fold(0.0, f64::max);
    let axis = Axis::log(signal.role.symbol(), unit);
    let axis = if lowest < highest { axis.within(0.2 * lowest, 2.0 * highest) } else { axis };
    Panel::new(axis, HEIGHT, layers)
}
