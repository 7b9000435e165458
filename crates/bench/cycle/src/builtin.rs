//! The cycles that are embedded.

use crate::denormalise::{Rule, SpeedScale};
use crate::engine_map::EngineMap;
use crate::error::CycleError;
use crate::modes::Modes;
use crate::reference::{Reference, Scales};
use crate::text;

/// Kind of a cycle's content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Speed and torque of an engine in % at each second.
    Transient,
    /// Modes joined by ramps.
    Modes,
    /// Speed of a vehicle.
    Vehicle,
}

/// A cycle by its name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Builtin {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// Kind of its content.
    pub kind: Kind,
    /// The requirement set that usually judges it.
    pub requirement: &'static str,
    data: &'static str,
    rule: Rule,
    /// Time of the first value, s.
    first_s: f64,
    /// m/s of a unit of vehicle speed.
    unit_m_s: f64,
}

const NONE: Builtin = Builtin {
    name: "",
    title: "",
    kind: Kind::Modes,
    requirement: "",
    data: "",
    rule: Rule::Cfr1065,
    first_s: 0.0,
    unit_m_s: 1.0,
};

const ALL: [Builtin; 8] = [
    Builtin {
        name: "whtc",
        title: "World harmonised transient cycle of heavy engines",
        kind: Kind::Transient,
        requirement: "whtc",
        data: include_str!("../data/whtc.txt"),
        rule: Rule::Whtc,
        first_s: 1.0,
        ..NONE
    },
    Builtin {
        name: "nrtc",
        title: "Transient cycle of engines of mobile machinery",
        kind: Kind::Transient,
        requirement: "nrtc",
        data: include_str!("../data/nrtc.txt"),
        rule: Rule::Nrtc,
        first_s: 1.0,
        ..NONE
    },
    Builtin { name: "whsc", title: "World harmonised ramped modes of heavy engines", requirement: "whsc", ..NONE },
    Builtin { name: "c1-rmc", title: "Ramped modes C1 of mobile machinery", requirement: "1065.514", ..NONE },
    Builtin { name: "d2-rmc", title: "Ramped modes D2 of engines of constant speed", requirement: "1065.514", ..NONE },
    Builtin { name: "g2-rmc", title: "Ramped modes G2 of small engines", requirement: "1065.514", ..NONE },
    Builtin {
        name: "wltc-3b",
        title: "WLTC class 3b, speed of a light vehicle",
        kind: Kind::Vehicle,
        requirement: "1036.545",
        data: include_str!("../data/wltc_class3b.txt"),
        unit_m_s: 1.0 / 3.6,
        ..NONE
    },
    Builtin {
        name: "udds",
        title: "Urban schedule UDDS, speed of a light vehicle",
        kind: Kind::Vehicle,
        requirement: "1036.545",
        data: include_str!("../data/udds.txt"),
        unit_m_s: 0.44704,
        ..NONE
    },
];

/// Every embedded cycle.
pub fn all() -> &'static [Builtin] {
    &ALL
}

/// The cycle of a name; letter case does not matter.
///
/// # Errors
/// [`CycleError::UnknownCycle`] with the names there are.
pub fn builtin(name: &str) -> Result<Builtin, CycleError> {
    let found = ALL.iter().find(|cycle| cycle.name.eq_ignore_ascii_case(name.trim())).copied();
    found.ok_or_else(|| CycleError::UnknownCycle {
        name: name.to_owned(),
        known: ALL.iter().map(|cycle| cycle.name).collect(),
    })
}

impl Builtin {
    /// Where the figures are from.
    ///
    /// # Errors
    /// Damaged data.
    pub fn source(&self) -> Result<String, CycleError> {
        match self.kind {
            Kind::Modes => Ok(Modes::of(self.name)?.source),
            _ => Ok(text::source(self.data)),
        }
    }

    /// How long it is, s.
    ///
    /// # Errors
    /// Damaged data.
    pub fn duration_s(&self) -> Result<f64, CycleError> {
        match self.kind {
            Kind::Modes => Ok(Modes::of(self.name)?.duration_s()),
            Kind::Transient => Ok(self.normalised()?.len() as f64),
            Kind::Vehicle => Ok(self.vehicle_speed_m_s()?.len().saturating_sub(1) as f64),
        }
    }

    /// Speed and torque in %, of each second; without a torque the engine is motored. Empty for other kinds.
    ///
    /// # Errors
    /// Damaged data.
    pub fn normalised(&self) -> Result<Vec<(f64, Option<f64>)>, CycleError> {
        let parse = |word: &str| {
            let (speed, torque) = word.split_once('/')?;
            let torque = if torque == "m" { None } else { Some(text::number(torque)?) };
            Some((text::number(speed)?, torque))
        };
        if self.kind == Kind::Transient { text::values(self.name, self.data, parse) } else { Ok(Vec::new()) }
    }

    /// The speed of a vehicle at each second from 0 on, m/s.
    ///
    /// # Errors
    /// [`CycleError::NoVehicle`] of a cycle for engines, damaged data.
    pub fn vehicle_speed_m_s(&self) -> Result<Vec<f64>, CycleError> {
        if self.kind != Kind::Vehicle {
            return Err(CycleError::NoVehicle { name: self.name });
        }
        text::values(self.name, self.data, |word| text::number(word).map(|speed| speed * self.unit_m_s))
    }

    /// The cycle on an engine.
    ///
    /// # Errors
    /// [`CycleError::NeedsVehicle`] of a cycle for vehicles, damaged data.
    pub fn reference(&self, map: &EngineMap) -> Result<Reference, CycleError> {
        let course = match self.kind {
            Kind::Vehicle => return Err(CycleError::NeedsVehicle { name: self.name }),
            Kind::Modes => Modes::of(self.name)?.course(map),
            Kind::Transient => denormalised(&self.normalised()?, self.rule, map),
        };
        let (speed_rad_s, torque_nm) = course.into_iter().unzip();
        Ok(Reference { start_s: self.first_s, step_s: 1.0, speed_rad_s, torque_nm, scales: Scales::of(map) })
    }
}

/// Speeds and torques of a normalised course; without a torque the engine is motored.
pub fn denormalised(course: &[(f64, Option<f64>)], rule: Rule, map: &EngineMap) -> Vec<(f64, f64)> {
    let scale = SpeedScale::of(rule, map);
    let point = |(speed, torque): &(f64, Option<f64>)| {
        let speed_rad_s = scale.speed_rad_s(*speed);
        let torque_nm = match torque {
            Some(percent) => 0.01 * percent * map.full_load_nm(speed_rad_s),
            None => map.motoring_nm(speed_rad_s),
        };
        (speed_rad_s, torque_nm)
    };
    course.iter().map(point).collect()
}

impl Scales {
    /// Those of an engine map.
    pub fn of(map: &EngineMap) -> Self {
        Scales {
            idle_rad_s: map.idle_rad_s(),
            maximum_test_speed_rad_s: map.maximum_test_speed_rad_s(),
            maximum_torque_nm: map.maximum_torque_nm(),
            maximum_power_w: map.maximum_power_w(),
        }
    }
}
