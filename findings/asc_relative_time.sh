#!/usr/bin/env bash
# python-can 4.6.1 reads an ASC log with "timestamps relative" as if its times were absolute.
#
# In this form each line has the time since the line before (Vector writes it on request). The guess: the
# reader adds them up, as its reading of the header suggests. What comes: each frame has its own difference
# as its time, so that time goes back where a pause is shorter than the one before.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check python-can==4.6.1
cd "$work"
cat >relative.asc <<'FILE'
date Sat Nov 28 10:00:00.000 am 2026
base hex  timestamps relative
no internal events logged
   0.010000 1  181             Rx   d 2 01 02
   0.010000 1  182             Rx   d 2 01 02
   0.001000 1  183             Rx   d 2 01 02
FILE
cat >try.py <<'PYTHON'
import can

print([message.timestamp for message in can.LogReader("relative.asc")])
PYTHON
cat >expected <<'TEXT'
[0.01, 0.01, 0.001]
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
