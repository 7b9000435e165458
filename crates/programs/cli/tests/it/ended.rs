//! Runs that are ended while they write, and runs that write at the same time.

use std::fs::File;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::identify;
use crate::support::{Campaign, command, dynoid};

const DESIGN: [&str; 8] = ["experiment", "design", "bench.toml", "BS_T_NT", "--duration", "5", "--out", "designed"];

/// A design that has written its files under temporary names, and waits for the reader of its picture.
struct Waiting {
    program: Child,
    _reader: File,
}

impl Waiting {
    /// Starts it through a shell that first does what is asked.
    fn start(campaign: &Campaign, first: &str) -> Self {
        let designed = campaign.path("designed");
        let before = temporaries(&designed);
        let pipe = campaign.path("picture.html");
        if !pipe.exists() {
            assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        }
        // Whoever runs the tests may ignore signals, which a child would inherit.
        let program = Command::new("env")
            .args(["--default-signal=HUP,INT,TERM", "sh", "-c", &format!("{first}\nexec \"$@\""), "sh"])
            .arg(env!("CARGO_BIN_EXE_dynoid"))
            .args(DESIGN)
            .args(["--plot", "picture.html"])
            .current_dir(campaign.path(""))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // It is never read, and a picture is larger than what the system keeps for a reader.
        let reader = File::open(&pipe).unwrap();
        let waiting = Waiting { program, _reader: reader };
        within_a_minute(|| temporaries(&designed).iter().filter(|name| !before.contains(name)).count() >= 2);
        waiting
    }

    fn signal(&self, signal: &str) {
        let sent = Command::new("kill").args([signal, &self.program.id().to_string()]).status().unwrap();
        assert!(sent.success());
    }

    /// The signal that ended it.
    fn ended_by(mut self) -> Option<i32> {
        within_a_minute(|| self.program.try_wait().unwrap().is_some());
        self.program.wait().unwrap().signal()
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

/// True where programs can be started with the usual answers to signals, as GNU's `env` does.
fn signals_can_be_reset() -> bool {
    let can = Command::new("env").args(["--default-signal=HUP", "true"]).status().is_ok_and(|ended| ended.success());
    if !can {
        testdata::skip("no `env --default-signal`");
    }
    can
}

pub(crate) fn within_a_minute(mut is_so: impl FnMut() -> bool) {
    let since = Instant::now();
    while !is_so() {
        assert!(since.elapsed() < Duration::from_secs(60), "the program does not come so far");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn temporaries(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let names = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
    names.filter(|name| name.starts_with(".dynoid-")).collect()
}

#[test]
fn regress_a_signal_leaves_no_temporary_files() {
    if !signals_can_be_reset() {
        return;
    }
    let campaign = Campaign::empty();
    for (signal, number) in [("-INT", 2), ("-TERM", 15), ("-HUP", 1)] {
        let waiting = Waiting::start(&campaign, "");
        waiting.signal(signal);
        assert_eq!(waiting.ended_by(), Some(number), "a shell sees 128 and this number");
        assert_eq!(std::fs::read_dir(campaign.path("designed")).unwrap().count(), 0, "{signal}");
    }
}

#[test]
fn regress_a_signal_that_the_caller_ignores_ends_nothing() {
    if !signals_can_be_reset() {
        return;
    }
    let campaign = Campaign::empty();
    let waiting = Waiting::start(&campaign, "trap '' HUP");
    waiting.signal("-HUP");
    waiting.signal("-TERM");
    assert_eq!(waiting.ended_by(), Some(15));
}

#[test]
fn regress_what_a_killed_run_leaves_is_removed_by_the_next() {
    if !signals_can_be_reset() {
        return;
    }
    let campaign = Campaign::empty();
    let designed = campaign.path("designed");
    let killed = Waiting::start(&campaign, "");
    killed.signal("-KILL");
    assert_eq!(killed.ended_by(), Some(9));
    let left = temporaries(&designed);
    assert!(left.len() >= 2, "{left:?}");
    // Files of people, and those of a run that goes on, stay.
    let own = [".dynoid-notes.tmp", ".dynoid-.tmp", ".dynoid-abcdefghijklmnopqrst"];
    own.iter().for_each(|name| campaign.write(&format!("designed/{name}"), b"mine"));
    let running = Waiting::start(&campaign, "");
    let of_running: Vec<String> =
        temporaries(&designed).into_iter().filter(|name| !own.contains(&name.as_str())).collect();
    assert!(of_running.len() >= 2 && of_running.iter().all(|name| !left.contains(name)), "{of_running:?}");
    assert_eq!(dynoid(&campaign.path(""), &DESIGN).code, Some(0));
    let after = temporaries(&designed);
    assert!(own.iter().all(|name| after.iter().any(|found| found == name)), "{after:?}");
    assert!(of_running.iter().all(|name| after.contains(name)), "{after:?}");
    assert_eq!(after.len(), own.len() + of_running.len());
    drop(running);
}

#[test]
fn regress_a_limit_of_the_shell_on_files_is_an_error() {
    let folder = identify::folder();
    let line = "ulimit -f 2; exec \"$0\" convert run.csv --out run.mf4";
    let ran = Command::new("sh")
        .args(["-c", line, env!("CARGO_BIN_EXE_dynoid")])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8(ran.stderr).unwrap();
    assert_eq!(ran.status.code(), Some(4), "{said}");
    assert!(said.contains("run.mf4") && said.contains("ulimit -f"), "{said}");
    assert!(temporaries(folder.path()).is_empty() && !folder.path().join("run.mf4").exists());
}

#[test]
fn regress_two_designs_at_once_leave_the_files_of_one() {
    let campaign = Campaign::empty();
    let design = |out: &'static str, seed: &'static str| {
        let line = ["experiment", "design", "bench.toml", "WhiteNoise_T_TN", "--speed", "1200", "--duration", "5"];
        command(&campaign.path(""), &[&line[..], &["--seed", seed, "--out", out, "--quiet", "--overwrite"]].concat())
    };
    let files = |out: &str| {
        ["WhiteNoise_T_TN_1200.csv", "WhiteNoise_T_TN_1200.mf4"]
            .map(|name| std::fs::read(campaign.path(out).join(name)).unwrap())
    };
    for (out, seed) in [("one", "1"), ("two", "2")] {
        assert!(design(out, seed).stderr(Stdio::null()).status().unwrap().success());
    }
    let (one, two) = (files("one"), files("two"));
    assert!(one[0] != two[0] && one[1] != two[1]);
    for _ in 0..5 {
        let mut running = ["1", "2"].map(|seed| design("both", seed).stderr(Stdio::null()).spawn().unwrap());
        running.iter_mut().for_each(|program| assert!(program.wait().unwrap().success()));
        let both = files("both");
        assert!(both == one || both == two, "the files of two designs are mixed");
    }
}
