"""Directional derivatives of FMUs against finite differences: at the start, at an event, while a solver integrates, and between
steps of Co-Simulation. Prints NAME DIFFERENCE."""

import ctypes
import pathlib
import sys

import numpy as np
from fmpy import extract, read_model_description
from instances import instance

ENGINE_TORQUE, BANDWIDTH, SAMPLE_TIME = 3, 22, 25
INPUTS, PARAMETERS, INITIALS = [1, 2, ENGINE_TORQUE, 4], list(range(10, 26)), list(range(30, 36))
STATES, DERIVATIVES, OUTPUTS = list(range(60, 66)), list(range(70, 76)), list(range(50, 55))
UNKNOWNS = OUTPUTS + STATES + DERIVATIVES
# Speed, torque, and the offsets from a steady start.
START = [120.0, 40.0, 1.5, 0.003, 4.0, 2.0]
X = [100.0, 103.0, 0.01, 20.0, 0.0, 0.0]
# Of a value; the differences are central, so that their error is its square.
PART = 1e-4
DOUBLES = ctypes.c_double * len(STATES)


class Moment:
    """An instance at a moment of its life."""

    def __init__(self, path, folder, kind):
        self.description = read_model_description(path)
        self.is_fmi2 = self.description.fmiVersion == "2.0"
        self.fmu = instance(self.description, folder, kind)
        if self.is_fmi2:
            self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.set(INITIALS, START)

    def get(self, references):
        return np.array((self.fmu.getReal if self.is_fmi2 else self.fmu.getFloat64)(references))

    def set(self, references, values):
        (self.fmu.setReal if self.is_fmi2 else self.fmu.setFloat64)(references, values)

    def update(self):
        (self.fmu.newDiscreteStates if self.is_fmi2 else self.fmu.updateDiscreteStates)()

    def move(self, known, value):
        """Sets a known, among them a state."""
        if known not in STATES:
            return self.set([known], [value])
        x = self.get(STATES)
        x[known - STATES[0]] = value
        self.fmu.setContinuousStates(DOUBLES(*x), len(x))

    def exact(self, knowns):
        """One column a known."""
        columns = [self.fmu.getDirectionalDerivative(UNKNOWNS, [known], [1.0]) for known in knowns]
        matrix = np.array(columns).T
        seed = np.cos(np.arange(len(knowns)))
        together = np.array(self.fmu.getDirectionalDerivative(UNKNOWNS, knowns, seed))
        assert np.allclose(together, matrix @ seed, rtol=1e-12, atol=1e-12)
        if not self.is_fmi2:
            weights = np.sin(1.0 + np.arange(len(UNKNOWNS)))
            backward = np.array(self.fmu.getAdjointDerivative(UNKNOWNS, knowns, weights, len(knowns)))
            assert np.allclose(backward, weights @ matrix, rtol=1e-12, atol=1e-12)
        return matrix

    def numeric(self, known):
        value = self.get([known])[0]
        step = PART * (abs(value) or 1.0)
        # No gain, delay or limit below zero.
        low, high = (value if value == 0.0 else value - step), value + step
        self.move(known, high)
        after = self.get(UNKNOWNS)
        self.move(known, low)
        before = self.get(UNKNOWNS)
        self.move(known, value)
        return (after - before) / (high - low)

    def difference(self, knowns):
        # At a = 0 the torque control has no lag, and its form changes with a.
        knowns = [known for known in knowns if known != BANDWIDTH or self.get([known])[0] > 0.0]
        exact = self.exact(knowns)
        most = 0.0
        for column, known in enumerate(knowns):
            numeric = self.numeric(known)
            scale = max(np.abs(numeric).max(), 1.0)
            most = max(most, np.abs(numeric - exact[:, column]).max() / scale)
        return most

    def nominals(self):
        """How far the nominals of the states are from those of the description, where 1 is meant if there is none."""
        found = DOUBLES()
        self.fmu.getNominalsOfContinuousStates(found, len(found))
        variables = {variable.valueReference: variable for variable in self.description.modelVariables}
        stated = [float(variables[state].nominal or 1.0) for state in STATES]
        assert stated[0] != 1.0, "the model has a range, which says how large its states are"
        return np.abs(np.array(found) / stated - 1.0).max()

    def undeclared(self, knowns):
        """The largest derivative of an unknown by a known that the description says it does not depend on."""
        structure = self.description.outputs + self.description.derivatives
        exact, most = self.exact(knowns), 0.0
        for unknown in structure:
            reference = unknown.variable.valueReference
            if reference not in UNKNOWNS:
                continue  # not a real number
            declared = {variable.valueReference for variable in unknown.dependencies}
            row = exact[UNKNOWNS.index(reference)]
            rest = [abs(value) for known, value in zip(knowns, row) if known not in declared]
            most = max([most, *rest])
            assert not self.is_fmi2 or not declared & set(PARAMETERS), "FMI 2.0 has no parameters among the dependencies"
        return most


def main(folder):
    for path in sorted(folder.glob("*.fmu")):
        unzipped, name = extract(str(path)), path.stem
        # FMPy does not read the flag of FMI 3.0.
        assert (pathlib.Path(unzipped) / "modelDescription.xml").read_text().count("providesDirectionalDerivative") == 2
        tunable = [known for known in PARAMETERS if known != SAMPLE_TIME]
        for kind in ("coSimulation", "modelExchange"):
            start = Moment(str(path), unzipped, kind)
            print(name, kind, "start", start.difference(INPUTS + tunable + INITIALS))
        moment = Moment(str(path), unzipped, "coSimulation")
        moment.fmu.exitInitializationMode()
        moment.set(INPUTS[:3], [125.0, 45.0, 70.0])
        moment.fmu.doStep(0.0, 0.0123)
        print(name, "step", moment.difference([ENGINE_TORQUE] + tunable))
        print(name, "step, not declared", moment.undeclared([ENGINE_TORQUE] + STATES + (tunable if not moment.is_fmi2 else [])))
        moment = Moment(str(path), unzipped, "modelExchange")
        moment.fmu.exitInitializationMode()
        moment.update()
        print(name, "nominals", moment.nominals())
        moment.fmu.enterContinuousTimeMode()
        moment.fmu.setContinuousStates(DOUBLES(*X), len(X))
        print(name, "continuous", moment.difference([ENGINE_TORQUE] + STATES))
        moment.fmu.enterEventMode()
        print(name, "event", moment.difference([ENGINE_TORQUE] + tunable))
        print(name, "event, not declared", moment.undeclared([ENGINE_TORQUE] + STATES + (tunable if not moment.is_fmi2 else [])))


main(pathlib.Path(sys.argv[1]))
