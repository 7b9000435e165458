//! Lines without their spectra.

use part_lines::lines::{
    BANDWIDTH_ORDERS, Line, OrderCurve, OrderTrack, OverSpeed, PartLines, RecordingLines, SignalLines,
};
use rig::{ExperimentLabel, Role};
use serde::Serialize;
use units::si_spelling;

/// The lines of recordings, and their orders over the speed.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LinesFacts<'a> {
    recordings: Vec<RecordingLinesFacts<'a>>,
    over_speed: Vec<OverSpeedFacts<'a>>,
}

impl<'a> LinesFacts<'a> {
    /// Of lines, and of what [`part_lines::lines::over_speed`] makes of them.
    pub fn of(lines: &'a [RecordingLines], over_speed: &'a [OverSpeed]) -> Self {
        LinesFacts {
            recordings: lines.iter().map(RecordingLinesFacts::of).collect(),
            over_speed: over_speed.iter().map(OverSpeedFacts::of).collect(),
        }
    }
}

/// The lines of one recording.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RecordingLinesFacts<'a> {
    file: &'a str,
    label: &'a ExperimentLabel,
    parts: Vec<PartFacts<'a>>,
}

impl<'a> RecordingLinesFacts<'a> {
    /// Of the lines of a recording.
    pub fn of(lines: &'a RecordingLines) -> Self {
        let parts = lines.parts.iter().map(PartFacts::of).collect();
        RecordingLinesFacts { file: &lines.file, label: &lines.label, parts }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct PartFacts<'a> {
    start_s: f64,
    end_s: f64,
    speed_rad_s: f64,
    speed_range_rad_s: [f64; 2],
    demanded_hz: &'a [f64],
    signals: Vec<SignalFacts<'a>>,
}

impl<'a> PartFacts<'a> {
    fn of(part: &'a PartLines) -> Self {
        PartFacts {
            start_s: part.start_s,
            end_s: part.end_s,
            speed_rad_s: part.speed_rad_s,
            speed_range_rad_s: part.speed_range_rad_s,
            demanded_hz: &part.demanded_hz,
            signals: part.signals.iter().map(SignalFacts::of).collect(),
        }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct SignalFacts<'a> {
    role: Role,
    unit: &'static str,
    sample_time_s: f64,
    lines: &'a [Line],
    tracks: &'a [OrderTrack],
}

impl<'a> SignalFacts<'a> {
    fn of(signal: &'a SignalLines) -> Self {
        SignalFacts {
            role: signal.role,
            unit: si_spelling(signal.role.quantity()),
            sample_time_s: signal.sample_time_s,
            lines: &signal.lines,
            tracks: &signal.tracks,
        }
    }
}

/// The orders of a signal over the speed without their map.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct OverSpeedFacts<'a> {
    role: Role,
    unit: &'static str,
    speed_rad_s: [f64; 2],
    bandwidth_orders: f64,
    orders: &'a [OrderCurve],
    staying: &'a [Line],
}

impl<'a> OverSpeedFacts<'a> {
    fn of(signal: &'a OverSpeed) -> Self {
        OverSpeedFacts {
            role: signal.role,
            unit: si_spelling(signal.role.quantity()),
            speed_rad_s: signal.speed_rad_s,
            bandwidth_orders: BANDWIDTH_ORDERS,
            orders: &signal.orders,
            staying: &signal.staying,
        }
    }
}
