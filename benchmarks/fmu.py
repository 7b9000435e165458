"""What a bench of an FMU takes in FMPy, beside an FMU that does nothing, and by its library alone.

    python fmu.py BENCH.fmu [SECONDS]

The FMU is one of FMI 2.0 that `dynoid export --to fmu2` wrote. The other FMU is made of its own sources, without the step of the bench.
It needs FMPy and a C compiler `cc`.
"""

import pathlib
import shutil
import subprocess
import sys
import time

from fmpy import extract, platform, read_model_description, simulate_fmu

STEP_S = 1e-3
WORK = "if (!bench_step(&i->bench, &inputs, length)) {"


def library(folder):
    return next((pathlib.Path(folder) / "binaries" / platform).iterdir())


def doing_nothing(folder):
    """A copy whose steps do nothing."""
    copy = f"{folder}_nothing"
    shutil.copytree(folder, copy)
    sources = pathlib.Path(copy) / "sources"
    instance = (sources / "instance.c").read_text()
    assert WORK in instance, "the sources are of another version"
    (sources / "instance.c").write_text(instance.replace(WORK, "if (0) {"))
    compiled = ["cc", "-std=c99", "-shared", "-fPIC", "-Os", *sorted(str(f) for f in sources.glob("*.c")), "-lm"]
    subprocess.run([*compiled, "-o", str(library(copy))], check=True)
    return copy


def in_fmpy(folder, stop_s):
    """Processor time of a run in Co-Simulation, s."""
    description, before = read_model_description(folder), time.process_time()
    simulate_fmu(folder, model_description=description, fmi_type="CoSimulation", stop_time=stop_s, step_size=STEP_S,
                 output_interval=STEP_S, output=["dyno_speed", "shaft_torque"])
    return time.process_time() - before


def alone(folder, stop_s):
    """Processor time of the steps alone, called from a program in C, s."""
    program = pathlib.Path(folder).with_suffix(".host")
    source = program.with_suffix(".c")
    source.write_text(HOST)
    subprocess.run(["cc", "-O1", "-I", str(pathlib.Path(folder) / "sources"), str(source), "-ldl", "-o", str(program)], check=True)
    token = read_model_description(folder).guid
    arguments = [program, library(folder), token, pathlib.Path(folder).as_uri() + "/resources", str(round(stop_s / STEP_S))]
    said = subprocess.run(arguments, check=True, capture_output=True, text=True)
    return float(said.stdout)


HOST = """
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "fmi2.h"
int main(int count, char **a) {
    void *library = dlopen(a[1], RTLD_NOW);
    static const fmi2CallbackFunctions none;
    fmi2Component c;
    clock_t start;
    fmi2ValueReference engine = 3;
    if (count < 5 || !library) return 1;
    c = ((fmi2Component (*)(fmi2String, fmi2Type, fmi2String, fmi2String, const fmi2CallbackFunctions *, int, int))
         dlsym(library, "fmi2Instantiate"))("bench", fmi2CoSimulation, a[2], a[3], &none, 0, 0);
    ((fmi2Status (*)(fmi2Component, int, double, double, int, double))dlsym(library, "fmi2SetupExperiment"))(c, 0, 0, 0, 0, 0);
    ((fmi2Status (*)(fmi2Component))dlsym(library, "fmi2EnterInitializationMode"))(c);
    ((fmi2Status (*)(fmi2Component))dlsym(library, "fmi2ExitInitializationMode"))(c);
    fmi2Status (*step)(fmi2Component, double, double, int) =
        (fmi2Status (*)(fmi2Component, double, double, int))dlsym(library, "fmi2DoStep");
    fmi2Status (*set)(fmi2Component, const fmi2ValueReference *, size_t, const double *) =
        (fmi2Status (*)(fmi2Component, const fmi2ValueReference *, size_t, const double *))dlsym(library, "fmi2SetReal");
    start = clock();
    for (long k = 0; k < atol(a[4]); k++) {
        double torque = (double)(k / 100 % 50);
        if (set(c, &engine, 1, &torque) > fmi2Warning || step(c, (double)k * 1e-3, 1e-3, 1) > fmi2Warning) return 1;
    }
    printf("%g\\n", (double)(clock() - start) / CLOCKS_PER_SEC);
    return 0;
}
"""


def main(path, stop_s=3600.0):
    folder = extract(path)
    nothing, whole, steps = in_fmpy(doing_nothing(folder), stop_s), in_fmpy(folder, stop_s), alone(folder, stop_s)
    print(f"{stop_s:g} s of bench, steps of {1e3 * STEP_S:g} ms")
    print(f"FMPy, an FMU that does nothing  {nothing:8.2f} s")
    print(f"FMPy, the bench                 {whole:8.2f} s, {whole / nothing:.2f} times that")
    print(f"the library alone               {steps:8.2f} s, {stop_s / steps:.0f} times real time")


main(sys.argv[1], *map(float, sys.argv[2:3]))
