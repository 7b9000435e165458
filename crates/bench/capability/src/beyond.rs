//! Points of a test beyond the range for which the model, or the engine's map, is known.

use bench_model::document::{Range, Validity};
use cycle::EngineMap;
use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

use crate::demand::{CycleDemand, Demand};
use crate::trace::Trace;

/// A range of recordings ends no more exactly than this part of its width.
const EDGE: f64 = 0.05;
/// An engine map ends no more exactly than this part of its largest torque and of its highest speed.
const MAP_EDGE: f64 = 0.02;

/// One such thing: no bench drawn can show that the test goes well there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "of", rename_all = "snake_case")]
pub enum Beyond {
    /// Speeds outside of the engine's map.
    EngineSpeed {
        /// Lowest and highest speed of the map, rad/s.
        map_rad_s: Range,
        /// The same of the test, rad/s.
        test_rad_s: Range,
    },
    /// A torque that the engine does not give.
    EngineTorque {
        /// The torque that is furthest beyond the map, Nm.
        #[serde(deserialize_with = "nan_if_null")]
        asked_nm: f64,
        /// Torque that the map gives there, Nm.
        #[serde(deserialize_with = "nan_if_null")]
        given_nm: f64,
        /// The speed there, rad/s.
        #[serde(deserialize_with = "nan_if_null")]
        speed_rad_s: f64,
        /// When, s.
        #[serde(deserialize_with = "nan_if_null")]
        time_s: f64,
    },
    /// Speeds that no recording has tested the model at.
    ModelSpeed {
        /// N_d of the recordings, rad/s.
        model_rad_s: Range,
        /// N_d of the test, rad/s.
        test_rad_s: Range,
    },
    /// Torques that no recording has tested the model at.
    ModelTorque {
        /// T_d of the recordings, Nm.
        model_nm: Range,
        /// T_d of the test, Nm.
        test_nm: Range,
    },
}

impl Beyond {
    /// Tells whether it is the engine that is asked for too much.
    pub fn is_of_engine(&self) -> bool {
        matches!(self, Beyond::EngineSpeed { .. } | Beyond::EngineTorque { .. })
    }
}

/// All of it: what the engine cannot, and where the model was not tested.
pub(crate) fn beyond(demand: &Demand<'_>, validity: &Validity, trace: &Trace) -> Vec<Beyond> {
    let of_engine = match demand {
        Demand::Cycle(CycleDemand { map: Some(map), .. }) => of_engine(map, trace),
        Demand::Cycle(_) | Demand::Plan(..) => Vec::new(),
    };
    let of_model = of_model(validity, &trace.dyno_speed_rad_s, &trace.dyno_demand_nm);
    of_engine.into_iter().chain(of_model).collect()
}

/// Where speeds, rad/s, and torques of the dynamometer, Nm, leave the range of the recordings that a model is from.
pub fn of_model(validity: &Validity, speed_rad_s: &[f64], torque_nm: &[f64]) -> Vec<Beyond> {
    let left = |range: Option<Range>, values: &[f64]| {
        let (range, test) = (range?, Validity::range_of(values.iter().copied())?);
        let edge = EDGE * (range.1 - range.0);
        (test.0 < range.0 - edge || test.1 > range.1 + edge).then_some((range, test))
    };
    let speed = left(validity.dyno_speed_rad_s, speed_rad_s)
        .map(|(model_rad_s, test_rad_s)| Beyond::ModelSpeed { model_rad_s, test_rad_s });
    let torque = left(validity.air_gap_torque_nm, torque_nm)
        .map(|(model_nm, test_nm)| Beyond::ModelTorque { model_nm, test_nm });
    [speed, torque].into_iter().flatten().collect()
}

/// Returns, for each value of a run, whether it leaves the range of the recordings that a model is from.
pub(crate) fn is_beyond_model(validity: &Validity, trace: &Trace) -> impl Fn(usize) -> bool {
    let wide = |range: Option<Range>| range.map(|(low, high)| (low - EDGE * (high - low), high + EDGE * (high - low)));
    let (speed, torque) = (wide(validity.dyno_speed_rad_s), wide(validity.air_gap_torque_nm));
    let leaves = |range: Option<Range>, value: f64| range.is_some_and(|(low, high)| value < low || value > high);
    move |k| leaves(speed, trace.dyno_speed_rad_s[k]) || leaves(torque, trace.dyno_demand_nm[k])
}

fn of_engine(map: &EngineMap, trace: &Trace) -> Vec<Beyond> {
    let (speeds, torques) = (&trace.speed_demand_rad_s, &trace.torque_demand_nm);
    let map_rad_s = (map.lowest_rad_s(), map.highest_rad_s());
    let edge_rad_s = MAP_EDGE * map_rad_s.1;
    // An engine that gives no torque may stand still, or be started.
    let turning = speeds.iter().zip(torques).filter(|(_, torque)| **torque > MAP_EDGE * map.maximum_torque_nm());
    let driven = Validity::range_of(turning.map(|(speed, _)| *speed));
    let highest = speeds.iter().copied().fold(0.0, f64::max);
    let is_too_slow = driven.is_some_and(|(low, _)| low < map_rad_s.0 - edge_rad_s);
    let test_rad_s = (driven.map_or(highest, |(low, _)| low), highest);
    let is_left = is_too_slow || highest > map_rad_s.1 + edge_rad_s;
    let speed = is_left.then_some(Beyond::EngineSpeed { map_rad_s, test_rad_s });
    // The demand is straight between its seconds, and the map is not.
    let excess = |k: usize| {
        let (speed, torque) = (speeds[k], torques[k]);
        (torque - map.full_load_nm(speed)).max(map.motoring_nm(speed) - torque)
    };
    let worst = (0..torques.len()).max_by(|a, b| excess(*a).total_cmp(&excess(*b)));
    let worst = worst.filter(|k| excess(*k) > MAP_EDGE * map.maximum_torque_nm());
    let torque = worst.map(|k| Beyond::EngineTorque {
        asked_nm: torques[k],
        given_nm: torques[k].clamp(map.motoring_nm(speeds[k]), map.full_load_nm(speeds[k])),
        speed_rad_s: speeds[k],
        time_s: trace.time_s(k),
    });
    [speed, torque].into_iter().flatten().collect()
}
