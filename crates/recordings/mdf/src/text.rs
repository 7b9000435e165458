//! Texts of blocks and of samples.

use crate::model::Encoding;

/// Text of the single-byte encoding, up to the first NUL.
pub(crate) fn latin1(bytes: &[u8]) -> String {
    bytes.iter().take_while(|&&b| b != 0).map(|&b| char::from(b)).collect()
}

/// UTF-8 up to the first NUL; bytes that are none are read as the single-byte encoding, which some programs write.
pub(crate) fn utf8(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&b| b == 0).unwrap_or(bytes.len());
    match std::str::from_utf8(&bytes[..end]) {
        Ok(text) => text.to_owned(),
        Err(_) => latin1(bytes),
    }
}

/// The text of a sample, up to the first NUL.
pub(crate) fn decoded(bytes: &[u8], encoding: Encoding) -> String {
    let pairs = || bytes.chunks_exact(2).map(|p| [p[0], p[1]]);
    let utf16 = |units: &mut dyn Iterator<Item = u16>| {
        let units: Vec<u16> = units.take_while(|&u| u != 0).collect();
        let text = String::from_utf16_lossy(&units);
        text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text)
    };
    match encoding {
        Encoding::Latin1 => latin1(bytes),
        Encoding::Utf8 => utf8(bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)),
        Encoding::Utf16Le => utf16(&mut pairs().map(u16::from_le_bytes)),
        Encoding::Utf16Be => utf16(&mut pairs().map(u16::from_be_bytes)),
    }
}

/// Text of the `TX` element of an XML comment; text that is no XML, as it is.
pub(crate) fn comment(xml: &str) -> String {
    let Some(start) = xml.find("<TX") else {
        let is_xml = xml.trim_start().starts_with('<');
        return if is_xml { String::new() } else { xml.trim().to_owned() };
    };
    let rest = &xml[start..];
    let inner = rest.find('>').map(|at| (&rest[..at], &rest[at + 1..]));
    match inner {
        Some((tag, inner)) if !tag.ends_with('/') => {
            let end = inner.find("</TX").unwrap_or(inner.len());
            unescaped(inner[..end].trim())
        }
        _ => String::new(),
    }
}

/// XML text with its entities replaced.
fn unescaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('&') {
        out.push_str(&rest[..at]);
        rest = &rest[at..];
        let entity = rest.find(';').filter(|&end| end <= 10).map(|end| (&rest[1..end], &rest[end + 1..]));
        match entity.and_then(|(name, after)| Some((character(name)?, after))) {
            Some((c, after)) => {
                out.push(c);
                rest = after;
            }
            None => {
                out.push('&');
                rest = &rest[1..];
            }
        }
    }
    out.push_str(rest);
    out
}

fn character(entity: &str) -> Option<char> {
    let code = |digits: &str, radix| u32::from_str_radix(digits, radix).ok().and_then(char::from_u32);
    match entity {
        "lt" => Some('<'),
        "gt" => Some('>'),
        "amp" => Some('&'),
        "quot" => Some('"'),
        "apos" => Some('\''),
        _ => match entity.strip_prefix('#')? {
            hexadecimal if hexadecimal.starts_with(['x', 'X']) => code(&hexadecimal[1..], 16),
            decimal => code(decimal, 10),
        },
    }
}
