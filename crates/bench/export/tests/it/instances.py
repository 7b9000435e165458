"""Instances of FMUs in FMPy, of either version of FMI."""

from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave


def instance(description, folder, interface):
    """An instance for `coSimulation` or `modelExchange`."""
    is_fmi2 = description.fmiVersion == "2.0"
    kinds = {"coSimulation": (FMU2Slave, FMU3Slave), "modelExchange": (FMU2Model, FMU3Model)}
    kind = kinds[interface][0 if is_fmi2 else 1]
    token = description.guid if is_fmi2 else description.instantiationToken
    fmu = kind(guid=token, unzipDirectory=folder, modelIdentifier=getattr(description, interface).modelIdentifier)
    fmu.instantiate()
    return fmu
