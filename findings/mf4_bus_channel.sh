#!/usr/bin/env bash
# python-can 4.6.1 counts buses from 1 in a BLF and from 0 in an MF4; asammdf 8.8.28 cannot choose bus 0.
#
# Two buses have a frame with the same identifier, and both logs are written from the same messages. The guess: a tool that
# asks for one bus gets that bus, from either file. What comes: vblf 0.3.1 reads channels 1 and 2 from the BLF. In the MF4 they
# are 0 and 1, and 0 means any bus to asammdf: asked for bus 0 it mixes both, and the first bus cannot be had alone.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check python-can==4.6.1 asammdf==8.8.28 vblf==0.3.1
cd "$work"
cat >position.dbc <<'DBC'
VERSION ""
NS_ :
BS_:
BU_: drive
BO_ 385 TPDO1: 2 drive
 SG_ position : 0|16@1+ (1,0) [0|65535] "" drive
DBC
cat >try.py <<'PYTHON'
import can
from asammdf import MDF
from vblf.reader import BlfReader

messages = [
    can.Message(timestamp=index * 0.001, arbitration_id=385, is_extended_id=False, data=[10 * (index % 2 + 1), 0], channel=index % 2)
    for index in range(4)
]
for name in ("log.blf", "log.mf4"):
    with can.Logger(name) as log:
        for message in messages:
            log(message)
with BlfReader("log.blf") as log:
    print("BLF", [(one.channel, one.data[0]) for one in log])
with MDF("log.mf4") as log:
    print("MF4", list(zip(log.get("CAN_DataFrame.BusChannel").samples.tolist(), log.get("CAN_DataFrame.DataBytes").samples[:, 0].tolist())))
    for bus in (0, 1, 2):
        found = log.extract_bus_logging({"CAN": [("position.dbc", bus)]})
        print("asammdf, bus", bus, [value for group in found.iter_groups() for value in group["position"].tolist()] if "position" in found else [])
PYTHON
cat >expected <<'TEXT'
BLF [(1, 10), (2, 20), (1, 10), (2, 20)]
MF4 [(0, 10), (1, 20), (0, 10), (1, 20)]
asammdf, bus 0 [10, 10, 20, 20]
asammdf, bus 1 [20, 20]
asammdf, bus 2 []
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
