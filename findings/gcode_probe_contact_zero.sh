#!/usr/bin/env bash
# gscrib 1.2.0 takes the unknown place of a contact for zero as soon as a relative move follows.
#
# A straight probe (G38.2) ends at the contact, which the writer of a program cannot know; gscrib says so: the axis has no
# position then. The guess: after a relative move of 15 mm it still has none, and a check of the range of the axis refuses or waits
# for the next absolute move. What comes: the position is 15, as if every contact were at 0, and the range is checked with it.
# With a contact at 10 mm (the probe began at 12) the axis goes to 25, beyond the 20 mm that are allowed, without a word.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check gscrib==1.2.0
cd "$work"
cat >try.py <<'PYTHON'
import io

from gscrib import GCodeBuilder

written = io.StringIO()
with GCodeBuilder({"output": written}) as program:
    program.set_length_units("mm")
    program.set_bounds("axes", min=(0, 0, 0), max=(50, 50, 20))
    program.set_distance_mode("absolute")
    program.move(x=0, y=0, z=12, F=600)
    try:
        program.move(z=25)
    except ValueError:
        print("absolute 25: refused")
    program.probe("towards", z=0, F=100)
    print("after the probe:", program.position.z)
    program.set_distance_mode("relative")
    program.move(z=15)
    print("15 mm further:", program.position.z)
print(*[line for line in written.getvalue().splitlines() if "Z" in line], sep="\n")
PYTHON
cat >expected <<'TEXT'
absolute 25: refused
after the probe: None
15 mm further: 15
G1 X0 Y0 Z12 F600
G38.2 Z0 F100 ; Probe towards
G1 Z15
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
