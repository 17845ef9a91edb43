#!/usr/bin/env bash
# armkin 0.7.0 holds the elbow of an arm below when it is asked for it above, and calls each fifth stretched pose of the arm out of reach.
#
# An arm of two links, 0.325 m and 0.275 m, is to reach points in front of it. The guess: with the elbow up, as is its default, the elbow lies above the line from the shoulder to the
# point, by the other choice below; and the joint angles of a stretched arm, found by its own forward kinematics, come back (closed form: the point is at 0.6 m). What
# comes: the elbow is below where it is to be up, and above where it is to be down, for all points, as the second angle is taken positive for up, which bends the arm to the left,
# and the elbow to the right. Of 360 stretched poses, one degree apart, 82 are refused, by a rounding of 1e-16 in the cosine, which is not held at 1.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check armkin==0.7.0
cd "$work"
cat >try.py <<'PYTHON'
import math

from armkin import forward, inverse

UPPER, LOWER = 0.325, 0.275
for point in ((0.5, 0.0), (0.4, 0.2), (0.3, -0.3)):
    for up in (True, False):
        first, second = inverse(UPPER, LOWER, *point, elbow_up=up)
        reached = forward(UPPER, LOWER, first, second)
        above = UPPER * math.sin(first - math.atan2(point[1], point[0]))
        print(f"{point}, elbow_up {up}: reaches ({reached[0]:.3f}, {reached[1]:.3f}), elbow {above:+.3f} m above the line to it")
refused = []
for degrees in range(360):
    point = forward(UPPER, LOWER, math.radians(degrees), 0.0)
    try:
        inverse(UPPER, LOWER, *point)
    except ValueError as error:
        refused.append((degrees, str(error), math.hypot(*point) - UPPER - LOWER))
print(f"stretched arm: {len(refused)} of 360 poses refused, {refused[0][1]}, first at {refused[0][0]} degrees, beyond its reach by at most {max(one[2] for one in refused):.0e} m")
PYTHON
cat >expected <<'TEXT'
(0.5, 0.0), elbow_up True: reaches (0.500, 0.000), elbow -0.165 m above the line to it
(0.5, 0.0), elbow_up False: reaches (0.500, -0.000), elbow +0.165 m above the line to it
(0.4, 0.2), elbow_up True: reaches (0.400, 0.200), elbow -0.199 m above the line to it
(0.4, 0.2), elbow_up False: reaches (0.400, 0.200), elbow +0.199 m above the line to it
(0.3, -0.3), elbow_up True: reaches (0.300, -0.300), elbow -0.211 m above the line to it
(0.3, -0.3), elbow_up False: reaches (0.300, -0.300), elbow +0.211 m above the line to it
stretched arm: 82 of 360 poses refused, target out of reach, first at 0 degrees, beyond its reach by at most 6e-17 m
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
