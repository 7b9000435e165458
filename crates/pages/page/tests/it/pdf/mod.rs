//! Pages on paper.

mod reader;

use page::{
    Align, Axis, Block, Card, Cell, Day, Figure, Finding, Layer, Logo, Page, Panel, Paper, PdfOptions, Prose, Quantity,
    Style, Table, Tone, Weight, pdf, without_glyph,
};

use crate::renderers;
use reader::{Pdf, value};

fn options(paper: Paper) -> PdfOptions {
    let created = Day::parse("2026-05-03");
    PdfOptions {
        paper,
        generator: "dynoid test".to_owned(),
        author: "A. Meyer".to_owned(),
        created,
        on_one_page: false,
    }
}

fn written(page: &Page, paper: Paper) -> Pdf {
    let bytes = pdf(page, &options(paper)).unwrap();
    assert_eq!(bytes, pdf(page, &options(paper)).unwrap(), "the same page gives the same bytes");
    Pdf::read(&bytes)
}

/// Everything drawn lies between the margins; heads and feet lie on the paper.
fn assert_inside(pdf: &Pdf, paper: Paper) {
    let (width, height) = if paper == Paper::A4 { (595.28, 841.89) } else { (612.0, 792.0) };
    for (number, page) in pdf.pages().into_iter().enumerate() {
        let drawn = pdf.drawn(page);
        assert!(!drawn.is_empty(), "page {number} is empty");
        for one in drawn {
            let [left, low, right, high] = one.area;
            let (bottom, top) = if one.is_edge { (20.0, height - 20.0) } else { (52.0, height - 54.0) };
            let is_inside = left >= 46.0 && right <= width - 46.0 && low >= bottom && high <= top;
            assert!(is_inside, "page {number} of {paper:?}: {one:?}");
        }
    }
}

/// Sections with blocks, each after a paragraph.
fn sections(blocks: Vec<Vec<Block>>) -> Page {
    let section = |(n, mut blocks): (usize, Vec<Block>)| {
        blocks.insert(0, Block::lead("What this section is about."));
        Block::section(format!("part-{n}"), format!("Part {n}"), blocks)
    };
    let page = Page::new("A report", blocks.into_iter().enumerate().map(section).collect());
    Page { running_head: "A report · confidential".to_owned(), ..page }
}

fn table_of(rows: usize) -> Table {
    let row = |n: usize| -> Vec<Cell> {
        vec![format!("row {n}").into(), Quantity::within(2438.0, (2426.0, 2450.0), "Nm/rad").into()]
    };
    Table::new(&[("Name", Align::Left), ("Estimate", Align::Right)]).with_rows((0..rows).map(row))
}

#[test]
fn exact_the_document_names_title_author_language_and_day() {
    let pdf = written(&renderers::page(), Paper::A4);
    let information = pdf.with("/Title(Bench <1>)").next().unwrap();
    assert!(
        information.contains("/Author(A. Meyer)") && information.contains("/CreationDate(D:20260503"),
        "{information}"
    );
    let catalog = pdf.with("/Type/Catalog").next().unwrap();
    assert!(catalog.contains("/Lang(en)") && catalog.contains("/MarkInfo<</Marked true"), "{catalog}");
    assert!(pdf.text.contains("Bench &lt;1&gt;"));
}

#[test]
fn exact_every_kind_of_block_is_in_it_as_text() {
    let text = written(&renderers::page(), Paper::A4).all_text();
    let wanted = [
        "Bench <1>",
        "VERDICT",
        "The model is good",
        "All rules are met.",
        "Shaft",
        "It carries torque",
        "WhiteNoise_T_TN",
        "Tshaft",
        "stiffness",
        "as the bench file states it",
        "bs_1.mf4",
        "A remark with 5\u{a0}% in it.",
        "Torque Td",
        "measured",
        "Measured Td in bs_1.mf4.",
        "warning",
        "Lower the demand.",
        "at 12.35 s",
        "the demand",
        "Details",
        "a\u{a0}=\u{a0}1",
        "not estimated",
        "needs",
    ];
    for words in wanted {
        assert!(text.contains(words), "{words} is not in {text}");
    }
}

#[test]
fn exact_the_structure_has_headings_lists_table_cells_figures_and_formulas() {
    let pdf = written(&renderers::page(), Paper::A4);
    let count = |role: &str| pdf.with("/Type/StructElem").filter(|element| value(element, "/S") == Some(role)).count();
    for role in [
        "/Document",
        "/H1",
        "/H2",
        "/P",
        "/L",
        "/LI",
        "/Lbl",
        "/LBody",
        "/Table",
        "/THead",
        "/TR",
        "/TH",
        "/TD",
        "/Caption",
    ] {
        assert!(count(role) > 0, "{role}");
    }
    assert_eq!((count("/H1"), count("/Figure"), count("/Formula"), count("/TH")), (1, 1, 1, 3));
    let figure = pdf.with("/S/Figure").next().unwrap();
    assert!(figure.contains("/Alt") && figure.contains("/BBox"), "{figure}");
    assert!(pdf.with("/S/Formula").all(|formula| formula.contains("/Alt")));
    assert!(pdf.with("/S/TH/").all(|cell| cell.contains("/Scope/Column")));
}

#[test]
fn exact_fonts_are_embedded_in_parts_and_can_be_read_as_text() {
    let pdf = written(&renderers::page(), Paper::A4);
    assert_eq!(pdf.with("/FontFile2").count(), 3);
    assert_eq!(pdf.with("/ToUnicode").count(), 3);
    assert!(pdf.text.len() < 100_000, "{} bytes", pdf.text.len());
}

#[test]
fn exact_characters_that_the_fonts_lack_are_named_once_each() {
    let texts = |title: &str, text: &str| Page {
        title: title.to_owned(),
        blocks: vec![Block::paragraph(text.to_owned())],
        ..Page::default()
    };
    assert_eq!(without_glyph(&texts("ω_d in µs — “Prüfstand”", "Испытание, δοκιμή, 1 → 2")).unwrap(), "");
    assert_eq!(without_glyph(&texts("試験", "験台")).unwrap(), "台試験");
}

#[test]
fn exact_contents_bookmarks_and_links_lead_to_the_pages_of_sections() {
    let long = || vec![Block::heading("A heading"), Block::Table(table_of(60))];
    let mut page = sections((0..5).map(|_| long()).collect());
    let link =
        Prose::from("See ").then(Prose::link("the last part", "#part-4")).then(Prose::link(" or nothing", "#none"));
    page.blocks.insert(0, Block::paragraph(link));
    let pdf = written(&page, Paper::A4);
    let pages = pdf.pages();
    assert!(pages.len() >= 6, "{}", pages.len());
    let begins = |n: usize| format!("Part {n}What this section is about.");
    let starts: Vec<usize> =
        (0..5).map(|n| pages.iter().position(|page| pdf.page_text(page).contains(&begins(n))).unwrap()).collect();
    let contents = pdf.drawn(pages[starts[0]]).into_iter().chain(pdf.drawn(pages[starts[0] + 1]));
    let shown: Vec<String> =
        contents.filter(|one| !one.is_edge).map(|one| one.text).filter(|text| !text.is_empty()).collect();
    for (n, start) in starts.iter().enumerate() {
        let listed = shown.windows(2).any(|two| two[0] == format!("Part {n}") && two[1] == (start + 1).to_string());
        assert!(listed, "part {n} is on page {}: {shown:?}", start + 1);
    }
    assert_eq!(
        pdf.with("/Parent").filter(|object| object.contains("/Title(Part ") && object.contains("/Dest[")).count(),
        5
    );
    assert_eq!(pdf.with("/Title(A heading)").count(), 5);
    let links: Vec<&str> = pdf.with("/Subtype/Link").collect();
    assert_eq!(links.len(), 6, "five entries and one link; what leads nowhere is none");
    assert!(links.iter().all(|link| link.contains("/StructParent ") && link.contains("/Contents(")), "{links:?}");
}

#[test]
fn exact_pages_have_head_program_and_number() {
    let pdf = written(&sections(vec![vec![Block::Table(table_of(200))]]), Paper::Letter);
    let count = pdf.pages().len();
    for (number, page) in pdf.pages().into_iter().enumerate() {
        let edge: String = pdf.drawn(page).into_iter().filter(|one| one.is_edge).map(|one| one.text).collect();
        assert_eq!(edge, format!("A report · confidentialdynoid testpage {} of {count}", number + 1));
    }
}

#[test]
fn exact_a_long_table_repeats_its_headings_and_cuts_no_row() {
    let pdf = written(&sections(vec![vec![Block::Table(table_of(200))]]), Paper::A4);
    let pages = pdf.pages();
    assert!(pages.len() >= 3);
    for page in &pages {
        assert_eq!(pdf.page_text(page).matches("Estimate").count(), 1);
    }
    let rows: Vec<String> = (0..200).map(|n| format!("row {n}")).collect();
    let shown: Vec<String> = pages
        .iter()
        .flat_map(|page| pdf.drawn(page))
        .map(|one| one.text)
        .filter(|text| text.starts_with("row "))
        .collect();
    assert_eq!(shown, rows);
}

#[test]
fn exact_a_short_table_and_a_figure_stay_on_one_page() {
    let x: Vec<f64> = (0..50).map(f64::from).collect();
    let panel = Panel::new(
        Axis::linear("y", "Nm"),
        200,
        vec![Layer::curve("a", Style::Modelled, &x, &x), Layer::curve("b", Style::Measured, &x, &x)],
    );
    let figure = Figure::new("The title", Axis::time(), vec![panel]).with_caption("The caption.");
    for lines in 20..52 {
        let filler = vec![Block::List { items: (0..lines).map(|_| "filler".into()).collect() }];
        let page = Page::new("", [filler, vec![Block::Table(table_of(6)), Block::Figure(figure.clone())]].concat());
        let pdf = written(&page, Paper::A4);
        let of = |words: &str| pdf.pages().iter().position(|page| pdf.page_text(page).contains(words)).unwrap();
        assert_eq!(of("row 0"), of("row 5"), "{lines}");
        assert_eq!((of("The title"), of("time [s]")), (of("The caption."), of("The title")), "{lines}");
    }
}

/// A page of the worst content that it may have.
fn hostile() -> Page {
    let word = "ein_sehr_langes_Wort/".repeat(60);
    let signs = "😀 汉字 שלום עולם \u{202e}evil\u{202c} \u{0} a\u{301} \u{fe0f} 🇩🇪 \t\u{7f}";
    let texts = [word.as_str(), signs, "", " ", "\u{a0}"];
    let headings: Vec<String> = (0..12).map(|n| format!("heading {n} of_a_wide_table")).collect();
    let columns: Vec<(&str, Align)> = headings.iter().map(|heading| (heading.as_str(), Align::Right)).collect();
    let many: Vec<(&str, Align)> = (0..90).map(|_| ("column", Align::Left)).collect();
    let wide = |columns: &[(&str, Align)]| {
        let cells = |_| columns.iter().map(|_| Cell::from("123.456 Nm/(rad/s²)")).collect::<Vec<Cell>>();
        let mut table = Table::new(columns).with_rows((0..30).map(cells));
        table.note(&word);
        Block::Table(table)
    };
    let mut blocks = vec![wide(&columns), wide(&many), Block::Table(Table::new(&[])), Block::Table(table_of(0))];
    for text in texts {
        let prose = || Prose::verbatim(text);
        let tags = Prose::tag(Tone::Bad, text).then(Prose::code(text)).then(Prose::link(text, "https://example.org"));
        let finding = Finding {
            tone: Tone::Bad,
            severity: text.into(),
            text: prose(),
            remedy: Some(tags.clone()),
            places: vec![text.into()],
        };
        let row: Vec<Cell> = vec![prose().into(), tags.clone().into(), text.repeat(40).into()];
        blocks.extend([
            Block::heading(prose()),
            Block::lead(Prose::strong(text)),
            Block::Paragraph { text: tags, weight: Weight::Note },
            Block::equation(format!("T_shaft = {{K + {text}}}/{{s}} ^({text})")),
            Block::List { items: vec![prose(), Prose::default()] },
            Block::Definitions { items: vec![(prose(), prose())] },
            Block::Cards {
                items: vec![
                    Card { label: prose(), value: Err(prose()) },
                    Card { label: prose(), value: Ok(Quantity::exact(f64::NAN, text)) },
                ],
            },
            Block::Table(Table::of_text(&[text, "b", text]).with_rows([row])),
            Block::Finding(finding),
            Block::Preformatted { text: format!("{text}\n\n   {text}") },
            Block::Callout {
                tone: Tone::Caution,
                kicker: text.into(),
                title: text.into(),
                blocks: vec![Block::Fold { summary: prose(), blocks: vec![Block::Table(table_of(80))] }],
            },
        ]);
        let layers = vec![
            Layer::dots(text, Style::Measured, &[0.0, 1.0], &[f64::NAN, 1.0]),
            Layer::dots("b", Style::Other, &[], &[]),
        ];
        let figure = Figure::new(text, Axis::linear(text, text), vec![Panel::new(Axis::log(text, text), 900, layers)])
            .with_caption(text.repeat(9));
        blocks.extend([Block::Figure(figure.clone()), Block::Row { figures: vec![figure.clone(), figure] }]);
    }
    let title = format!("{word} {signs}");
    let all = Page::new(title.clone(), blocks.clone());
    let sections = vec![
        Block::section("a", &title, blocks),
        Block::section("b", "", vec![]),
        Block::section("c", "C", vec![]),
        Block::section("d", "D", vec![]),
    ];
    Page {
        subtitle: Prose::verbatim(title.repeat(30)),
        running_head: title,
        blocks: [all.blocks, sections].concat(),
        ..all
    }
}

#[test]
fn regress_nothing_leaves_the_page_and_what_has_no_glyph_is_seen() {
    for paper in [Paper::A4, Paper::Letter] {
        let pdf = written(&hostile(), paper);
        assert_inside(&pdf, paper);
        let text = pdf.all_text();
        assert!(
            text.contains('\u{fffd}') && text.contains("😀") && text.contains("שלום"),
            "what there is a glyph for is shown"
        );
        assert_eq!(text.matches("汉").count(), 0);
    }
}

#[test]
fn exact_what_is_to_be_on_one_page_is_set_smaller() {
    let page = Page::new("Much", vec![Block::section("a", "A", vec![Block::Table(table_of(70))])]);
    assert_eq!(written(&page, Paper::A4).pages().len(), 2);
    let bytes = pdf(&page, &PdfOptions { on_one_page: true, ..options(Paper::A4) }).unwrap();
    let pdf = Pdf::read(&bytes);
    assert_eq!(pdf.pages().len(), 1);
    assert!(pdf.pages()[0].contains("/MediaBox[0 0 595.28 841.89]"), "{}", pdf.pages()[0]);
    assert!(pdf.all_text().contains("row 69"));
    assert_inside(&pdf, Paper::A4);
}

#[test]
fn exact_an_empty_page_is_a_page() {
    let pdf = written(&Page::default(), Paper::A4);
    assert_eq!(pdf.pages().len(), 1);
    assert_inside(&pdf, Paper::A4);
}

#[test]
fn exact_a_picture_at_the_top_is_shown_and_described() {
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='40' height='10'><rect width='40' height='10' fill='red'/></svg>";
    let logo = Logo::read(svg.as_bytes().to_vec()).unwrap();
    let page = Page { logo: Some(logo), ..renderers::page() };
    let pdf = written(&page, Paper::A4);
    assert_inside(&pdf, Paper::A4);
    assert_eq!(pdf.with("/Subtype/Image").count(), 2, "the picture, and how opaque it is");
    assert!(pdf.with("/S/Figure").any(|figure| figure.contains("/Alt(Logo)")));
    assert!(page::html(&page, "").contains("<img class=\"logo\" src=\"data:image/svg+xml;base64,PHN2Zy"));
}

#[test]
fn regress_a_file_that_is_no_logo_is_refused_with_a_remedy() {
    let mut huge = page::png(&[Figure::new("", Axis::time(), vec![])]).unwrap();
    huge[16..20].copy_from_slice(&60_000_u32.to_be_bytes());
    let jpeg = [0xff, 0xd8, 0xff, 0xc0, 0, 17, 8, 0, 10, 0, 10, 4];
    let cases = [
        (b"GIF89a".to_vec(), "PNG, JPEG or SVG"),
        (vec![0; 2 << 20], "save it smaller"),
        (huge, "scale it down"),
        (b"\x89PNG".to_vec(), "ends early"),
        (b"\xff\xd8\xff".to_vec(), "no frame"),
        (jpeg.to_vec(), "RGB or grey"),
        (b"<svg".to_vec(), "save it anew"),
    ];
    for (bytes, words) in cases {
        let error = Logo::read(bytes).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}
