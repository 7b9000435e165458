"""Reads parameter sets in FMPy, which validates them by the schema of SSP 1.0: names once each, and units that are declared."""

import math
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

from fmpy.ssp.ssd import read_ssv

SSC = "{http://ssp-standard.org/SSP1/SystemStructureCommon}"
files = sorted(pathlib.Path(sys.argv[1]).glob("*.ssv"))
for file in files:
    declared = {unit.attrib["name"] for unit in ElementTree.parse(file).getroot().iter(SSC + "Unit")}
    parameters = read_ssv(str(file)).parameters
    assert parameters and len({parameter.name for parameter in parameters}) == len(parameters)
    for parameter in parameters:
        assert parameter.type == "Real" and math.isfinite(float(parameter.value)), parameter
        assert parameter.unit in declared | {None}, parameter
print(len(files), "sets")
