#!/usr/bin/env bash
# gcodeparser 0.3.0 takes a probing block for a block without words.
#
# G38.2 is the straight probe of LinuxCNC and grbl. The guess: command G 38.2 with Z and F, as G1 has them. What comes:
# command G 38 and no parameter at all; the target of the probe is gone without a message.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check gcodeparser==0.3.0
cd "$work"
cat >try.py <<'PYTHON'
from gcodeparser import parse_gcode_lines

for block in ("G1 Z-10 F100", "G38.2 Z-10 F100"):
    print([(line.command, line.params) for line in parse_gcode_lines(block)])
PYTHON
cat >expected <<'TEXT'
[(('G', 1), {'Z': -10, 'F': 100})]
[(('G', 38), {})]
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
