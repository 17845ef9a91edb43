#!/usr/bin/env bash
# DynamicAxisControl 1.0.2 ends a short move of an axis at a third of its way, and turns mm/s into revolutions by the inverse of the pitch.
#
# Two axes with 0.5 m/s, 2 m/s2 and 38 mm per revolution go to one target. The guess: both end there at the same time, whatever the length, for the axes are synchronised; 0.5 m/s are
# 13.16 revolutions per second; a move back has positions that fall (a profile without constant speed, s = a t^2 with t half of the time; the package's own description). What comes: from
# 125 mm on, where the full speed is reached, the end is right. Below it the longer axis ends at 32.8 % of its way, and one of two equal ones does. The speed of a cartesian
# axis is 19 revolutions per second (500 * 38 / 1000), that of a CoreXY is 13.16. All positions are lengths: a move from 200 to 0 goes from 0 to 200.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check DynamicAxisControl==1.0.2 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cd "$work"
cat >try.py <<'PYTHON'
import contextlib
import io

from DynamicAxisControl import ProfileGenerator

axes = ProfileGenerator(2.0, 0.5, 2.0, 0.5, 38, 1000)
for start, target in (((0, 0), (200, 100)), ((0, 0), (125, 125)), ((0, 0), (100, 100)), ((0, 0), (100, 50)), ((0, 0), (50, 100)), ((200, 100), (0, 0))):
    with contextlib.redirect_stdout(io.StringIO()):
        move = axes.SyncLinearAxes(*start, *target, Graph=False)
    x, y = move["XAxisPositionTrajectory"], move["YAxisPositionTrajectory"]
    print(f"{start} to {target}: X from {x[0]:.1f} to {x[-1]:.1f} mm, Y from {y[0]:.1f} to {y[-1]:.1f} mm")
for name, function in (("cartesian", axes.SyncLinearAxes), ("CoreXY", axes.SyncCoreXYAxis)):
    with contextlib.redirect_stdout(io.StringIO()):
        move = function(0, 0, 200, 200, Graph=False)
    fastest = max(value for key, value in move.items() if "MaxSpeed" in key)
    print(f"{name}: {fastest:.2f} revolutions per second")
PYTHON
cat >expected <<'TEXT'
(0, 0) to (200, 100): X from 0.0 to 200.0 mm, Y from 0.0 to 100.0 mm
(0, 0) to (125, 125): X from 0.0 to 125.0 mm, Y from 0.0 to 125.0 mm
(0, 0) to (100, 100): X from 0.0 to 100.0 mm, Y from 0.0 to 32.8 mm
(0, 0) to (100, 50): X from 0.0 to 32.8 mm, Y from 0.0 to 50.0 mm
(0, 0) to (50, 100): X from 0.0 to 50.0 mm, Y from 0.0 to 32.8 mm
(200, 100) to (0, 0): X from 0.0 to 200.0 mm, Y from 0.0 to 100.0 mm
cartesian: 19.00 revolutions per second
CoreXY: 13.16 revolutions per second
TEXT
MPLBACKEND=Agg MPLCONFIGDIR="$work" venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
