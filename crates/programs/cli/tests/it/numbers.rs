//! Report, terminal and JSON of a study give the same numbers.

use page::Quantity;
use serde_json::Value;

use crate::full_report::white_noise_alone;
use crate::support::{Campaign, simulated, text, white_noise};
use rig::experiment::ExperimentPlan;

/// Headings below which a report gives other routes to a number, each named so.
const OTHER_ROUTES: [&str; 4] = [
    "Delay alone",
    "What ignoring the timing would give",
    "Other recordings and methods",
    "The inertias estimated from the data",
];

/// A row of a table: the last heading or the summary of a fold above it, and its cells.
struct Row {
    heading: String,
    cells: Vec<String>,
}

/// Texts between the start of a tag and its end, one after the other.
fn between<'a>(page: &'a str, start: &'a str, end: &'a str) -> impl Iterator<Item = &'a str> {
    page.split(start).skip(1).filter_map(move |rest| rest.split(end).next())
}

fn rows(page: &str) -> Vec<Row> {
    let (mut heading, mut all) = (String::new(), Vec::new());
    for (n, part) in page.split("<h3>").flat_map(|part| part.split("<summary>")).enumerate() {
        if n > 0 {
            let end = ["</h3>", "</summary>"].iter().filter_map(|end| part.find(end)).min();
            heading = text(&part[..end.unwrap_or(0)]);
        }
        for row in between(part, "<tr>", "</tr>") {
            let cells = between(row, "<td", "</td>").map(|cell| text(&format!("<td{cell}"))).collect();
            all.push(Row { heading: heading.clone(), cells });
        }
    }
    all
}

/// An estimate of the study as the pages write it: symbol, name, value with its interval.
struct Written {
    symbol: String,
    name: String,
    quantity: Quantity,
}

fn written(estimate: &Value) -> Written {
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{estimate}"));
    let interval = (number(&estimate["interval"][0]), number(&estimate["interval"][1]));
    let word = |field: &str| estimate[field].as_str().unwrap_or_else(|| panic!("{estimate}")).to_owned();
    let quantity = Quantity::within(number(&estimate["value"]), interval, &word("unit"));
    Written { symbol: word("symbol"), name: word("name"), quantity }
}

/// Every row of a report about an estimate, but for those of other routes and of single recordings, has its value.
/// Returns how many rows it compared.
fn compare_rows(page: &str, estimates: &[Written]) -> usize {
    let is_other = |row: &Row| OTHER_ROUTES.contains(&&*row.heading) || row.heading.contains("recordings/");
    let own: Vec<Row> = rows(page).into_iter().filter(|row| !is_other(row)).collect();
    let mut compared = 0;
    for Written { symbol, name, quantity } in estimates {
        let is_about = |row: &&Row| {
            let [first, second, _, ..] = row.cells.as_slice() else { return false };
            first == symbol && (second == name || second.ends_with(&format!(": {name}")))
        };
        for row in own.iter().filter(is_about) {
            if row.cells[2].contains(['±', '+']) {
                assert_eq!(row.cells[2], quantity.text(), "{name}, below “{}”: {:?}", row.heading, row.cells);
                compared += 1;
            }
        }
    }
    compared
}

/// The cards of the first page give the same to fewer digits.
fn compare_cards(page: &str, estimates: &[Written]) -> usize {
    let cards: Vec<String> = between(page, "<p class=\"name\">", "</div>").map(text).collect();
    let has = |card: &&String, quantity: &Quantity| {
        let short = quantity.short().expect("an interval");
        card.contains(&format!("{} {}", short.value, short.unit)) && card.contains(&short.interval)
    };
    for card in cards.iter().filter(|card| !card.contains("not estimated")) {
        assert!(estimates.iter().any(|one| has(&card, &one.quantity)), "no estimate is that of the card “{card}”");
    }
    cards.len()
}

/// A number as it is written is the number that it stands for, but for its last digit.
#[track_caller]
fn assert_written(written: &str, number: f64) {
    let plain: f64 = written.replace('−', "-").parse().unwrap_or_else(|_| panic!("`{written}` is no number"));
    let decimals = written.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let half = 0.5 * 10f64.powi(-i32::try_from(decimals).unwrap());
    assert!((plain - number).abs() <= 1.001 * half, "{written} for {number}");
}

/// The fits of the replays, signal by signal.
fn compare_replays(page: &str, study: &Value) -> usize {
    let all = rows(page);
    let mut compared = 0;
    for replay in study["study"]["replays"].as_array().unwrap() {
        let file = replay["stretch"]["file"].as_str().unwrap();
        let row = all
            .iter()
            .find(|row| row.cells.len() > 3 && row.cells[1].starts_with(file))
            .unwrap_or_else(|| panic!("no {file}"));
        for signal in replay["signals"].as_array().unwrap() {
            let name = signal["quantity"].as_str().unwrap();
            let fits = row.cells[3].split(", ").flat_map(|fits| fits.split(" and "));
            let mut named = fits.filter_map(|fit| fit.strip_prefix(name)?.trim().strip_suffix('%'));
            let fit = named.next().unwrap_or_else(|| panic!("{name} of {file}: {:?}", row.cells));
            assert_written(fit.trim(), signal["fit_percent"].as_f64().unwrap());
            compared += 1;
        }
    }
    compared
}

/// The sentence of a page that starts so.
fn sentence<'a>(text: &'a str, start: &str) -> &'a str {
    let from = text.find(start).unwrap_or_else(|| panic!("no `{start}` in {text}"));
    let end = text[from..].find(". ").map_or(text.len(), |end| from + end);
    &text[from..end]
}

/// Checks that the interval of a term contains zero where it is not significant, and does not where it is found.
/// Returns how many it compared.
fn compare_verdicts(page: &str) -> usize {
    let number = |text: &str| -> f64 { text.trim().replace('−', "-").parse().unwrap_or_else(|_| panic!("`{text}`")) };
    let mut compared = 0;
    for row in rows(page) {
        let Some(verdict) = row.cells.last().filter(|last| ["not significant", "found"].contains(&last.as_str()))
        else {
            continue;
        };
        let (low, rest) = row.cells[row.cells.len() - 2].split_once('…').unwrap_or_else(|| panic!("{:?}", row.cells));
        let high = rest.trim().split(' ').next().unwrap();
        let has_zero = number(low.trim_start_matches('(')) <= 0.0 && number(high.trim_end_matches([')', '%'])) >= 0.0;
        assert_eq!(has_zero, verdict == "not significant", "{:?}", row.cells);
        compared += 1;
    }
    compared
}

/// Compares all that a study says. Returns how many rows of the report, cards and fits it compared.
fn compare(campaign: &Campaign, report: &str) -> [usize; 3] {
    let json = campaign.run(&["study", "bench.toml", "--json"]).study();
    let terminal = campaign.run(&["study", "bench.toml", "--all"]).stdout;
    let terminal = terminal.split_whitespace().collect::<Vec<_>>().join(" ");
    let estimates: Vec<Written> = json["estimates"].as_array().unwrap().iter().map(written).collect();
    let page = campaign.read(report);
    for Written { symbol, name, quantity } in &estimates {
        let line = format!("{symbol} {} {name}", quantity.text());
        assert!(terminal.contains(&line), "`{line}` is not on the terminal:\n{terminal}");
    }
    let plain = text(&page);
    for start in ["Valid for speeds", "Next: "] {
        if terminal.contains(start) {
            assert_eq!(sentence(&terminal, start).replace('`', ""), sentence(&plain, start).replace('`', ""));
        }
    }
    let headline = json["verdict"]["headline"].as_str().unwrap();
    assert!(terminal.contains(headline) && plain.contains(headline), "{headline}");
    compare_model(campaign, &page, &estimates);
    let study: Value = serde_json::from_str(&campaign.read("study/study.json")).unwrap();
    [compare_rows(&page, &estimates), compare_cards(&page, &estimates), compare_replays(&page, &study)]
}

/// The numbers of model.json are those of the estimates, and the report lists them.
fn compare_model(campaign: &Campaign, page: &str, estimates: &[Written]) {
    if !campaign.path("study/model.json").is_file() {
        return;
    }
    let model: Value = serde_json::from_str(&campaign.read("study/model.json")).unwrap();
    let all = rows(page);
    let listed: Vec<&Row> =
        all.iter().filter(|row| row.heading == "The numbers of the model" && row.cells.len() == 4).collect();
    for one in model["parameters"].as_array().unwrap() {
        let name = one["name"].as_str().unwrap();
        let row = listed.iter().find(|row| row.cells[1] == name).unwrap_or_else(|| panic!("the report has no {name}"));
        if let Some(own) = estimates.iter().find(|own| own.name == name) {
            assert_eq!(row.cells[2], own.quantity.text(), "{name}");
        }
        if one["unit"] == "kg m²" {
            let value = row.cells[2].split(' ').next().unwrap();
            assert_written(value, one["value"].as_f64().unwrap());
        }
    }
}

#[test]
fn exact_report_terminal_and_json_give_the_same_numbers() {
    let whole = Campaign::whole()
        .with("Levels_N_NT_1200.mf4", &simulated(&ExperimentPlan::levels_n_nt(1200.0, 20.0), 3))
        .with("Ramp_N_NT_1200.mf4", &simulated(&ExperimentPlan::ramp_n_nt(1200.0, 10.0), 4));
    let [rows, cards, fits] = compare(&whole, "study/report.html");
    assert!(rows > 25 && cards == 6 && fits >= 4, "{rows} rows, {cards} cards, {fits} fits");
    let noise_alone = Campaign::empty().with("WhiteNoise_T_TN_1200.mf4", &white_noise());
    let [rows, cards, _] = compare(&noise_alone, "study/report.html");
    assert!(rows > 12 && cards == 6, "{rows} rows, {cards} cards");
}

#[test]
fn exact_the_full_report_gives_the_numbers_of_the_study() {
    let [rows, cards, _] = compare(white_noise_alone(), "study/report-full.html");
    assert!(rows > 12 && cards == 6, "{rows} rows, {cards} cards");
    let verdicts = compare_verdicts(&white_noise_alone().read("study/report-full.html"));
    assert!(verdicts > 4, "{verdicts} verdicts");
}
