#!/usr/bin/env bash
# gcode-lib 1.1.13 makes nearly a whole circle of twice the radius of a half circle that is given by R.
#
# From X0 Y0 the block G2 X10 Y0 R5 is the half circle over X5 Y5, and the same as G2 X10 Y0 I5 (RS274/NGC, arcs in radius format). The guess: both
# become lines that keep between X0 and X10. What comes: with I they do; with R the centre is where the arc begins, so that the lines jump
# to X10 and go around X0 to X-10 and back. The bounds of the program are those of that circle, too.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check gcode-lib==1.1.13
cd "$work"
cat >try.py <<'PYTHON'
import gcode_lib

for arc in ("G2 X10 Y0 I5", "G2 X10 Y0 R5"):
    lines = gcode_lib.parse_lines(f"G21\nG90\nG17\nG1 X0 Y0 F100\n{arc}\n")
    pieces = [line.words for line in gcode_lib.linearize_arcs(lines) if line.command == "G1"]
    box = gcode_lib.compute_bounds(lines)
    print(
        f"{arc}: {len(pieces) - 1} lines, X {min(p['X'] for p in pieces):.1f} to {max(p['X'] for p in pieces):.1f},",
        f"the first to X{pieces[1]['X']:.1f} Y{pieces[1]['Y']:.1f},",
        f"bounds X {box.x_min:.1f} to {box.x_max:.1f}, Y {box.y_min:.1f} to {box.y_max:.1f}",
    )
PYTHON
cat >expected <<'TEXT'
G2 X10 Y0 I5: 79 lines, X 0.0 to 10.0, the first to X0.0 Y0.2, bounds X 0.0 to 10.0, Y 0.0 to 5.0
G2 X10 Y0 R5: 315 lines, X -10.0 to 10.0, the first to X10.0 Y-0.2, bounds X -10.0 to 10.0, Y -10.0 to 10.0
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
