#!/usr/bin/env bash
# ncplot7py 0.2.0 takes words of several letters for their letters: a spindle that is turned to 90 degrees turns the path, and a feed is 1 mm/min.
#
# Between two moves along X a program turns its spindle by SPOS=90, or gives a feed for roundings, FRC=100, or one for a positioning axis, FA[X]=100. The guess: the second
# move still goes to X20 Y0 at 600 mm/min, and takes a second, since SPOS is the place of the spindle, FRC the feed of a chamfer or rounding and FA that of a positioning
# axis alone (Siemens, SINUMERIK 840D sl, fundamentals). What comes: X0 Y20 with SPOS; with FRC=100 X-3.47 Y19.7, in 36 minutes; with FA and FRCM the right place after
# ten minutes. The feed stays so for the rest of the program. No error is listed; OVR and RND are passed over.
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


for words in ("X20", "SPOS=90\nX20", "X20 FRC=100", "X20 FRCM=100", "X20 FA[X]=100", "OVR=50\nX20", "X20 RND=2"):
    second = moves_and_time("SIEMENS_840DI", f"G90\nG1 X10 Y0 F600\n{words}")[0][-1]
    print(f"{words!r}: X{second['x'][-1]:.1f} Y{second['y'][-1]:.1f} in {second['t']:.1f} s")
PYTHON
cat >expected <<'TEXT'
'X20': X20.0 Y0.0 in 1.0 s
'SPOS=90\nX20': X0.0 Y20.0 in 1.0 s
'X20 FRC=100': X-3.5 Y19.7 in 2178.6 s
'X20 FRCM=100': X20.0 Y0.0 in 600.0 s
'X20 FA[X]=100': X20.0 Y0.0 in 600.0 s
'OVR=50\nX20': X20.0 Y0.0 in 1.0 s
'X20 RND=2': X20.0 Y0.0 in 1.0 s
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
