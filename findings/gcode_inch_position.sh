#!/usr/bin/env bash
# pygcode 0.2.1 adds inches to millimetres.
#
# Its Machine knows G20 (inch) and G21 (mm). The guess: after 15 mm, G20 G91 G1 X1 leads 1 inch further: 40.4 mm, or the
# position in inches. What comes: 16, neither of the two; the number is taken as it stands.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pygcode==0.2.1
cd "$work"
cat >try.py <<'PYTHON'
from pygcode import Line, Machine

machine = Machine()
for block in ("G21 G90", "G1 X15 F300", "G20", "G91", "G1 X1"):
    machine.process_block(Line(block).block)
print(machine.pos, machine.mode.units)
PYTHON
cat >expected <<'TEXT'
<Position: X16 Y0 Z0> G20
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
