//! The page as a whole: self-contained, small, and closed against text from outside.

use std::ops::ControlFlow;

use bench_model::model::ModelUncertainty;
use rig::results::Outcome;
use study::Study;

use crate::fixture;

/// The text of each element opened by `open`, up to `close`.
fn elements<'a>(page: &'a str, open: &str, close: &str) -> Vec<&'a str> {
    page.split(open).skip(1).filter_map(|rest| rest.split(close).next()).collect()
}

fn figures(page: &str) -> Vec<&str> {
    elements(page, "<figure class=\"plot\">", "</figure>")
}

#[test]
fn exact_every_figure_is_drawn_without_scripts_and_said_in_words() {
    let page = fixture::html(&fixture::complete());
    let figures = figures(&page);
    assert!(figures.len() >= 15, "{} figures", figures.len());
    for figure in figures {
        assert!(figure.contains("<g class=\"panel\"") && figure.contains("<path d=\"M"), "{figure}");
        assert!(figure.contains("role=\"img\" aria-label=\"") && figure.contains("<desc>"), "{figure}");
        let label = elements(figure, "aria-label=\"", "\"")[0];
        let title = elements(figure, "<title>", "</title>")[0];
        assert!(label.len() > title.len() + 10, "the result is said too: {label}");
    }
    let diagram = elements(&page, "<figure class=\"diagram\" aria-label=\"", "\"")[0];
    assert!(diagram.contains("Nm/rad") && diagram.contains("rad/s"), "{diagram}");
}

#[test]
fn exact_page_needs_no_network() {
    let page = fixture::html(&fixture::complete());
    let without_namespaces = page.replace("http://www.w3.org/2000/svg", "");
    for word in ["http://", "https://", "src=", "@import", "url(//", "fetch(", "XMLHttpRequest"] {
        assert!(!without_namespaces.contains(word), "{word}");
    }
}

#[test]
fn exact_page_of_a_large_study_stays_small() {
    let size = fixture::html(&fixture::complete()).len();
    assert!(size < 3_000_000, "{size} bytes");
}

#[test]
fn exact_links_lead_somewhere() {
    for study in [fixture::complete(), fixture::bare()] {
        let page = fixture::html(&study);
        for target in elements(&page, "href=\"#", "\"") {
            assert!(page.contains(&format!("id=\"{target}\"")), "{target}");
        }
    }
}

/// Every tag that is opened is closed in order; `script` and `style` are taken as they are.
fn is_well_formed(page: &str) -> bool {
    const EMPTY: [&str; 8] = ["meta", "br", "!DOCTYPE", "path", "rect", "circle", "line", "hr"];
    let mut open: Vec<&str> = Vec::new();
    let mut rest = page;
    while let Some((_, behind)) = rest.split_once('<') {
        let Some((tag, after)) = behind.split_once('>') else { return false };
        let name = tag.trim_start_matches('/').split([' ', '\n', '/']).next().unwrap_or_default();
        rest = after;
        if tag.starts_with('/') {
            if open.pop() != Some(name) {
                return false;
            }
        } else if name == "script" || name == "style" {
            let Some((_, after)) = rest.split_once(&format!("</{name}>")) else { return false };
            rest = after;
        } else if !EMPTY.contains(&name) {
            open.push(name);
        }
    }
    open.is_empty()
}

#[test]
fn exact_tags_are_balanced() {
    assert!(is_well_formed(&fixture::html(&fixture::complete())));
    assert!(is_well_formed(&fixture::html(&fixture::bare())));
}

const HOSTILE: [&str; 6] = [
    "</script><script>alert(1)</script>",
    "\"><img src=x onerror=alert(1)>",
    "' onmouseover='alert(1)",
    "<!--<script>",
    "]]></style></pre><b>",
    "\u{202e}4fm.gnp\u{0}\u{7}",
];

#[test]
fn exact_outside_text_cannot_leave_its_place() {
    let harmless = skeleton(&fixture::html(&fixture::hostile("x")));
    for text in HOSTILE {
        let page = fixture::html(&fixture::hostile(text));
        assert!(is_well_formed(&page), "{text}");
        assert_eq!(skeleton(&page), harmless, "{text}");
        assert!(!page.contains('\u{202e}') && !page.contains('\u{0}'));
    }
}

/// The names of the page's tags in order: what hostile text would change.
fn skeleton(page: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut rest = page;
    let _ = std::iter::repeat(()).try_for_each(|()| {
        let Some((_, behind)) = rest.split_once('<') else { return ControlFlow::Break(()) };
        let name: String = behind.chars().take_while(|c| c.is_alphanumeric() || "/!".contains(*c)).collect();
        rest = match name.as_str() {
            "script" => behind.split_once("</script>").map_or("", |(_, after)| after),
            _ => behind,
        };
        names.push(name);
        ControlFlow::Continue(())
    });
    names
}

/// A study with NaN or infinity wherever a curve or a number can hold one.
fn with_non_finite(mut study: Study) -> Study {
    if let Outcome::Estimated(shaft) = &mut study.shaft {
        shaft.validation.fit_percent = f64::NAN;
        shaft.validation.measured.values[100] = f64::NAN;
        shaft.validation.modelled.values[5000] = f64::INFINITY;
        shaft.frequency_response.measured_gain_db[3] = f64::NEG_INFINITY;
        shaft.residual_spectrum.bound = f64::NAN;
        shaft.estimate.parameters[0].value = f64::NAN;
        shaft.estimate.parameters[1].interval = (f64::NEG_INFINITY, f64::INFINITY);
    }
    if let Outcome::Estimated(whole) = &mut study.whole {
        whole.resonance_hz.value = f64::INFINITY;
        whole.resonance_hz.interval = (f64::NAN, f64::NAN);
        whole.sine_points[0].gain = 0.0;
        whole.bode[0].gain_db[0] = f64::NAN;
    }
    study
}

#[test]
fn exact_numbers_that_are_not_finite_are_null_or_not_known() {
    let study = with_non_finite(fixture::complete());
    let page = fixture::html(&study);
    let body = page.split("<script>").next().unwrap_or_default();
    // Packed samples are letters that can spell anything.
    let samples = elements(body, "class=\"samples\"", "</script>");
    let body = samples.iter().fold(body.to_owned(), |body, packed| body.replace(packed, ""));
    assert!(!body.contains("NaN") && !body.contains("inf "));
    assert!(body.contains("not known"));
    assert!(
        serde_json::from_str::<serde_json::Value>(&page::json(&report::study(&study, &fixture::origin())).unwrap())
            .is_ok()
    );
    let json: serde_json::Value = serde_json::from_str(&study::document::json(&study, None)).unwrap();
    assert!(json["study"]["shaft"]["validation"]["fit_percent"].is_null());
}

#[test]
fn exact_json_names_its_format_and_keeps_full_precision() {
    let study = fixture::complete();
    let json: serde_json::Value = serde_json::from_str(&study::document::json(&study, None)).unwrap();
    assert_eq!(json["format"], "dynoid-study");
    assert_eq!(json["format_version"], study::document::FORMAT_VERSION);
    let gain = json["study"]["speed_controller"]["estimate"]["parameters"][0]["value"].as_f64().unwrap();
    // From SI to Nm/rpm, which rounds once.
    assert!((gain / 0.93841 - 1.0).abs() < 4.0 * f64::EPSILON, "{gain}");
    assert_eq!(json["study"]["shaft"]["status"], "estimated");
}

#[test]
fn snap_a_report_states_when_and_from_what_it_was_made_and_whose_it_is() {
    let mut study = fixture::complete();
    let page = fixture::html(&study);
    for words in
        ["studied on 2018-05-06", "of 2018-05-03 to 2018-05-04", "0123456789abcdef0123", "page \" counter(page)"]
    {
        assert!(page.contains(words), "{words}");
    }
    study.provenance.report.title = Some("Shaft of the new coupling".into());
    study.provenance.report.test_id = Some("T-17".into());
    study.provenance.report.customer = Some("Gearbox team".into());
    study.provenance.report.confidentiality = Some("internal".into());
    let page = fixture::html(&study);
    assert!(page.contains("<h1>Shaft of the new coupling</h1>"));
    for words in [
        "test T-17",
        "for Gearbox team",
        "internal",
        "Test cell 4",
        "internal · Shaft of the new coupling · T-17 · 2018-05-06",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn snap_the_first_section_has_the_verdict_its_range_six_numbers_a_replay_and_what_to_do() {
    let page = fixture::html(&fixture::complete());
    let first = page.split("<section id=\"known\">").next().unwrap_or_default();
    assert_eq!(first.matches("class=\"card").count() - first.matches("class=\"cards\"").count(), 6);
    for words in [
        "Valid for",
        "993 to 2005 rpm",
        "Next:",
        "Worst replay of an unseen recording",
        "How the verdict was reached</summary>",
    ] {
        assert!(first.contains(words), "{words}: {first}");
    }
    assert_eq!(first.matches("<figure class=\"plot\"").count(), 1);
}

#[test]
fn exact_the_summary_of_any_study_is_one_page_of_paper() {
    let mut many = fixture::complete();
    many.provenance.report.title = Some("Shaft of the new coupling, second campaign".into());
    many.provenance.report.customer = Some("Gearbox team".into());
    many.provenance.report.confidentiality = Some("internal".into());
    for study in [fixture::complete(), many, fixture::bare(), fixture::hostile("a long text without any sense, ")] {
        let summary = report::summary_page(&study, &fixture::origin());
        for paper in [page::Paper::A4, page::Paper::Letter] {
            let options = page::PdfOptions { paper, on_one_page: true, ..page::PdfOptions::default() };
            let bytes = page::pdf(&summary, &options).unwrap();
            let count = bytes.windows(12).filter(|window| window.starts_with(b"/Type/Page/")).count();
            assert_eq!(count, 1, "{}", study.bench.name);
        }
    }
    let text = page::markdown(&report::summary_page(&fixture::complete(), &fixture::origin()));
    for words in ["Valid for", "993 to 2005 rpm", "Next:", "stiffness", "Worst replay of an unseen recording"] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn exact_the_model_of_a_study_is_read_back() {
    let study = fixture::complete();
    assert!(study.model.as_ref().is_some_and(|model| model.uncertainty != ModelUncertainty::default()));
    assert_eq!(study::model(&study::document::json(&study, None)).as_ref(), Ok(study.model.as_ref().unwrap()));
}

#[test]
fn regress_what_holds_no_model_is_refused_in_words() {
    let words = |text: &str| study::model(text).unwrap_err().to_string();
    let json = study::document::json(&fixture::complete(), None);
    assert!(
        words(&json.replace("\"format_version\":3", "\"format_version\":7"))
            .contains("version 7, where 2 to 3 are read")
    );
    assert!(words(&json.replace("dynoid-study", "dynoid model")).contains("its `format` is “dynoid model”"));
    assert!(words("{}").contains("neither a bench model nor a study"));
    assert!(words(&json[..json.len() / 2]).contains("the file ends in the middle"));
    assert!(words(&study::document::json(&fixture::bare(), None)).contains("holds no bench model"));
}
