#!/usr/bin/env bash
# A container of the FMU Manipulation Toolbox 2.0 holds its outputs between its inner steps, and says that it takes any step.
#
# The container is made with an inner step of 1 ms around an FMU whose output is the time (pythonfmu 0.7.0, which takes any
# step). Its description says canHandleVariableCommunicationStepSize="true" and has no fixedInternalStepSize. The guess: steps of
# 0.25 ms are refused, or outputs follow them. What comes: they are accepted, and the output changes in every fourth alone. Who looks for an event in short steps finds it up to 1 ms late.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pythonfmu==0.7.0 fmu-manipulation-toolbox==2.0 fmpy==0.3.32
cd "$work"
cat >clock.py <<'FILE'
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Clock(Fmi2Slave):
    def __init__(self, **given):
        super().__init__(**given)
        self.now = 0.0
        self.register_variable(Real("now", causality=Fmi2Causality.output, variability=Fmi2Variability.continuous))

    def do_step(self, time, step):
        self.now = time + step
        return True
FILE
cat >try.py <<'PYTHON'
import json
import subprocess

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

subprocess.run(["venv/bin/pythonfmu", "build", "-f", "clock.py"], check=True, capture_output=True)
table = {"name": "box.fmu", "step_size": 0.001, "fmu": ["Clock.fmu"], "auto_link": True, "auto_input": True,
         "auto_output": True, "auto_parameter": False, "mt": False, "profiling": False}
open("box.json", "w").write(json.dumps(table))
subprocess.run(["venv/bin/fmucontainer", "-fmu-directory", ".", "-container", "box.json", "-fmi", "2"],
               check=True, capture_output=True)
for name in ("Clock.fmu", "box.fmu"):
    about = read_model_description(name)
    how = about.coSimulation
    (output,) = [v for v in about.modelVariables if v.name == "now"]
    slave = FMU2Slave(guid=about.guid, unzipDirectory=extract(name), modelIdentifier=how.modelIdentifier, instanceName="a")
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    seen = []
    for step in range(8):
        slave.doStep(currentCommunicationPoint=step * 0.00025, communicationStepSize=0.00025)
        seen.append(round(slave.getReal([output.valueReference])[0] * 1e3, 6))
    slave.terminate()
    slave.freeInstance()
    print(name, "any step:", how.canHandleVariableCommunicationStepSize, "fixed:", how.fixedInternalStepSize, seen)
PYTHON
cat >expected <<'TEXT'
Clock.fmu any step: True fixed: None [0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0]
box.fmu any step: True fixed: None [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0]
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
