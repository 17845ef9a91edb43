#!/usr/bin/env bash
# fmpy 0.3.32 steps an FMU by 16 ms where its description says 1 ms, as soon as the run takes 10 s.
#
# A Co-Simulation FMU gives stepSize="0.001" in its DefaultExperiment, the preferred step of a master (FMI 2.0); it
# counts its steps and notes the length of each. The guess: simulate_fmu steps it by 1 ms however long the run is, and
# thins its output, if anything. What comes: the step is doubled until the run has no more than 1000 of them, also where
# step_size=0.001 is given; output_interval=0.001 is what sets it. A loop that is stable over 1 s may not be over 10 s.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check fmpy==0.3.32 pythonfmu==0.7.0 'setuptools<81'
cd "$work"
cat >meter.py <<'PYTHON'
from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Slave, Real


class Meter(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.length = self.count = 0.0
        self.default_experiment = DefaultExperiment(start_time=0.0, stop_time=1.0, step_size=0.001)
        self.register_variable(Real("length", causality=Fmi2Causality.output))
        self.register_variable(Real("count", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.length = step_size
        self.count += 1.0
        return True
PYTHON
venv/bin/pythonfmu build -f meter.py >log 2>&1 || { cat log; exit 2; }
cat >try.py <<'PYTHON'
from fmpy import simulate_fmu

for settings in (
    {"stop_time": 1.0},
    {"stop_time": 2.0},
    {"stop_time": 10.0},
    {"stop_time": 10.0, "step_size": 0.001},
    {"stop_time": 10.0, "output_interval": 0.001},
):
    last = simulate_fmu("Meter.fmu", **settings)[-1]
    print(*(f"{name}={value}" for name, value in settings.items()), f"-> {last['count']:.0f} steps of {1000.0 * last['length']:.0f} ms")
PYTHON
cat >expected <<'TEXT'
stop_time=1.0 -> 1000 steps of 1 ms
stop_time=2.0 -> 1000 steps of 2 ms
stop_time=10.0 -> 625 steps of 16 ms
stop_time=10.0 step_size=0.001 -> 625 steps of 16 ms
stop_time=10.0 output_interval=0.001 -> 10000 steps of 1 ms
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
