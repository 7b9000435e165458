//! Reads the PDFs of this crate: objects, text with its places, and where lines and areas are.

use std::collections::BTreeMap;
use std::io::Read as _;

/// A file in its objects: the text of each, and its stream.
pub(super) struct Pdf {
    objects: BTreeMap<usize, (String, Vec<u8>)>,
    /// The whole file, as text.
    pub(super) text: String,
}

/// Something drawn: left, lower end, right, upper end; and its text.
#[derive(Debug, Clone)]
pub(super) struct Drawn {
    pub(super) area: [f64; 4],
    pub(super) text: String,
    /// True if it is a head or foot of the page.
    pub(super) is_edge: bool,
}

/// A font: width and text of each glyph.
#[derive(Default)]
struct Font {
    widths: Vec<f64>,
    texts: BTreeMap<usize, String>,
}

/// Text behind a key, up to the next blank, slash or bracket.
pub(super) fn value<'t>(text: &'t str, key: &str) -> Option<&'t str> {
    let start = text.find(&format!("{key} ")).or_else(|| text.find(&format!("{key}/")))? + key.len();
    let rest = text[start..].trim_start();
    let length = rest[1..].find(['/', '>', '[', ']', '\n', '(']).map_or(rest.len(), |end| end + 1);
    Some(rest[..length].trim())
}

fn reference(text: &str, key: &str) -> Option<usize> {
    value(text, key)?.strip_suffix(" 0 R")?.parse().ok()
}

impl Pdf {
    pub(super) fn read(bytes: &[u8]) -> Self {
        let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
        let start: usize = text.rsplit("startxref\n").next().unwrap().lines().next().unwrap().parse().unwrap();
        let offsets =
            text[bytes_to_chars(&text, start)..].lines().skip(2).take_while(|line| !line.starts_with("trailer"));
        let used: Vec<usize> =
            offsets.filter(|line| line.contains(" n")).map(|line| line[..10].parse().unwrap()).collect();
        let objects = used.iter().map(|offset| object(bytes, *offset)).collect();
        Pdf { objects, text }
    }

    pub(super) fn object(&self, id: usize) -> &str {
        &self.objects[&id].0
    }

    /// Objects with a text in them.
    pub(super) fn with<'p>(&'p self, text: &'p str) -> impl Iterator<Item = &'p str> {
        self.objects.values().map(|(object, _)| object.as_str()).filter(move |object| object.contains(text))
    }

    /// The pages in order.
    pub(super) fn pages(&self) -> Vec<&str> {
        let tree = self.with("/Type/Pages").next().unwrap();
        let kids = tree.split("/Kids[").nth(1).unwrap().split(']').next().unwrap();
        kids.split(" 0 R").filter_map(|id| id.trim().parse().ok()).map(|id| self.object(id)).collect()
    }

    fn fonts(&self) -> BTreeMap<String, Font> {
        let resources =
            self.with("/ExtGState").chain(self.with("/Font<<")).find(|object| object.contains("/Font<<")).unwrap();
        let fonts = resources.split("/Font<<").nth(1).unwrap().split(">>").next().unwrap();
        fonts
            .split('/')
            .filter_map(|entry| entry.split_once(' '))
            .map(|(name, id)| (name.to_owned(), self.font(id.trim_end_matches(" 0 R").trim().parse().unwrap())))
            .collect()
    }

    fn font(&self, id: usize) -> Font {
        let font = self.object(id);
        let cid = font.split("/DescendantFonts[").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        let widths = self.object(cid).split("/W[0[").nth(1).unwrap().split(']').next().unwrap();
        let characters = reference(font, "/ToUnicode").unwrap();
        let map = String::from_utf8(inflated(&self.objects[&characters].1)).unwrap();
        Font {
            widths: widths.split(' ').map(|width| width.parse().unwrap()).collect(),
            texts: map.lines().filter_map(mapping).collect(),
        }
    }

    /// Everything that a page draws, in order.
    pub(super) fn drawn(&self, page: &str) -> Vec<Drawn> {
        let content = inflated(&self.objects[&reference(page, "/Contents").unwrap()].1);
        let fonts = self.fonts();
        let mut reader = Reader {
            fonts: &fonts,
            all: Vec::new(),
            state: State::default(),
            kept: Vec::new(),
            operands: Vec::new(),
            path: Vec::new(),
            edges: 0,
            marks: Vec::new(),
            clips: false,
        };
        for token in tokens(&content) {
            reader.take(token);
        }
        assert!(reader.kept.is_empty() && reader.marks.is_empty(), "every state and every mark is closed");
        reader.all
    }

    /// The text of a page, heads and feet aside.
    pub(super) fn page_text(&self, page: &str) -> String {
        self.drawn(page).iter().filter(|drawn| !drawn.is_edge).map(|drawn| drawn.text.as_str()).collect()
    }

    /// All text.
    pub(super) fn all_text(&self) -> String {
        self.pages().iter().map(|page| self.page_text(page)).collect()
    }
}

/// Each byte is a character here.
fn bytes_to_chars(text: &str, bytes: usize) -> usize {
    text.char_indices().nth(bytes).map_or(text.len(), |(at, _)| at)
}

fn object(bytes: &[u8], offset: usize) -> (usize, (String, Vec<u8>)) {
    let find =
        |text: &[u8]| bytes[offset..].windows(text.len()).position(|window| window == text).map(|at| offset + at);
    let end = find(b"endobj").unwrap();
    let stream = find(b"stream\n").filter(|at| *at < end);
    let text: String = bytes[offset..stream.unwrap_or(end)].iter().map(|byte| char::from(*byte)).collect();
    let id = text.split(' ').next().unwrap().parse().unwrap();
    let content = stream.map_or_else(Vec::new, |at| {
        let length: usize = value(&text, "/Length").unwrap().parse().unwrap();
        bytes[at + 7..at + 7 + length].to_vec()
    });
    (id, (text, content))
}

fn inflated(bytes: &[u8]) -> Vec<u8> {
    let mut all = Vec::new();
    flate2::read::ZlibDecoder::new(bytes).read_to_end(&mut all).unwrap();
    all
}

/// A line `<0005> <0041>` of a map from glyphs to text.
fn mapping(line: &str) -> Option<(usize, String)> {
    let (glyph, text) = line.strip_prefix('<')?.split_once("> <")?;
    let units: Vec<u16> = text.strip_suffix('>')?.as_bytes().chunks(4).map(hex).collect::<Option<_>>()?;
    Some((usize::from_str_radix(glyph, 16).ok()?, String::from_utf16(&units).ok()?))
}

fn hex(digits: &[u8]) -> Option<u16> {
    u16::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
}

enum Token {
    Number(f64),
    Bytes(Vec<u8>),
    Name(String),
    Dictionary(String),
    Operator(String),
}

/// The tokens of a content stream; an array counts as nothing.
fn tokens(content: &[u8]) -> Vec<Token> {
    let mut all = Vec::new();
    let mut rest = content;
    while let Some(first) = rest.first() {
        let until = |end: &[u8]| rest.windows(end.len()).position(|window| window == end).unwrap() + end.len();
        let length = match first {
            b' ' | b'\n' => 1,
            b'[' => until(b"]"),
            b'<' if rest.starts_with(b"<<") => {
                let length = until(b">>");
                all.push(Token::Dictionary(String::from_utf8_lossy(&rest[..length]).into_owned()));
                length
            }
            b'<' => {
                let length = until(b">");
                all.push(Token::Bytes(rest[1..length - 1].chunks(2).map(|two| hex(two).unwrap() as u8).collect()));
                length
            }
            b'(' => {
                let (bytes, length) = literal(rest);
                all.push(Token::Bytes(bytes));
                length
            }
            _ => {
                let is_end = |byte: &u8| b" \n[<(/".contains(byte);
                let length = rest[1..].iter().position(is_end).map_or(rest.len(), |at| at + 1);
                let word = String::from_utf8_lossy(&rest[..length]).into_owned();
                all.push(match (word.parse(), word.strip_prefix('/')) {
                    (Ok(number), _) => Token::Number(number),
                    (_, Some(name)) => Token::Name(name.to_owned()),
                    _ => Token::Operator(word),
                });
                length
            }
        };
        rest = &rest[length..];
    }
    all
}

/// The bytes of a string in brackets, and its length.
fn literal(text: &[u8]) -> (Vec<u8>, usize) {
    let (mut bytes, mut at, mut depth) = (Vec::new(), 1, 1);
    loop {
        match text[at] {
            b'\\' => {
                at += 1;
                let octal = text[at..].iter().take(3).take_while(|digit| digit.is_ascii_digit()).count();
                let digits = std::str::from_utf8(&text[at..at + octal]).unwrap();
                bytes.push(match text[at] {
                    _ if octal > 0 => u8::from_str_radix(digits, 8).unwrap(),
                    b'n' => b'\n',
                    b'r' => b'\r',
                    b't' => b'\t',
                    b'b' => 8,
                    b'f' => 12,
                    other => other,
                });
                at += octal.saturating_sub(1);
            }
            b')' if depth == 1 => return (bytes, at + 1),
            byte => {
                depth += i32::from(byte == b'(') - i32::from(byte == b')');
                bytes.push(byte);
            }
        }
        at += 1;
    }
}

type Matrix = [f64; 6];

fn times(a: Matrix, b: Matrix) -> Matrix {
    let [a0, a1, a2, a3, a4, a5] = a;
    let [b0, b1, b2, b3, b4, b5] = b;
    [
        a0 * b0 + a1 * b2,
        a0 * b1 + a1 * b3,
        a2 * b0 + a3 * b2,
        a2 * b1 + a3 * b3,
        a4 * b0 + a5 * b2 + b4,
        a4 * b1 + a5 * b3 + b5,
    ]
}

fn moved([a, b, c, d, e, f]: Matrix, (x, y): (f64, f64)) -> (f64, f64) {
    (a * x + c * y + e, b * x + d * y + f)
}

#[derive(Clone)]
struct State {
    matrix: Matrix,
    text: Matrix,
    font: (String, f64),
    clip: [f64; 4],
}

impl Default for State {
    fn default() -> Self {
        let unit = [1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        State { matrix: unit, text: unit, font: (String::new(), 0.0), clip: [-1e9, -1e9, 1e9, 1e9] }
    }
}

struct Reader<'f> {
    fonts: &'f BTreeMap<String, Font>,
    all: Vec<Drawn>,
    state: State,
    kept: Vec<State>,
    operands: Vec<Token>,
    path: Vec<(f64, f64)>,
    edges: usize,
    marks: Vec<bool>,
    clips: bool,
}

impl Reader<'_> {
    fn take(&mut self, token: Token) {
        match token {
            Token::Operator(operator) => {
                self.operate(&operator);
                self.operands.clear();
            }
            operand => self.operands.push(operand),
        }
    }

    fn numbers(&self) -> Vec<f64> {
        self.operands
            .iter()
            .filter_map(|token| if let Token::Number(number) = token { Some(*number) } else { None })
            .collect()
    }

    fn name(&self) -> String {
        self.operands
            .iter()
            .find_map(|token| if let Token::Name(name) = token { Some(name.clone()) } else { None })
            .unwrap()
    }

    fn operate(&mut self, operator: &str) {
        let numbers = self.numbers();
        let matrix = || <Matrix>::try_from(numbers.as_slice()).unwrap();
        match operator {
            "q" => self.kept.push(self.state.clone()),
            "Q" => self.state = self.kept.pop().unwrap(),
            "cm" => self.state.matrix = times(matrix(), self.state.matrix),
            "Tm" => self.state.text = matrix(),
            "Tf" => self.state.font = (self.name(), numbers[0]),
            "Tj" => self.show(),
            "re" => {
                let [x, y, width, height] = <[f64; 4]>::try_from(numbers.as_slice()).unwrap();
                for corner in [(x, y), (x + width, y), (x, y + height), (x + width, y + height)] {
                    self.path.push(moved(self.state.matrix, corner));
                }
            }
            "m" | "l" | "c" => {
                let points = numbers.chunks(2).map(|point| moved(self.state.matrix, (point[0], point[1])));
                self.path.extend(points);
            }
            "W" => self.clips = true,
            "n" | "f" | "f*" | "S" => self.end_path(operator != "n"),
            "Do" => {
                self.path = [(0.0, 0.0), (1.0, 1.0)].map(|corner| moved(self.state.matrix, corner)).to_vec();
                self.end_path(true);
            }
            "BDC" | "BMC" => {
                let is_edge = self
                    .operands
                    .iter()
                    .any(|token| matches!(token, Token::Dictionary(text) if text.contains("Pagination")));
                self.marks.push(is_edge);
                self.edges += usize::from(is_edge);
            }
            "EMC" => self.edges -= usize::from(self.marks.pop().unwrap()),
            _ => {}
        }
    }

    fn end_path(&mut self, is_drawn: bool) {
        let area = bounds(&std::mem::take(&mut self.path));
        let seen = self.seen(area);
        if std::mem::take(&mut self.clips) {
            self.state.clip = seen.unwrap_or([0.0; 4]);
        }
        if let (true, Some(seen)) = (is_drawn, seen) {
            self.push(seen, String::new());
        }
    }

    /// Part of an area that is not clipped.
    fn seen(&self, area: [f64; 4]) -> Option<[f64; 4]> {
        let [left, low, right, high] = self.state.clip;
        let seen = [area[0].max(left), area[1].max(low), area[2].min(right), area[3].min(high)];
        (seen[0] <= seen[2] && seen[1] <= seen[3]).then_some(seen)
    }

    fn push(&mut self, area: [f64; 4], text: String) {
        assert!(!self.marks.is_empty(), "what is drawn is marked: {text}");
        self.all.push(Drawn { area, text, is_edge: self.edges > 0 });
    }

    fn show(&mut self) {
        let bytes =
            self.operands.iter().find_map(|token| if let Token::Bytes(bytes) = token { Some(bytes) } else { None });
        let bytes = bytes.unwrap();
        let font = &self.fonts[&self.state.font.0];
        let size = self.state.font.1;
        let glyphs: Vec<usize> = bytes.chunks(2).map(|two| usize::from(two[0]) << 8 | usize::from(two[1])).collect();
        let width: f64 = glyphs.iter().map(|glyph| font.widths[*glyph] * size / 1000.0).sum();
        let text = glyphs.iter().map(|glyph| font.texts[glyph].as_str()).collect();
        let whole = times(self.state.text, self.state.matrix);
        let corners = [(0.0, -0.2 * size), (width, 0.75 * size)].map(|corner| moved(whole, corner));
        self.state.text = times([1.0, 0.0, 0.0, 1.0, width, 0.0], self.state.text);
        if let Some(seen) = self.seen(bounds(&corners)) {
            self.push(seen, text);
        }
    }
}

fn bounds(points: &[(f64, f64)]) -> [f64; 4] {
    points.iter().fold([1e9, 1e9, -1e9, -1e9], |[left, low, right, high], (x, y)| {
        [left.min(*x), low.min(*y), right.max(*x), high.max(*y)]
    })
}
