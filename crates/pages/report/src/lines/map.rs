//! Campbell maps in numbers: what a program draws, with the lines over it and their causes.

use part_lines::lines::{Cause, Line, OrderCurve, OverSpeed, folded_hz};
use serde::Serialize;
use units::RPM_RAD_S;

use super::words::{cause, shades, top_hz, unit};

/// Points of an order's line.
const POINTS: usize = 60;

/// The Campbell map of a signal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MapFacts {
    /// Symbol of the signal.
    signal: &'static str,
    /// Unit of its amplitudes.
    unit: &'static str,
    sample_rate_hz: f64,
    /// Lowest and highest speed.
    speed_rpm: [f64; 2],
    /// Upper end of the shades, Hz.
    top_hz: f64,
    /// Digits of shades, a string a class of speed, from the lowest frequency up. It is empty where no recording has
    /// the speed.
    shades: Vec<String>,
    /// How much a shade is worth, dB.
    shade_db: f64,
    lines: Vec<LineFacts>,
}

/// A line of a map.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct LineFacts {
    /// Its cause, in words.
    cause: String,
    /// None of a line that stays where it is.
    order: Option<f64>,
    /// Its largest amplitude.
    amplitude: f64,
    /// Standard error of it; none of a broad peak.
    standard_error: Option<f64>,
    /// Speed of the largest amplitude; none of a line that stays.
    at_rpm: Option<f64>,
    points: Vec<PointFacts>,
}

/// A point of a line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct PointFacts {
    speed_rpm: f64,
    /// True frequency.
    hz: f64,
    /// Frequency at which it shows.
    shown_hz: f64,
}

impl MapFacts {
    /// Of a signal over the speed.
    pub fn of(signal: &OverSpeed) -> Self {
        let (shades, shade_db) = shades(&signal.map);
        let orders = signal.orders.iter().map(|curve| order(curve, signal));
        MapFacts {
            signal: signal.role.symbol(),
            unit: unit(signal.role).0,
            sample_rate_hz: 1.0 / signal.sample_time_s,
            speed_rpm: signal.speed_rad_s.map(|w| w / RPM_RAD_S),
            top_hz: top_hz(&signal.map),
            shades,
            shade_db,
            lines: orders.chain(signal.staying.iter().map(|line| staying(line, signal))).collect(),
        }
    }
}

fn order(curve: &OrderCurve, signal: &OverSpeed) -> LineFacts {
    let (rate_hz, per_si) = (1.0 / signal.sample_time_s, unit(signal.role).1);
    let largest = curve.points.iter().max_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
    let point = |speed_rad_s: f64| PointFacts {
        speed_rpm: speed_rad_s / RPM_RAD_S,
        hz: curve.at_hz(speed_rad_s),
        shown_hz: folded_hz(curve.at_hz(speed_rad_s), rate_hz),
    };
    LineFacts {
        cause: cause(&Cause::Order { order: curve.order, is_firing: curve.is_firing }),
        order: Some(curve.order),
        amplitude: largest.map_or(f64::NAN, |point| per_si * point.amplitude),
        standard_error: largest.map(|point| per_si * point.standard_error),
        at_rpm: largest.map(|point| point.speed_rad_s / RPM_RAD_S),
        points: speeds(signal).map(point).collect(),
    }
}

fn staying(line: &Line, signal: &OverSpeed) -> LineFacts {
    let per_si = unit(signal.role).1;
    let point = |speed_rad_s: f64| PointFacts {
        speed_rpm: speed_rad_s / RPM_RAD_S,
        hz: line.frequency_hz,
        shown_hz: line.frequency_hz,
    };
    LineFacts {
        cause: cause(&line.cause),
        order: None,
        amplitude: per_si * line.amplitude,
        standard_error: line.standard_error.map(|error| per_si * error),
        at_rpm: None,
        points: speeds(signal).map(point).collect(),
    }
}

/// Speeds of the points of a line.
fn speeds(signal: &OverSpeed) -> impl Iterator<Item = f64> {
    let [low, high] = signal.speed_rad_s;
    (0..=POINTS).map(move |k| low + (high - low) * k as f64 / POINTS as f64)
}
