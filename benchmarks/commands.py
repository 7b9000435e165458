"""Times whole commands of dynoid beside scripts that do the same with other packages, on the same files, in one run.

    commands.py DYNOID FOLDER [--quick] [--growth] [NAME]

Every run is a process of its own, from its start to its end, reading the file included. The runs of a task go by turns, so that what
disturbs the machine disturbs all. The files are made once, in FOLDER. With NAME, the tasks whose name contains it.
"""

import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from commands_data import A, B, DELAY_S, GAIN, LAG_S

HERE = Path(__file__).resolve().parent
TURNS = 3
LONG_S = 20.0
"""A task whose first turn takes longer has no other."""
LONG_OUTPUT = 10**6
"""Numbers of so many bytes are not read: a spectrum, whose error is not compared."""
LIMIT_S = 300.0
"""Where ten times the samples would take longer, growth ends."""
BENCH = """[bench]
name = "bench"
variant = "load-cell"
cylinders = 4
dynamometer_inertia = "0.6 kg m²"
engine_inertia = "0.28 kg m²"
[limits]
torque = "400 Nm"
[channels]
dyno_speed = "DynoSpeed"
engine_speed = "EngineSpeed"
dyno_speed_demand = "DynoSpeedDemand"
dyno_torque_demand = "DynoTorqueDemand"
air_gap_torque = "DynoTorqueCalc"
load_cell_torque = "DynoTorqueMeas"
[recordings]
files = ["recordings/*.mf4"]
"""


def make_campaign(dynoid, folder, seconds):
    recordings = folder / "recordings"
    recordings.mkdir(parents=True, exist_ok=True)
    bench = folder / "bench.toml"
    bench.write_text(BENCH)
    for test in ("BS_T_NT", "WhiteNoise_T_TN", "Ramp_N_NT", "NoShaft_N_NT"):
        to = recordings / f"{test}_1200.mf4"
        if not to.exists():
            part = folder / f"{test}.mf4"
            options = ["--speed", "1200", "--duration", str(seconds), "--out", part, "--quiet", "--overwrite"]
            subprocess.run([dynoid, "experiment", "simulate", bench, test, *options], check=True)
            part.replace(to)


def make_demo(dynoid, demo):
    if not (demo / "bench.toml").exists():
        part = demo.with_suffix(".part")
        subprocess.run([dynoid, "demo", "--out", part, "--quiet"], check=True)
        part.replace(demo)


class Run:
    """Wall and processor time in s, peak memory in MB, and what was printed, unless it is long."""

    def __init__(self, command):
        start = time.perf_counter()
        # Into a file: the peak of a process counts the memory that its parent had when it started it.
        with tempfile.TemporaryFile() as printed, tempfile.TemporaryFile() as errors:
            streams = {"stdin": subprocess.DEVNULL, "stdout": printed, "stderr": errors}
            process = subprocess.Popen([str(word) for word in command], **streams)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self.wall_s = time.perf_counter() - start
            self.processor_s = usage.ru_utime + usage.ru_stime
            self.memory_mb = usage.ru_maxrss / 1000
            # A bad verdict is a result too.
            if process.returncode not in (0, 1):
                errors.seek(0)
                raise RuntimeError(f"{command}: {errors.read().decode().strip().splitlines()[-1:]}")
            if os.fstat(printed.fileno()).st_size < LONG_OUTPUT:
                printed.seek(0)
                self.output = printed.read().decode()


def coefficient_error(found, truth):
    return max(abs(one - true) for one, true in zip(found, truth, strict=True))


def of_parameters(truth):
    def error(printed):
        parameters = json.loads(printed)["model"]["estimate"]["parameters"]
        return coefficient_error([one["value"] if isinstance(one, dict) else one for one in parameters], truth)

    return error


def of_numbers(truth):
    """The largest error of the numbers that a peer prints."""
    return lambda printed: coefficient_error(json.loads(printed), truth)


class Task:
    def __init__(self, name, ours, error=None, peers=()):
        """`peers`: name, command, how to read its error, and what it does not do."""
        self.name, self.ours, self.error, self.peers = name, ours, error, peers


def tasks(dynoid, folder, stem):
    """What grows with the number of samples."""
    csv, parquet, mdf = (stem.with_suffix(end) for end in (".csv", ".parquet", ".mf4"))
    script = HERE / "commands_peer.py"
    octave = shutil.which("octave-cli")
    arx = A[1:] + B[1:]
    lag = [GAIN, LAG_S, DELAY_S]

    def python(what, file):
        return [sys.executable, script, what, file]

    def in_octave(what, file):
        return [octave, "--quiet", "--no-gui", "--no-init-file", HERE / "commands_peer.m", what, file] if octave else None

    def fit(structure, file, *options):
        return [dynoid, "fit", structure, file, "--json", "--quiet", *options]

    arx_options = ("-u", "u", "-y", "y", "--na", "4", "--nb", "4", "--nk", "1")
    no_more = "no covariance, no residual tests, no check of the data"
    own_arx = of_parameters(arx)
    both = ("-u", "u", "-u", "u2", "-y", "y", "-y", "y2")
    return [
        Task("fit arx 4,4,1; CSV", fit("arx", csv, *arx_options), own_arx, [
            ("numpy lstsq", python("arx", csv), of_numbers(arx), no_more),
            ("Octave", in_octave("arx", csv), of_numbers(arx), no_more),
        ]),
        Task("fit arx 4,4,1; Parquet", fit("arx", parquet, *arx_options), own_arx, [
            ("numpy lstsq", python("arx", parquet), of_numbers(arx), no_more),
        ]),
        Task("fit arx 4,4,1; MDF", fit("arx", mdf, *arx_options), own_arx, [
            ("numpy lstsq, asammdf", python("arx", mdf), of_numbers(arx), no_more),
        ]),
        Task("fit oe 4,4,1; Parquet", fit("oe", parquet, "-u", "u", "-y", "oe", "--nb", "4", "--nf", "4", "--nk", "1"), None, [
            ("scipy, analytic Jacobian", python("oe", parquet), None, no_more + ", no initial states"),
        ]),
        Task("fit process P1D; Parquet",
             fit("process", parquet, "-u", "held", "-y", "lag", "--structure", "P1D", "--delay", "0:0.05"), None, [
            ("scipy, delays tried", python("process", parquet), of_numbers(lag), no_more + ", delays of whole samples"),
        ]),
        Task("fit tf, 1 pole; Parquet", fit("tf", parquet, "-u", "held", "-y", "lag", "--poles", "1", "--delay", "0:0.05"), None, [
            ("scipy, delays tried", python("process", parquet), None, no_more + ", delays of whole samples"),
        ]),
        Task("fit ss --subspace, order 10, 2×2", fit("ss", parquet, *both, "--order", "10", "--subspace"), None, [
            ("Octave n4sid", in_octave("n4sid", csv), None, no_more),
        ]),
        Task("fit ss, order 4, 2×2", fit("ss", parquet, *both, "--order", "4"), None, []),
        Task("data spectrum --method welch", [dynoid, "data", "spectrum", parquet, "-u", "u", "-y", "y", "--method", "welch", "--json", "--quiet"], None, [
            ("scipy welch and csd", python("welch", parquet), None, "no intervals, no noise spectrum"),
        ]),
        Task("data spectrum --method lpm", [dynoid, "data", "spectrum", parquet, "-u", "u", "-y", "y", "--method", "lpm", "--json", "--quiet"], None, []),
        Task("data delay", [dynoid, "data", "delay", parquet, "-u", "held", "-y", "lag", "--json", "--quiet"], None, [
            ("numpy, ARX(2,2) over delays", python("delay", parquet), None, "no interval, no continuous delay"),
        ]),
        Task("convert CSV to Parquet", [dynoid, "convert", csv, "--out", folder / "converted.parquet", "--overwrite", "--quiet"], None, [
            ("pyarrow", python("convert", csv), None, "no check of the time column"),
        ]),
    ]


def bench_folders(folder, lengths):
    """Those of the campaigns by their length in s, and the demo's."""
    return {seconds: folder / f"campaign-{seconds}" for seconds in lengths}, folder / "demo"


def bench_tasks(dynoid, folder, lengths):
    """Campaigns of four recordings, an hour of simulation, and the demo's nine recordings, about five minutes of data."""
    campaigns, demo = bench_folders(folder, lengths)
    campaigns = {seconds: campaign / "bench.toml" for seconds, campaign in campaigns.items()}
    campaign, demo = campaigns[lengths[0]], demo / "bench.toml"
    studies = [
        ("study, demo", [demo]),
        ("study --full, demo", [demo, "--full"]),
        *[(f"study, 4 × {seconds // 60} min", [campaign]) for seconds, campaign in campaigns.items()],
    ]
    parts = ("lines", "torque-signals", "torque-control", "controller", "shaft", "engine", "friction")
    hour = ["--duration", "3600", "--out", folder / "hour.mf4", "--overwrite", "--quiet"]
    return [
        *[Task(name, [dynoid, "study", *what, "--out", folder / "study", "--quiet"]) for name, what in studies],
        *[Task(f"{part}, demo", [dynoid, part, demo, "--json", "--quiet"]) for part in parts],
        Task("simulate 1 h", [dynoid, "experiment", "simulate", campaign, "BS_T_NT", *hour]),
    ]


def compare(task):
    """One row a peer; the runs go by turns."""
    contenders = [("dynoid", task.ours, task.error)] + [peer[:3] for peer in task.peers if peer[1]]
    runs = {name: [] for name, *_ in contenders}
    for turn in range(TURNS):
        for name, command, _ in contenders:
            if turn == 0 or runs[name][0].wall_s < LONG_S:
                runs[name].append(Run(command))
    rows = {}
    for name, _, error in contenders:
        median = lambda of: statistics.median(getattr(run, of) for run in runs[name])
        rows[name] = [median("wall_s"), median("processor_s"), median("memory_mb"), error(runs[name][0].output) if error else None]
    return rows


def cells(row):
    wall, processor, memory, error = row
    return f"{wall:.2f} | {processor:.2f} | {memory:.0f} | {'–' if error is None else f'{error:.2g}'}"


def table(all_tasks):
    print("| command | wall s | CPU s | MB | error | peer | wall s | CPU s | MB | error | CPU × | what the peer does not do |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for task in all_tasks:
        try:
            rows = compare(task)
        except RuntimeError as problem:
            print(f"| {task.name} | failed: {problem} |")
            continue
        ours = rows["dynoid"]
        if not task.peers:
            print(f"| {task.name} | {cells(ours)} | none | | | | | | |", flush=True)
        for name, command, _, lacks in task.peers:
            start = f"| {task.name} | {cells(ours)} | {name} |"
            if command is None:
                print(f"{start} not installed | | | | | |", flush=True)
            else:
                print(f"{start} {cells(rows[name])} | {rows[name][1] / ours[1]:.1f} | {lacks} |", flush=True)


def growth(dynoid, folder, sizes, chosen):
    """Time and memory of every command over the number of samples."""
    print("| command | samples | wall s | CPU s | MB | CPU µs a sample |")
    print("| --- | --- | --- | --- | --- | --- |")
    last = {}
    for samples in sizes:
        stem = data(dynoid, folder, samples)
        for task in tasks(dynoid, folder, stem):
            if chosen not in task.name:
                continue
            if last.get(task.name, 0.0) > LIMIT_S / 10.0:
                print(f"| {task.name} | {samples} | not run |")
                continue
            try:
                run = Run(task.ours)
            except RuntimeError as problem:
                print(f"| {task.name} | {samples} | failed: {problem} |")
                last[task.name] = LIMIT_S
                continue
            last[task.name] = run.wall_s
            per_sample = 1e6 * run.processor_s / samples
            print(f"| {task.name} | {samples} | {run.wall_s:.2f} | {run.processor_s:.2f} | {run.memory_mb:.0f} | {per_sample:.2f} |", flush=True)


def data(dynoid, folder, samples):
    stem = folder / f"data-{samples}"
    if not stem.with_suffix(".csv").exists():
        subprocess.run([sys.executable, HERE / "commands_data.py", stem, str(samples)], check=True)
    mdf = stem.with_suffix(".mf4")
    if not mdf.exists():
        subprocess.run([dynoid, "convert", stem.with_suffix(".parquet"), "--out", mdf, "--quiet"], check=True)
    return stem


def main(arguments):
    flags = {word for word in arguments if word.startswith("--")}
    words = [word for word in arguments if not word.startswith("--")]
    if flags - {"--quick", "--growth"} or not 2 <= len(words) <= 3:
        sys.exit(__doc__)
    dynoid, folder, chosen = words[0], Path(words[1]), words[2] if len(words) == 3 else ""
    folder.mkdir(parents=True, exist_ok=True)
    quick = "--quick" in flags
    if "--growth" in flags:
        return growth(dynoid, folder, [10**5, 10**6] if quick else [10**5, 10**6, 10**7], chosen)
    samples = 10**5 if quick else 10**6
    stem = data(dynoid, folder, samples)
    lengths = [60] if quick else [600, 3600]
    chosen_tasks = [task for task in tasks(dynoid, folder, stem) + bench_tasks(dynoid, folder, lengths) if chosen in task.name]
    used = {word for task in chosen_tasks for word in task.ours if isinstance(word, Path)}
    campaigns, demo = bench_folders(folder, lengths)
    for seconds, campaign in campaigns.items():
        if campaign / "bench.toml" in used:
            make_campaign(dynoid, campaign, seconds)
    if demo / "bench.toml" in used:
        make_demo(dynoid, demo)
    print(f"{samples} samples, {os.cpu_count()} cores; medians of {TURNS} turns\n")
    table(chosen_tasks)


main(sys.argv[1:])
