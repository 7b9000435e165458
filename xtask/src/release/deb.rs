//! Packages for Debian and Ubuntu: program, manual, completions, licences. They need no other package.

use super::archive::{Entry, gzip, tar};
use super::content::Content;
use super::files::{REPOSITORY, VERSION};

/// Makes the package for an architecture of Debian. Its members are an archive of words on it and one of its files.
pub(super) fn package(content: &Content, program: Vec<u8>, debian: &str) -> Result<Vec<u8>, String> {
    let files = files(content, program)?;
    let size_kb = files.iter().map(|file| file.bytes.len().div_ceil(1024)).sum();
    let control = [Entry::text("control", control(debian, size_kb))];
    let members = [
        ("debian-binary", b"2.0\n".to_vec()),
        ("control.tar.gz", gzip(&tar(&control, content.time_s)?)?),
        ("data.tar.gz", gzip(&tar(&files, content.time_s)?)?),
    ];
    Ok(ar(&members, content.time_s))
}

/// The files where Debian expects them.
fn files(content: &Content, program: Vec<u8>) -> Result<Vec<Entry>, String> {
    let documents = "usr/share/doc/dynoid";
    let mut files = vec![
        Entry::program("usr/bin/dynoid", program),
        Entry::text(format!("{documents}/copyright"), copyright(content)?),
        Entry::text(format!("{documents}/changelog.gz"), gzip(content.file("CHANGELOG.md")?)?),
        Entry::text(format!("{documents}/THIRD-PARTY.txt.gz"), gzip(content.file("THIRD-PARTY.txt")?)?),
    ];
    for (from, to) in [
        ("completions/dynoid.bash", "usr/share/bash-completion/completions/dynoid"),
        ("completions/_dynoid", "usr/share/zsh/vendor-completions/_dynoid"),
        ("completions/dynoid.fish", "usr/share/fish/vendor_completions.d/dynoid.fish"),
    ] {
        files.push(Entry::text(to, content.file(from)?));
    }
    for page in content.files.iter().filter(|file| file.path.starts_with("man/")) {
        files.push(Entry::text(format!("usr/share/{}.gz", page.path), gzip(&page.bytes)?));
    }
    Ok(files)
}

fn control(debian: &str, size_kb: usize) -> String {
    let owner = REPOSITORY.rsplit('/').nth(1).unwrap_or("dynoid");
    format!(
        "Package: dynoid\nVersion: {VERSION}\nArchitecture: {debian}\nSection: science\nPriority: optional\n\
         Maintainer: The dynoid developers <{owner}@users.noreply.github.com>\nInstalled-Size: {size_kb}\n\
         Homepage: {REPOSITORY}\nDescription: validated models of dynamometer test benches\n \
         dynoid turns the recordings of a dynamometer test bench into a validated\n \
         simulation model of that bench. A report shows how far one can trust it.\n"
    )
}

/// The file `copyright` in the form of Debian.
fn copyright(content: &Content) -> Result<String, String> {
    let mut text = format!(
        "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: dynoid\n\
         Source: {REPOSITORY}\nComment: THIRD-PARTY.txt.gz beside this file has the licences of all crates in the program.\n\n\
         Files: *\nCopyright: The dynoid developers\nLicense: Apache-2.0 or Expat\n"
    );
    for (name, file) in [("Apache-2.0", "LICENSE-APACHE"), ("Expat", "LICENSE-MIT")] {
        text.push_str(&format!("\nLicense: {name}\n"));
        for line in String::from_utf8_lossy(content.file(file)?).lines() {
            text.push_str(&if line.trim().is_empty() { " .\n".to_owned() } else { format!(" {line}\n") });
        }
    }
    Ok(text)
}

/// An archive in the form of the program `ar`: each member has a header of 60 bytes and an even length.
fn ar(members: &[(&str, Vec<u8>)], time_s: u64) -> Vec<u8> {
    let mut bytes = b"!<arch>\n".to_vec();
    for (name, content) in members {
        let header = format!("{name:<16}{time_s:<12}{:<6}{:<6}{:<8}{:<10}`\n", 0, 0, "100644", content.len());
        bytes.extend(header.as_bytes());
        bytes.extend(content);
        if content.len() % 2 == 1 {
            bytes.push(b'\n');
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_members_of_an_archive_begin_at_even_places() {
        let bytes = ar(&[("debian-binary", b"2.0\n".to_vec()), ("odd", b"abc".to_vec())], 12);
        assert_eq!(&bytes[..8], b"!<arch>\n");
        assert_eq!(&bytes[8..68], b"debian-binary   12          0     0     100644  4         `\n");
        assert_eq!((&bytes[72..75], &bytes[132..], bytes.len()), (&b"odd"[..], &b"abc\n"[..], 136));
    }
}
