//! Starts the programs of a release, those for other machines with an emulator.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::files::read;
use super::targets::Target;
use crate::folder;
use crate::steps::run;

/// An emulator needs this long for its first start, at most.
const LONGEST_START: Duration = Duration::from_secs(120);

/// Runs the demonstration with a program. Returns false where nothing here runs it.
pub(super) fn demonstrate(target: &Target, program: &Path) -> Result<bool, String> {
    if target.is_linux() && has_interpreter(&read(program)?) {
        return Err(format!("{}: the program is not static", target.triple));
    }
    let Some(mut command) = command(target, program) else { return Ok(false) };
    let place = folder::target()?.join("release-demo").join(target.triple);
    fs::create_dir_all(&place).map_err(|error| format!("{}: {error}", place.display()))?;
    // The place is relative, as every system reads it.
    command.current_dir(&place).args(["demo", "--quiet", "--overwrite", "--out", "demo"]);
    run("the demonstration", &mut command)?;
    Ok(true)
}

/// The start of a program, if something here runs it.
fn command(target: &Target, program: &Path) -> Option<Command> {
    if target.runs_here() {
        return Some(Command::new(program));
    }
    let emulated = |emulator: &str| {
        let mut command = Command::new(emulator);
        command.arg(program).env("WINEDEBUG", "-all");
        command
    };
    let answers = |emulator: &&str| ends(emulated(emulator).arg("--version"));
    target.emulator.filter(answers).map(emulated)
}

/// Tells whether a command starts and ends in time: an emulator that is set up badly may wait for ever.
fn ends(command: &mut Command) -> bool {
    let Ok(mut child) = command.stdin(Stdio::null()).stdout(Stdio::null()).spawn() else { return false };
    let since = Instant::now();
    while since.elapsed() < LONGEST_START {
        match child.try_wait() {
            Ok(None) => std::thread::sleep(Duration::from_millis(100)),
            Ok(Some(_)) => return true,
            Err(_) => return false,
        }
    }
    let _ = child.kill();
    let _ = child.wait();
    false
}

/// Tells whether a 64-bit ELF program asks for a dynamic linker: a header of type `PT_INTERP` (3) among those of its
/// segments.
fn has_interpreter(elf: &[u8]) -> bool {
    let number = |at: usize, length: usize| {
        let bytes = elf.get(at..at.checked_add(length)?)?;
        Some(bytes.iter().rev().fold(0, |number, byte| number << 8 | usize::from(*byte)))
    };
    let (Some(first), Some(size), Some(count)) = (number(32, 8), number(54, 2), number(56, 2)) else { return false };
    (0..count).any(|segment| number(first + segment * size, 4) == Some(3))
}

#[cfg(all(test, target_os = "linux", target_env = "gnu"))]
mod tests {
    use super::*;

    #[test]
    fn exact_an_emulator_that_is_absent_is_known() {
        assert!(ends(&mut Command::new("true")) && !ends(&mut Command::new("no-such-emulator")));
    }

    #[test]
    fn exact_a_program_with_a_dynamic_linker_is_known() {
        let own = read(&std::env::current_exe().unwrap()).unwrap();
        assert!(has_interpreter(&own));
        let mut other = own;
        let first = usize::try_from(u64::from_le_bytes(other[32..40].try_into().unwrap())).unwrap();
        let size = usize::from(u16::from_le_bytes(other[54..56].try_into().unwrap()));
        let count = usize::from(u16::from_le_bytes(other[56..58].try_into().unwrap()));
        (0..count).map(|segment| first + segment * size).for_each(|at| {
            if other[at] == 3 {
                other[at] = 0;
            }
        });
        assert!(!has_interpreter(&other) && !has_interpreter(b"text"));
    }
}
