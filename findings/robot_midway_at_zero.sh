#!/usr/bin/env bash
# robotkinematicscatalogue 1.1.2 sends all joints of a robot to zero halfway through a move, and a joint that stays to zero at its ends.
#
# Joints go from 10, 30 and -20 degrees to 90, 30 and 40 within 2 s, by parabolas with a straight line between. The guess: each instant has its place on the path, 50, 30 and 10 degrees
# halfway, and the second joint stays at 30 (linear function with parabolic blends; the package's own cubic polynomial is there too, and its own formulas of the three
# pieces). What comes: right, but for the instants where pieces meet, as these belong to none: with the highest acceleration, which is the default, that is halfway, and all joints are
# at 0. With 100 degrees/s2 a joint that stays has its pieces meet at both ends: it is sent to 0 at 0 s and at 2 s, and a plan of whole steps begins with a jump of 30 degrees.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check robotkinematicscatalogue==1.1.2 numpy==2.4.6 scipy==1.17.1 sympy==1.14.0 matplotlib==3.11.2
cd "$work"
cat >try.py <<'PYTHON'
import contextlib
import io

import numpy as np
from robotkinematicscatalogue.trajectoryGeneration import trajectoryGeneration as path

START, END, SECONDS = np.array([10.0, 30.0, -20.0]), np.array([90.0, 30.0, 40.0]), 2.0
COURSES = {
    "cubic": lambda time: path.cubicPolynomialPoint(START, END, np.full(3, SECONDS), np.full(3, time)),
    "blend": lambda time: path.parabolicBlendPoint(START, END, SECONDS, time),
    "blend, 100 degrees/s2": lambda time: path.parabolicBlendPoint(START, END, SECONDS, time, a=100.0),
}
for name, course in COURSES.items():
    for time in (0.0, 0.5, 1.0, 1.5, 2.0):
        with contextlib.redirect_stdout(io.StringIO()):
            joints = course(time)
        print(f"{name}, {time:.1f} s:", *(f"{joint:.1f}" for joint in joints))
PYTHON
cat >expected <<'TEXT'
cubic, 0.0 s: 10.0 30.0 -20.0
cubic, 0.5 s: 22.5 30.0 -10.6
cubic, 1.0 s: 50.0 30.0 10.0
cubic, 1.5 s: 77.5 30.0 30.6
cubic, 2.0 s: 90.0 30.0 40.0
blend, 0.0 s: 10.0 30.0 -20.0
blend, 0.5 s: 20.0 30.0 -12.5
blend, 1.0 s: 0.0 0.0 0.0
blend, 1.5 s: 80.0 30.0 32.5
blend, 2.0 s: 90.0 30.0 40.0
blend, 100 degrees/s2, 0.0 s: 10.0 0.0 -20.0
blend, 100 degrees/s2, 0.5 s: 22.5 30.0 -8.4
blend, 100 degrees/s2, 1.0 s: 50.0 30.0 10.0
blend, 100 degrees/s2, 1.5 s: 77.5 30.0 28.4
blend, 100 degrees/s2, 2.0 s: 90.0 0.0 40.0
TEXT
MPLBACKEND=Agg MPLCONFIGDIR="$work" venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
