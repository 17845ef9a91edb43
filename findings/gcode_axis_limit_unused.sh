#!/usr/bin/env bash
# pyGCodeDecode 1.5.1 plans a Z axis of 12 mm/s at 100 mm/s: the highest speeds of the axes are read and never used.
#
# A machine is described by highest speeds of 180 mm/s in X and Y and of 12 mm/s in Z (keys vX, vY and vZ, axis max speeds) and 1250 mm/s2; it is the one in the page's example.
# The guess: 10 mm of Z at F6000 take 0.84 s, as long as at F720, which is 12 mm/s, for a planner slows a block until no axis is above its own limit (Marlin, M203); and
# 100 mm of X at F30000 go no faster than 180 mm/s. What comes: Z at 100 mm/s in 0.18 s, and X at 354 mm/s. Acceleration is kept, so that
# the course looks like that of a planner. G20, which the page lists as supported, changes nothing either: X1 is 1 mm.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyGCodeDecode==1.5.1
cd "$work"
cat >machine.yaml <<'YAML'
axis_rig:
  nozzle_diam: 0.4
  filament_diam: 1.75
  p_vel: 35
  p_acc: 1250
  jerk: 8
  vX: 180
  vY: 180
  vZ: 12
  vE: 80
  firmware: prusa
YAML
cat >try.py <<'PYTHON'
from pyGCodeDecode import gcode_interpreter

setup = gcode_interpreter.setup(presets_file="machine.yaml", printer="axis_rig")
for block in ("G1 Z10 F720", "G1 Z10 F6000", "G1 X100 F30000", "G20\nG1 X1 F60"):
    with open("program.gcode", "w") as file:
        file.write(block + "\n")
    run = gcode_interpreter.simulation(gcode_path="program.gcode", initial_machine_setup=setup)
    segments = [segment for planned in run.blocklist for segment in planned.get_segments()]
    end = segments[-1].t_end
    fastest = max(max(segment.vel_begin.get_norm(), segment.vel_end.get_norm()) for segment in segments)
    place = segments[-1].pos_end.get_vec()
    print(f"> {block!r}: {end:.2f} s, up to {fastest:.0f} mm/s, to X{place[0]:g} Z{place[2]:g}")
PYTHON
cat >expected <<'TEXT'
'G1 Z10 F720': 0.84 s, up to 12 mm/s, to X0 Z10
'G1 Z10 F6000': 0.18 s, up to 100 mm/s, to X0 Z10
'G1 X100 F30000': 0.57 s, up to 354 mm/s, to X100 Z0
'G20\nG1 X1 F60': 1.00 s, up to 1 mm/s, to X1 Z0
TEXT
venv/bin/python try.py 2>log | sed -n 's/^> //p' >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
