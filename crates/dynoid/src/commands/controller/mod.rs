//! `dynoid controller`: the speed controller.

mod noise_test;

use bench::estimate::speed_controller::{FeedForwardTerms, Round, TermTest};
use bench::speed_control::{
    Controller, ControllerRecording, FeedForwardFound, FeedForwardRecording, SpeedControl, speed_control,
};
use bench::study::Validation;
use bench::torque_signals::Told;
use bench::units::RPM_RAD_S;
use page::{Align, Table, Tone};
use report::controller::{
    M_IS_UNTOLD, bends, delay, figures, improvement, limits, negligible, probability, round, rules, structure, term,
    untold, untold_terms, verdict,
};
use report::wording::number;
use serde_json::{Value, json};

use super::experiments::{self, Campaign, print_parameters};
use super::identify::judge::{picture, written};
use crate::cli::GivenRecordings;
use crate::cli::controller::{ControllerArguments, ControllerCommand};
use crate::cli::identify::ResultArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &ControllerArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    match (&arguments.command, &arguments.given) {
        (Some(ControllerCommand::NoiseTest(arguments)), _) => noise_test::run(arguments, terminal),
        (None, Some(given)) => identify(given, &arguments.result, terminal),
        (None, None) => {
            Err(CliError::Usage { what: "name a bench file; `dynoid controller --help` has examples".into() })
        }
    }
}

fn identify(given: &GivenRecordings, result: &ResultArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let Campaign { bench, experiments, refused } = experiments::all((given, result), terminal)?;
    let progress = terminal.progress(experiments.len() as u64);
    let found = speed_control(&experiments.iter().collect::<Vec<_>>(), &bench, &mut |file| {
        progress.say(&format!("looking at the speed controller in {file}"));
        progress.step();
    });
    drop(progress);
    if found.controllers.is_empty() {
        return Err(CliError::NoHeldSpeed { path: given.bench.clone() });
    }
    picture(result, "Speed controller", || figures(&found))?;
    if result.json {
        terminal.json(&short(&found, &refused))?;
    } else if !terminal.is_quiet() {
        found.controllers.iter().for_each(|one| print_controller(one, terminal));
        found.feed_forward.iter().for_each(|one| print_feed_forward(one, terminal));
        print_rest(&found, terminal);
        written(&result.plot, terminal);
    }
    let tells = found.controllers.iter().any(|one| one.found.found().is_some());
    Ok(Outcome::of(tells, &refused))
}

/// The results without the samples of T_d*.
fn short(found: &SpeedControl, refused: &[String]) -> Value {
    let controllers: Vec<Value> = found.controllers.iter().map(short_controller).collect();
    let feed_forward: Vec<Value> = found.feed_forward.iter().map(short_feed_forward).collect();
    json!({"controllers": controllers, "feed_forward": feed_forward, "limits": found.limits, "refused": refused})
}

fn short_controller(one: &ControllerRecording) -> Value {
    let found = match &one.found {
        Told::Found(c) => json!({"found": {
            "with_delay": c.with_delay, "without_delay": c.without_delay,
            "validation": without_traces(&c.validation),
            "validation_without_delay": without_traces(&c.validation_without_delay),
            "si": c.si, "discrete": c.discrete, "structure": c.structure,
        }}),
        Told::Untold(why) => json!({"untold": why}),
    };
    json!({"file": one.file, "label": one.label, "found": found})
}

fn short_feed_forward(one: &FeedForwardRecording) -> Value {
    let found = match &one.found {
        Told::Found(f) => json!({"found": {
            "estimate": f.straight.estimate, "validation": without_traces(&f.straight.validation),
            "pi_alone": without_traces(&f.straight.pi_alone), "terms": f.terms,
        }}),
        Told::Untold(why) => json!({"untold": why}),
    };
    json!({"file": one.file, "label": one.label, "found": found})
}

fn without_traces(validation: &Validation) -> Value {
    json!({
        "stretch": validation.stretch, "quantity": validation.quantity, "unit": validation.unit,
        "fit_percent": validation.fit_percent, "rms_error": validation.rms_error, "residuals": validation.residuals,
        "share_outside": validation.residuals.as_ref().map(bench::study::ResidualTest::share_outside),
    })
}

fn print_controller(one: &ControllerRecording, terminal: &mut Terminal) {
    terminal.heading(&format!("{}, {}", one.file, one.label), Tone::Strong);
    match &one.found {
        Told::Found(found) => print_found(found, terminal),
        Told::Untold(why) => terminal.line(&format!("speed controller: {}", untold(why))),
    }
    terminal.gap();
}

fn print_found(found: &Controller, terminal: &mut Terminal) {
    let columns = [
        ("symbol", Align::Left),
        ("PI alone", Align::Right),
        ("PI and delay", Align::Right),
        ("95 % interval", Align::Right),
        ("what it is", Align::Left),
    ];
    let mut table = Table::new(&columns);
    for p in &found.with_delay.parameters {
        let alone = found.without_delay.parameter(&p.symbol).map_or_else(|| "–".to_owned(), number::parameter);
        let (value, interval) = (number::parameter(p), number::interval(p));
        table.row([p.symbol.clone().into(), alone.into(), value.into(), interval.into(), p.name.clone().into()]);
    }
    for p in found.si.iter().chain(&found.discrete.coefficients.parameters) {
        let (value, interval) = (number::parameter(p), number::interval(p));
        table.row([p.symbol.clone().into(), "".into(), value.into(), interval.into(), p.name.clone().into()]);
    }
    terminal.table(&table);
    terminal.paragraph(&delay(found));
    let every = number::duration(found.discrete.sample_time_s);
    terminal.paragraph(&format!(
        "Discrete form, every {every}: T_d*(k) = T_d*(k − 1) + b_0 e(k) + b_1 e(k − 1), e the speed error τ ago. {}",
        rules(found)
    ));
    match &found.structure {
        Told::Found(tested) => {
            print_rounds("PI and delay", &tested.rounds, terminal);
            terminal.paragraph(&structure(tested));
            if let Some(with) = &tested.with_terms {
                let values = with.parameters.iter().map(|p| format!("{} = {}", p.symbol, number::parameter(p)));
                terminal.paragraph(&format!("Together: {}.", values.collect::<Vec<_>>().join(", ")));
            }
        }
        Told::Untold(why) => terminal.paragraph(&format!("terms beside PI and delay: {}", untold(why))),
    }
}

/// Each round's tests, and what is to be said of the last ones.
fn print_rounds(base: &str, rounds: &[Round], terminal: &mut Terminal) {
    for one in rounds {
        terminal.gap();
        terminal.line(&format!("{}:", round(base, one)));
        print_tests(&one.tests, terminal);
    }
    let last = rounds.last().map(|round| round.tests.as_slice()).unwrap_or_default();
    untold_terms(last).iter().chain(&negligible(last)).for_each(|text| terminal.paragraph(text));
}

fn print_tests(tests: &[TermTest], terminal: &mut Terminal) {
    let columns = [
        ("term", Align::Left),
        ("", Align::Left),
        ("estimate (95 %)", Align::Right),
        ("explains of N_d", Align::Right),
        ("p (Holm)", Align::Right),
        ("", Align::Left),
    ];
    let mut table = Table::new(&columns);
    for test in tests {
        let estimate = test.estimate.as_ref();
        let explains = number::significant_with_unit(test.explains_rad_s / RPM_RAD_S, 2, "rpm");
        table.row([
            term(test.term).into(),
            estimate.map_or_else(String::new, |p| p.symbol.clone()).into(),
            estimate.map_or_else(|| "–".to_owned(), number::parameter).into(),
            if estimate.is_some() || test.p_value < 1.0 { explains } else { "–".to_owned() }.into(),
            if test.p_value < 1.0 { probability(test.adjusted_p_value) } else { "–".to_owned() }.into(),
            verdict(test).into(),
        ]);
    }
    terminal.table(&table);
}

fn print_feed_forward(one: &FeedForwardRecording, terminal: &mut Terminal) {
    terminal.heading(&format!("{}, {}: feed-forward", one.file, one.label), Tone::Strong);
    match &one.found {
        Told::Found(found) => print_feed_forward_found(found, terminal),
        Told::Untold(why) => terminal.line(&untold(why)),
    }
    terminal.gap();
}

fn print_feed_forward_found(found: &FeedForwardFound, terminal: &mut Terminal) {
    print_parameters(&found.straight.estimate.parameters, terminal);
    terminal.paragraph(&improvement(found));
    match &found.terms {
        Told::Found(terms) => {
            print_rounds("k and k_a", &terms.rounds, terminal);
            terminal.paragraph(&bends(terms));
            print_map(terms, terminal);
        }
        Told::Untold(why) => terminal.paragraph(&untold(why)),
    }
}

fn print_map(terms: &FeedForwardTerms, terminal: &mut Terminal) {
    if terms.map.is_empty() {
        return;
    }
    let columns =
        [("N_d*", Align::Right), ("feed-forward above the lowest", Align::Right), ("beyond straight", Align::Right)];
    let mut table = Table::new(&columns);
    let shown = |value: f64, (low, high): (f64, f64)| match high > low {
        true => number::plus_minus(value, 0.5 * (high - low), "Nm"),
        false => "–".to_owned(),
    };
    for point in &terms.map {
        table.row([
            number::rpm(point.speed_rad_s).into(),
            shown(point.torque_nm, point.interval_nm).into(),
            shown(point.bend_nm, point.bend_interval_nm).into(),
        ]);
    }
    terminal.table(&table);
}

/// Limits, and what no recording tells.
fn print_rest(found: &SpeedControl, terminal: &mut Terminal) {
    terminal.heading("Limit of T_d*", Tone::Strong);
    limits(found).iter().for_each(|text| terminal.paragraph(text));
    terminal.gap();
    if found.feed_forward.is_empty() {
        terminal.paragraph("No recording moves N_d*, so that the feed-forward is untold; run Levels_N_NT.");
    }
    terminal.paragraph(M_IS_UNTOLD);
}
