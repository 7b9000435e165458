//! The numbers of a model as the runtime reads them (`model_file.h`).

use std::fmt::Write;

use super::numbers::BenchNumbers;
use super::{csv, variables};

/// The text of `resources/bench.txt`. Numbers are hexadecimal: exact, and the same whatever decimal sign a program
/// uses.
pub(super) fn text(numbers: &BenchNumbers, token: &str) -> String {
    let mut text = String::from("dynoid-bench 0x1p+0\n");
    line(&mut text, format_args!("token {token}"));
    line(&mut text, format_args!("speed_control {}", hexadecimal(f64::from(u8::from(numbers.has_speed_control)))));
    for parameter in &numbers.parameters {
        let (name, value) = (parameter.name, parameter.value);
        let (number, unit) = (csv::number(value), parameter.unit.plain());
        line(&mut text, format_args!("{name} {} # {number} {unit}, {}", hexadecimal(value), parameter.description));
    }
    let start = [numbers.start_rad_s, numbers.start_nm];
    let ([speed, torque], [rad_s, nm]) = (start.map(hexadecimal), start.map(csv::number));
    line(&mut text, format_args!("initial {speed} {torque} # {rad_s} rad/s, {nm} Nm"));
    for (name, range) in [("speed_range", numbers.speed_range_rad_s), ("torque_range", numbers.torque_range_nm)] {
        if let Some((low, high)) = range {
            line(&mut text, format_args!("{name} {} {}", hexadecimal(low), hexadecimal(high)));
        }
    }
    line(&mut text, format_args!("nominals {}", row(&variables::nominals_of_states(numbers))));
    let count = |count: usize| hexadecimal(count as f64);
    line(&mut text, format_args!("draws {} {}", count(numbers.draws.len()), count(numbers.drawn.len())));
    line(&mut text, format_args!("{}", numbers.drawn.join(" ")));
    for draw in &numbers.draws {
        line(&mut text, format_args!("{}", row(draw)));
    }
    text.push_str("end\n");
    text
}

fn row(values: &[f64]) -> String {
    values.iter().map(|value| hexadecimal(*value)).collect::<Vec<_>>().join(" ")
}

fn line(text: &mut String, content: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{content}");
}

/// A finite number as C's `%a` writes it.
pub(super) fn hexadecimal(value: f64) -> String {
    let bits = value.to_bits();
    let (sign, exponent, fraction) = (bits >> 63, (bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    let sign = if sign == 1 { "-" } else { "" };
    let digits = format!("{fraction:013x}");
    let digits = digits.trim_end_matches('0');
    let point = if digits.is_empty() { "" } else { "." };
    match (exponent, fraction) {
        (0, 0) => format!("{sign}0x0p+0"),
        (0, _) => format!("{sign}0x0{point}{digits}p-1022"),
        _ => format!("{sign}0x1{point}{digits}p{:+}", exponent - 1023),
    }
}
