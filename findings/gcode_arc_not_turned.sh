#!/usr/bin/env bash
# mecode 0.4.1 turns the moves and the arcs by radius of a pattern and not its arcs by centre, and scales an arc without its radius.
#
# A pattern is turned by 90 degrees, or made twice as large, by the transformations of the package. The guess: all of it is turned or scaled, for points pass through the matrix before they are
# written, and arcs too (NIST RS274NGC, 3.5.3: an arc by centre has its end and its centre as offsets; turned, both turn). An absolute move of Z alone leaves X and Y. What
# comes: the arc by centre is written as it is, behind moves that are turned; a half circle of twice the size is refused, as its radius of 5 stays, and an arc of 20 has 20 where
# 40 are due, another arc between the same ends; an arc in XZ that is turned has lost its X. And an absolute move of Z alone goes to X0 Y0,
# even if nothing is turned, while the class without transformations leaves them.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check mecode==0.4.1 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
import contextlib
import io
import math

from mecode import G, GMatrix


def program(kind, pattern):
    written = io.StringIO()
    with contextlib.redirect_stdout(written):
        maker = kind(print_lines=True, setup=False, output_digits=1)
        try:
            pattern(maker)
        except RuntimeError as error:
            print("refused:", error)
    return ", ".join(text for line in written.getvalue().replace("-0.0", "0.0").splitlines() if (text := line.split(";")[0].strip()))


def corner(maker):
    maker.move(x=10)
    maker.arc(x=5, y=5, radius=5, direction="CCW")
    maker.arc_ijk((-5, 5), (-5, 0), "xy", direction="CCW")


def turned(maker):
    maker.rotate(math.pi / 2)
    corner(maker)


def scaled(radius, way):
    def pattern(maker):
        maker.scale(2)
        maker.arc(x=0, y=way, radius=radius)

    return pattern


def turned_in_depth(maker):
    maker.rotate(math.pi / 2)
    maker.arc(x=10, z=10, radius=10)


def down(maker):
    maker.absolute()
    maker.move(x=10, y=20)
    maker.move(z=-5)


print("corner:", program(GMatrix, corner))
print("turned by 90 degrees:", program(GMatrix, turned))
print("half circle of 5 by 2:", program(GMatrix, scaled(5, 10)))
print("arc of 20 by 2:", program(GMatrix, scaled(20, 10)))
print("arc in XZ, turned:", program(GMatrix, turned_in_depth))
print("absolute, Z alone:", program(GMatrix, down))
print("absolute, Z alone, no transformations:", program(G, down))
PYTHON
cat >expected <<'TEXT'
corner: G1 X10.0 Y0.0, G17, G3 X5.0 Y5.0 R5.0, G17, G3 X-5.0 Y5.0 I-5.0 J0.0
turned by 90 degrees: G1 X0.0 Y10.0, G17, G3 X-5.0 Y5.0 R5.0, G17, G3 X-5.0 Y5.0 I-5.0 J0.0
half circle of 5 by 2: refused: Radius 5 to small for distance 20.0
arc of 20 by 2: G17, G2 X0.0 Y20.0 R20.0
arc in XZ, turned: G16 X Y Z, G18, G2 X0.0 Z10.0 R10.0
absolute, Z alone: G90, G1 X10.0 Y20.0, G1 X0.0 Y0.0 Z-5.0
absolute, Z alone, no transformations: G90, G1 X10.0 Y20.0, G1 Z-5.0
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
