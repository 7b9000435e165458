//! The runtime's binaries, which `cargo xtask fmu` builds, under the names that FMI has for their platforms.

use super::archive::Archive;

/// Version of FMI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FmiVersion {
    /// 2.0.
    V2,
    /// 3.0.
    V3,
}

/// What the binaries are called.
pub(super) const IDENTIFIER: &str = "dynoid_bench";

const X86_64_LINUX: &[u8] = include_bytes!("../../runtime/binaries/x86_64-linux.so");
const AARCH64_LINUX: &[u8] = include_bytes!("../../runtime/binaries/aarch64-linux.so");
const X86_64_WINDOWS: &[u8] = include_bytes!("../../runtime/binaries/x86_64-windows.dll");
const X86_64_DARWIN: &[u8] = include_bytes!("../../runtime/binaries/x86_64-darwin.dylib");
const AARCH64_DARWIN: &[u8] = include_bytes!("../../runtime/binaries/aarch64-darwin.dylib");

/// Adds the binaries for every platform.
pub(super) fn add_to(archive: &mut Archive, version: FmiVersion) {
    let mut add = |platform: &str, ending: &str, bytes: &[u8]| {
        archive.add(&format!("binaries/{platform}/{IDENTIFIER}.{ending}"), bytes);
    };
    match version {
        FmiVersion::V2 => {
            add("linux64", "so", X86_64_LINUX);
            // FMI 2.0 has no name for it; importers that run there take the one of FMI 3.0.
            add("aarch64-linux", "so", AARCH64_LINUX);
            add("win64", "dll", X86_64_WINDOWS);
            add("darwin64", "dylib", &universal());
        }
        FmiVersion::V3 => {
            add("x86_64-linux", "so", X86_64_LINUX);
            add("aarch64-linux", "so", AARCH64_LINUX);
            add("x86_64-windows", "dll", X86_64_WINDOWS);
            add("x86_64-darwin", "dylib", X86_64_DARWIN);
            add("aarch64-darwin", "dylib", AARCH64_DARWIN);
        }
    }
}

/// One file for both kinds of macOS machines, as FMI 2.0 has one folder for them: Mach-O's format for several architectures, in which a
/// head of big-endian numbers has type, subtype, offset, size and alignment of each.
fn universal() -> Vec<u8> {
    const MAGIC: u32 = 0xcafe_babe;
    const ALIGNMENT: u32 = 14;
    /// Types and subtypes of the processors.
    const ARCHITECTURES: [(u32, u32, &[u8]); 2] = [(0x0100_0007, 3, X86_64_DARWIN), (0x0100_000c, 0, AARCH64_DARWIN)];
    let mut head: Vec<u32> = vec![MAGIC, ARCHITECTURES.len() as u32];
    let mut content = Vec::new();
    for (processor, subtype, bytes) in ARCHITECTURES {
        let offset = (content.len() + 1).next_multiple_of(1 << ALIGNMENT);
        content.resize(offset, 0);
        content.extend(bytes);
        head.extend([processor, subtype, offset as u32, bytes.len() as u32, ALIGNMENT]);
    }
    for (place, number) in content.chunks_exact_mut(4).zip(head) {
        place.copy_from_slice(&number.to_be_bytes());
    }
    content
}
