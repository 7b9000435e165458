"""Reads parameter sets as XML: names, values, and units that are declared."""

import math
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

SSV = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"
SSC = "{http://ssp-standard.org/SSP1/SystemStructureCommon}"
files = sorted(pathlib.Path(sys.argv[1]).glob("*.ssv"))
for file in files:
    root = ElementTree.parse(file).getroot()
    assert root.tag == SSV + "ParameterSet" and root.attrib["version"] == "2.0" and root.attrib["name"]
    declared = {unit.attrib["name"] for unit in root.iter(SSC + "Unit")}
    parameters = list(root.find(SSV + "Parameters"))
    assert len({p.attrib["name"] for p in parameters}) == len(parameters)
    for parameter in parameters:
        value, *dimensions = list(parameter)
        assert value.tag == SSV + "Float64"
        numbers = [float(v) for v in value.attrib["value"].split()]
        assert all(dimension.tag == SSC + "Dimension" for dimension in dimensions)
        assert len(numbers) == math.prod(int(dimension.attrib["size"]) for dimension in dimensions)
        assert value.attrib.get("unit") in declared | {None}
print(len(files), "sets")
