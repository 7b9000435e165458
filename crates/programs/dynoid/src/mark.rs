//! The marks by which results of this program are known, so that nothing else is written over.
//!
//! Pages, pictures and recordings name the program, the command and the version that made them; exported models and
//! manual pages the program; documents in JSON have their `format`. Text in columns and Arrow files have no mark.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use bench_model::document::{BenchModelDocument, format_of};
use ident::DocumentHeader;

use crate::files::Files;

const PROGRAM: &[u8] = b"dynoid ";
/// Bytes at the beginning of a file in which its mark is.
const HEAD: usize = 4096;
/// Bytes at the beginning in which files that name the program alone do so.
const PROGRAM_WITHIN: usize = 512;
/// Bytes at the end of a file in which its mark is, where the format has it there.
const TAIL: usize = 1 << 16;

/// Bytes that no bench file has.
const LARGEST_BENCH_FILE: u64 = 1 << 20;

/// Kind of a text, by its `format`; also where it cannot be read to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A bench model.
    Bench,
    /// A linear model.
    Linear,
    /// The data of a study.
    Study,
    /// Any other text.
    Other,
}

impl Kind {
    /// Of a text.
    pub fn of(text: &str) -> Self {
        match format_of(text) {
            Some(format) if BenchModelDocument::is_format(&format) => Kind::Bench,
            Some(format) if study::document::is_study(&format) => Kind::Study,
            Some(format) if DocumentHeader::is_format(&format) => Kind::Linear,
            _ => Kind::Other,
        }
    }
}

/// Statement of a file on its maker.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Mark {
    /// A command of this program, by its words.
    Command(String),
    /// This program.
    Program,
    /// A document in JSON.
    Document(Kind),
    /// A bench file, which people write too.
    BenchFile,
}

impl Mark {
    /// The mark of pages, pictures and recordings of a run.
    pub fn of_run(files: &Files) -> Self {
        Mark::Command(files.maker().to_owned())
    }

    /// Maker of files of this mark, in words.
    pub fn maker(&self) -> String {
        match self {
            Mark::Command(command) => format!("`dynoid {command}`"),
            Mark::Program => "dynoid".to_owned(),
            Mark::Document(Kind::Study | Kind::Bench) => "`dynoid study`".to_owned(),
            Mark::Document(_) => "`dynoid fit`".to_owned(),
            Mark::BenchFile => "you, or `dynoid init`,".to_owned(),
        }
    }

    /// The mark of a file; none where it has none, or cannot be read.
    pub fn of_file(path: &Path) -> Option<Self> {
        // Opening a pipe waits for who writes to it.
        let mut file = path.is_file().then(|| File::open(path).ok())??;
        let mut head = Vec::new();
        file.by_ref().take(HEAD as u64).read_to_end(&mut head).ok()?;
        let mut tail = Vec::new();
        let length = file.metadata().ok()?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(TAIL as u64))).ok()?;
        file.take(TAIL as u64).read_to_end(&mut tail).ok()?;
        match of_ends(&head, &tail) {
            // What `init` writes names the program too.
            None | Some(Mark::Program) if is_bench_file(path) => Some(Mark::BenchFile),
            found => found,
        }
    }

    /// The mark of what is to be written.
    pub fn of_content(content: &[u8]) -> Option<Self> {
        of_ends(&content[..content.len().min(HEAD)], &content[content.len().saturating_sub(TAIL)..])
    }
}

fn of_ends(head: &[u8], tail: &[u8]) -> Option<Mark> {
    if head.trim_ascii_start().starts_with(b"{") {
        let kind = Kind::of(&String::from_utf8_lossy(head));
        return (kind != Kind::Other).then_some(Mark::Document(kind));
    }
    if head.starts_with(b"MDF     ") && head.get(16..23) != Some(PROGRAM) {
        // Another program wrote it, from a file of this one.
        return None;
    }
    let is_marked_at_end = head.starts_with(b"%PDF") || head.starts_with(b"PAR1");
    let place = if is_marked_at_end { tail } else { head };
    let first = &head[..head.len().min(PROGRAM_WITHIN)];
    match generator(place) {
        Some(command) if !command.is_empty() => Some(Mark::Command(command)),
        Some(_) => Some(Mark::Program),
        None => first.windows(PROGRAM.len()).any(|bytes| bytes == PROGRAM).then_some(Mark::Program),
    }
}

/// The words between the name of the program and a version of it, such as `model bode` in `dynoid model bode 0.1.0`.
fn generator(bytes: &[u8]) -> Option<String> {
    let starts = bytes.windows(PROGRAM.len()).enumerate().filter(|(_, found)| *found == PROGRAM);
    starts.map(|(at, _)| &bytes[at + PROGRAM.len()..]).find_map(|rest| {
        let is_word = |byte: &u8| byte.is_ascii_lowercase() || b"- ".contains(byte);
        let words = rest.iter().take_while(|byte| is_word(byte)).count();
        let is_version = rest[words..].first().is_some_and(u8::is_ascii_digit)
            && rest[words..].iter().take_while(|byte| byte.is_ascii_digit() || **byte == b'.').count() >= 5;
        is_version.then(|| String::from_utf8_lossy(&rest[..words]).trim().to_owned())
    })
}

/// Tells whether a file is a bench file: TOML with the table that every bench file begins with. Nothing larger is read.
pub fn is_bench_file(path: &Path) -> bool {
    let is_small = std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() < LARGEST_BENCH_FILE);
    let text = if is_small { std::fs::read_to_string(path).unwrap_or_default() } else { String::new() };
    text.parse::<toml::Table>().is_ok_and(|table| table.get("bench").is_some_and(toml::Value::is_table))
}

/// A drawing with the mark of a run.
pub(crate) fn in_svg(drawing: &str, files: &Files) -> String {
    drawing.replacen(">\n", &format!(">\n<metadata>{}</metadata>\n", files.generator()), 1)
}

/// A picture with the mark of a run: a chunk of text behind the header (PNG 3rd edition, 11.3.3.2).
pub(crate) fn in_png(picture: &[u8], files: &Files) -> Vec<u8> {
    /// Signature, and the header with length, type and checksum.
    const BEGINNING: usize = 8 + 25;
    let (beginning, rest) = picture.split_at(picture.len().min(BEGINNING));
    let text = [b"tEXtSoftware\0", files.generator().as_bytes()].concat();
    let length = u32::try_from(text.len() - 4).unwrap_or_default();
    [beginning, &length.to_be_bytes(), &text, &crc32(&text).to_be_bytes(), rest].concat()
}

/// The checksum of a chunk (PNG 3rd edition, annex D).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { 0xEDB8_8320 ^ (crc >> 1) } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

#[cfg(test)]
mod tests {
    use super::{Mark, crc32};

    #[test]
    fn ref_the_checksum_of_a_chunk_without_data() {
        assert_eq!(crc32(b"IEND"), 0xAE42_6082);
    }

    #[test]
    fn exact_marks_are_read_from_what_names_program_command_and_version() {
        let of = |text: &str| Mark::of_content(text.as_bytes());
        let command = |words: &str| Some(Mark::Command(words.to_owned()));
        assert_eq!(of("<meta name=\"generator\" content=\"dynoid model bode 0.1.0\">"), command("model bode"));
        assert_eq!(of("# Written by dynoid 0.1.0 from the bench model of 2026-05-03."), Some(Mark::Program));
        assert_eq!(of("run `dynoid study bench.toml` 1.0.0"), Some(Mark::Program));
        assert_eq!(of("time [s],n [rpm]\n0,1200\n"), None);
        assert_eq!(of("{\"name\": \"dynoid study 0.1.0\"}"), None);
    }
}
