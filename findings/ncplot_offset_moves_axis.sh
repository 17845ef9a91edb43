#!/usr/bin/env bash
# ncplot7py 0.2.0 moves the axis of a Fanuc machine where a block only sets an offset, bores in rapid feed, and gives a dwell no time.
#
# After G1 X20. F600 a program sets its coordinate system (G92 X0), a local one (G52 X100.) or a zero offset (G10 L2 P1 X100.); another bores with G81, another dwells two seconds.
# The guess: none of the first three moves anything or takes time, G81 goes down from R2 at F100 and comes back, and the dwell counts two seconds (Fanuc, operator's
# manual, coordinate system, canned cycles and dwell). What comes: a cut of 20 mm back to 0, two of 80 mm to 100, a rapid move from 10 to -5 that
# stays there, so that the next hole is reached through the workpiece, and no time for the dwell. No error is listed.
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


for block in ("", "G92 X0", "G52 X100.", "G10 L2 P1 X100.", "G4 X2.", "G4 P2000"):
    moves, seconds = moves_and_time("FANUC_MILL", f"G1 X20. F600\n{block}")
    print(f"{block:15}", *(f"{move['traversal']} to X{move['x'][-1]:g}," for move in moves), f"{seconds:.1f} s")
for move in moves_and_time("FANUC_MILL", "G90 G0 X20. Z10.\nG99 G81 Z-5. R2. F100\nX30.\nG80")[0][1:]:
    print("G81", move["traversal"], f"to X{move['x'][-1]:g} Z{move['z'][-1]:g}")
PYTHON
cat >expected <<'TEXT'
                FEED to X20, 2.0 s
G92 X0          FEED to X20, FEED to X0, 4.0 s
G52 X100.       FEED to X20, FEED to X100, 10.0 s
G10 L2 P1 X100. FEED to X20, FEED to X100, 10.0 s
G4 X2.          FEED to X20, 2.0 s
G4 P2000        FEED to X20, 2.0 s
G81 RAPID to X20 Z-5
G81 RAPID to X30 Z-5
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
