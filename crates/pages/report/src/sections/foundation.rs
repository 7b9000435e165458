//! Foundation of a result, and the people who answer for it: limits, assumptions, a place for signatures.

use page::{Block, Blocks, Prose};
use rig::facts::{BenchFacts, BenchVariant, StatedInertia};
use study::Study;

use crate::wording::{self, number};

/// Where a signature belongs.
const TO_SIGN: &str = "________________________________";

/// The limits of the bench, and what the model assumes.
pub(super) fn limits_and_assumptions(study: &Study) -> Blocks {
    let bench = &study.bench;
    let shaft = match bench.variant {
        BenchVariant::LoadCell => {
            "Two rigid masses on one shaft. K and B are constant over torque, speed, time and temperature."
        }
        BenchVariant::TorqueFlange => {
            "The shaft up to the torque flange has constant K and B. The flywheel’s spring is no part of it."
        }
    };
    let items = [
        limits(bench),
        shaft.to_owned(),
        wording::torque_scale(study),
        format!("{}; {}.", inertia("J_d", bench.dynamometer_inertia()), inertia("J_e", bench.engine_inertia())),
        "Friction of the dynamometer is no part of the model.".to_owned(),
    ];
    // A note: the first page holds more than this.
    vec![Block::heading("Limits and assumptions"), Block::note(items.join(" "))].into()
}

/// The limits that the bench file states.
fn limits(bench: &BenchFacts) -> String {
    let stated = [
        bench.torque_limit_nm.map(|nm| format!("{} of the drive", number::measure(nm, "Nm"))),
        bench.shaft_torque_limit_nm.map(|nm| format!("{} of the shaft", number::measure(nm, "Nm"))),
        bench.speed_limit_rad_s.map(number::rpm),
    ];
    let stated: Vec<String> = stated.into_iter().flatten().collect();
    match stated.is_empty() {
        true => "The bench file states no limits of torque and speed.".to_owned(),
        false => format!("The limits of the bench are {}.", wording::join(&stated, "and")),
    }
}

/// An inertia as the bench file states it.
fn inertia(symbol: &str, stated: StatedInertia) -> String {
    let value = number::measure(stated.kg_m2, "kg m²");
    match stated.uncertainty_percent {
        0.0 => format!("{symbol} is stated as {value}, exact"),
        percent => format!("{symbol} is stated as {value}, with a standard uncertainty of {percent} %"),
    }
}

/// Who made and who approved a report, each with a place to sign.
pub(super) fn signatures(study: &Study) -> Blocks {
    let report = &study.provenance.report;
    let place = |word: &str, name: &Option<String>| {
        let named = name.as_ref().map_or_else(|| word.to_owned(), |name| format!("{word} {name}"));
        format!("{named}, date and signature: {TO_SIGN}")
    };
    let both = [place("Made by", &report.author), place("Approved by", &report.approved_by)];
    Block::List { items: both.into_iter().map(Prose::verbatim).collect() }.into()
}
