"""FMUs in FMPy: validated, simulated as slaves and by CVode, and built from their sources. Prints NAME DIFFERENCE."""

import contextlib
import json
import os
import pathlib
import subprocess
import sys

import numpy as np
from fmpy import extract, platform, platform_tuple, read_model_description, simulate_fmu, supported_platforms
from fmpy.build import build_platform_binary
from fmpy.validation import validate_fmu
from instances import instance

OUTPUTS = ["dyno_speed", "engine_speed", "air_gap_torque", "shaft_torque", "limited_torque_demand"]
EXPECTED = ["w_d", "w_e", "T_d", "T_shaft", "T_d_demand"]
STEP_S = 1e-3
CHECK = "from fmu_manipulation_toolbox.cli.fmutool import fmutool; fmutool()"


def start_values(case, parameters):
    """The start of a case as the FMU has it."""
    dyno, engine, twist, torque, integrator = case["start"]
    return {
        "initial_speed": dyno,
        "initial_torque": torque,
        "initial_speed_difference": engine - dyno,
        "initial_twist_offset": twist - torque / parameters["K"],
        "initial_integrator_offset": integrator - (torque - parameters["k"] * dyno),
    }


class Slave:
    """An instance for Co-Simulation, of either version."""

    def __init__(self, path, folder):
        self.description = read_model_description(path)
        self.by_name = {v.name: v for v in self.description.modelVariables}
        self.is_fmi2 = self.description.fmiVersion == "2.0"
        self.fmu = instance(self.description, folder, "coSimulation")

    def set(self, values):
        references = [self.by_name[name].valueReference for name in values]
        numbers = [float(v) for v in values.values()]
        (self.fmu.setReal if self.is_fmi2 else self.fmu.setFloat64)(references, numbers)

    def get(self, names):
        references = [self.by_name[name].valueReference for name in names]
        return (self.fmu.getReal if self.is_fmi2 else self.fmu.getFloat64)(references)

    def choose(self, mode, draw=0):
        if self.is_fmi2:
            self.fmu.setInteger([40, 41], [mode, draw])
        else:
            self.fmu.setInt64([40], [mode])
            self.fmu.setInt32([41], [draw])

    def start(self, values, mode, draw=0):
        if self.is_fmi2:
            self.fmu.setupExperiment(startTime=0.0)
        self.choose(mode, draw)
        self.set(values)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def end(self):
        self.fmu.terminate()
        self.fmu.freeInstance()


def inputs_at(case, k):
    engine, demand = case["engine"], case["demand"]
    name = "speed_demand" if case["drive"] == "Speed" else "torque_demand"
    slope = (engine[min(k + 1, len(engine) - 1)] - engine[k]) / STEP_S
    return {name: demand[k], "engine_torque": engine[k], "engine_torque_rate": slope}


def stepped(path, folder, case, parameters, parts=(1.0,)):
    """What the FMU gives after each sample; each sample in the given parts."""
    slave = Slave(path, folder)
    slave.start(start_values(case, parameters), 1 if case["drive"] == "Speed" else 2)
    rows = []
    for k in range(len(case["engine"]) - 1):
        inputs, done = inputs_at(case, k), 0.0
        for part in parts:
            slave.set({**inputs, "engine_torque": inputs["engine_torque"] + inputs["engine_torque_rate"] * done * STEP_S})
            slave.fmu.doStep((k + done) * STEP_S, part * STEP_S)
            done += part
        rows.append(slave.get(OUTPUTS))
    slave.end()
    return np.array(rows).T


def difference(case, rows, has_lag):
    most = 0.0
    for name, key, row in zip(OUTPUTS, EXPECTED, rows):
        if key == "T_d" and not has_lag:
            continue  # at a sample the two differ by which side of the jump they show
        expected = np.array(case["expected"][key])
        # T_d* at an instant is that of the last sample, which the FMU has run.
        expected = expected[:-1] if key == "T_d_demand" else expected[1:]
        most = max(most, np.abs(row - expected).max() / np.abs(expected).max())
    return most


def exchanged(path, case, parameters, samples):
    """The largest difference with CVode, in Model Exchange. FMPy holds inputs between the outputs."""
    name = "speed_demand" if case["drive"] == "Speed" else "torque_demand"
    names = ["time", name, "engine_torque"]
    rows = [(k * STEP_S, case["demand"][k], case["engine"][k]) for k in range(samples + 1)]
    signals = np.array(rows, dtype=[(n, np.float64) for n in names])
    mode = 1 if case["drive"] == "Speed" else 2
    result = simulate_fmu(
        path, fmi_type="ModelExchange", solver="CVode", relative_tolerance=1e-12, stop_time=samples * STEP_S,
        output_interval=STEP_S, start_values={**start_values(case, parameters), "control_mode": mode}, input=signals,
        output=OUTPUTS, record_events=False,
    )
    most = 0.0
    for output, key in (("dyno_speed", "w_d"), ("shaft_torque", "T_shaft")):
        expected = np.array(case["expected"][key])[: samples + 1]
        most = max(most, np.abs(result[output][: samples + 1] - expected).max() / np.abs(expected).max())
    return most


def binary(unzipped):
    names = {"2.0": platform, "3.0": platform_tuple}
    version = read_model_description(unzipped).fmiVersion
    return next((pathlib.Path(unzipped) / "binaries" / names[version]).iterdir())


@contextlib.contextmanager
def redirected(file):
    """The output of this process and its children goes to a file."""
    sys.stdout.flush()
    kept = os.dup(1)
    os.dup2(file.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)


def drawn(path, unzipped):
    """How far the parameters of draw 7 are from its row, and whether what was set stays, and whether the range is told."""
    lines = (pathlib.Path(unzipped) / "extra/org.fmi-standard.fmi-ls-ref/draws.csv").read_text().splitlines()
    names, row = lines[0].split(","), [float(cell) for cell in lines[7].split(",")]
    slave = Slave(path, unzipped)
    slave.start({}, 1, draw=7)
    found = slave.get(names)
    slave.set({"B": 7.5})
    assert slave.get(["B", "K"]) == [7.5, row[0]]
    slave.fmu.doStep(0.0, 0.1)
    assert is_valid(slave)
    slave.set({"speed_demand": 600.0})
    slave.fmu.doStep(0.1, 5.0)
    assert not is_valid(slave)
    slave.end()
    return max(abs(a - b) / abs(b) for a, b in zip(found, row))


def turned(path, unzipped):
    """How far a torque that repeats with the engine's cycle, calculated from the angle, is from that of the angle turned: 2500 rad."""
    slave = Slave(path, unzipped)
    slave.start({"initial_speed": 500.0, "initial_torque": 0.0, "torque_demand": 0.0, "engine_torque": 0.0}, 2)
    time, angles = 0.05 * np.arange(1, 101), []
    for end in time:
        slave.fmu.doStep(end - 0.05, 0.05)
        angles += slave.get(["engine_angle"])
    slave.end()
    assert max(angles) < 2000.0, "the angle was taken back"
    pulse = lambda angle: 1.0 + np.cos(0.5 * angle) + np.sin(1.5 * angle)
    return np.abs(pulse(np.array(angles)) - pulse(500.0 * time)).max()


def is_valid(slave):
    values = slave.fmu.getBoolean([55])
    return bool(values[0])


def main(folder):
    document = json.loads((folder / "cases.json").read_text())
    parameters = document["parameters"]
    for version in ("fmi2", "fmi3"):
        path = str(folder / f"{version}.fmu")
        problems = validate_fmu(path)
        assert not problems, problems
        checked = subprocess.run([sys.executable, "-c", CHECK, "-input", path, "-check"], capture_output=True, text=True)
        said = checked.stdout + checked.stderr
        assert "seems to be compliant" in said and "No semantic error" in said, said
        assert len(supported_platforms(path)) >= 4, supported_platforms(path)
        unzipped = extract(path)
        if document["compile"]:
            print(version, "draw 7", drawn(path, unzipped))
            print(version, "pulse from the angle", turned(path, unzipped))
        for case in document["cases"]:
            has_lag = parameters["a"] > 0.0
            rows = stepped(path, unzipped, case, parameters)
            print(version, case["drive"], "co-simulation", difference(case, rows, has_lag))
            parts = stepped(path, unzipped, case, parameters, parts=(0.3, 0.45, 0.25))
            print(version, case["drive"], "parts of samples", difference(case, parts, has_lag))
        for case in document["exchanged"]:
            # CVode is as exact as its tolerance.
            found = exchanged(path, case, parameters, 300)
            assert found < 1e-7, found
            print(version, case["drive"], f"model exchange, apart by {found}: within the tolerance", 0.0)
        if document["compile"]:
            # CMake is a package beside this Python, and writes to the output of this process.
            os.environ["PATH"] = os.pathsep.join([os.path.dirname(sys.executable), os.environ["PATH"]])
            before = binary(unzipped).read_bytes()
            with open(os.devnull, "w") as nowhere, redirected(nowhere):
                build_platform_binary(unzipped)
            assert binary(unzipped).read_bytes() != before
            case = document["cases"][0]
            rows = stepped(path, unzipped, case, parameters)
            print(version, "from sources", difference(case, rows, has_lag))


main(pathlib.Path(sys.argv[1]))
