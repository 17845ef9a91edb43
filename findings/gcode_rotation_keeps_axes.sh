#!/usr/bin/env bash
# gcodetools 0.3.2 turns a part by 90 degrees without the points that lie on an axis, and has no zero shift to zero and no full circle.
#
# A square of 10 mm with a corner at the origin is turned by 90 degrees; a program sets its zero where the tool stands, G92 X0 Y0, at X10 Y20; another mills a full circle of 10 mm. The
# guess: the corners are at (0, 10), (-10, 10), (-10, 0); after the shift X5 Y0 is the place (15, 20), as G92 gives the place of the tool the stated coordinates (NIST RS274NGC, 3.5.18); an
# arc whose end is its start is a full circle (same, 3.5.3.2). What comes: only the corner off the axes is turned, as a coordinate of 0 is taken for none. For the same
# reason G92 X0 Y0 does nothing while G92 X1 Y1 works, and after that a move to X0 goes to 0 without the shift. Of the circle nothing is left but its start,
# while three quarters of it are 270 points.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check gcodetools==0.3.2
cd "$work"
cat >try.py <<'PYTHON'
from GcodeTools import Gcode, Tools


def places(blocks):
    return [(round(block.position.X, 3) + 0.0, round(block.position.Y, 3) + 0.0) for block in blocks]


square = Gcode(gcode_str="G1 X10 Y0 F1200\nG1 X10 Y10\nG1 X0 Y10\nG1 X0 Y0\n")
print("square:", *places(square))
print("turned by 90 degrees:", *places(Tools.rotate(square, 90)))
for shift, move in (("X0 Y0", "X5 Y0"), ("X1 Y1", "X6 Y1"), ("X1 Y1", "X0 Y1")):
    program = Gcode(gcode_str=f"G1 X10 Y20 F600\nG92 {shift}\nG1 {move}\n")
    print(f"at (10, 20) G92 {shift}, then {move}:", places(program)[-1])
for end in ("X10 Y0", "X0 Y10", "X-10 Y0"):
    arc = places(Gcode(gcode_str=f"G1 X10 Y0 F600\nG2 {end} I-10 J0\n"))[1:]
    lowest, highest = min(place[1] for place in arc), max(place[1] for place in arc)
    print(f"arc from X10 Y0 to {end}: {len(arc)} points, Y from {lowest} to {highest}")
PYTHON
cat >expected <<'TEXT'
square: (10.0, 0.0) (10.0, 10.0) (0.0, 10.0) (0.0, 0.0)
turned by 90 degrees: (10.0, 0.0) (-10.0, 10.0) (0.0, 10.0) (0.0, 0.0)
at (10, 20) G92 X0 Y0, then X5 Y0: (5.0, 0.0)
at (10, 20) G92 X1 Y1, then X6 Y1: (15.0, 20.0)
at (10, 20) G92 X1 Y1, then X0 Y1: (0.0, 20.0)
arc from X10 Y0 to X10 Y0: 1 points, Y from 0.0 to 0.0
arc from X10 Y0 to X0 Y10: 270 points, Y from -10.0 to 10.0
arc from X10 Y0 to X-10 Y0: 180 points, Y from -10.0 to 0.0
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
