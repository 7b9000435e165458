//! Acts as lines of Python: a call of the module `dynoid` where there is one, or else the command.

use super::act::Act;

const HEAD: &str = "\
# The acts of a session of dynoid, in their order. To repeat them, go to a copy of the folder.
import pathlib
import subprocess

import dynoid

pathlib.Path(\".dynoid\").mkdir(exist_ok=True)
";

/// Commands that have a call, by their first words.
const CALLS: &[(&[&str], Call)] = &[
    (&["study"], study),
    (&["lines"], |given| of_bench(given, "lines")),
    (&["torque-signals"], |given| of_bench(given, "torque_signals")),
    (&["torque-control"], |given| of_bench(given, "torque_control")),
    (&["controller"], |given| of_bench(given, "controller")),
    (&["shaft"], |given| of_bench(given, "shaft")),
    (&["engine"], |given| of_bench(given, "engine")),
    (&["friction"], |given| of_bench(given, "friction")),
    (&["can"], can),
    (&["diff"], diff),
    (&["export"], export),
    (&["fit", "arx"], |given| fit(given, "arx", "slowest", &[("na", "2"), ("nb", "2"), ("nk", "1")])),
    (&["fit", "armax"], |given| fit(given, "armax", "slowest", POLYNOMIAL)),
    (&["fit", "oe"], |given| fit(given, "oe", "fastest", POLYNOMIAL)),
    (&["fit", "bj"], |given| fit(given, "bj", "slowest", POLYNOMIAL)),
];

/// The usual orders of polynomials; those that have none must be given.
const POLYNOMIAL: &[(&str, &str)] = &[("na", ""), ("nb", "2"), ("nc", ""), ("nd", ""), ("nf", ""), ("nk", "1")];

/// Makes a call of what stands after the first words of a command; none where the call would not do the same.
type Call = fn(Given<'_>) -> Option<String>;

/// Words of a command after the first ones.
#[derive(Default)]
struct Given<'a> {
    places: Vec<&'a str>,
    /// Options with their values; one without a value is a flag.
    options: Vec<(&'a str, Option<&'a str>)>,
}

impl<'a> Given<'a> {
    fn of(words: &'a [String]) -> Self {
        let mut given = Given::default();
        for word in words {
            match word.strip_prefix("--").map(|option| option.split_once('=').unwrap_or((option, ""))) {
                Some((option, "")) => given.options.push((option, None)),
                Some((option, value)) => given.options.push((option, Some(value))),
                None => given.places.push(word),
            }
        }
        given
    }

    /// Takes a flag.
    fn flag(&mut self, name: &str) -> bool {
        let before = self.options.len();
        self.options.retain(|option| *option != (name, None));
        self.options.len() < before
    }

    /// Takes all values of an option.
    fn values(&mut self, name: &str) -> Vec<&'a str> {
        let found = self.options.iter().filter(|option| option.0 == name).filter_map(|option| option.1).collect();
        self.options.retain(|option| option.0 != name || option.1.is_none());
        found
    }

    /// Takes the value of an option.
    fn value(&mut self, name: &str) -> Option<&'a str> {
        self.values(name).pop()
    }

    /// A call, if nothing of the command is left out of it.
    fn all_in(self, call: String) -> Option<String> {
        self.options.is_empty().then_some(call)
    }
}

/// A file that repeats acts.
pub(super) fn script(acts: &[Act]) -> String {
    let lines = acts.iter().map(|act| match act {
        Act::Command(words) => format!("{}\n", line(words)),
        // As bytes, so that the ends of its lines stay as they are.
        Act::Saved { file, text } => {
            format!("pathlib.Path({}).write_bytes({}.encode())\n", literal(file), literal(text))
        }
    });
    std::iter::once(HEAD.to_owned()).chain(lines).collect()
}

/// An act in one line.
pub(super) fn in_short(act: &Act) -> String {
    match act {
        Act::Command(words) => line(words),
        Act::Saved { file, .. } => format!("pathlib.Path({}).write_bytes(…)", literal(file)),
    }
}

fn line(words: &[String]) -> String {
    let begins = |first: &[&str]| words.len() >= first.len() && words.iter().zip(first).all(|(word, own)| word == own);
    let call = CALLS.iter().find(|(first, _)| begins(first));
    let call = call.and_then(|(first, call)| call(Given::of(&words[first.len()..])));
    call.unwrap_or_else(|| {
        let words: Vec<String> =
            std::iter::once("dynoid").chain(words.iter().map(String::as_str)).map(literal).collect();
        format!("subprocess.run([{}])", words.join(", "))
    })
}

/// A text as Python writes it; JSON writes it so, too.
fn literal(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

fn list(texts: &[&str]) -> String {
    let all: Vec<String> = texts.iter().map(|text| literal(text)).collect();
    format!("[{}]", all.join(", "))
}

fn study(mut given: Given<'_>) -> Option<String> {
    let [bench] = given.places[..] else { return None };
    let folder = bench.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
    let out = given.value("out").map_or(format!("{folder}study"), str::to_owned);
    let full = if given.flag("full") { ", full=True" } else { "" };
    given.all_in(format!("dynoid.Study.run({}, out={}{full})", literal(bench), literal(&out)))
}

/// An analysis of a part, of all recordings of the bench file.
fn of_bench(given: Given<'_>, method: &str) -> Option<String> {
    let [bench] = given.places[..] else { return None };
    given.all_in(format!("dynoid.Bench({}).{method}()", literal(bench)))
}

fn can(mut given: Given<'_>) -> Option<String> {
    let [bench, test] = given.places[..] else { return None };
    let required = given.values("require");
    let require = if required.is_empty() { String::new() } else { format!(", require={}", list(&required)) };
    let call = format!("dynoid.Bench({}).can({}{require})", literal(bench), literal(test));
    // A map is of no test.
    if test == "map" { None } else { given.all_in(call) }
}

fn diff(given: Given<'_>) -> Option<String> {
    let [first, second] = given.places[..] else { return None };
    // The model of a bench file is studied first.
    let is_model = !second.to_ascii_lowercase().ends_with(".toml");
    if is_model { given.all_in(format!("dynoid.diff({}, {})", literal(first), literal(second))) } else { None }
}

fn export(mut given: Given<'_>) -> Option<String> {
    let [model] = given.places[..] else { return None };
    let (to, out) = (given.value("to")?, given.value("out")?);
    given.all_in(format!("dynoid.export({}, {}, out={})", literal(model), literal(to), literal(out)))
}

/// An estimate with these orders, each with its usual value, on the clock that the command takes.
fn fit(mut given: Given<'_>, method: &str, clock: &str, orders: &[(&str, &str)]) -> Option<String> {
    let [recording] = given.places[..] else { return None };
    let (inputs, outputs) = (given.values("input"), given.values("output"));
    let (start, end) = (given.value("from"), given.value("to"));
    let stretch =
        [("start", start), ("end", end)].into_iter().filter_map(|(name, at)| Some(format!(", {name}={}", at?)));
    let data = format!(
        "dynoid.read({}).dataset(u={}, y={}, clock=\"{clock}\", detrend=\"mean\"{})",
        literal(recording),
        list(&inputs),
        list(&outputs),
        stretch.collect::<String>()
    );
    let of_method: &[&str] = match method {
        "arx" => &["na", "nb", "nk"],
        "armax" => &["na", "nb", "nc", "nk"],
        "oe" => &["nb", "nf", "nk"],
        _ => &["nb", "nc", "nd", "nf", "nk"],
    };
    let mut arguments = String::new();
    for (name, usual) in orders.iter().filter(|(name, _)| of_method.contains(name)) {
        let order = given.value(name).unwrap_or(usual);
        // An order without a usual value is left to the command.
        match order {
            "" => return None,
            several if several.contains(',') => arguments.push_str(&format!(", {name}=[{several}]")),
            one => arguments.push_str(&format!(", {name}={one}")),
        }
    }
    let saved = given.value("out").map_or(String::new(), |out| format!(".save({}, overwrite=True)", literal(out)));
    given.all_in(format!("dynoid.fit.{method}({data}{arguments}){saved}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(command: &str) -> String {
        line(&command.split(' ').map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn exact_commands_have_their_calls() {
        assert_eq!(of("study a/bench.toml --full"), r#"dynoid.Study.run("a/bench.toml", out="a/study", full=True)"#);
        assert_eq!(of("shaft bench.toml"), r#"dynoid.Bench("bench.toml").shaft()"#);
        assert_eq!(
            of("fit oe run.mf4 --input=u --output=y --from=2 --nf=1 --out=m.json"),
            "dynoid.fit.oe(dynoid.read(\"run.mf4\").dataset(u=[\"u\"], y=[\"y\"], clock=\"fastest\", detrend=\"mean\", \
             start=2), nb=2, nf=1, nk=1).save(\"m.json\", overwrite=True)"
        );
    }

    #[test]
    fn exact_a_command_with_more_than_its_call_stays_a_command() {
        for command in ["shaft bench.toml run.mf4", "shaft bench.toml --plot=a.html", "fit oe run.mf4 --output=y"] {
            assert!(of(command).starts_with("subprocess.run([\"dynoid\", "), "{command}");
        }
    }
}
