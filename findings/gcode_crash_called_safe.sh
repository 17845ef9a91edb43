#!/usr/bin/env bash
# gcode-collision-check 0.1.0 calls a program safe that cuts into the vise, if the move into it has no G word of its own.
#
# A vise stands at X20 to X40 and is 10 mm high; the tool goes from X0 to X60 at Z5. The guess: COLLISION for G1 X60 F200 and for the same in two blocks, G1 F200 and X60, since
# G1 stays until another word of its group comes (RS274/NGC, modal groups; the tool reads the dialect of Fanuc, and lists no such limit), and for X+60, which is 60
# with its sign. What comes: COLLISION for the first alone, SAFE and exit code 0 for the others. The count of samples is smaller then, which
# is the only trace: the block sets the place and makes no move, and the next one starts behind the vise. A drilling cycle hits in its first hole alone.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check gcode-collision-check==0.1.0
cd "$work"
cat >try.py <<'PYTHON'
import itertools
import subprocess

CORNERS = list(itertools.product((20, 40), (-20, 20), (-20, 10)))
FACES = ("013", "032", "467", "475", "045", "051", "237", "276", "026", "064", "157", "173")
with open("vise.stl", "w") as file:
    file.write("solid vise\n")
    for face in FACES:
        corners = "".join("vertex {} {} {}\n".format(*CORNERS[int(corner)]) for corner in face)
        file.write(f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    file.write("endsolid vise\n")
for blocks in ("G1 X60 F200", "G1 F200\nX60", "G1 X+60 F200", "G81 X30 Z-5 R20 F100\nG80", "G81 X0 Z-5 R20 F100\nX30\nG80"):
    with open("program.nc", "w") as file:
        file.write(f"G21 G90 G17\nG0 X0 Y0 Z50\nG0 Z5\n{blocks}\nG0 Z50\nM30\n")
    done = subprocess.run(
        ["venv/bin/gcode-collision-check", "verify", "program.nc", "--scene", "vise.stl"], capture_output=True, text=True
    )
    hits = [line.split()[0] for line in done.stdout.splitlines() if "flute / vise" in line]
    print(f"{blocks!r}: {done.stdout.split()[1]}, exit code {done.returncode},", "hits in line", *(hits or ["none"]))
PYTHON
cat >expected <<'TEXT'
'G1 X60 F200': COLLISION, exit code 1, hits in line 4
'G1 F200\nX60': SAFE, exit code 0, hits in line none
'G1 X+60 F200': SAFE, exit code 0, hits in line none
'G81 X30 Z-5 R20 F100\nG80': COLLISION, exit code 1, hits in line 4
'G81 X0 Z-5 R20 F100\nX30\nG80': SAFE, exit code 0, hits in line none
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
