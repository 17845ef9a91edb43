#!/usr/bin/env bash
# canopen-monitor 4.1.0 finds no name for an emergency that has one, and gives the name of another to one that has none.
#
# A drive that has lost its master sends the emergency 8130 (life guard or heartbeat error), one whose frames get lost 8110 (CAN overrun). The code goes
# with its lowest byte first: 30 81 and 10 81 (CiA 301, emergency object and encoding rules). The guess: the names of the table that the package has for
# them. What comes: "Error code not found", and so for 1000 and 8210; the names come for the two bytes the other way round, so that 3081, which is a voltage
# by its first digit and special to the device by the rest, is shown as the lost heartbeat. Only 0000 is the same in both ways.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check canopen-monitor==4.1.0
cd "$work"
cat >try.py <<'PYTHON'
from canopen_monitor.can import Message
from canopen_monitor.parse import CANOpenParser

parser = CANOpenParser({})
for code, register in ((0x8130, 0x11), (0x8110, 0x11), (0x1000, 0x01), (0x8210, 0x11), (0x3081, 0x05), (0x0000, 0x00)):
    data = code.to_bytes(2, "little") + bytes([register]) + bytes(5)
    print(f"{code:04X} as 085#{data.hex().upper()}:", parser.parse(Message(0x085, data=list(data)))[0])
PYTHON
cat >expected <<'TEXT'
8130 as 085#3081110000000000: Error code not found
8110 as 085#1081110000000000: Error code not found
1000 as 085#0010010000000000: Error code not found
8210 as 085#1082110000000000: Error code not found
3081 as 085#8130050000000000: Life guard error on heartbeat error
0000 as 085#0000000000000000: Error reset or no error
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
