//! Running the program, and campaigns of short simulated recordings for it.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

use recording::{Recording, encode_mdf4};
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use tempfile::TempDir;
use virtual_bench::simulate;

/// Exit code and output of a run of the program.
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Ran {
    /// Runs a command to its end.
    pub(crate) fn of(command: &mut Command) -> Self {
        let output = command.output().expect("the program starts");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
        Ran { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    /// Standard output as JSON.
    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {}", self.stdout))
    }

    /// Fails unless the program ended with this code and its standard error holds all of these.
    #[track_caller]
    pub(crate) fn assert_refused(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "stdout: {}\nstderr: {}", self.stdout, self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "`{word}` is not in: {}", self.stderr);
        }
        assert_eq!(self.stdout, "", "nothing belongs on standard output");
    }

    /// The study of a run of `study run --json`, which may say that the data are insufficient.
    #[track_caller]
    pub(crate) fn study(&self) -> serde_json::Value {
        assert!(matches!(self.code, Some(0 | 1)), "code {:?}, stderr: {}", self.code, self.stderr);
        self.json()
    }
}

pub(crate) fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dynoid"));
    command.args(arguments).current_dir(folder).stdin(Stdio::null()).env_remove("NO_COLOR").env_remove("COLUMNS");
    command
}

pub(crate) fn dynoid(folder: &Path, arguments: &[&str]) -> Ran {
    Ran::of(&mut command(folder, arguments))
}

pub(crate) fn bs() -> Recording {
    static RECORDING: OnceLock<Recording> = OnceLock::new();
    RECORDING.get_or_init(|| simulated(&ExperimentPlan::bs_t_nt(1200.0, 12.0), 1)).clone()
}

pub(crate) fn white_noise() -> Recording {
    static RECORDING: OnceLock<Recording> = OnceLock::new();
    RECORDING.get_or_init(|| simulated(&ExperimentPlan::white_noise_t_tn(1200.0, 12.0), 2)).clone()
}

pub(crate) fn simulated(plan: &ExperimentPlan, seed: u64) -> Recording {
    simulate(&BenchParameters::default(), plan, seed).expect("the default bench")
}

pub(crate) const BENCH: &str = r#"
[bench]
name = "Test bench"
variant = "load-cell"
cylinders = 4
dynamometer_inertia = "0.6 kg m²"
engine_inertia = "0.28 kg m²"

[channels]
dyno_speed = "DynoSpeed"
engine_speed = "EngineSpeed"
dyno_speed_demand = "DynoSpeedDemand"
dyno_torque_demand = "DynoTorqueDemand"
air_gap_torque = "DynoTorqueCalc"
load_cell_torque = "DynoTorqueMeas"
system_shaft_torque = "ShaftTorqueCalc"

[recordings]
files = ["recordings/*.mf4"]
"#;

/// A folder with a bench file and recordings.
pub(crate) struct Campaign {
    folder: TempDir,
}

impl Campaign {
    /// A bench file and an empty folder for recordings.
    pub(crate) fn empty() -> Self {
        let campaign = Campaign { folder: tempfile::tempdir().expect("a folder for tests") };
        campaign.write("bench.toml", BENCH.as_bytes());
        std::fs::create_dir(campaign.path("recordings")).expect("writable");
        campaign
    }

    /// With a recording of each of the two experiments that give most.
    pub(crate) fn whole() -> Self {
        Campaign::empty().with("BS_T_NT_1200.mf4", &bs()).with("WhiteNoise_T_TN_1200.mf4", &white_noise())
    }

    pub(crate) fn with(self, name: &str, recording: &Recording) -> Self {
        let bytes = encode_mdf4(recording).expect("a recording that can be written");
        self.write(&format!("recordings/{name}"), &bytes);
        self
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.path(name), bytes).expect("writable");
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Ran {
        dynoid(self.folder.path(), arguments)
    }

    /// The names of all files in the folder of the results.
    pub(crate) fn results(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path("study")).into_iter().flatten();
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Runs the study and returns the text of every finding about a file.
    #[track_caller]
    pub(crate) fn findings_about(&self, file: &str) -> String {
        let study = self.run(&["study", "bench.toml", "--json"]).study();
        let findings = study["findings"].as_array().expect("findings");
        let about = findings.iter().filter(|found| found["file"] == format!("recordings/{file}"));
        let line = |found: &serde_json::Value| {
            [&found["severity"], &found["text"], &found["advice"]].map(|v| v.as_str().unwrap_or_default()).join(" ")
        };
        about.map(line).collect::<Vec<_>>().join("\n")
    }
}

/// A channel of a recording, to be tampered with.
pub(crate) fn channel<'a>(recording: &'a mut Recording, name: &str) -> &'a mut recording::Channel {
    recording.channels.iter_mut().find(|channel| channel.name == name).expect("the channel is there")
}

/// Text without tags, a symbol as `T_d*`.
pub(crate) fn text(html: &str) -> String {
    let html = html.replace("<sub>", "_").replace("</sub>", "").replace('\u{a0}', " ");
    let mut pieces = html.split('<');
    let first = pieces.next().unwrap_or_default().to_owned();
    let all = pieces.filter_map(|piece| piece.split_once('>')).fold(first, |all, (_, text)| all + text);
    all.split_whitespace().collect::<Vec<_>>().join(" ")
}
