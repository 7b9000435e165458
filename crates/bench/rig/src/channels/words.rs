//! The words of channel names, English and German, and what they mean.

use crate::channels::guess::Meaning;
use Meaning::{
    AirGap, Calculated, Demand, Dynamometer, Engine, Flange, LoadCell, Measured, Other, Shaft, Speed, Throttle, Torque,
};

/// Words that mean something wherever they occur in a name.
const PARTS: &[(&str, Meaning)] = &[
    ("speed", Speed),
    ("drehzahl", Speed),
    ("omega", Speed),
    ("torque", Torque),
    ("moment", Torque),
    ("throttle", Throttle),
    ("pedal", Throttle),
    ("drosselklappe", Throttle),
    ("alpha", Throttle),
    ("dyno", Dynamometer),
    ("dynamometer", Dynamometer),
    ("brake", Dynamometer),
    ("brems", Dynamometer),
    ("belast", Dynamometer),
    ("absorber", Dynamometer),
    ("lastmaschine", Dynamometer),
    ("engine", Engine),
    ("motor", Engine),
    ("verbrenn", Engine),
    ("crank", Engine),
    ("kurbelwelle", Engine),
    ("shaft", Shaft),
    ("welle", Shaft),
    ("coupling", Shaft),
    ("kupplung", Shaft),
    ("demand", Demand),
    ("setpoint", Demand),
    ("setpt", Demand),
    ("setval", Demand),
    ("sollwert", Demand),
    ("solldreh", Demand),
    ("sollmoment", Demand),
    ("target", Demand),
    ("desired", Demand),
    ("command", Demand),
    ("vorgabe", Demand),
    ("request", Demand),
    ("reference", Demand),
    ("airgap", AirGap),
    ("luftspalt", AirGap),
    ("umrichter", AirGap),
    ("inverter", AirGap),
    ("calc", Calculated),
    ("berechn", Calculated),
    ("estimate", Calculated),
    ("loadcell", LoadCell),
    ("kraftdose", LoadCell),
    ("kraftmess", LoadCell),
    ("kraftaufnehmer", LoadCell),
    ("messdose", LoadCell),
    ("messbrems", LoadCell),
    ("measure", Measured),
    ("gemessen", Measured),
    ("istwert", Measured),
    ("istdreh", Measured),
    ("istmoment", Measured),
    ("actual", Measured),
    ("flange", Flange),
    ("flansch", Flange),
    ("messwelle", Flange),
    ("torquemeter", Flange),
    ("vehicle", Other),
    ("fahrzeug", Other),
    ("wheel", Other),
    ("limit", Other),
    ("grenz", Other),
    ("error", Other),
    ("abweichung", Other),
    ("temp", Other),
    ("press", Other),
    ("druck", Other),
    ("gradient", Other),
    ("leistung", Other),
    ("power", Other),
];

/// Words that mean something only when they stand alone: between separators, capitals or digits.
const WORDS: &[(&str, Meaning)] = &[
    ("n", Speed),
    ("spd", Speed),
    ("rpm", Speed),
    ("rev", Speed),
    ("vel", Speed),
    ("m", Torque),
    ("t", Torque),
    ("md", Torque),
    ("tq", Torque),
    ("trq", Torque),
    ("tor", Torque),
    ("mom", Torque),
    ("dk", Throttle),
    ("thr", Throttle),
    ("app", Throttle),
    ("dyn", Dynamometer),
    ("dy", Dynamometer),
    ("brk", Dynamometer),
    ("lm", Dynamometer),
    ("last", Dynamometer),
    ("load", Dynamometer),
    ("d", Dynamometer),
    ("nd", Dynamometer),
    ("td", Dynamometer),
    ("eng", Engine),
    ("ne", Engine),
    ("te", Engine),
    ("mot", Engine),
    ("vkm", Engine),
    ("vm", Engine),
    ("ice", Engine),
    ("e", Engine),
    ("shft", Shaft),
    ("sh", Shaft),
    ("dmd", Demand),
    ("dem", Demand),
    ("soll", Demand),
    ("set", Demand),
    ("sp", Demand),
    ("ref", Demand),
    ("cmd", Demand),
    ("tgt", Demand),
    ("des", Demand),
    ("req", Demand),
    ("ag", AirGap),
    ("gap", AirGap),
    ("foc", AirGap),
    ("ls", AirGap),
    ("inv", AirGap),
    ("fu", AirGap),
    ("est", Calculated),
    ("ber", Calculated),
    ("lc", LoadCell),
    ("cell", LoadCell),
    ("kmd", LoadCell),
    ("ist", Measured),
    ("act", Measured),
    ("meas", Measured),
    ("mess", Measured),
    ("fl", Flange),
    ("flg", Flange),
    ("max", Other),
    ("min", Other),
    ("lim", Other),
    ("err", Other),
    ("dev", Other),
];

/// Speed and torque letters that often stand glued to the next word, as in `NMOT` and `mdist`.
const GLUED: &[(&str, Meaning)] = &[("md", Torque), ("tq", Torque), ("n", Speed), ("m", Torque), ("t", Torque)];

/// A word found in a text, with its meaning.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    pub(super) word: String,
    pub(super) meaning: Meaning,
}

/// The meaningful words of a channel's name.
pub(super) fn of_name(name: &str) -> Vec<Found> {
    let name = without_device(name);
    let mut found = Vec::new();
    for token in tokens(name) {
        read_token(&token, &mut found);
    }
    let joined = tokens(name).concat();
    read_parts(&joined, &mut found);
    found
}

/// The meaningful words of a comment: whole words only, as single letters mean nothing in prose.
pub(super) fn of_comment(comment: &str) -> Vec<Found> {
    let mut found = Vec::new();
    read_parts(&comment.to_lowercase().replace([' ', '-'], ""), &mut found);
    for token in tokens(comment).iter().filter(|token| token.len() > 2) {
        read_token(token, &mut found);
    }
    found
}

/// A name without what a measurement system adds: `INCA: DynoSpd\ETK` is `DynoSpd`.
fn without_device(name: &str) -> &str {
    let name = name.split('\\').next().unwrap_or(name);
    name.rsplit(": ").next().unwrap_or(name)
}

/// Lower-case words of a name, split at separators, digits and humps.
fn tokens(name: &str) -> Vec<String> {
    let letters: Vec<char> = name.chars().collect();
    let mut tokens = vec![String::new()];
    for (i, &c) in letters.iter().enumerate() {
        let before = i.checked_sub(1).map(|j| letters[j]);
        if !c.is_alphabetic() {
            tokens.push(String::new());
            continue;
        }
        let hump = c.is_uppercase() && before.is_some_and(char::is_lowercase);
        let next_lower = letters.get(i + 1).is_some_and(|next| next.is_lowercase());
        let end_of_capitals = c.is_uppercase() && before.is_some_and(char::is_uppercase) && next_lower;
        if hump || end_of_capitals {
            tokens.push(String::new());
        }
        if let Some(token) = tokens.last_mut() {
            token.extend(c.to_lowercase());
        }
    }
    tokens.retain(|token| !token.is_empty());
    tokens
}

fn lookup(word: &str) -> Option<Meaning> {
    WORDS.iter().find(|(known, _)| *known == word).map(|(_, meaning)| *meaning)
}

fn push(found: &mut Vec<Found>, word: &str, meaning: Meaning) {
    if !found.iter().any(|known| known.meaning == meaning) {
        found.push(Found { word: word.to_owned(), meaning });
    }
}

fn read_token(token: &str, found: &mut Vec<Found>) {
    if let Some(meaning) = lookup(token) {
        push(found, token, meaning);
        return;
    }
    let glued = GLUED.iter().find_map(|(letters, quantity)| {
        let rest = token.strip_prefix(letters)?;
        let meaning = lookup(rest).filter(|_| rest.len() > 2)?;
        Some((*letters, *quantity, rest, meaning))
    });
    if let Some((letters, quantity, rest, meaning)) = glued {
        push(found, letters, quantity);
        push(found, rest, meaning);
    }
}

fn read_parts(text: &str, found: &mut Vec<Found>) {
    // A Leistungsbremse is a dynamometer, Leistung is power.
    let text = text.replace("leistungsbrems", "brems");
    for (part, meaning) in PARTS {
        if text.contains(part) {
            push(found, part, *meaning);
        }
    }
}
