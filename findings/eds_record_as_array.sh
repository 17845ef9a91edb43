#!/usr/bin/env bash
# durand 0.5.0 writes an EDS in which records are arrays, arrays are records, and sub-index 10 is 16.
#
# A node has a record with sub-indices 1, 2 and 10, and an array. The guess: ObjectType 9 for the record and 8 for the array
# (CiA 301, object codes), and a section 2000subA for sub-index 10, which is hexadecimal (CiA 306). What comes: the two codes are
# exchanged, and the section is 2000sub10. canopen 2.4.1 reads it as an array with a sub-index 16, so that it makes up
# sub-index 10, an INTEGER32, as an UNSIGNED8.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check durand==0.5.0 canopen==2.4.1 python-can==4.6.1
cd "$work"
cat >try.py <<'PYTHON'
import can
import canopen
from canopen.objectdictionary import datatypes
from durand import Array, CANBusNetwork, Node, Record, Variable, set_scheduler
from durand.datatypes import DatatypeEnum
from durand.node import NodeCapabilities
from durand.scheduler import VirtualScheduler

set_scheduler(VirtualScheduler())
slave = can.Bus("line", interface="virtual")
node = Node(CANBusNetwork(slave), 5, capabilities=NodeCapabilities(1, 0, 0))
settings = Record("Settings")
settings[1] = Variable(DatatypeEnum.UNSIGNED8, "rw", 3, name="Mode")
settings[2] = Variable(DatatypeEnum.INTEGER16, "rw", -2, name="Torque")
settings[10] = Variable(DatatypeEnum.INTEGER32, "rw", -3, name="Offset")
node.object_dictionary[0x2000] = settings
node.object_dictionary[0x2001] = Array(Variable(DatatypeEnum.INTEGER16, "rw", 1, name="Point"), 3, name="Points")
with open("node.eds", "w") as file:
    file.write(node.eds.content)
node.network.stop()
slave.shutdown()
read = canopen.import_od("node.eds", 5)
for index in (0x2000, 0x2001):
    print(hex(index), type(read[index]).__name__, list(read[index]))
print(hex(read[0x2000][10].data_type), hex(datatypes.UNSIGNED8), hex(datatypes.INTEGER32))
PYTHON
cat >expected <<'TEXT'
0x2000 ODArray [0, 1, 2, 16]
0x2001 ODRecord [0, 1, 2, 3]
0x5 0x5 0x4
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
