"""Times other identification packages on the data that the benchmark of dynoid wrote.

usage: peers.py FOLDER SAMPLES RESULTS [NAME]

Reads FOLDER/data-SAMPLES.csv and appends a line for each task and package to RESULTS. A package that is not installed
is listed as absent, a task that would take more than two minutes (judged by fewer samples in the same file) as
skipped.
"""

import os

for name in ("OPENBLAS", "OMP", "MKL", "NUMEXPR", "BLIS"):
    os.environ[f"{name}_NUM_THREADS"] = "1"

import contextlib
import importlib.util
import io
import math
import shutil
import statistics
import subprocess
import sys
import time
import warnings
from pathlib import Path

LIMIT_S = 120.0
"""Nothing is started that would take longer."""
LONG_S = 10.0
"""A run that takes longer is not repeated."""
LEAST_RUN_S = 0.1

A = [1.0, -1.5, 0.7]
B = [0.0, 1.0, 0.5]
C = [1.0, -1.0, 0.2]


def response(num, den, length=100):
    """Impulse response of num/den in powers of the backward shift."""
    h = []
    for t in range(length):
        past = sum(den[l] * h[t - l] for l in range(1, min(len(den), t + 1)))
        h.append(((num[t] if t < len(num) else 0.0) - past) / den[0])
    return h


def relative(h):
    truth = response(B, A)
    size = math.fsum(x * x for x in truth)
    return math.sqrt(math.fsum((x - y) ** 2 for x, y in zip(h, truth)) / size)


def largest(*pairs):
    return max(abs(float(x) - y) for found, truth in pairs for x, y in zip(found, truth, strict=True))


def sysidentpy_model(u, y, order, method, estimator):
    from sysidentpy.basis_function import Polynomial

    model = method(
        order_selection=False,
        n_terms=2 * order,
        xlag=order,
        ylag=order,
        estimator=estimator,
        basis_function=Polynomial(degree=1),
    )
    model.fit(X=u.reshape(-1, 1), y=y.reshape(-1, 1))
    a, b = [1.0] + [0.0] * order, [0.0] * (order + 1)
    for (code,), value in zip(model.final_model, model.theta.ravel()):
        if code // 1000 == 1:
            a[code % 1000] = -float(value)
        elif code // 1000 == 2:
            b[code % 1000] = float(value)
    return a, b


def sysidentpy_arx(data):
    from sysidentpy.model_structure_selection import FROLS
    from sysidentpy.parameter_estimation import LeastSquares

    a, b = sysidentpy_model(data["u"], data["y_armax"], 4, FROLS, LeastSquares())
    return lambda: relative(response(b, a))


def sysidentpy_armax(data):
    from sysidentpy.model_structure_selection import FROLS
    from sysidentpy.parameter_estimation import LeastSquares

    a, b = sysidentpy_model(data["u"], data["y_armax"], 2, FROLS, LeastSquares(unbiased=True))
    return lambda: largest((a, A), (b, B))


def sippy(data, y, method, **options):
    from sippy_unipi import system_identification

    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return system_identification(data[y], data["u"], method, **options)


def coefficients(system):
    """Numerator and denominator of a transfer function of python-control, the delay as leading zeros."""
    num, den = list(system.num[0][0]), list(system.den[0][0])
    num = [0.0] * (len(den) - len(num)) + num
    while len(num) > 3 and num[-1] == den[-1] == 0.0:
        num, den = num[:-1], den[:-1]
    return num, den


def sippy_arx(data):
    model = sippy(data, "y_armax", "ARX", ARX_orders=[4, 4, 0])
    return lambda: relative(response(*coefficients(model.G)))


def sippy_armax(data):
    model = sippy(data, "y_armax", "ARMAX", ARMAX_orders=[2, 2, 2, 0], ARMAX_mod="RLLS")

    def error():
        (num, den), (noise, _) = coefficients(model.G), coefficients(model.H)
        return largest((num, B), (den, A), (noise, C))

    return error


def sippy_rational(data, y, method, **options):
    model = sippy(data, y, method, **options)

    def error():
        num, den = coefficients(model.G)
        return largest((num, B), (den, A))

    return error


def sippy_oe(data):
    return sippy_rational(data, "y_oe", "OE", OE_orders=[2, 2, 0], OE_mod="RLLS")


def sippy_bj(data):
    return sippy_rational(data, "y_bj", "BJ", BJ_orders=[2, 2, 2, 2, 0])


def sippy_n4sid(data):
    model = sippy(data, "y_armax", "N4SID", SS_fixed_order=4)

    def error():
        x, h = model.B[:, 0], [0.0]
        for _ in range(99):
            h.append(float((model.C @ x).item()))
            x = model.A @ x
        return relative(h)

    return error


def sippy_scan(data):
    model = sippy(data, "y_armax", "ARX", IC="AIC", na_ord=[1, 10], nb_ord=[1, 10], delays=[0, 0])
    return lambda: relative(response(*coefficients(model.G)))


# Task of the benchmark, package, name of its module, what to run. SIPPY counts a delay of one sample as none.
PYTHON = [
    ("ARX(4,4,1)", "SysIdentPy", "sysidentpy", sysidentpy_arx),
    ("ARX(4,4,1)", "SIPPY", "sippy_unipi", sippy_arx),
    ("ARMAX(2,2,2,1)", "SysIdentPy ELS", "sysidentpy", sysidentpy_armax),
    ("ARMAX(2,2,2,1)", "SIPPY RLLS", "sippy_unipi", sippy_armax),
    ("OE(2,2,1)", "SIPPY RLLS", "sippy_unipi", sippy_oe),
    ("BJ(2,2,2,2,1)", "SIPPY OPT", "sippy_unipi", sippy_bj),
    ("N4SID(4)", "SIPPY", "sippy_unipi", sippy_n4sid),
    ("ARX scan 10×10", "SIPPY AIC", "sippy_unipi", sippy_scan),
]
OCTAVE = [
    ("ARX(4,4,1)", "Octave", "arx"),
    ("N4SID(4)", "Octave n4sid", "n4sid"),
    ("N4SID(4)", "Octave moen4", "moen4"),
    ("ARX scan 10×10", "Octave loop", "scan"),
]


def timed(action):
    wall, processor = time.perf_counter(), time.process_time()
    result = action()
    return result, time.perf_counter() - wall, time.process_time() - processor


def measure(action):
    """One run to warm up, then the median of three; one alone where it takes long."""
    error, wall, processor = timed(action)
    if wall < LONG_S:
        _, wall, processor = timed(action)
    if wall < LONG_S:
        count = max(1, math.ceil(LEAST_RUN_S / wall))
        runs = [timed(lambda: [action() for _ in range(count)])[1:] for _ in range(3)]
        wall, processor = (statistics.median(column) / count for column in zip(*runs))
    return wall, processor, error()


class Results:
    """The file that both sides append to."""

    def __init__(self, path, samples):
        self.path, self.samples = Path(path), samples
        lines = [line.split("\t") for line in self.path.read_text(encoding="utf-8").splitlines()]
        self.earlier = {(line[0], line[2], int(line[1])): line for line in lines}

    def write(self, task, tool, wall="", processor="", error="", note=""):
        known = isinstance(error, float) and math.isfinite(error)
        error = error if known else ""
        with self.path.open("a", encoding="utf-8") as file:
            file.write(f"{task}\t{self.samples}\t{tool}\t{wall}\t{processor}\t{error}\t{note}\n")
        shown = f"error {error:.5f}" if known else "error not measured"
        outcome = note or f"{wall:.5g} s, {processor:.5g} s processor, {shown}"
        print(f"{task:<17}{self.samples:>9}  {tool:<16} {outcome}", flush=True)

    def too_long(self, task, tool):
        """Whether the next smaller number of samples tells that this one would pass the limit."""
        of_task = [(n, line) for (t, name, n), line in self.earlier.items() if (t, name) == (task, tool)]
        known = [(n, line) for n, line in of_task if n < self.samples]
        if not known:
            return False
        samples, line = max(known)
        if line[3]:
            return float(line[3]) * self.samples / samples > LIMIT_S
        return line[6].startswith("skipped")


def run_python(data_path, wanted, results):
    present = [row for row in wanted if importlib.util.find_spec(row[2])]
    data = None
    if present:
        import numpy

        table = numpy.loadtxt(data_path, delimiter=",", skiprows=1)
        names = ("u", "y_armax", "y_oe", "y_bj")
        data = {name: numpy.ascontiguousarray(table[:, k]) for k, name in enumerate(names)}
    for row in wanted:
        task, tool, _, action = row
        if row not in present:
            results.write(task, tool, note="absent")
        elif results.too_long(task, tool):
            results.write(task, tool, note="skipped: more than two minutes")
        else:
            try:
                results.write(task, tool, *measure(lambda: action(data)))
            except (Exception, SystemExit) as failure:  # A package that fails is a result as well.
                first = (str(failure).splitlines() or [""])[0]
                results.write(task, tool, note=f"failed: {type(failure).__name__} {first}"[:120])


def run_octave(data_path, wanted, results):
    program = shutil.which("octave-cli")
    chosen = []
    for task, tool, what in wanted:
        if program is None:
            results.write(task, tool, note="absent")
        elif results.too_long(task, tool):
            results.write(task, tool, note="skipped: more than two minutes")
        else:
            chosen.append((task, tool, what))
    if not chosen:
        return
    script = Path(__file__).with_name("peers.m")
    command = [program, "--quiet", "--no-gui", str(script), str(data_path), *(what for _, _, what in chosen)]
    output = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    lines = {line.split("\t")[0]: line.split("\t")[1:] for line in output.splitlines() if "\t" in line}
    for task, tool, what in chosen:
        values = lines.get(what, ["absent"])
        if len(values) == 3:
            results.write(task, tool, *(float(v) for v in values))
        else:
            results.write(task, tool, note=values[0])


def main():
    folder, samples, path = sys.argv[1:4]
    part = sys.argv[4].lower() if len(sys.argv) > 4 else ""
    data_path = Path(folder) / f"data-{samples}.csv"
    results = Results(path, int(samples))
    run_python(data_path, [row for row in PYTHON if part in row[0].lower()], results)
    run_octave(data_path, [row for row in OCTAVE if part in row[0].lower()], results)


if __name__ == "__main__":
    main()
