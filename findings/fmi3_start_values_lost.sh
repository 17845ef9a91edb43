#!/usr/bin/env bash
# fmureader 0.1.2 loses the start values of texts and binaries of an FMI 3.0 description, takes a 1 for false, and an empty list for none.
#
# A description of an axis has a text and a binary with start values, three enable bits that start as `true false 1`, a clock of 1 ms, an output that depends on nothing
# (dependencies="") and one of which nothing is said. The guess: all of it is in the model that the package makes, for it names variables with clocks as supported: the texts,
# true twice (xs:boolean has 1 for true), the interval, and a difference between the two outputs, the second of which may depend on everything (FMI 3.0, Start elements,
# clock attributes, dependencies). What comes: no text, no binary, the third bit false, no word of the interval, and None for both lists. As a single Boolean of
# FMI 2.0 the 1 is true. Nothing is raised, though the package checks each description.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check fmureader==0.1.2
cd "$work"
cat >modelDescription.xml <<'XML'
<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="axis" instantiationToken="{1}">
<CoSimulation modelIdentifier="axis" hasEventMode="true"/>
<ModelVariables>
<Float64 name="position" valueReference="0" causality="output" initial="calculated"/>
<Float64 name="version" valueReference="1" causality="output" initial="calculated"/>
<String name="name" valueReference="2" causality="parameter" variability="fixed"><Start value="Axis X"/></String>
<Binary name="frame" valueReference="3" causality="input" variability="discrete"><Start value="00ff"/></Binary>
<Boolean name="enable" valueReference="4" causality="input" variability="discrete" start="true false 1"><Dimension start="3"/></Boolean>
<Clock name="cycle" valueReference="5" causality="input" intervalVariability="constant" intervalDecimal="0.001"/>
</ModelVariables>
<ModelStructure><Output valueReference="0"/><Output valueReference="1" dependencies=""/></ModelStructure>
</fmiModelDescription>
XML
cat >try.py <<'PYTHON'
from fmureader.fmi3 import read_model_description

model = read_model_description("modelDescription.xml")
for variable in model.model_variables:
    for kind in ("string", "binary", "boolean", "clock"):
        found = getattr(variable, kind)
        if found is not None:
            shown = {name: value for name, value in found.model_dump().items() if "tart" in name or "nterval" in name}
            print(kind, found.name, *(f"{name} {shown[name]}" for name in sorted(shown)), sep=", ")
for output in model.model_structure.outputs:
    print(f"output {output.value_reference}, dependencies {output.dependencies}")
PYTHON
cat >expected <<'TEXT'
boolean, enable, start [True, False, False]
string, name, start None
binary, frame, start None
clock, cycle, interval_counter None
output 0, dependencies None
output 1, dependencies None
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
