"""Opens a system of SSP in FMPy, which validates it by the schema, checks the rules beyond the schema, puts an FMU in the place of the
engine, and simulates both. Prints NAME DIFFERENCE."""

import pathlib
import sys
import zipfile

import numpy as np
from fmpy import extract, read_model_description
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd, read_ssv
from instances import instance
from lxml import etree

SSD = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"
SSC = "{http://ssp-standard.org/SSP1/SystemStructureCommon}"
STRUCTURE = "SystemStructure.ssd"
STEP_S, STEPS = 1e-3, 400


def connectors(element):
    """Kind and unit of each connector, by its name."""
    found = {}
    for connector in element.find(SSD + "Connectors"):
        assert connector.get("name") not in found, connector.get("name")
        found[connector.get("name")] = (connector.get("kind"), connector[0].get("unit"))
    return found


def check_connections(system, elements):
    """Sources and destinations as the standard allows them: of the same unit, and one for each destination."""
    own, taken = connectors(system), set()
    for connection in system.find(SSD + "Connections"):
        ends = []
        for end in ("start", "end"):
            element, name = connection.get(end + "Element"), connection.get(end + "Connector")
            kind, unit = (own if element is None else elements[element])[name]
            gives = kind == ("input" if element is None else "output")
            ends.append((gives, unit, (element, name)))
        (first, unit, source), (second, other, destination) = ends
        assert first and not second and unit == other, ends
        assert destination not in taken, destination
        taken.add(destination)
    inputs = {(None, name) for name, (kind, _) in own.items() if kind == "output"}
    inputs |= {(element, name) for element, all in elements.items() for name, (kind, _) in all.items() if kind == "input"}
    assert taken == inputs, taken ^ inputs


def check(path):
    read_ssd(str(path))
    with zipfile.ZipFile(path) as archive:
        entries = archive.infolist()
        assert all(e.compress_type in (0, 8) and e.extract_version <= 20 and not e.flag_bits & 1 for e in entries)
        assert all(e.filename == STRUCTURE or e.filename.startswith("resources/") for e in entries)
        root = etree.fromstring(archive.read(STRUCTURE))
        archive.extractall(path.with_suffix(""))
    system = root.find(SSD + "System")
    components = {c.get("name"): c for c in system.find(SSD + "Elements")}
    elements = {name: connectors(component) for name, component in components.items()}
    assert set(elements) == {"bench", "engine"} and components["engine"].get("source") == ""
    check_connections(system, elements)
    declared = {unit.get("name") for unit in root.iter(SSC + "Unit")}
    assert {real.get("unit") for real in root.iter(SSC + "Real")} <= declared
    description = read_model_description(str(path.with_suffix("") / components["bench"].get("source")))
    variables = {variable.name: variable for variable in description.modelVariables}
    for name, (kind, unit) in elements["bench"].items():
        assert variables[name].causality == kind and variables[name].unit == unit, name
    bound = components["bench"].find(f"{SSD}ParameterBindings/{SSD}ParameterBinding").get("source")
    for parameter in read_ssv(str(path), resource=bound).parameters:
        variable = variables[parameter.name]
        assert variable.causality == "parameter" and float(variable.start) == float(parameter.value), parameter
        assert variable.unit == parameter.unit, parameter


def with_engine(path, engine):
    """The system with an FMU in the place of its engine."""
    whole = path.with_name("whole.ssp")
    with zipfile.ZipFile(path) as archive, zipfile.ZipFile(whole, "w") as other:
        for entry in archive.infolist():
            content = archive.read(entry)
            if entry.filename == STRUCTURE:
                content = content.replace(b'source=""', b'source="resources/engine.fmu"')
            other.writestr(entry.filename, content)
        other.write(engine, "resources/engine.fmu")
    return whole


def by_hand(path, engine):
    """The same system, stepped and connected here: each takes what the other gave in the step before."""
    slaves = []
    for fmu in (next(path.with_suffix("").glob("resources/*.fmu")), engine):
        description = read_model_description(str(fmu))
        slave = instance(description, extract(str(fmu)), "coSimulation")
        slave.setupExperiment(startTime=0.0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        slaves.append((slave, {variable.name: variable.valueReference for variable in description.modelVariables}))
    (bench, of_bench), (motor, of_motor) = slaves
    demand = torque = speed = 0.0
    shafts = []
    for k in range(STEPS):
        bench.setReal([of_bench["speed_demand"], of_bench["engine_torque"]], [demand, torque])
        bench.doStep(k * STEP_S, STEP_S)
        motor.setReal([of_motor["w"]], [speed])
        motor.doStep(k * STEP_S, STEP_S)
        speed, shaft = bench.getReal([of_bench["engine_side_speed"], of_bench["shaft_torque"]])
        torque, demand = motor.getReal([of_motor["tau"]])[0], demanded(k * STEP_S)
        shafts.append(shaft)
    return np.array(shafts)


def demanded(time):
    return 170.0 if time < 0.1 else 175.0


def main(folder):
    path, engine = folder / "test_cell_4.ssp", folder / "engine.fmu"
    check(path)
    check(folder / "plant.ssp")
    found = simulate_ssp(
        str(with_engine(path, engine)), stop_time=(STEPS - 0.5) * STEP_S, step_size=STEP_S, input={"speed_demand": demanded}
    )
    shafts = by_hand(path, engine)
    assert len(found) == STEPS and np.abs(shafts).max() > 1.0
    print("shaft torque", np.abs(found["bench.shaft_torque"] - shafts).max() / np.abs(shafts).max())


main(pathlib.Path(sys.argv[1]))
