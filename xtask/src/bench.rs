//! `cargo xtask bench`: the times of estimators and of whole commands, alone or beside those of other packages.

use std::path::Path;
use std::process::Command;

/// Numbers of samples beside peers, and with `--quick`.
const SAMPLES: [usize; 3] = [10_000, 100_000, 1_000_000];
const QUICK: usize = 2;

/// Runs the benchmark; with `--peers`, both sides one after the other for each number of samples.
pub(crate) fn run(arguments: &[String]) -> Result<(), String> {
    let arguments = absolute_paths(arguments)?;
    if arguments == ["--mdf"] {
        return mdf();
    }
    if let Some((first, others)) = arguments.split_first()
        && first == "--commands"
    {
        return commands(others);
    }
    let Some(position) = arguments.iter().position(|a| a == "--peers") else {
        return ours(&arguments);
    };
    let mut others = arguments;
    others.remove(position);
    let mut sizes = SAMPLES.to_vec();
    if let Some(position) = others.iter().position(|a| a == "--quick") {
        others.remove(position);
        sizes.truncate(QUICK);
    }
    if others.len() > 1 || others.iter().any(|a| a.starts_with('-')) {
        return Err("with --peers go --quick and one NAME only".into());
    }
    beside_peers(&sizes, &others)
}

fn beside_peers(sizes: &[usize], name: &[String]) -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = crate::folder::target()?.join("benchmark");
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let results = folder.join("results.tsv");
    std::fs::write(&results, "").map_err(|e| format!("{}: {e}", results.display()))?;
    let (folder, file) = (folder.display().to_string(), results.display().to_string());
    let python = std::env::var(crate::python::VARIABLE).unwrap_or_else(|_| "python3".into());
    for samples in sizes {
        let samples = samples.to_string();
        let options = ["--samples", &samples, "--write-data", &folder, "--results", &file];
        ours(&options.iter().map(|o| (*o).to_owned()).chain(name.iter().cloned()).collect::<Vec<_>>())?;
        let script = root.join("benchmarks/peers.py");
        let mut peers = Command::new(&python);
        peers.arg(script).args([&folder, &samples, &file]).args(name);
        succeed("the peers", &mut peers)?;
    }
    let lines = std::fs::read_to_string(&results).map_err(|e| format!("{}: {e}", results.display()))?;
    println!("\n{}", table(&lines));
    Ok(())
}

/// Reading MDF files of a gigabyte, beside asammdf.
fn mdf() -> Result<(), String> {
    let python = crate::python::interpreter()?.ok_or("there is no asammdf to compare with")?;
    let target = crate::folder::target()?;
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "--release", "--package", "mdf", "--example", "measure"]);
    succeed("building the reader", &mut build)?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../benchmarks/mdf.py");
    let (files, measure) = (target.join("benchmark/mdf"), target.join("release/examples/measure"));
    succeed("the comparison", Command::new(python).arg(script).arg(files).arg(measure))
}

/// Whole commands, beside scripts with other packages.
fn commands(arguments: &[String]) -> Result<(), String> {
    let python = crate::python::interpreter()?.ok_or("there are no packages to compare with")?;
    let target = crate::folder::target()?;
    // As the check builds it: the features of the program alone would build the large libraries again.
    let mut build = Command::new(env!("CARGO"));
    build.args(["test", "--workspace", "--release", "--no-run", "--quiet"]);
    succeed("building the program", &mut build)?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../benchmarks/commands.py");
    let (program, folder) = (target.join("release/dynoid"), target.join("benchmark/commands"));
    succeed("the comparison", Command::new(python).arg(script).arg(program).arg(folder).args(arguments))
}

fn ours(arguments: &[String]) -> Result<(), String> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["bench", "--quiet", "--package", "ident", "--bench", "estimators", "--"]).args(arguments);
    succeed("the benchmark", &mut cargo)
}

fn succeed(what: &str, command: &mut Command) -> Result<(), String> {
    let status = command.status().map_err(|error| format!("{what} could not be started: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{what} failed")) }
}

/// Cargo starts a benchmark in its crate's folder, so paths have to be absolute.
fn absolute_paths(arguments: &[String]) -> Result<Vec<String>, String> {
    let mut changed = arguments.to_vec();
    for i in 1..changed.len() {
        if ["--write-data", "--results"].contains(&arguments[i - 1].as_str()) {
            let path = std::path::absolute(&arguments[i]).map_err(|e| e.to_string())?;
            changed[i] = path.display().to_string();
        }
    }
    Ok(changed)
}

/// One line of the results: what was estimated, by which tool, at what cost.
struct Line<'a> {
    task: &'a str,
    samples: &'a str,
    tool: &'a str,
    wall_s: Option<f64>,
    processor_s: Option<f64>,
    error: Option<f64>,
    note: &'a str,
}

impl<'a> Line<'a> {
    fn parse(line: &'a str) -> Option<Self> {
        let fields: Vec<&str> = line.split('\t').collect();
        let [task, samples, tool, wall, processor, error, note] = fields[..] else { return None };
        let number = |text: &str| text.parse().ok();
        let (wall_s, processor_s, error) = (number(wall), number(processor), number(error));
        Some(Line { task, samples, tool, wall_s, processor_s, error, note })
    }

    /// Wall and processor time and the error.
    fn cells(&self) -> String {
        let time =
            |s: Option<f64>| s.map_or("–".into(), |s| if s < 0.01 { format!("{s:.5}") } else { format!("{s:.3}") });
        let error = self.error.map_or("–".into(), |e| format!("{e:.5}"));
        format!("{} | {} | {error}", time(self.wall_s), time(self.processor_s))
    }
}

/// Every peer's result beside ours, with the ratios of the times.
fn table(results: &str) -> String {
    let lines: Vec<Line> = results.lines().filter_map(Line::parse).collect();
    let mut text = String::from(
        "| task | samples | dynoid wall s | processor s | error \
         | peer | wall s | processor s | error | wall × | processor × |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for own in lines.iter().filter(|l| l.tool == "dynoid") {
        let start = format!("| {} | {} | {} |", own.task, own.samples, own.cells());
        let mut alone = true;
        for peer in lines.iter().filter(|l| l.tool != "dynoid" && l.task == own.task && l.samples == own.samples) {
            alone = false;
            if peer.wall_s.is_none() {
                text += &format!("{start} {} | {} | | | | |\n", peer.tool, peer.note);
                continue;
            }
            let (wall, processor) = (ratio(peer.wall_s, own.wall_s), ratio(peer.processor_s, own.processor_s));
            text += &format!("{start} {} | {} | {wall} | {processor} |\n", peer.tool, peer.cells());
        }
        if alone {
            text += &format!("{start} none | | | | | |\n");
        }
    }
    text
}

fn ratio(theirs: Option<f64>, ours: Option<f64>) -> String {
    match (theirs, ours) {
        (Some(theirs), Some(ours)) if ours > 0.0 => format!("{:.1}", theirs / ours),
        _ => "–".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snap_peers_stand_beside_ours_and_absent_ones_are_listed() {
        let results = "ARX\t10\tdynoid\t0.5\t0.25\t0.1\t\nARX\t10\tA\t2\t1\t0.2\t\nARX\t10\tB\t\t\t\tabsent\n\
                       IV\t10\tdynoid\t1\t\t0.1\t\n";
        let rows: Vec<String> = table(results).lines().skip(2).map(str::to_owned).collect();
        assert_eq!(rows[0], "| ARX | 10 | 0.500 | 0.250 | 0.10000 | A | 2.000 | 1.000 | 0.20000 | 4.0 | 4.0 |");
        assert_eq!(rows[1], "| ARX | 10 | 0.500 | 0.250 | 0.10000 | B | absent | | | | |");
        assert_eq!(rows[2], "| IV | 10 | 1.000 | – | 0.10000 | none | | | | | |");
    }
}
