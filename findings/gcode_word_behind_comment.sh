#!/usr/bin/env bash
# gcodeparser 0.3.0 drops the words behind a comment in brackets.
#
# A comment in brackets may stand between the words of a block (RS274/NGC). The guess: X, F and Y are read. What comes:
# X and F; the motion of Y is lost without a message. A comment at the end does no harm.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check gcodeparser==0.3.0
cd "$work"
cat >try.py <<'PYTHON'
from gcodeparser import parse_gcode_lines

for block in ("G1 X10 F300 Y3 (approach)", "G1 X10 F300 (approach) Y3"):
    print([line.params for line in parse_gcode_lines(block)])
PYTHON
cat >expected <<'TEXT'
[{'X': 10, 'F': 300, 'Y': 3}]
[{'X': 10, 'F': 300}]
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
