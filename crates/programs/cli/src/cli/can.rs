//! Arguments of `dynoid can`.

use std::path::PathBuf;

use clap::Args;

use super::experiment::OnBenchArguments;
use super::number;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid can bench.toml whtc --engine-map engine.csv --model study/study.json
  dynoid can bench.toml whtc --engine-map engine.csv --recorded run.mf4
  dynoid can bench.toml tip-in --set to=180 --set ramp=0.1
  dynoid can bench.toml speed-step --require \"speed overshoot below 10 %\"
  dynoid can bench.toml sine-sweep --require \"torque phase at 5 Hz below 60 deg\"
  dynoid can bench.toml cycle.csv --by 1065.514
  dynoid can bench.toml map --model study/study.json --plot map.html
  dynoid can bench.toml map --want \"100 rpm at 2 Hz\" --want \"4000 rpm/s\"

TEST is one of these:
  a cycle of an engine (with --engine-map): whtc, nrtc, whsc, c1-rmc, d2-rmc, g2-rmc;
  a schedule of a vehicle (with --vehicle): wltc-3b, udds;
  a shape (numbers with --set): speed-step, torque-step, tip-in, tip-out,
    gear-shift, engine-start, coast-down, clutch-slip, sine-sweep;
    `dynoid experiment list tip-in` shows the numbers with defaults and units;
  an experiment of the method, such as Step_T_TN;
  a file of demands, as `dynoid experiment design` reads it;
  a file of a cycle with columns time, speed and torque, in units or in %;
    m in place of a torque means that the engine is motored;
  map: the largest sine over frequency and speed, and the largest gradient.

An engine map is a table with columns speed and torque, and motoring_torque if it was measured.

Requirement sets: 1065.514, 1036.545, whtc, nrtc, whsc. A cycle is judged by its own set unless --by names others. A shape or an experiment has no set of its own. Your own requirements:
  speed within 10 rpm for 95 %
  torque rise below 50 ms
  speed overshoot below 5 %
  torque settling within 2 % below 0.5 s

Requirements at a frequency:
  torque phase at 5 Hz below 60 deg
  shaft_torque amplitude at 12 Hz below 80 Nm

Without --recorded the test is simulated on many random benches, with the limits of the bench file. With --model they follow the covariance of the study's estimates. The exit code is 0 if 95 % of them keep everything and all limits are stated, and 1 otherwise. With --allow-unchecked, limits that are not stated do not count. Without any limit and requirement the test is not judged.

With --recorded the run is judged by the requirements alone, not by [limits], and no model is needed. A shape or an experiment then needs --by or --require. The exit code is 0 if it passes, and 1 if it fails.")]
pub(crate) struct CanArguments {
    #[command(flatten)]
    pub(crate) on: OnBenchArguments,
    /// The test: a cycle, a shape, an experiment, or a file
    #[arg(value_name = "TEST")]
    pub(crate) test: String,
    /// Judge this recording of the test instead of predicting it
    #[arg(long, value_name = "FILE", help_heading = "Test")]
    pub(crate) recorded: Option<PathBuf>,
    /// Full-load curve of the engine: a table of speed and torque
    #[arg(long, value_name = "FILE", help_heading = "Test")]
    pub(crate) engine_map: Option<PathBuf>,
    /// Warm idle speed [default: the lowest speed of the engine map, or of the cycle without one]
    #[arg(long, value_name = "RPM", value_parser = number::positive_rpm, help_heading = "Test")]
    pub(crate) idle: Option<f64>,
    /// Vehicle and gears for a cycle of vehicle speed: a TOML file
    #[arg(long, value_name = "FILE", help_heading = "Test")]
    pub(crate) vehicle: Option<PathBuf>,
    /// Requirement set; repeat it for more [default: that of the cycle]
    #[arg(long = "by", value_name = "SET", help_heading = "Requirements")]
    pub(crate) by: Vec<String>,
    /// A requirement of your own; repeat it for more
    #[arg(long = "require", value_name = "TEXT", help_heading = "Requirements")]
    pub(crate) require: Vec<String>,
    /// With `map`: a sine or a gradient that is wanted; repeat it for more
    #[arg(long = "want", value_name = "TEXT", help_heading = "Requirements")]
    pub(crate) want: Vec<String>,
    /// When the test begins in the recording, s [default: found by the speed]
    #[arg(long, value_name = "SECONDS", value_parser = number::seconds, help_heading = "Requirements", requires = "recorded")]
    pub(crate) start: Option<f64>,
    /// Number of random benches, 72 or more; of fewer, the 95 % interval of a full yes begins below 95 %
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = number::benches)]
    pub(crate) samples: u32,
    /// Exit with 0 although the bench file does not state every limit
    #[arg(long)]
    pub(crate) allow_unchecked: bool,
}
