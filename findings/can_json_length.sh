#!/usr/bin/env bash
# canmatrix 1.3.3 writes a JSON from which a frame of six bytes comes back with eight, and without units.
#
# A frame of 6 bytes with a position in mm is written as JSON by default options. The guess: what is read again is what
# was written. What comes: the length 8, and no unit; start, size, sign and factor are kept.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check canmatrix==1.3.3
cd "$work"
cat >try.py <<'PYTHON'
import canmatrix.formats
from canmatrix import ArbitrationId, CanMatrix, Ecu, Frame, Signal

matrix = CanMatrix()
matrix.add_ecu(Ecu("drive"))
frame = Frame("TPDO1", size=6, arbitration_id=ArbitrationId(0x185, extended=False), transmitters=["drive"])
frame.add_signal(Signal("position", start_bit=16, size=32, is_little_endian=True, is_signed=True, factor=0.001, unit="mm"))
matrix.add_frame(frame)
for kind in ("dbc", "json"):
    canmatrix.formats.dumpp({"": matrix}, f"bus.{kind}")
    (read,) = canmatrix.formats.loadp(f"bus.{kind}").values()
    (signal,) = read.frames[0].signals
    print(kind, read.frames[0].size, signal.start_bit, signal.size, signal.is_signed, float(signal.factor), repr(signal.unit))
PYTHON
cat >expected <<'TEXT'
dbc 6 16 32 True 0.001 'mm'
json 8 16 32 True 0.001 ''
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
