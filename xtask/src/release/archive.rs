//! Archives that are the same bytes from the same files: sorted, of one time, and of no user.

use std::collections::BTreeSet;
use std::io::Write;

use flate2::write::DeflateEncoder;
use flate2::{Compression, GzBuilder};
use rawzip::time::UtcDateTime;
use rawzip::{CompressionMethod, ZipArchiveWriter};
use tar::{Builder, EntryType, Header};

/// A file in an archive, under a path with `/`.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub(super) path: String,
    pub(super) bytes: Vec<u8>,
    pub(super) is_program: bool,
}

impl Entry {
    /// A file that is read.
    pub(super) fn text(path: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Entry { path: path.into(), bytes: bytes.into(), is_program: false }
    }

    /// A file that is run.
    pub(super) fn program(path: impl Into<String>, bytes: Vec<u8>) -> Self {
        Entry { path: path.into(), bytes, is_program: true }
    }

    fn mode(&self) -> u32 {
        if self.is_program { 0o755 } else { 0o644 }
    }
}

/// The files in the order of their paths.
fn sorted(entries: &[Entry]) -> Vec<&Entry> {
    let mut sorted: Vec<&Entry> = entries.iter().collect();
    sorted.sort_by(|a, b| a.path.cmp(&b.path));
    sorted
}

/// A tar archive with the folders of its files; `time_s` counts from 1970.
pub(super) fn tar(entries: &[Entry], time_s: u64) -> Result<Vec<u8>, String> {
    let mut builder = Builder::new(Vec::new());
    for folder in folders(entries) {
        let mut header = header(0, 0o755, EntryType::Directory, time_s);
        builder.append_data(&mut header, &folder, std::io::empty()).map_err(|error| format!("{folder}: {error}"))?;
    }
    for entry in sorted(entries) {
        let mut header = header(entry.bytes.len() as u64, entry.mode(), EntryType::Regular, time_s);
        let added = builder.append_data(&mut header, &entry.path, entry.bytes.as_slice());
        added.map_err(|error| format!("{}: {error}", entry.path))?;
    }
    builder.into_inner().map_err(|error| format!("a tar archive: {error}"))
}

fn header(size: u64, mode: u32, kind: EntryType, time_s: u64) -> Header {
    let mut header = Header::new_gnu();
    header.set_size(size);
    header.set_mode(mode);
    header.set_entry_type(kind);
    header.set_mtime(time_s);
    header.set_uid(0);
    header.set_gid(0);
    header
}

/// All folders above the files, the outer ones first.
fn folders(entries: &[Entry]) -> BTreeSet<String> {
    let above = |path: &str| path.match_indices('/').map(|(end, _)| format!("{}/", &path[..end])).collect::<Vec<_>>();
    entries.iter().flat_map(|entry| above(&entry.path)).collect()
}

/// Bytes packed by gzip, without a name and a time.
pub(super) fn gzip(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let mut encoder = GzBuilder::new().mtime(0).write(Vec::new(), Compression::best());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).map_err(|error| format!("gzip: {error}"))
}

/// A ZIP archive, whose times are in UTC.
pub(super) fn zip(entries: &[Entry], time_s: u64) -> Result<Vec<u8>, String> {
    let mut archive = ZipArchiveWriter::new(Vec::new());
    for entry in sorted(entries) {
        add(&mut archive, entry, time_s).map_err(|error| format!("{}: {error}", entry.path))?;
    }
    archive.finish().map_err(|error| format!("a ZIP archive: {error}"))
}

fn add(archive: &mut ZipArchiveWriter<Vec<u8>>, entry: &Entry, time_s: u64) -> Result<(), rawzip::Error> {
    let file = archive.new_file(&entry.path).compression_method(CompressionMethod::DEFLATE);
    let time = UtcDateTime::from_unix(i64::try_from(time_s).unwrap_or_default());
    let (mut packed, config) = file.last_modified(time).unix_permissions(entry.mode()).start()?;
    let mut writer = config.wrap(DeflateEncoder::new(&mut packed, Compression::best()));
    writer.write_all(&entry.bytes)?;
    let (encoder, description) = writer.finish()?;
    encoder.finish()?;
    packed.finish(description).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries() -> Vec<Entry> {
        vec![Entry::program("d/b/program", vec![7; 5000]), Entry::text("d/a", "words"), Entry::text("d/b/z", "more")]
    }

    #[test]
    fn exact_an_archive_holds_folders_and_files_in_order_with_one_time() {
        let bytes = tar(&entries(), 1_700_000_000).unwrap();
        let mut archive = tar::Archive::new(bytes.as_slice());
        let read = |entry: std::io::Result<tar::Entry<'_, &[u8]>>| {
            let entry = entry.unwrap();
            let header = entry.header();
            assert_eq!((header.mtime().unwrap(), header.uid().unwrap()), (1_700_000_000, 0));
            (entry.path().unwrap().display().to_string(), header.mode().unwrap())
        };
        let found: Vec<(String, u32)> = archive.entries().unwrap().map(read).collect();
        let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["d/", "d/b/", "d/a", "d/b/program", "d/b/z"]);
        assert_eq!(found.iter().map(|(_, mode)| *mode).collect::<Vec<_>>(), [0o755, 0o755, 0o644, 0o755, 0o644]);
    }

    #[test]
    fn exact_the_order_of_the_files_does_not_change_the_bytes() {
        let reversed: Vec<Entry> = entries().into_iter().rev().collect();
        assert_eq!(gzip(&tar(&entries(), 5).unwrap()), gzip(&tar(&reversed, 5).unwrap()));
        assert_eq!(zip(&entries(), 1_700_000_000), zip(&reversed, 1_700_000_000));
    }
}
