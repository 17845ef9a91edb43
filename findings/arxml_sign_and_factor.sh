#!/usr/bin/env bash
# canmatrix 1.3.3 writes an ARXML in which a signed position in 0.001 mm is an unsigned number in mm.
#
# A frame with one signal of 32 bits, signed, factor 0.001, unit mm, is written as ARXML. The guess: the same signal when
# the file is read again. What comes: canmatrix reads it without sign and with factor 1, the unit is still mm, so that
# -3145.728 mm is 4291821568 mm; cantools 45.1.0 refuses the file, since its base types have no encoding. The same frame
# as DBC is right in both.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check canmatrix==1.3.3 cantools==45.1.0 lxml==6.1.3
cd "$work"
cat >try.py <<'PYTHON'
import canmatrix.formats
import cantools
from canmatrix import ArbitrationId, CanMatrix, Ecu, Frame, Signal

matrix = CanMatrix()
matrix.add_ecu(Ecu("drive"))
frame = Frame("TPDO1", size=4, arbitration_id=ArbitrationId(0x185, extended=False), transmitters=["drive"])
frame.add_signal(Signal("position", start_bit=0, size=32, is_little_endian=True, is_signed=True, factor=0.001, unit="mm"))
matrix.add_frame(frame)
for kind in ("dbc", "arxml"):
    canmatrix.formats.dumpp({"": matrix}, f"bus.{kind}")
    (read,) = canmatrix.formats.loadp(f"bus.{kind}").values()
    (signal,) = read.frames[0].signals
    print(kind, "canmatrix:", "signed" if signal.is_signed else "unsigned", float(signal.factor), signal.unit)
    try:
        (message,) = cantools.database.load_file(f"bus.{kind}").messages
        print(kind, "cantools:", message.decode((-3145728).to_bytes(4, "little", signed=True)))
    except cantools.database.UnsupportedDatabaseFormatError as error:
        print(kind, "cantools:", error)
PYTHON
cat >expected <<'TEXT'
dbc canmatrix: signed 0.001 mm
dbc cantools: {'position': -3145.728}
arxml canmatrix: unsigned 1.0 mm
arxml cantools: ARXML: "BASE-TYPE-ENCODING in base type "sint32" does not exist."
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
