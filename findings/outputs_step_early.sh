#!/usr/bin/env bash
# pathsim-fmi 0.1.1 shows the outputs of an FMU one communication step before their time.
#
# The FMU gives the time, and steps by 0.1 s. The guess: at 0.2 s its output is 0.2, as fmpy 0.3.32 has it, or older. What comes:
# 0.3; the block makes the step from 0.2 s to 0.3 s when the simulation reaches 0.2 s, with the inputs of that instant, and
# its result counts from there on. A loop that is closed over such an FMU lacks the dead time of one step.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pathsim-fmi==0.1.1 pathsim==0.27.1 pythonfmu==0.7.0 fmpy==0.3.32 'setuptools<81'
cd "$work"
cat >clock.py <<'PYTHON'
from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class Clock(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.now = 0.0
        self.register_variable(Real("now", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.now = current_time + step_size
        return True
PYTHON
venv/bin/pythonfmu build -f clock.py >log 2>&1 || { cat log; exit 2; }
cat >try.py <<'PYTHON'
from fmpy import simulate_fmu
from pathsim import Connection, Simulation
from pathsim.blocks import Scope
from pathsim_fmi import CoSimulationFMU

part, scope = CoSimulationFMU("Clock.fmu", dt=0.1), Scope()
simulation = Simulation([part, scope], [Connection(part["now"], scope)], dt=0.1, log=False)
simulation.run(0.4)
times, (values,) = scope.read()
print("pathsim", *(f"{time:.1f}:{value:.1f}" for time, value in zip(times, values)))
rows = simulate_fmu("Clock.fmu", stop_time=0.4, step_size=0.1, output_interval=0.1)
print("fmpy   ", *(f"{row['time']:.1f}:{row['now']:.1f}" for row in rows))
PYTHON
cat >expected <<'TEXT'
pathsim 0.0:0.1 0.1:0.2 0.2:0.3 0.3:0.4 0.4:0.5
fmpy    0.0:0.0 0.1:0.1 0.2:0.2 0.3:0.3 0.4:0.4
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
