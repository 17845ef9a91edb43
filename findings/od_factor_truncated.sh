#!/usr/bin/env bash
# durand 0.5.0 sends a value one increment short where an object has a factor.
#
# An object of 32 bits has the factor 0.001, so that one increment is 1 µm, and the device writes 0.043 mm to it. The guess: a
# client reads 43. What comes: 42, since 0.043 / 0.001 is just below 43 as a double and is cut, not rounded. Of the
# thousand values from 0.001 to 1 mm 126 are wrong, while the device itself reads back what it wrote.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check durand==0.5.0 python-can==4.6.1
cd "$work"
cat >try.py <<'PYTHON'
from durand import Node, Variable, set_scheduler
from durand.datatypes import DatatypeEnum
from durand.network import NetworkABC
from durand.node import NodeCapabilities
from durand.scheduler import VirtualScheduler


class Line(NetworkABC):
    """Passes a frame to who waits for it, and keeps the last one that the node sends."""

    def __init__(self):
        self.waiting = {}
        self.last = b""

    def add_subscription(self, cob_id, callback):
        self.waiting[cob_id] = callback

    def remove_subscription(self, cob_id):
        del self.waiting[cob_id]

    def send(self, cob_id, msg):
        self.last = msg

    def receive(self, cob_id, data):
        self.waiting[cob_id](cob_id, data)


set_scheduler(VirtualScheduler())
line = Line()
node = Node(line, 5, capabilities=NodeCapabilities(1, 0, 0))
node.object_dictionary[0x6064] = Variable(DatatypeEnum.INTEGER32, "ro", 0, factor=0.001, name="Position actual value")
wrong = []
for increments in range(1, 1001):
    node.object_dictionary.write(0x6064, 0, increments / 1000)
    line.receive(0x605, bytes.fromhex("4064600000000000"))  # SDO upload of 6064:0
    came = int.from_bytes(line.last[4:8], "little", signed=True)
    if came != increments:
        wrong.append((node.object_dictionary.read(0x6064, 0), came))
print(len(wrong), wrong[0], {came - round(1000 * value) for value, came in wrong})
PYTHON
cat >expected <<'TEXT'
126 (0.043, 42) {-1}
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
