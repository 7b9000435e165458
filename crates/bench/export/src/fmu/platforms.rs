//! The runtimes' binaries, which `cargo xtask fmu` builds, under the names that FMI has for their platforms.

use super::archive::Archive;

/// Version of FMI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FmiVersion {
    /// 2.0.
    V2,
    /// 3.0.
    V3,
}

impl FmiVersion {
    /// As model descriptions state it.
    #[must_use]
    pub fn number(self) -> &'static str {
        match self {
            FmiVersion::V2 => "2.0",
            FmiVersion::V3 => "3.0",
        }
    }

    /// End of the names of FMUs of this version.
    pub(super) fn suffix(self) -> &'static str {
        match self {
            FmiVersion::V2 => "_fmi2",
            FmiVersion::V3 => "_fmi3",
        }
    }
}

/// Program that simulates: that of the bench, or that of any linear model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Runtime {
    /// A bench.
    Bench,
    /// A linear model.
    Linear,
}

/// The binaries of a runtime.
struct Binaries {
    x86_64_linux: &'static [u8],
    aarch64_linux: &'static [u8],
    x86_64_windows: &'static [u8],
    x86_64_darwin: &'static [u8],
    aarch64_darwin: &'static [u8],
}

macro_rules! binaries {
    ($folder:literal) => {
        Binaries {
            x86_64_linux: include_bytes!(concat!("../../runtime/", $folder, "/x86_64-linux.so")),
            aarch64_linux: include_bytes!(concat!("../../runtime/", $folder, "/aarch64-linux.so")),
            x86_64_windows: include_bytes!(concat!("../../runtime/", $folder, "/x86_64-windows.dll")),
            x86_64_darwin: include_bytes!(concat!("../../runtime/", $folder, "/x86_64-darwin.dylib")),
            aarch64_darwin: include_bytes!(concat!("../../runtime/", $folder, "/aarch64-darwin.dylib")),
        }
    };
}

const BENCH: Binaries = binaries!("binaries");
const LINEAR: Binaries = binaries!("binaries/linear");

impl Runtime {
    /// Name of the binaries.
    pub(super) fn identifier(self) -> &'static str {
        match self {
            Runtime::Bench => "dynoid_bench",
            Runtime::Linear => "dynoid_linear",
        }
    }

    fn binaries(self) -> &'static Binaries {
        match self {
            Runtime::Bench => &BENCH,
            Runtime::Linear => &LINEAR,
        }
    }
}

/// Adds the binaries for every platform.
pub(super) fn add_to(archive: &mut Archive, version: FmiVersion, runtime: Runtime) {
    let mut add = |platform: &str, ending: &str, bytes: &[u8]| {
        archive.add(&format!("binaries/{platform}/{}.{ending}", runtime.identifier()), bytes);
    };
    let of = runtime.binaries();
    match version {
        FmiVersion::V2 => {
            add("linux64", "so", of.x86_64_linux);
            // FMI 2.0 has no name for it; importers that run there take the one of FMI 3.0.
            add("aarch64-linux", "so", of.aarch64_linux);
            add("win64", "dll", of.x86_64_windows);
            add("darwin64", "dylib", &universal(of));
        }
        FmiVersion::V3 => {
            add("x86_64-linux", "so", of.x86_64_linux);
            add("aarch64-linux", "so", of.aarch64_linux);
            add("x86_64-windows", "dll", of.x86_64_windows);
            add("x86_64-darwin", "dylib", of.x86_64_darwin);
            add("aarch64-darwin", "dylib", of.aarch64_darwin);
        }
    }
}

/// One file for both kinds of macOS machines, as FMI 2.0 has one folder for them: Mach-O's format for several
/// architectures, in which a head of big-endian numbers has type, subtype, offset, size and alignment of each.
fn universal(of: &Binaries) -> Vec<u8> {
    const MAGIC: u32 = 0xcafe_babe;
    const ALIGNMENT: u32 = 14;
    // Types and subtypes of the processors.
    let architectures = [(0x0100_0007, 3, of.x86_64_darwin), (0x0100_000c, 0, of.aarch64_darwin)];
    let mut head: Vec<u32> = vec![MAGIC, architectures.len() as u32];
    let mut content = Vec::new();
    for (processor, subtype, bytes) in architectures {
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
