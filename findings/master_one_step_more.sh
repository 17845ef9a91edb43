#!/usr/bin/env bash
# cofmupy 1.0.0 goes one step beyond the end that was asked for, when ten steps of 0.1 s are to make one second.
#
# The FMU gives the time. The guess: a run to 1 s in steps of 0.1 s makes ten steps, and the row of 0.1 s holds 0.1. What
# comes: eleven steps, since ten tenths that are added up stay below 1 by a rounding, so that the FMU stands at 1.1 s; a run
# to 2 s in steps of 0.25 s makes its eight. A row has the time of the begin of its step beside the outputs of its end.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check cofmupy==1.0.0 pythonfmu==0.6.3 'setuptools<81'
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
echo '{"fmus": [{"id": "clock", "path": "Clock.fmu", "name": "Clock"}], "connections": []}' >system.json
cat >try.py <<'PYTHON'
from cofmupy import Coordinator

for step_s, end_s in ((0.1, 1.0), (0.25, 2.0)):
    master = Coordinator()
    master.start("system.json")
    master.run_simulation(step_s, end_s)
    rows = master.get_results()
    values = list(zip(rows["time"], rows["clock", "now"]))
    print("row", len(values), "rows, the last", *(f"{value:.2f}" for value in values[-1]))
PYTHON
cat >expected <<'TEXT'
row 11 rows, the last 1.00 1.10
row 8 rows, the last 1.75 2.00
TEXT
venv/bin/python try.py 2>log | { grep '^row' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
