//! Ranges of text.

use std::fmt::Write;
use std::sync::Arc;

use proptest::prelude::*;
use recording::{Recording, RecordingError, Selection, Span, decode, encode_csv, open};
use work::Context;

use crate::handle::{Counted, assert_parts, assert_same, middle, noisy, part, span};

/// How a text is written.
#[derive(Debug, Clone)]
struct Style {
    delimiter: char,
    has_comma: bool,
    line_end: &'static str,
    encoding: usize,
    clock: usize,
    has_row_numbers: bool,
    is_ended: bool,
}

fn style() -> impl Strategy<Value = Style> {
    let separation = prop::sample::select(vec![(',', false), (';', false), (';', true), ('\t', true), ('|', false)]);
    let line_end = prop::sample::select(vec!["\n", "\r\n", "\r"]);
    (separation, line_end, 0..4_usize, 0..CLOCKS.len(), any::<bool>(), any::<bool>()).prop_map(
        |((delimiter, has_comma), line_end, encoding, clock, has_row_numbers, is_ended)| Style {
            delimiter,
            has_comma,
            line_end,
            encoding,
            clock,
            has_row_numbers,
            is_ended,
        },
    )
}

/// A heading of a clock, and its stamp in a row, of which one is each 2 ms.
type Clock = (&'static str, fn(usize) -> String);

const CLOCKS: [Clock; 8] = [
    ("time [s]", |row| format!("{:.4}", row as f64 * 2e-3)),
    // Out of order.
    ("time [ms]", |row| format!("{}.5", 2 * (row ^ 5))),
    ("time", |row| (10 * row).to_string()),
    ("time [ms]", |row| (1_700_000_000_000 + 2 * row as u64).to_string()),
    ("time", |row| {
        let ms = (86_399_500 + 2 * row) % 86_400_000;
        format!("{}:{:02}:{:02}.{:03}", ms / 3_600_000, ms / 60_000 % 60, ms / 1000 % 60, ms % 1000)
    }),
    ("time", |row| format!("2026-11-21T12:{:02}:{:02}.{:03}", row / 30_000, row / 500 % 60, 2 * row % 1000)),
    ("time [excel]", |row| format!("{:.12}", 46_000.25 + row as f64 * 2e-3 / 86_400.0)),
    // A step back.
    ("time [s]", |row| format!("{:.4}", (row - row / 400 * 100) as f64 * 2e-3)),
];

/// Numbers, words for missing ones, integers too large to be exact, text in quotes, columns that begin late or hold
/// nothing, comments and empty lines, and a second clock that ends earlier.
fn text(style: &Style, rows: usize) -> String {
    let (heading, stamp) = CLOCKS[style.clock];
    let cell = |text: String| if style.has_comma { text.replace('.', ",") } else { text };
    let delimiter = style.delimiter.to_string();
    // Days of spreadsheets are a clock in the first column.
    let has_row_numbers = style.has_row_numbers && heading != "time [excel]";
    let mut headings = vec![heading, "a µ [Nm]", "n", "state", "late", "empty", "time [s]", "b"];
    if has_row_numbers {
        headings.insert(0, "");
    }
    // The clocks of both blocks have to be alike.
    let has_second = heading == "time [s]";
    headings.truncate(headings.len() - if has_second { 0 } else { 2 });
    let mut lines = vec![headings.join(&delimiter)];
    for row in 0..rows {
        let mut cells = vec![cell(stamp(row))];
        cells.push(match row % 31 {
            30 => "n/a".into(),
            29 => String::new(),
            _ => cell(format!("{}.25", row % 1000)),
        });
        cells.push(if row % 401 == 400 { "9007199254740993".into() } else { (row % 7).to_string() });
        cells.push(match row % 5 {
            0 => format!("\"two{}lines\"", style.line_end),
            1 => format!("\"one {delimiter} \"\"more\"\"\""),
            2 => "\"".into(),
            _ => "plain".into(),
        });
        cells.push(if row < 300 { String::new() } else { cell(format!("-{row}.5")) });
        cells.push(String::new());
        if has_second {
            let is_there = row < rows / 3;
            let stamp = cell(format!("{:.4}", row as f64 * 6e-3));
            cells.extend(
                [(is_there, stamp), (is_there, row.to_string())].map(|(is, s)| if is { s } else { String::new() }),
            );
        }
        if has_row_numbers {
            cells.insert(0, (row + 1).to_string());
        }
        lines.push(cells.join(&delimiter));
        match row % 60 {
            20 => lines.push("# a note".into()),
            40 => lines.push(String::new()),
            _ => {}
        }
    }
    let mut text = lines.join(style.line_end);
    if style.is_ended {
        text.push_str(style.line_end);
    }
    text
}

fn encoded(text: &str, encoding: usize) -> Vec<u8> {
    match encoding {
        0 => text.as_bytes().to_vec(),
        1 => [b"\xEF\xBB\xBF", text.as_bytes()].concat(),
        2 => text.chars().map(|c| u32::from(c) as u8).collect(),
        _ => [0xFEFF].into_iter().chain(text.encode_utf16()).flat_map(u16::to_be_bytes).collect(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn prop_ranges_of_text_are_parts_of_the_whole(
        style in style(), rows in 1_usize..1300, spans in prop::collection::vec(span(), 1..5),
    ) {
        let bytes = encoded(&text(&style, rows), style.encoding);
        assert_parts(&format!("{style:?}"), &bytes, None, &spans);
    }

    #[test]
    fn prop_ranges_of_text_without_a_clock_are_parts_of_the_whole(
        rows in 1_usize..1300, is_blank in any::<bool>(), spans in prop::collection::vec(span(), 1..5),
    ) {
        let delimiter = if is_blank { "  " } else { "," };
        let bytes: String = (0..rows).map(|row| format!("{row}.5{delimiter}-{row}\n")).collect();
        assert_parts("a.dat", bytes.as_bytes(), Some(2e-3), &spans);
    }
}

/// Time of day goes on past midnight, wherever reading begins.
#[test]
fn exact_ranges_past_midnight() {
    let style = Style {
        delimiter: ';',
        has_comma: false,
        line_end: "\n",
        encoding: 0,
        clock: 4,
        has_row_numbers: false,
        is_ended: true,
    };
    let text = text(&style, 1200);
    let spans = [(86_399.6, 86_400.4), (86_400.1, 86_401.0)].map(|(from_s, to_s)| Span::Time { from_s, to_s });
    assert_parts("a.csv", text.as_bytes(), None, &spans);
    let handle = open("a.csv", Arc::new(text.into_bytes()), None, &Context::new()).unwrap();
    let read = handle.read(&Selection::names(["n"]), &spans[1], &Context::new()).unwrap();
    assert_eq!((read.rasters[0].time_s.len(), read.rasters[0].time_s[0]), (451, 86_400.1));
}

/// After the pass that makes the index, a range takes the text of its rows, of any selection.
#[test]
fn exact_of_text_a_range_reads_what_it_must() {
    let recording = noisy(400_000);
    let bytes = encode_csv(&recording).unwrap();
    let (span, _) = middle(&recording);
    let whole = decode("a.csv", &bytes, &Selection::All).unwrap();
    let size = bytes.len() as u64;
    let source = Counted::new(bytes);
    let handle = open("a.csv", source.clone(), None, &Context::new()).unwrap();
    handle.read(&Selection::names(["x3"]), &Span::Rows(0..1), &Context::new()).unwrap();
    source.taken();
    let read = handle.read(&Selection::All, &span, &Context::new()).unwrap();
    let taken = source.taken();
    assert_same(&read, &part(&whole, &span), "a.csv");
    // 2 s are 0.25 % of the first clock; on each the search takes some 256 rows for each halving.
    assert!(taken < size / 20, "{taken} of {size} bytes were read");
}

/// Reads of a column and of all, from the whole and in part.
fn outcomes(text: &str, channel: Option<&str>) -> [Result<Recording, RecordingError>; 2] {
    let selection = channel.map_or(Selection::All, |channel| Selection::names([channel]));
    let handle = open("a.csv", Arc::new(text.as_bytes().to_vec()), None, &Context::new()).unwrap();
    let span = Span::Rows(0..usize::MAX as u64);
    [decode("a.csv", text.as_bytes(), &selection), handle.read(&selection, &span, &Context::new())]
}

/// A column that cannot be read is no obstacle to others, and a sign in text counts where the text is not selected.
#[test]
fn regress_ranges_of_text_fail_where_the_whole_does() {
    let mut spoilt = String::from("time [s],a,b\n");
    let mut doubtful = String::from("time [s];a;b\n");
    let mut words = String::from("time [s];a;b\n");
    for row in 0..600 {
        writeln!(spoilt, "{row},{row},{}", if row == 500 { "x".into() } else { row.to_string() }).unwrap();
        writeln!(doubtful, "{row};{row};{}", if row > 300 { "1,5" } else { "x" }).unwrap();
        writeln!(words, "{row};1.500;{}", if row > 300 { "0.5" } else { "x" }).unwrap();
    }
    for text in [spoilt, doubtful, words] {
        for channel in [None, Some("a"), Some("b"), Some("c")] {
            let [whole, part] = outcomes(&text, channel);
            match (whole, part) {
                (Ok(whole), Ok(part)) => assert_same(&part, &whole, "a.csv"),
                (whole, part) => assert_eq!(part.map(|_| ()), whole.map(|_| ()), "{channel:?}"),
            }
        }
    }
}
