//! Lines that recordings show before any model, in words and figures.

use std::f64::consts::TAU;

use page::{Abscissa, Axis, Figure, Layer, Panel, Rounded, Style, rounded};
use part_lines::lines::{
    Cause, CurvePoint, Line, OrderCurve, OverSpeed, PartLines, RecordingLines, ShortSpectrum, SignalLines, folded_hz,
};
use rig::Role;
use units::RPM_RAD_S;

use crate::wording::{self, number};

/// Height of a panel on the page, and that of a map.
const HEIGHT: u32 = 150;
const MAP_HEIGHT: u32 = 260;
/// Multiples of the firing order that are drawn in.
const FIRINGS: u32 = 6;
/// Lines of a signal that are named in its spectrum.
const MOST_NAMED: usize = 12;
/// Orders whose amplitudes are drawn over the speed, of a signal and of all.
const MOST_CURVES: usize = 5;
const MOST_ORDERS: usize = 10;
/// Fewer speeds than these are drawn as points.
const FEW_POINTS: usize = 3;
/// Points so many classes of speed apart are joined.
const NEAR: f64 = 4.0;
/// Rows of a map, at most; the shades above nothing; and the least and the largest ratio that they span.
const ROWS: usize = 130;
const SHADES: f64 = 9.0;
const SPANS: [f64; 2] = [30.0, 1000.0];
/// Points of an order's line in a map.
const POINTS: usize = 200;

/// A cause in words.
pub fn cause(cause: &Cause) -> String {
    let hz = |value: f64| number::significant(value, 4);
    match cause {
        Cause::Order { order, is_firing: true } => format!("order {order}, firing"),
        Cause::Order { order, is_firing: false } => format!("order {order}"),
        Cause::FoldedOrder { order, from_hz } => format!("order {order}, alias of {} Hz", hz(*from_hz)),
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
        Cause::BroadHump => "broad hump, cause unknown".to_owned(),
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

/// A cause without the numbers that differ from recording to recording.
pub fn kind_of_cause(cause: &Cause) -> String {
    match cause {
        Cause::FoldedOrder { order, .. } => format!("order {order}, alias"),
        Cause::HoldImage { .. } => "images of a demand that is held".to_owned(),
        Cause::RippleSideband { .. } => "ripple of the drive in proportion to a torque".to_owned(),
        Cause::OrderSideband { order, .. } => format!("order {order}, swinging with a demanded sine"),
        Cause::Undecided { .. } => "undecided between several causes".to_owned(),
        other => self::cause(other),
    }
}

/// Kind of cause that is drawn with one colour.
fn kind(cause: &Cause) -> (&'static str, Style) {
    match cause {
        Cause::Order { .. } | Cause::OrderSideband { .. } => ("engine orders", Style::Modelled),
        Cause::FoldedOrder { .. } => ("folded orders", Style::Sixth),
        Cause::Demanded => ("demanded", Style::Residual),
        Cause::HoldImage { .. } => ("images of the hold", Style::Fourth),
        Cause::RippleSideband { .. } | Cause::Mains { .. } => ("mains and ripple", Style::Fifth),
        Cause::StructuralResonance | Cause::SensorResonance => ("resonances", Style::Other),
        Cause::BroadHump => ("no known cause", Style::Eighth),
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

/// Short name at a line in a figure.
fn short_name(cause: &Cause) -> String {
    match cause {
        Cause::Order { order, .. } => format!("{order}"),
        Cause::FoldedOrder { order, .. } => format!("{order} folded"),
        Cause::Demanded => "demanded".to_owned(),
        Cause::HoldImage { .. } => "image".to_owned(),
        Cause::RippleSideband { ripple_hz, .. } => format!("{ripple_hz:.0} Hz ripple"),
        Cause::OrderSideband { order, .. } => format!("{order} ± demanded"),
        Cause::Mains { multiple, mains_hz } => format!("{multiple} × {mains_hz} Hz"),
        Cause::StructuralResonance => "resonance".to_owned(),
        Cause::SensorResonance => "sensor".to_owned(),
        Cause::BroadHump => "hump".to_owned(),
        Cause::Undecided { .. } => "?".to_owned(),
        Cause::Unknown => "no cause".to_owned(),
    }
}

/// A part of a recording: the spectrum of each signal with its lines, and where the firing and its multiples are.
pub fn figure(look: &RecordingLines, part: &PartLines) -> Figure {
    let panels = part
        .signals
        .iter()
        .map(|signal| panel(signal, look.firing_order.map(|order| order * part.speed_rad_s / TAU)))
        .collect();
    let demanded = match part.demanded_hz[..] {
        [one] => format!(", {} Hz demanded", number::significant(one, 3)),
        _ => String::new(),
    };
    let title = format!("{}, {}{demanded}", look.file, number::rpm(part.speed_rad_s));
    let caption = "Numbers at lines are orders: multiples of the engine's speed. Vertical lines: the firing and its \
                   multiples; dashed lines: their aliases from above half the sample rate.";
    Figure::new(&title, Axis::linear("frequency", "Hz"), panels).with_caption(caption)
}

fn panel(signal: &SignalLines, firing_hz: Option<f64>) -> Panel {
    let (unit, per_si) = unit(signal.role);
    let scaled: Vec<f64> = signal.amplitude.iter().map(|a| a * per_si).collect();
    // What lies under the weakest line is noise.
    let lowest = 0.2 * signal.lines.iter().map(|l| l.amplitude * per_si).fold(f64::INFINITY, f64::min);
    let highest = 4.0 * scaled.iter().copied().fold(0.0, f64::max);
    let firings = firing_hz.map(|hz| firings(hz, 1.0 / signal.sample_time_s, [lowest, highest]));
    let mut layers = firings.unwrap_or_default();
    layers.push(Layer::trace("amplitude", Style::Measured, grid(&signal.frequency_hz), &scaled));
    let mut seen: Vec<&str> = Vec::new();
    for line in &signal.lines {
        let (name, style) = kind(&line.cause);
        if seen.contains(&name) {
            continue;
        }
        seen.push(name);
        let alike: Vec<&Line> = signal.lines.iter().filter(|other| kind(&other.cause).0 == name).collect();
        let of = |value: fn(&Line) -> f64| alike.iter().map(|l| value(l)).collect::<Vec<_>>();
        let amplitudes: Vec<f64> = alike.iter().map(|l| l.amplitude * per_si).collect();
        layers.push(Layer::dots(name, style, &of(|l| l.frequency_hz), &amplitudes));
    }
    for line in signal.lines.iter().take(MOST_NAMED) {
        layers.push(word(kind(&line.cause).1, (line.frequency_hz, line.amplitude * per_si), short_name(&line.cause)));
    }
    let axis = Axis::log(signal.role.symbol(), unit);
    let axis = if lowest < highest { axis.within(lowest, highest) } else { axis };
    Panel::new(axis, HEIGHT, layers)
}

/// First frequency and distance of a spectrum's lines, which are equally far apart.
fn grid(frequency_hz: &[f64]) -> (f64, f64) {
    let at = |k: usize| frequency_hz.get(k).copied().unwrap_or(0.0);
    (at(0), at(1) - at(0))
}

/// Upright lines at the firing and its multiples, those that fold apart.
fn firings(firing_hz: f64, rate_hz: f64, ends: [f64; 2]) -> Vec<Layer> {
    let drawn = |name: &str, style: Style, folds: bool| {
        let all = (1..=FIRINGS).map(|multiple| f64::from(multiple) * firing_hz);
        let places: Vec<f64> =
            all.filter(|hz| (*hz > 0.5 * rate_hz) == folds).map(|hz| folded_hz(hz, rate_hz)).collect();
        let x: Vec<f64> = places.iter().flat_map(|hz| [*hz, *hz, f64::NAN]).collect();
        let y: Vec<f64> = places.iter().flat_map(|_| [ends[0], ends[1], f64::NAN]).collect();
        path(name, style, &x, &y)
    };
    vec![drawn("firing and multiples", Style::Modelled, false), drawn("folded orders", Style::Sixth, true)]
}

fn path(name: &str, style: Style, x: &[f64], y: &[f64]) -> Layer {
    Layer::Path { name: name.to_owned(), style, x: rounded(x), y: rounded(y) }
}

fn word(style: Style, place: (f64, f64), word: String) -> Layer {
    words(style, [(place, word)])
}

/// Words at their places, none over another.
fn words(style: Style, words: impl IntoIterator<Item = ((f64, f64), String)>) -> Layer {
    let (places, words): (Vec<(f64, f64)>, Vec<String>) = words.into_iter().unzip();
    let (x, y) = places.into_iter().map(|(x, y)| (Rounded(x), Rounded(y))).unzip();
    Layer::Words { style, x, y, words }
}

/// The signals over the speed: their Campbell maps, the orders' amplitudes, and where there is one, the phases.
pub fn over_speed_figures(title: &str, signals: &[OverSpeed]) -> Vec<Figure> {
    if signals.is_empty() {
        return Vec::new();
    }
    let speed = Axis::linear("speed", "rpm");
    let maps = signals.iter().map(campbell).collect();
    let maps = Figure::new(&format!("{title}: Campbell map"), speed.clone(), maps).with_caption(
        "Darker is stronger. Numbers are orders, multiples of the engine's speed; dashed lines are aliases from \
         above half the sample rate. Constant frequencies are level lines: resonances, multiples of the mains.",
    );
    let drawn = drawn_orders(signals);
    let curves = signals.iter().filter(|signal| !signal.orders.is_empty());
    let amplitudes: Vec<Panel> = curves.clone().map(|signal| amplitudes(signal, &drawn)).collect();
    let amplitudes = Figure::new(&format!("{title}: orders over the speed"), speed.clone(), amplitudes).with_caption(
        "Amplitudes by least squares, all orders at once, in windows of ten turns; the bands are ± two standard \
         errors.",
    );
    let phases: Vec<Panel> = curves.filter_map(|signal| phases(signal, &drawn)).collect();
    let phases = Figure::new(&format!("{title}: phases of the orders"), speed, phases)
        .with_caption("Against the crank angle since the recording began.");
    [maps, amplitudes, phases].into_iter().filter(|figure| !figure.panels.is_empty()).collect()
}

fn campbell(signal: &OverSpeed) -> Panel {
    let rate_hz = 1.0 / signal.sample_time_s;
    let [low, high] = signal.speed_rad_s;
    let (rows, shade_db) = shades(&signal.map);
    let top_hz = top_hz(&signal.map);
    let x = [low, high].map(|w| Rounded(w / RPM_RAD_S));
    let mut layers = vec![Layer::Shades { x, y: [Rounded(0.0), Rounded(top_hz)], columns: rows }];
    layers.extend(order_lines(signal, rate_hz));
    // Over the orders, which come close at low speeds.
    let ends = [low, high].map(|w| w / RPM_RAD_S);
    for line in &signal.staying {
        layers.push(path("stays", Style::Other, &ends, &[line.frequency_hz; 2]));
    }
    let labels = signal.staying.iter().map(|line| {
        let label = format!("{}, {} Hz", short_name(&line.cause), number::significant(line.frequency_hz, 3));
        ((ends[0], line.frequency_hz), label)
    });
    layers.push(words(Style::Other, labels));
    let axis = Axis::linear(&format!("{}: frequency", signal.role.symbol()), "Hz").within(0.0, 0.5 * rate_hz);
    Panel::new(axis, MAP_HEIGHT, layers).noted(format!("a shade is {shade_db:.0} dB"))
}

/// Upper end of the shades of a map, Hz.
pub(super) fn top_hz(map: &[Vec<f64>]) -> f64 {
    let lines = map.iter().map(Vec::len).max().unwrap_or(0);
    let per_row = lines.div_ceil(ROWS).max(1);
    (lines.div_ceil(per_row) * per_row) as f64 * ShortSpectrum::STEP_HZ
}

/// Digits of shades, a string a class of speed, from the lowest frequency up; and how many decibels one is worth.
/// Nothing is shaded below twice the median, which is noise.
pub(super) fn shades(map: &[Vec<f64>]) -> (Vec<String>, f64) {
    let lines = map.iter().map(Vec::len).max().unwrap_or(0);
    let per_row = lines.div_ceil(ROWS).max(1);
    let rows: Vec<Vec<f64>> = map
        .iter()
        .map(|column| column.chunks(per_row).map(|cells| cells.iter().copied().fold(0.0, f64::max)).collect())
        .collect();
    let mut all: Vec<f64> = rows.iter().flatten().copied().filter(|a| *a > 0.0).collect();
    all.sort_by(f64::total_cmp);
    let highest = all.last().copied().unwrap_or(1.0);
    let lowest = 2.0 * all.get(all.len() / 2).copied().unwrap_or(0.0);
    let lowest = lowest.clamp(highest / SPANS[1], highest / SPANS[0]);
    let decades = (highest / lowest).log10();
    let digit = |a: &f64| {
        let shade = (SHADES * (a / lowest).log10() / decades).ceil().clamp(0.0, SHADES);
        char::from(b'0' + shade as u8)
    };
    let columns = rows.iter().map(|column| column.iter().map(digit).collect()).collect();
    (columns, 20.0 * decades / SHADES)
}

/// The orders of a map: straight where they show, dashed where they fold, with their numbers at the right.
fn order_lines(signal: &OverSpeed, rate_hz: f64) -> Vec<Layer> {
    let [low, high] = signal.speed_rad_s;
    let speeds: Vec<f64> = (0..=POINTS).map(|k| low + (high - low) * k as f64 / POINTS as f64).collect();
    let rpm: Vec<f64> = speeds.iter().map(|w| w / RPM_RAD_S).collect();
    // Nothing is drawn through speeds that no recording has.
    let class = |w: f64| (signal.map.len() as f64 * (w - low) / (high - low)) as usize;
    let is_known = |w: f64| signal.map.get(class(w)).or(signal.map.last()).is_some_and(|column| !column.is_empty());
    let mut layers = Vec::new();
    for curve in &signal.orders {
        let shown = |folds: bool| -> Vec<f64> {
            let at = |w: &f64| {
                let hz = curve.at_hz(*w);
                let is_shown = (hz > 0.5 * rate_hz) == folds && is_known(*w);
                if is_shown { folded_hz(hz, rate_hz) } else { f64::NAN }
            };
            speeds.iter().map(at).collect()
        };
        layers.push(path("orders", Style::Modelled, &rpm, &shown(false)));
        layers.push(path("folded orders", Style::Sixth, &rpm, &shown(true)));
    }
    let numbers = signal.orders.iter().enumerate().map(|(k, curve)| {
        // Not all numbers at one speed, where lines meet.
        let speed = low + (high - low) * (0.99 - 0.01 * (k % 3) as f64);
        ((speed / RPM_RAD_S, folded_hz(curve.at_hz(speed), rate_hz)), format!("{}", curve.order))
    });
    layers.push(words(Style::Modelled, numbers));
    layers
}

/// The orders that figures draw, no more than there are colours: the strongest of each signal first.
fn drawn_orders(signals: &[OverSpeed]) -> Vec<f64> {
    let mut drawn: Vec<f64> = Vec::new();
    for rank in 0..MOST_CURVES {
        for curve in signals.iter().filter_map(|signal| signal.orders.get(rank)) {
            if drawn.len() < MOST_ORDERS && !drawn.contains(&curve.order) {
                drawn.push(curve.order);
            }
        }
    }
    drawn.sort_by(f64::total_cmp);
    drawn
}

/// The strongest orders of those drawn, each with its name and its colour, the same in all panels.
fn strongest<'s>(
    signal: &'s OverSpeed,
    drawn: &'s [f64],
) -> impl Iterator<Item = (&'s OrderCurve, String, Style)> + use<'s> {
    let name = |curve: &OrderCurve| match curve.is_firing {
        true => format!("order {}, firing", curve.order),
        false => format!("order {}", curve.order),
    };
    signal.orders.iter().take(MOST_CURVES).filter_map(move |curve| {
        let place = drawn.iter().position(|order| *order == curve.order)?;
        Some((curve, name(curve), Style::of_model(place)))
    })
}

fn amplitudes(signal: &OverSpeed, drawn: &[f64]) -> Panel {
    let (unit, per_si) = unit(signal.role);
    let mut layers = Vec::new();
    let [lowest, highest] = signal.speed_rad_s;
    let reach = NEAR * (highest - lowest) / signal.map.len().max(1) as f64;
    for (curve, name, style) in strongest(signal, drawn) {
        // Between speeds that are far apart nothing is known.
        let is_near = |a: &CurvePoint, b: &CurvePoint| b.speed_rad_s - a.speed_rad_s <= reach;
        for points in curve.points.chunk_by(is_near) {
            let name = name.clone();
            let x: Vec<f64> = points.iter().map(|p| p.speed_rad_s / RPM_RAD_S).collect();
            let y: Vec<f64> = points.iter().map(|p| p.amplitude * per_si).collect();
            let off = |sign: f64| -> Vec<f64> {
                points.iter().map(|p| (p.amplitude + sign * 2.0 * p.standard_error).max(0.0) * per_si).collect()
            };
            let (low, high) = (rounded(&off(-1.0)), rounded(&off(1.0)));
            if points.len() < FEW_POINTS {
                let (x, y) = (Abscissa::Values(rounded(&x)), rounded(&y));
                layers.push(Layer::Points { name, style, x, y, low: Some(low), high: Some(high) });
            } else {
                let x_of_band = Abscissa::Values(rounded(&x));
                layers.push(Layer::Band { name: name.clone(), style, x: x_of_band, low, high });
                layers.push(Layer::curve(&name, style, &x, &y));
            }
        }
    }
    Panel::new(Axis::linear(signal.role.symbol(), unit), HEIGHT, layers)
}

fn phases(signal: &OverSpeed, drawn: &[f64]) -> Option<Panel> {
    let mut layers = Vec::new();
    for (curve, name, style) in strongest(signal, drawn) {
        let known = || curve.points.iter().filter_map(|p| Some((p.speed_rad_s / RPM_RAD_S, p.phase_rad?.to_degrees())));
        if known().next().is_some() {
            let (x, y): (Vec<f64>, Vec<f64>) = known().unzip();
            layers.push(Layer::dots(&name, style, &x, &y));
        }
    }
    let axis = Axis::angle(&format!("{}: phase", signal.role.symbol())).within(-180.0, 180.0);
    (!layers.is_empty()).then(|| Panel::new(axis, HEIGHT, layers))
}
