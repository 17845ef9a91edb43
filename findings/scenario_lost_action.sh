#!/usr/bin/env bash
# ecospy 0.7.2 makes a change at 0.2 s in steps of 0.1 s, but none at 0.3 s.
#
# A scenario sets the input of an FMU at a given instant. The guess: it is set in the first step that begins at this instant or
# later. What comes: up to 0.2 s it is, at 0.3 s it never is, and nothing is said about it; the sum of three steps is 0.30000000000000004,
# and an action waits for its own double.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check ecospy==0.7.2 pythonfmu==0.7.0 'setuptools<81'
cd "$work"
cat >servo.py <<'PYTHON'
from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Servo(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.target = 0.0
        self.register_variable(Real("target", causality=Fmi2Causality.input))

    def do_step(self, current_time, step_size):
        return True
PYTHON
venv/bin/pythonfmu build -f servo.py >log 2>&1 || { cat log; exit 2; }
cat >try.py <<'PYTHON'
from ecospy import EcosSimulation, EcosSimulationStructure


for instant in (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7):
    structure = EcosSimulationStructure()
    structure.add_model("servo", "Servo.fmu")
    simulation = EcosSimulation(structure=structure, step_size=0.1)
    simulation.add_scenario(real_actions=[(instant, "servo::target", 1.5)])
    simulation.init()
    simulation.step(10)
    print(f"{instant} s:", simulation.get_real("servo::target"))
PYTHON
cat >expected <<'TEXT'
0.0 s: 1.5
0.1 s: 1.5
0.2 s: 1.5
0.3 s: 0.0
0.4 s: 1.5
0.5 s: 1.5
0.6 s: 1.5
0.7 s: 1.5
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
