"""FMUs of linear models in FMPy: validated, stepped through, simulated by events, and built from their sources. Prints NAME DIFFERENCE."""

import json
import os
import pathlib
import subprocess
import sys

import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.build import build_platform_binary
from fmpy.validation import validate_fmu
from instances import instance

CHECK = "from fmu_manipulation_toolbox.cli.fmutool import fmutool; fmutool()"


def slave(description, folder):
    is_fmi2 = description.fmiVersion == "2.0"
    fmu = instance(description, folder, "coSimulation")
    if is_fmi2:
        fmu.setupExperiment(startTime=0.0)
    return fmu, (fmu.setReal if is_fmi2 else fmu.setFloat64), (fmu.getReal if is_fmi2 else fmu.getFloat64)


def references(description, causality):
    return [v.valueReference for v in description.modelVariables if v.causality == causality]


def stepped(description, folder, case):
    """The outputs at each sample and within it, in two steps a sample."""
    fmu, set_values, get_values = slave(description, folder)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    inputs, outputs = references(description, "input"), references(description, "output")
    step, at, within = case["step"], [], []
    for k, row in enumerate(case["u"]):
        set_values(inputs, row)
        at.append(get_values(outputs))
        fmu.doStep(k * step, 0.4 * step)
        set_values(inputs, [7.0 for _ in row])  # the sample has been taken
        within.append(get_values(outputs))
        fmu.doStep((k + 0.4) * step, 0.6 * step)
    fmu.terminate()
    fmu.freeInstance()
    return np.array(at), np.array(within)


def by_events(path, description, case):
    """The outputs in Model Exchange, in the middle of each sample."""
    names = [v.name for v in description.modelVariables if v.causality == "input"]
    outputs = [v.name for v in description.modelVariables if v.causality == "output"]
    step, count = case["step"], len(case["u"])
    signals = np.zeros(count, dtype=[("time", float)] + [(name, float) for name in names])
    signals["time"] = np.arange(count) * step
    for j, name in enumerate(names):
        signals[name] = np.array(case["u"])[:, j]
    result = simulate_fmu(path, fmi_type="ModelExchange", input=signals, output=outputs, stop_time=(count - 1) * step,
                          output_interval=step, record_events=True)
    time = result["time"]
    last = np.searchsorted(time, np.arange(count - 1) * step + 0.5 * step) - 1
    return np.column_stack([result[name][last] for name in outputs])


def drawn(description, folder, draws):
    """Whether the first draw is another model, and a draw that does not exist is refused."""
    fmu, _, _ = slave(description, folder)
    choose = fmu.setInteger if description.fmiVersion == "2.0" else fmu.setInt32
    choose([1], [draws])
    try:
        choose([1], [draws + 1])
    except Exception:
        fmu.freeInstance()
        return
    raise AssertionError("a draw beyond the last one is taken")


def main(folder):
    for name, case in json.loads((folder / "cases.json").read_text()).items():
        expected = np.array(case["y"])
        for version in ("fmi2", "fmi3"):
            path = str(folder / f"{name}_{version}.fmu")
            problems = validate_fmu(path)
            assert not problems, problems
            checked = subprocess.run([sys.executable, "-c", CHECK, "-input", path, "-check"], capture_output=True, text=True)
            said = checked.stdout + checked.stderr
            assert "seems to be compliant" in said and "No semantic error" in said, said
            description, unzipped = read_model_description(path), extract(path)
            drawn(description, unzipped, case["draws"])
            size = np.abs(expected).max()
            at, within = stepped(description, unzipped, case)
            print(name, version, "at samples", np.abs(at - expected).max() / size)
            print(name, version, "within samples", np.abs(within - expected).max() / size)
            found = by_events(path, description, case)
            print(name, version, "model exchange", np.abs(found - expected[:-1]).max() / size)
            if name == "arx":
                os.environ["PATH"] = os.pathsep.join([os.path.dirname(sys.executable), os.environ["PATH"]])
                build_platform_binary(unzipped)
                at, _ = stepped(description, unzipped, case)
                print(name, version, "from sources", np.abs(at - expected).max() / size)


main(pathlib.Path(sys.argv[1]))
