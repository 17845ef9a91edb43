#!/usr/bin/env bash
# asammdf 8.8.28 makes all named values of a signal NaN as soon as one value without a name comes.
#
# A DBC names values 6 and 8 of a mode; a bus log has the modes 6, 6, 8, 8 or, with one more that has no name, 6, 6, 9, 8. The
# guess: extract_bus_logging gives the names, and 9 for the value without one, as cantools 45.1.0 does. What comes: the
# names with the first log, but NaN, NaN, 9, NaN with the second: one frame takes the modes before and after it out of
# values, data frame and CSV.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check asammdf==8.8.28 python-can==4.6.1 canmatrix==1.2 cantools==45.1.0
cd "$work"
cat >mode.dbc <<'FILE'
VERSION ""

NS_ :

BS_:

BU_: drive

BO_ 389 TPDO1: 1 drive
 SG_ mode : 0|8@1- (1,0) [-128|127] "" Vector__XXX

VAL_ 389 mode 0 "no mode" 6 "homing" 8 "cyclic position" ;
FILE
cat >try.py <<'PYTHON'
import can
import cantools
from asammdf import MDF

names = cantools.database.load_file("mode.dbc")
for modes in ((6, 6, 8, 8), (6, 6, 9, 8)):
    with can.io.MF4Writer("bus.mf4") as log:
        for number, mode in enumerate(modes):
            log.on_message_received(
                can.Message(timestamp=1.7e9 + 0.01 * number, arbitration_id=0x185, is_extended_id=False, data=[mode])
            )
    with MDF("bus.mf4") as log, log.extract_bus_logging({"CAN": [("mode.dbc", 0)]}) as signals:
        print(*modes, "asammdf ", signals.get("mode").samples.tolist())
    print(*modes, "cantools", [str(names.decode_message(0x185, bytes([mode]))["mode"]) for mode in modes])
PYTHON
cat >expected <<'TEXT'
6 6 8 8 asammdf  [b'homing', b'homing', b'cyclic position', b'cyclic position']
6 6 8 8 cantools ['homing', 'homing', 'cyclic position', 'cyclic position']
6 6 9 8 asammdf  [nan, nan, 9.0, nan]
6 6 9 8 cantools ['homing', 'homing', '9', 'cyclic position']
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
