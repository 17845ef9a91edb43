#!/usr/bin/env bash
# fmpy 0.3.32 simulates an SSP without the linear transformations of its connections.
#
# A part of a system gives 0.25, and the connection to the next one has `factor="1000"` (m to mm). The guess: 250 arrives, for
# the transformation is a part of the connection (SSP 1.0, Connection and LinearTransformation), or an error says that it is not
# there. What comes: 0.25 arrives, without a message; the description that fmpy reads holds no factor either.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pythonfmu==0.7.0 fmpy==0.3.32 'setuptools<81'
cd "$work"
mkdir -p system/resources
cat >pass_on.py <<'PYTHON'
from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class PassOn(Fmi2Slave):
    author = "example"
    description = "passes a number on"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.u, self.y = 0.0, 0.0
        self.register_variable(Real("u", causality=Fmi2Causality.input))
        self.register_variable(Real("y", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.y = self.u
        return True
PYTHON
venv/bin/pythonfmu build -f pass_on.py -d system/resources >log 2>&1 || { cat log; exit 2; }
cat >system/SystemStructure.ssd <<'XML'
<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription name="line" version="1.0"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">
  <ssd:System name="line">
    <ssd:Connectors>
      <ssd:Connector name="in" kind="input"><ssc:Real/></ssd:Connector>
      <ssd:Connector name="out" kind="output"><ssc:Real/></ssd:Connector>
    </ssd:Connectors>
    <ssd:Elements>
      <ssd:Component name="metres" type="application/x-fmu-sharedlibrary" source="resources/PassOn.fmu">
        <ssd:Connectors>
          <ssd:Connector name="u" kind="input"><ssc:Real/></ssd:Connector>
          <ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector>
        </ssd:Connectors>
      </ssd:Component>
      <ssd:Component name="millimetres" type="application/x-fmu-sharedlibrary" source="resources/PassOn.fmu">
        <ssd:Connectors>
          <ssd:Connector name="u" kind="input"><ssc:Real/></ssd:Connector>
          <ssd:Connector name="y" kind="output"><ssc:Real/></ssd:Connector>
        </ssd:Connectors>
      </ssd:Component>
    </ssd:Elements>
    <ssd:Connections>
      <ssd:Connection startConnector="in" endElement="metres" endConnector="u"/>
      <ssd:Connection startElement="metres" startConnector="y" endElement="millimetres" endConnector="u">
        <ssc:LinearTransformation factor="1000"/>
      </ssd:Connection>
      <ssd:Connection startElement="millimetres" startConnector="y" endConnector="out"/>
    </ssd:Connections>
  </ssd:System>
</ssd:SystemStructureDescription>
XML
(cd system && python3 -m zipfile -c ../line.ssp SystemStructure.ssd resources)
cat >try.py <<'PYTHON'
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd

read = [vars(connection) for connection in read_ssd("line.ssp").system.connections]
print("connections", len(read), "with a transformation", sum("linearTransformation" in one for one in read))
print("out", float(simulate_ssp("line.ssp", stop_time=1.0, step_size=0.1, input={"in": lambda time: 0.25})["out"][-1]))
PYTHON
cat >expected <<'TEXT'
connections 3 with a transformation 0
out 0.25
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
