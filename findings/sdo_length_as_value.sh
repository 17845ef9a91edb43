#!/usr/bin/env bash
# uc2canopen 0.2.3 reads an object of eight bytes as the number 8, and takes the answer of another drive for that of the one it asked.
#
# A drive, made with canopen 2.4.1, has a status word of 16 bits, a position of 32 and one of 64 bits, and a name; another drive on the bus answers another master. The guess: what fits in
# four bytes is read, what does not is refused, for the package has expedited transfers only, and calls these fully compliant; an answer belongs to the node and the object that were
# asked for (CiA 301, SDO upload: with e = 0 the four bytes are the length of what follows; each server has its own COB-ID). What comes: 8 for the position of 64 bits, 13 for
# the name, whose length that is. An answer of node 5 about the object 2001h is the value of the object 6064h of node 2, and the confirmation of a write is a position
# of 0: nothing but an abort is told apart.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check uc2canopen==0.2.3 python-can==4.6.1 canopen==2.4.1
cd "$work"
cat >try.py <<'PYTHON'
import struct

import can
import canopen
from canopen.objectdictionary import INTEGER32, INTEGER64, UNSIGNED16, VISIBLE_STRING, ObjectDictionary, ODVariable
from uc2canopen.sdo import SdoClient

OBJECTS = {0x6041: (UNSIGNED16, 0x0637), 0x6064: (INTEGER32, -25000), 0x2064: (INTEGER64, -25000), 0x1008: (VISIBLE_STRING, "Axis X of rig")}
dictionary = ObjectDictionary()
for index, (kind, value) in OBJECTS.items():
    variable = ODVariable(f"object {index:04x}", index)
    variable.data_type, variable.default, variable.access_type = kind, value, "ro"
    dictionary.add_object(variable)
network = canopen.Network()
network.connect(interface="virtual", channel="rig")
network.add_node(canopen.LocalNode(2, dictionary))

with can.Bus(interface="virtual", channel="rig") as bus:
    client = SdoClient(bus)
    notifier = can.Notifier(bus, [client])
    for index, read in ((0x6041, client.read_u16), (0x6064, client.read_i32), (0x2064, client.read_i32), (0x1008, client.read_u32)):
        print(f"{index:04X}h, {OBJECTS[index][1]}: read as {read(2, index, 0)}")
    notifier.stop()
network.disconnect()


class Busy:
    """A bus on which another answer is there before that of the drive that was asked."""

    def __init__(self, identifier, data):
        self.answer = can.Message(arbitration_id=identifier, data=data, is_extended_id=False)

    def send(self, frame):
        self.client.on_message_received(self.answer)


for name, identifier, data in (
    ("node 5 about 2001h", 0x585, struct.pack("<BHBi", 0x43, 0x2001, 1, 777)),
    ("node 2 about 6041h", 0x582, struct.pack("<BHBi", 0x4B, 0x6041, 0, 0x0637)),
    ("node 2 after a write", 0x582, struct.pack("<BHBi", 0x60, 0x6040, 0, 0)),
):
    bus = Busy(identifier, data)
    bus.client = SdoClient(bus)
    print(f"6064h of node 2, while {name} answers: read as {bus.client.read_i32(2, 0x6064, 0)}")
PYTHON
cat >expected <<'TEXT'
6041h, 1591: read as 1591
6064h, -25000: read as -25000
2064h, -25000: read as 8
1008h, Axis X of rig: read as 13
6064h of node 2, while node 5 about 2001h answers: read as 777
6064h of node 2, while node 2 about 6041h answers: read as 1591
6064h of node 2, while node 2 after a write answers: read as 0
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
