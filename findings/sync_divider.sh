#!/usr/bin/env bash
# durand 0.5.0 sends a TPDO of transmission type 4 once each fourth SYNC, but only the first time.
#
# Types 1 to 240 send a TPDO after each n-th SYNC (CiA 301, transmission type). The guess: with 4 it comes after SYNC 4, 8 and
# 12. What comes: after 4, and then after each SYNC, so that the node loads the bus with four times of what it was
# configured to send. Type 1 is right.
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
    """Passes a frame to who waits for it, and keeps what the node sends."""

    def __init__(self):
        self.waiting = {}
        self.sent = []

    def add_subscription(self, cob_id, callback):
        self.waiting[cob_id] = callback

    def remove_subscription(self, cob_id):
        del self.waiting[cob_id]

    def send(self, cob_id, msg):
        self.sent.append(cob_id)

    def receive(self, cob_id, data=b""):
        self.waiting[cob_id](cob_id, data)


set_scheduler(VirtualScheduler())
for kind in (1, 4):
    line = Line()
    node = Node(line, 5, capabilities=NodeCapabilities(1, 4, 4))
    node.object_dictionary[0x6064] = Variable(DatatypeEnum.INTEGER32, "ro", 0, name="Position actual value")
    node.tpdo[0].mapping = [(0x6064, 0)]
    node.tpdo[0].transmission_type = kind
    line.receive(0x000, bytes((1, 5)))  # start of node 5
    answered = []
    for number in range(1, 13):
        line.sent.clear()
        line.receive(0x080)
        answered += [number] * line.sent.count(0x185)
    print(f"type {kind}:", *answered)
PYTHON
cat >expected <<'TEXT'
type 1: 1 2 3 4 5 6 7 8 9 10 11 12
type 4: 4 5 6 7 8 9 10 11 12
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
