//! One page in every shape.

use page::{
    Align, Axis, Block, Card, Cell, Figure, Finding, Layer, Page, Panel, Prose, Quantity, Screen, Style, Table, Tone,
    html, json, markdown, terminal,
};

fn figure() -> Figure {
    let x: Vec<f64> = (0..40).map(|n| 0.1 * f64::from(n)).collect();
    let y: Vec<f64> = x.iter().map(|t| t.sin()).collect();
    let layers =
        vec![Layer::dots("measured", Style::Measured, &x, &y), Layer::curve("modelled", Style::Modelled, &x, &y)];
    Figure::new("Torque T_d", Axis::time(), vec![Panel::new(Axis::linear("T_d", "Nm"), 120, layers)])
        .with_caption("Measured T_d in bs_1.mf4.")
}

fn table() -> Table {
    let columns =
        [("", Align::Left), ("Parameter", Align::Left), ("Estimate", Align::Right), ("95 % interval", Align::Right)];
    let row = |symbol: &str, name: &str, quantity: Quantity| -> Vec<Cell> {
        vec![Prose::symbol(symbol).into(), name.into(), quantity.clone().into(), Cell::interval(quantity)]
    };
    let mut table = Table::new(&columns).with_rows([
        row("K", "stiffness", Quantity::within(2438.0, (2426.0, 2450.0), "Nm/rad")),
        row("J_d", "inertia", Quantity::exact(0.35, "kg m²")),
    ]);
    table.note("as the bench file states it");
    table
}

pub(crate) fn page() -> Page {
    let finding = Finding {
        tone: Tone::Caution,
        severity: "warning".to_owned(),
        text: "T_d is clipped.".into(),
        remedy: Some("Lower the demand.".into()),
        places: vec!["bs_1.mf4, at 12.35 s".to_owned()],
    };
    let cards = vec![
        Card {
            label: Prose::symbol("K").then(" stiffness"),
            value: Ok(Quantity::within(2438.0, (2426.0, 2450.0), "Nm/rad")),
        },
        Card { label: Prose::symbol("B").then(" damping"), value: Err("needs BS_T_NT".into()) },
    ];
    let blocks = vec![
        Block::Callout {
            tone: Tone::Good,
            kicker: "Verdict".to_owned(),
            title: "The model is good".to_owned(),
            blocks: vec![Block::paragraph("All rules are met.")],
        },
        Block::Cards { items: cards },
        Block::section(
            "shaft",
            "Shaft",
            vec![
                Block::lead("It carries torque when it is twisted, see WhiteNoise_T_TN."),
                Block::equation("T_shaft = {K + B s}/{s} Δω"),
                Block::Table(table()),
                Block::List { items: vec!["one".into(), Prose::code("bs_1.mf4")] },
                Block::note("A remark with 5 % in it."),
                Block::Figure(figure()),
                Block::Finding(finding),
                Block::Definitions { items: vec![(Prose::symbol("T_d*"), "the demand".into())] },
                Block::Fold {
                    summary: "Details".into(),
                    blocks: vec![Block::Preformatted { text: "a = 1\n".to_owned() }],
                },
            ],
        ),
    ];
    Page::new("Bench <1>", blocks)
}

#[test]
fn snap_terminal() {
    insta::assert_snapshot!(terminal(&page(), Screen { width: 72, colour: false, is_narrow: true }));
}

#[test]
fn snap_markdown() {
    insta::assert_snapshot!(markdown(&page()));
}

#[test]
fn snap_html() {
    let page = html(&page(), "dynoid 1.0");
    let main = page.split("<main>").nth(1).and_then(|rest| rest.split("</main>").next()).unwrap_or_default();
    let drawing =
        main.split("<div class=\"stage\">").nth(1).and_then(|rest| rest.split("</div>").next()).unwrap_or_default();
    insta::assert_snapshot!(main.replace(drawing, "…"));
}

#[test]
fn exact_json_is_the_model_itself() {
    let data: serde_json::Value = serde_json::from_str(&json(&page()).unwrap()).unwrap();
    assert_eq!(data["title"], "Bench <1>");
    let estimate = &data["blocks"][2]["blocks"][2]["rows"][0]["cells"][2]["content"]["quantity"];
    assert_eq!((&estimate["value"], &estimate["unit"]), (&2438.0.into(), &"Nm/rad".into()));
    assert_eq!(estimate["uncertainty"]["interval"], serde_json::json!([2426.0, 2450.0]));
}

#[test]
fn exact_a_page_without_scripts_holds_the_whole_figure() {
    let page = html(&page(), "dynoid 1.0");
    let drawing = page.split("<div class=\"stage\">").nth(1).and_then(|rest| rest.split("</div>").next()).unwrap();
    assert!(drawing.contains("<path d=\"M") && drawing.contains("class=\"tick\""), "{drawing}");
    assert!(drawing.contains("role=\"img\"") && drawing.contains("aria-label=\"Torque T_d. Measured"), "{drawing}");
    assert!(drawing.contains("<desc>T_d [Nm] over time [s]. T_d, measured: −0.688 to 1 Nm."), "{drawing}");
}

#[test]
fn exact_columns_have_headings_a_reader_of_the_screen_finds() {
    let page = html(&page(), "dynoid 1.0");
    assert_eq!(page.matches("<th scope=\"col\"").count(), 3);
    assert!(page.contains("<nav aria-label=\"Contents\">") && page.contains("href=\"#shaft\""));
    assert!(page.contains("<html lang=\"en\">"));
}

#[test]
fn exact_outside_text_is_escaped() {
    let hostile = "<script>alert(1)</script>";
    let page = Page::new(hostile, vec![Block::paragraph(hostile), Block::heading(Prose::code(hostile))]);
    assert!(!html(&page, "dynoid").contains("<script>alert"));
    let screen = terminal(
        &Page::new("", vec![Block::paragraph("\u{1b}[31mred")]),
        Screen { width: 80, colour: false, is_narrow: true },
    );
    assert!(!screen.contains('\u{1b}'), "{screen:?}");
}

#[test]
fn exact_colour_is_used_where_it_is_welcome() {
    let shown = |colour| terminal(&page(), Screen { width: 80, colour, is_narrow: true });
    assert!(shown(true).contains('\u{1b}') && !shown(false).contains('\u{1b}'));
}

#[test]
fn snap_a_table_fits_the_terminal_in_columns_or_below_each_other() {
    let mut table = page::Table::of_text(&["Recording", "Why it was chosen", "Value"]);
    let text = "a_recording_with_a_long_name_and_a_number_4711.mf4";
    table.row([
        text.into(),
        "because it moves the torque by itself and is long enough".into(),
        "12.5 Nm/(rad/s²)".into(),
    ]);
    for width in [40, 60, 80, 200] {
        let page = Page::new("", vec![Block::Table(table.clone())]);
        let shown = terminal(&page, Screen { width, colour: false, is_narrow: true });
        let widest = shown.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(widest <= width, "{widest} of {width}: {shown}");
        let together: String = shown.split_whitespace().collect();
        for words in ["moves", "12.5", "/(rad/s²)"] {
            assert!(together.contains(words), "{words} at {width}: {shown}");
        }
    }
}

#[test]
fn exact_messages_keep_their_lines_and_their_indent() {
    assert_eq!(page::folded("one two three\n  four five six", 11), "one two\nthree\n  four five\n  six");
    assert_eq!(page::folded("a/long/path/to", 8), "a/long/\npath/to");
}

/// A comment of a recording may be megabytes without a space.
#[test]
fn regress_a_long_line_is_folded_in_a_time_that_grows_with_its_length() {
    let folded = page::folded(&"x".repeat(2_000_000), 100);
    assert!(folded.lines().count() == 20_000 && folded.lines().all(|line| line.len() == 100));
}
