#!/usr/bin/env bash
# gcode-simulator 0.2.1 lets a slow axis go faster than its rate as soon as another axis moves with it.
#
# Its settings are those of grbl: $110 and $111 are the highest rates of X and of Y, 3000 and 500 mm/min here, and grbl slows a block down until
# no axis is above its own. The guess: 100 mm of Y take more than 12 s, alone or in a diagonal. What comes: alone 12.01 s; with 100 mm of X 2.83 s,
# for which Y has to go at four times its rate, and with an F word the same. Acceleration is shared out in the same way. With equal axes nothing of it is seen.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check gcode-simulator==0.2.1
cd "$work"
cat >try.py <<'PYTHON'
from gcode_simulator import GCodeSimulator, GrblSettings

slow = GrblSettings(max_rate_x=3000, max_rate_y=500)
for block in ("G0 X0 Y100", "G0 X100 Y100", "G1 X100 Y100 F3000"):
    seconds, _ = GCodeSimulator(slow).estimate_time(block)
    print(f"{block}: {seconds:.2f} s, Y at {100 / seconds * 60:.0f} mm/min or more")
PYTHON
cat >expected <<'TEXT'
G0 X0 Y100: 12.01 s, Y at 500 mm/min or more
G0 X100 Y100: 2.83 s, Y at 2117 mm/min or more
G1 X100 Y100 F3000: 2.87 s, Y at 2089 mm/min or more
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
