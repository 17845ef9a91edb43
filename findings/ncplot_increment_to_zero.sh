#!/usr/bin/env bash
# ncplot7py 0.2.0 sends an axis of a SINUMERIK to zero where the program moves it by an increment, and counts no loop in an R parameter.
#
# A measuring row goes from X100 on by X=IC(5), and Y=AC(3) stands in a program of G91; a loop counts R1 from 1 to 3 and moves to X=R1. The guess: 105 and 110, then
# Y3, then 1, 2 and 3, for IC is a distance and AC a place whatever G90 and G91 say (Siemens, SINUMERIK 840D sl, fundamentals, absolute and incremental dimensions), and
# FOR counts in any variable (job planning, count loop). What comes: 0 and 0, the Y of before, and three times 0. No error is listed. With a variable of DEF INT the
# loop counts; a sum, as X=100+5, is worked out.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check ncplot7py==0.2.0
cd "$work"
cat >try.py <<'PYTHON'
import logging

from ncplot7py.application.nc_execution import NCExecutionEngine
from ncplot7py.domain.cnc_state import CNCState
from ncplot7py.domain.machines import get_machine_config
from ncplot7py.infrastructure.machines.base_stateful_control import UniversalConfigDrivenControl

logging.disable(logging.CRITICAL)


def moves_and_time(machine, program):
    state = CNCState(machine_config=get_machine_config(machine))
    engine = NCExecutionEngine(UniversalConfigDrivenControl(init_nc_states=[state]))
    (channel,) = engine.get_Syncro_plot([program], synch=False)
    assert not engine.errors, engine.errors
    return channel["plot"], engine.get_cacluated_runtime()


for name, axis, program in (
    ("IC with G90     ", "x", "G90\nG1 X100 F600\nX=IC(5)\nX=IC(5)"),
    ("AC with G91     ", "y", "G91\nG1 Y10 F600\nY=AC(3)"),
    ("FOR in R1       ", "x", "FOR R1=1 TO 3\nG1 X=R1 F600\nENDFOR"),
    ("FOR in a DEF INT", "x", "DEF INT cnt\nFOR cnt=1 TO 3\nG1 X=cnt F600\nENDFOR"),
    ("a sum           ", "x", "G90\nG1 X100 F600\nX=100+5"),
):
    print(name, axis, *(f"{move[axis][-1]:g}" for move in moves_and_time("SIEMENS_840DI", program)[0]))
PYTHON
cat >expected <<'TEXT'
IC with G90      x 100 0 0
AC with G91      y 10 10
FOR in R1        x 0 0 0
FOR in a DEF INT x 1 2 3
a sum            x 100 105
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
