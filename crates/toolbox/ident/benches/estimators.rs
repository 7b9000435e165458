//! Times of the estimators, and their distances from the truth: `cargo xtask bench`.
//!
//! One input that is −1 or 1, held for three samples; white Gaussian noise of standard deviation 0.5; three outputs of
//! the same input and noise, so that every structure has data that it can describe:
//!
//! | output | equation |
//! | --- | --- |
//! | ARMAX | `A y = B u + C e` |
//! | output error | `y = B/A u + e` |
//! | Box–Jenkins | `y = B/A u + C/D e` |
//!
//! A = [1 −1.5 0.7], B = [0 1 0.5], C = [1 −1 0.2], D = [1 −1.2 0.5].
#![allow(clippy::print_stdout, reason = "the table is what this program is for")]
#![allow(clippy::disallowed_types, clippy::disallowed_methods, reason = "a program, outside of the crate it measures")]

use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use faer::Mat;
use ident::{Armax, Arx, BoxJenkins, Criterion, Dataset, Iv4, OrderScan, OutputError, Subspace};
use lti::{PolynomialEquation, PolynomialModel, StateSpace};
use signal::excitation::Random;

const A: [f64; 2] = [-1.5, 0.7];
const B: [f64; 2] = [1.0, 0.5];
const C: [f64; 2] = [-1.0, 0.2];
const D: [f64; 2] = [-1.2, 0.5];
const NOISE: f64 = 0.5;
const HELD_SAMPLES: usize = 3;
const RUNS: usize = 3;
/// Short tasks are repeated for so long in each run: processor time is counted in steps of 10 ms.
const LEAST_RUN_S: f64 = 0.3;

const USAGE: &str = "usage: estimators [--quick] [--samples N] [--write-data FOLDER] [--results FILE] [NAME]

  --quick              10⁴ and 10⁵ samples only
  --samples N          this number of samples only
  --write-data FOLDER  also write the data as data-N.csv
  --results FILE       also append the results to a file, tab-separated
  NAME                 only tasks with this in their name";

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let options = Options::from_arguments()?;
    println!("{:<17}{:>9}{:>13}{:>13}{:>11}  error", "task", "samples", "wall s", "processor s", "µs/sample");
    for samples in &options.samples {
        let data = Data::new(*samples)?;
        if let Some(folder) = &options.data_folder {
            data.write(folder)?;
        }
        for task in TASKS.iter().filter(|t| t.name.to_lowercase().contains(&options.name)) {
            let measured = measure(task, &data)?;
            report(task, *samples, &measured, options.results.as_deref())?;
        }
    }
    Ok(())
}

struct Options {
    samples: Vec<usize>,
    data_folder: Option<PathBuf>,
    results: Option<PathBuf>,
    name: String,
}

impl Options {
    fn from_arguments() -> Outcome<Self> {
        let mut options = Options {
            samples: vec![10_000, 100_000, 1_000_000],
            data_folder: None,
            results: None,
            name: String::new(),
        };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                // Cargo's own, given to every benchmark.
                "--bench" => {}
                "--quick" => options.samples = vec![10_000, 100_000],
                "--samples" => options.samples = vec![arguments.next().ok_or(USAGE)?.parse()?],
                "--write-data" => options.data_folder = Some(arguments.next().ok_or(USAGE)?.into()),
                "--results" => options.results = Some(arguments.next().ok_or(USAGE)?.into()),
                name if !name.starts_with('-') => options.name = name.to_lowercase(),
                _ => return Err(USAGE.into()),
            }
        }
        Ok(options)
    }
}

/// The input and the three outputs.
struct Data {
    u: Vec<f64>,
    armax: Vec<f64>,
    output_error: Vec<f64>,
    box_jenkins: Vec<f64>,
}

impl Data {
    fn new(samples: usize) -> Outcome<Self> {
        let mut random = Random::new(1);
        let mut level = 1.0;
        let (mut u, mut e) = (Vec::with_capacity(samples), Vec::with_capacity(samples));
        for t in 0..samples {
            if t % HELD_SAMPLES == 0 {
                level = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
            }
            u.push(level);
            e.push(NOISE * random.normal());
        }
        let x = filtered(&[0.0, B[0], B[1]], &A, &u);
        let sum = |v: Vec<f64>| x.iter().zip(v).map(|(x, v)| x + v).collect::<Vec<_>>();
        let monic_c = [1.0, C[0], C[1]];
        let (armax, box_jenkins) = (sum(filtered(&monic_c, &A, &e)), sum(filtered(&monic_c, &D, &e)));
        Ok(Data { output_error: sum(e), u, armax, box_jenkins })
    }

    fn dataset(&self, system: System) -> Outcome<Dataset> {
        let y = match system {
            System::Armax => &self.armax,
            System::OutputError => &self.output_error,
            System::BoxJenkins => &self.box_jenkins,
        };
        Ok(Dataset::siso(1.0, &self.u, y)?)
    }

    /// Writes `data-N.csv` with every digit, so that others estimate from the same numbers.
    fn write(&self, folder: &Path) -> Outcome<()> {
        std::fs::create_dir_all(folder)?;
        let file = std::fs::File::create(folder.join(format!("data-{}.csv", self.u.len())))?;
        let mut file = std::io::BufWriter::new(file);
        writeln!(file, "u,y_armax,y_oe,y_bj")?;
        for t in 0..self.u.len() {
            writeln!(file, "{},{},{},{}", self.u[t], self.armax[t], self.output_error[t], self.box_jenkins[t])?;
        }
        Ok(file.flush()?)
    }
}

/// `y(t) = Σ num_l u(t − l) − Σ den_l y(t − l)`, from rest; the leading one of the denominator is left out.
fn filtered(num: &[f64], den: &[f64], u: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; u.len()];
    for t in 0..u.len() {
        let forced: f64 = num.iter().enumerate().filter(|(l, _)| *l <= t).map(|(l, b)| b * u[t - l]).sum();
        let past: f64 = den.iter().enumerate().filter(|(l, _)| *l < t).map(|(l, a)| a * y[t - l - 1]).sum();
        y[t] = forced - past;
    }
    y
}

/// Which of the three systems a task is about.
#[derive(Clone, Copy)]
enum System {
    Armax,
    OutputError,
    BoxJenkins,
}

/// An estimation: from data to the error of what was estimated.
struct Task {
    name: &'static str,
    system: System,
    /// Measure of the error: `g`, the norm of the error of the impulse response over the norm of the truth; `p`, the
    /// largest error of a coefficient of the polynomials named.
    measure: &'static str,
    run: fn(&Dataset) -> Outcome<f64>,
}

const TASKS: [Task; 7] = [
    Task { name: "ARX(4,4,1)", system: System::Armax, measure: "g", run: arx },
    Task { name: "ARMAX(2,2,2,1)", system: System::Armax, measure: "p(A,B,C)", run: armax },
    Task { name: "OE(2,2,1)", system: System::OutputError, measure: "p(B,F)", run: output_error },
    Task { name: "BJ(2,2,2,2,1)", system: System::BoxJenkins, measure: "p(B,F)", run: box_jenkins },
    Task { name: "N4SID(4)", system: System::Armax, measure: "g", run: subspace },
    Task { name: "IV4(2,2,1)", system: System::Armax, measure: "g", run: four_step },
    Task { name: "ARX scan 10×10", system: System::Armax, measure: "g", run: scan },
];

fn arx(data: &Dataset) -> Outcome<f64> {
    response_error(&Arx::new(4, 4, 1).fit(data)?.model)
}

fn armax(data: &Dataset) -> Outcome<f64> {
    let model = Armax::new(2, 2, 2, 1).fit(data)?.model;
    let e = equation(&model)?;
    Ok(largest(&[(&e.a[0], &A), (&e.b[0], &B), (&e.c, &C)]))
}

fn output_error(data: &Dataset) -> Outcome<f64> {
    let model = OutputError::new(2, 2, 1).fit(data)?.model;
    let e = equation(&model)?;
    Ok(largest(&[(&e.b[0], &B), (&e.f[0], &A)]))
}

fn box_jenkins(data: &Dataset) -> Outcome<f64> {
    let model = BoxJenkins::new(2, 2, 2, 2, 1).fit(data)?.model;
    let e = equation(&model)?;
    Ok(largest(&[(&e.b[0], &B), (&e.f[0], &A)]))
}

fn subspace(data: &Dataset) -> Outcome<f64> {
    impulse_error(Subspace::new(4).fit(data)?.model.system())
}

fn four_step(data: &Dataset) -> Outcome<f64> {
    response_error(&Iv4::new(2, 2, 1).fit(data)?.model)
}

/// The scan alone is what others do; the error is that of the structure which the Bayesian criterion picks.
fn scan(data: &Dataset) -> Outcome<f64> {
    let table = OrderScan::new(1..=10, 1..=10, 1..=1).run(data)?;
    response_error(&table.arx(table.best(Criterion::Bic)).fit(data)?.model)
}

fn equation(model: &PolynomialModel) -> Outcome<&PolynomialEquation> {
    Ok(model.equations().first().ok_or("a model without an equation")?)
}

fn largest(pairs: &[(&[f64], &[f64])]) -> f64 {
    let errors = pairs.iter().flat_map(|(found, truth)| found.iter().zip(*truth).map(|(f, t)| (f - t).abs()));
    errors.fold(0.0, f64::max)
}

fn response_error(model: &PolynomialModel) -> Outcome<f64> {
    impulse_error(&model.transfer_function(0, 0)?.to_state_space()?)
}

fn impulse_error(system: &StateSpace) -> Outcome<f64> {
    const LENGTH: usize = 100;
    let mut impulse = vec![0.0; LENGTH];
    impulse[0] = 1.0;
    let truth = filtered(&[0.0, B[0], B[1]], &A, &impulse);
    let u = Mat::from_fn(LENGTH, 1, |t, _| impulse[t]);
    let found = system.simulate(u.as_ref(), &vec![0.0; system.states()])?;
    let error: f64 = (0..LENGTH).map(|t| (found[(t, 0)] - truth[t]).powi(2)).sum();
    Ok((error / truth.iter().map(|h| h * h).sum::<f64>()).sqrt())
}

/// Seconds of one estimation, and its error.
struct Measured {
    wall_s: f64,
    /// `None` if the system does not report it.
    processor_s: Option<f64>,
    error: f64,
}

/// One run to warm up, then the median of the others; processor time is their mean.
fn measure(task: &Task, data: &Data) -> Outcome<Measured> {
    let data = data.dataset(task.system)?;
    let clock = Instant::now();
    let error = (task.run)(&data)?;
    let repetitions = (LEAST_RUN_S / clock.elapsed().as_secs_f64()).ceil().max(1.0) as usize;
    let before = processor_s();
    let mut walls = Vec::with_capacity(RUNS);
    for _ in 0..RUNS {
        let clock = Instant::now();
        for _ in 0..repetitions {
            std::hint::black_box((task.run)(std::hint::black_box(&data))?);
        }
        walls.push(clock.elapsed().as_secs_f64() / repetitions as f64);
    }
    let used = before.zip(processor_s()).map(|(before, after)| (after - before) / (RUNS * repetitions) as f64);
    walls.sort_by(f64::total_cmp);
    Ok(Measured { wall_s: walls[RUNS / 2], processor_s: used, error })
}

/// Processor time of this process over all of its threads, if the system reports it.
fn processor_s() -> Option<f64> {
    /// Of Linux, on every architecture that matters here.
    const TICKS_A_SECOND: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program stands in parentheses and may hold blanks; user and system time are fields 14 and 15.
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / TICKS_A_SECOND)
}

fn report(task: &Task, samples: usize, measured: &Measured, results: Option<&Path>) -> Outcome<()> {
    let Measured { wall_s, processor_s, error } = measured;
    let processor = processor_s.map_or("–".to_owned(), |s| format!("{s:.5}"));
    let per_sample = 1e6 * wall_s / samples as f64;
    let Task { name, measure, .. } = task;
    println!("{name:<17}{samples:>9}{wall_s:>13.5}{processor:>13}{per_sample:>11.3}  {measure} {error:.5}");
    if let Some(path) = results {
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path)?;
        let cpu = processor_s.map_or(String::new(), |s| s.to_string());
        writeln!(file, "{name}\t{samples}\tdynoid\t{wall_s}\t{cpu}\t{error}\t")?;
    }
    Ok(())
}
