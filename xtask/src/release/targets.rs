//! The machines that a release is for.

/// A wheel: the target that it is built for, and the oldest system that it promises to run on.
pub(super) struct Wheel {
    pub(super) triple: &'static str,
    /// A name of PyPA, such as `manylinux2014`; none where the target says it.
    pub(super) compatibility: Option<&'static str>,
}

/// A machine, as Rust names it, and what is made for it.
pub(super) struct Target {
    pub(super) triple: &'static str,
    /// The architecture of the Debian package, where there is one.
    pub(super) debian: Option<&'static str>,
    /// The end of the name of the program alone, where it is offered without an archive.
    pub(super) portable: Option<&'static str>,
    pub(super) wheels: &'static [Wheel],
    /// A program that starts programs for this target on other machines.
    pub(super) emulator: Option<&'static str>,
}

/// All machines. The programs for Linux are static: they need no library of the system.
pub(super) const ALL: [Target; 5] = [
    Target {
        triple: "x86_64-unknown-linux-musl",
        debian: Some("amd64"),
        portable: None,
        wheels: &[
            Wheel { triple: "x86_64-unknown-linux-gnu", compatibility: Some("manylinux2014") },
            Wheel { triple: "x86_64-unknown-linux-musl", compatibility: Some("musllinux_1_2") },
        ],
        emulator: None,
    },
    Target {
        triple: "aarch64-unknown-linux-musl",
        debian: Some("arm64"),
        portable: None,
        wheels: &[
            Wheel { triple: "aarch64-unknown-linux-gnu", compatibility: Some("manylinux2014") },
            Wheel { triple: "aarch64-unknown-linux-musl", compatibility: Some("musllinux_1_2") },
        ],
        emulator: Some("qemu-aarch64"),
    },
    Target {
        triple: "x86_64-pc-windows-gnu",
        debian: None,
        portable: Some("windows-x86_64.exe"),
        wheels: &[Wheel { triple: "x86_64-pc-windows-gnu", compatibility: None }],
        emulator: Some("wine"),
    },
    Target {
        triple: "x86_64-apple-darwin",
        debian: None,
        portable: None,
        wheels: &[Wheel { triple: "x86_64-apple-darwin", compatibility: None }],
        emulator: None,
    },
    Target {
        triple: "aarch64-apple-darwin",
        debian: None,
        portable: None,
        wheels: &[Wheel { triple: "aarch64-apple-darwin", compatibility: None }],
        emulator: None,
    },
];

impl Target {
    /// The target of this name.
    pub(super) fn named(triple: &str) -> Result<&'static Target, String> {
        let names = || ALL.iter().map(|target| target.triple).collect::<Vec<_>>().join(", ");
        ALL.iter().find(|target| target.triple == triple).ok_or_else(|| format!("{triple}: name one of {}", names()))
    }

    pub(super) fn is_linux(&self) -> bool {
        self.triple.contains("linux")
    }

    pub(super) fn is_windows(&self) -> bool {
        self.triple.contains("windows")
    }

    /// The name of the program.
    pub(super) fn program(&self) -> &'static str {
        if self.is_windows() { "dynoid.exe" } else { "dynoid" }
    }

    /// Tells whether a program for this target runs on the machine that makes the release.
    pub(super) fn runs_here(&self) -> bool {
        let system = if cfg!(target_os = "macos") { "darwin" } else { std::env::consts::OS };
        self.triple.starts_with(std::env::consts::ARCH) && self.triple.contains(system)
    }
}
