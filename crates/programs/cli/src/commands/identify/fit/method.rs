//! Methods and their orders, as a person would write them.

use super::greybox;
use crate::cli::identify::{FitCommand, PolynomialArguments};

/// The method and its orders, as a person would write it.
pub(super) fn wanted(command: &FitCommand) -> String {
    let list = |values: &[usize]| values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    let polynomial = |name: &str, a: &PolynomialArguments| {
        let mut text = name.to_owned();
        let single = [("na", a.na), ("nc", a.nc), ("nd", a.nd)];
        single.iter().filter_map(|(n, v)| v.map(|v| format!(" {n} {v}"))).for_each(|part| text.push_str(&part));
        let several = [("nb", &a.nb), ("nf", &a.nf), ("nk", &a.nk)];
        several.iter().filter(|(_, v)| !v.is_empty()).for_each(|(n, v)| text.push_str(&format!(" {n} {}", list(v))));
        text
    };
    match command {
        FitCommand::Arx(a) => {
            let name = if a.iv { "ARX by instrumental variables" } else { "ARX" };
            format!("{name} na {} nb {} nk {}", a.na, list(&a.nb), list(&a.nk))
        }
        FitCommand::Armax(a) => polynomial("ARMAX", a),
        FitCommand::Oe(a) => polynomial("output error", a),
        FitCommand::Bj(a) => polynomial("Box–Jenkins", a),
        FitCommand::Poly(a) => polynomial("polynomial", a),
        FitCommand::Tf(a) => format!("transfer function, zeros {} poles {}", list(&a.zeros), list(&a.poles)),
        FitCommand::Process(a) => {
            let held = if a.hold.is_empty() { String::new() } else { format!(", {} held", a.hold.join(", ")) };
            format!("process model {}{held}", a.structure)
        }
        FitCommand::Ss(a) => {
            let how = if a.subspace { "subspace" } else { "prediction error" };
            format!("state space by {how}, order {}", a.order)
        }
        FitCommand::Greybox(a) => greybox::method(a),
    }
}
