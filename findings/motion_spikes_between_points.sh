#!/usr/bin/env bash
# s-curve-beta 0.1.2 moves a robot with thirteen times the acceleration that it was told, if the set points come each 0.25 ms, and knows no time for a move backwards.
#
# An axis of 1 m/s and 1 m/s2 at most goes 1 m; the package states the time that this takes. The guess: second differences of the set points stay at 1 m/s2 in each cycle, for the curve is
# smooth, a beta function, whose largest acceleration is 6.6156 distances by the time squared (closed form, at a quarter of the time), and -1 m takes as long as 1 m. What comes: the
# time is right, 2.572 s, and the acceleration 1.1 m/s2 in cycles of 4 ms; but the curve is a table of 801 points with straight lines between, and each point is a step of speed: 3.1 m/s2
# in cycles of 1 ms, 12.8 in those of 0.25 ms, and none in the cycles between. The time of -1 m is
# an error of the square root.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check s-curve-beta==0.1.2 numpy==1.26.4
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
from scurvebeta import motionTime, sCurve

time = motionTime(1.0, 1.0, 1.0)
print(f"1 m by 1 m/s and 1 m/s2: {time:.4f} s, by the closed form {6.61564**0.5:.4f} s")
for cycle in (4e-3, 1e-3, 0.25e-3):
    instants = np.arange(0.0, time, cycle)
    acceleration = np.diff(sCurve(instants, time, 0.0, 1.0), n=2) / cycle**2
    still = np.mean(np.abs(acceleration) < 1e-4)
    print(f"cycle of {1e3 * cycle:.2f} ms: largest acceleration {np.abs(acceleration).max():.2f} m/s2, none in {100 * still:.0f} % of the cycles")
try:
    print(f"-1 m: {motionTime(1.0, 1.0, -1.0):.4f} s")
except ValueError as error:
    print("-1 m:", error)
PYTHON
cat >expected <<'TEXT'
1 m by 1 m/s and 1 m/s2: 2.5721 s, by the closed form 2.5721 s
cycle of 4.00 ms: largest acceleration 1.11 m/s2, none in 0 % of the cycles
cycle of 1.00 ms: largest acceleration 3.13 m/s2, none in 38 % of the cycles
cycle of 0.25 ms: largest acceleration 12.83 m/s2, none in 84 % of the cycles
-1 m: math domain error
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
