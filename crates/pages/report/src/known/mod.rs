//! Quantities that are known, and how well, in words.

mod why;

use std::ops::RangeInclusive;

use page::decimal::fixed;
use rig::results::Part;
use study::known::{FRICTION_NM, Grade, Known, REPLAY_FITS, Subject, Value, WIDTHS};
use study::{Analyses, Study};

use crate::wording::number;

/// One quantity in words, how well it is known, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Worded {
    /// Place of the part of the model it belongs to, in the order of the report.
    pub part: usize,
    /// Its symbol, empty where it has none.
    pub symbol: &'static str,
    /// Name of the quantity.
    pub name: String,
    /// How well it is known.
    pub grade: Grade,
    /// Its value with its uncertainty, or why there is none.
    pub value: String,
    /// Why, a sentence each.
    pub why: Vec<String>,
}

/// Every quantity that matters, in the order of the report.
pub fn known(study: &Study, analyses: Option<&Analyses>) -> Vec<Worded> {
    study::known(study, analyses).iter().map(worded).collect()
}

fn worded(one: &Known) -> Worded {
    let symbol = symbol(one.subject);
    Worded {
        part: one.part,
        symbol,
        name: name(one.subject),
        grade: one.grade,
        value: value(&one.value),
        why: one.why.iter().map(|why| why::sentence(symbol, why)).collect(),
    }
}

/// A grade as a headline.
pub fn headline(grade: Grade) -> &'static str {
    match grade {
        Grade::Well => "Known well",
        Grade::Roughly => "Known roughly",
        Grade::Poorly => "Known poorly",
        Grade::OnTrust => "Taken on trust",
        Grade::NotAtAll => "Not known",
    }
}

/// Meaning of a grade, with its thresholds.
pub fn meaning(grade: Grade) -> String {
    let [well, roughly] = [WIDTHS.well, WIDTHS.roughly].map(|share| whole(100.0 * share));
    let [fair, good] = ends(&REPLAY_FITS).map(whole);
    match grade {
        Grade::Well => format!(
            "The recordings determine it within ±{well} %, and nothing else in them contradicts it. For a time the limit is a tenth \
             of the fastest sample, for friction {} Nm, for a replay a fit of {good} %.",
            whole(FRICTION_NM)
        ),
        Grade::Roughly => format!(
            "Within ±{roughly} % (a time: half of the fastest sample; a replay: a fit of {fair} %). Or within ±{well} %, but something \
             else contradicts it."
        ),
        Grade::Poorly => "Less accurately than that: good for an order of magnitude.".to_owned(),
        Grade::OnTrust => "Stated in the bench file. No recording says whether it is true.".to_owned(),
        Grade::NotAtAll => "No recording shows it.".to_owned(),
    }
}

fn ends(range: &RangeInclusive<f64>) -> [f64; 2] {
    [*range.start(), *range.end()]
}

fn whole(value: f64) -> String {
    fixed(value, 0)
}

fn symbol(subject: Subject) -> &'static str {
    match subject {
        Subject::Quantity(quantity) | Subject::OfTorqueControl(quantity) | Subject::ByRecordings(quantity) => {
            quantity.symbol()
        }
        Subject::Part(part) => of_missing(part).0,
        Subject::FeedForwardConstant => "m",
        Subject::EngineTorque => "T_e",
        Subject::SignalDelay(_) | Subject::Friction | Subject::Replays => "",
    }
}

fn name(subject: Subject) -> String {
    match subject {
        Subject::Quantity(quantity) => quantity.name().to_owned(),
        Subject::OfTorqueControl(quantity) => format!("torque control: {}", quantity.name()),
        Subject::ByRecordings(quantity) => format!("{}, by the recordings alone", quantity.name()),
        Subject::Part(part) => of_missing(part).1.to_owned(),
        Subject::FeedForwardConstant => "constant part of the feed-forward".to_owned(),
        Subject::SignalDelay(role) => format!("delay of {}", role.symbol()),
        Subject::Friction => "friction of the dynamometer".to_owned(),
        Subject::EngineTorque => "torque of the engine".to_owned(),
        Subject::Replays => "what the bench does as a whole".to_owned(),
    }
}

/// Symbols and name of the quantities of a part that is not estimated.
fn of_missing(part: Part) -> (&'static str, &'static str) {
    match part {
        Part::Timing => ("", "delays of the torque signals"),
        Part::SpeedController => ("K_p, K_i, τ", "speed controller"),
        Part::FeedForward => ("k, k_a", "feed-forward"),
        Part::TorqueControl => ("τ, a", "torque control"),
        Part::Shaft => ("K, B", "stiffness and damping of the shaft"),
        Part::Whole => ("", "resonance of the bench"),
    }
}

fn value(value: &Value) -> String {
    match value {
        Value::None => "–".to_owned(),
        Value::NotSought => "not looked at here".to_owned(),
        Value::Estimated(parameter) => number::parameter(parameter),
        Value::Stated(kg_m2) => format!("{}, stated", number::measure(*kg_m2, "kg m²")),
        Value::Friction { torque_nm, half_width_nm, speed_rad_s } => {
            let torque = number::plus_minus(*torque_nm, *half_width_nm, "Nm");
            format!("{torque} at {}", number::rpm(*speed_rad_s))
        }
        Value::Rebuilt(recordings) => format!("rebuilt in {recordings} recordings"),
        Value::MedianFit(percent) => format!("median fit {}", number::fit(*percent)),
    }
}
