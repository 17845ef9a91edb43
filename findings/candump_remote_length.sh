#!/usr/bin/env bash
# python-can 4.6.1 loses the length of a remote frame where it writes a candump log.
#
# A remote frame of CAN has a DLC: that of the frame which it asks for (CANopen node guarding asks for 1 byte).
# can-utils write it behind the R: 701#R1. The guess: CanutilsLogWriter does so too, since its reader takes the
# digit. What comes: the writer leaves it out, and what it has written comes back with a length of 0.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check python-can==4.6.1
cd "$work"
cat >try.py <<'PYTHON'
import can

guard = can.Message(arbitration_id=0x701, is_extended_id=False, is_remote_frame=True, dlc=1, channel="can0")
with can.Logger("written.log") as writer:
    writer.on_message_received(guard)
print(open("written.log").read().split()[-2:])
open("given.log", "w").write("(1.000000) can0 701#R1 R\n")
for name in ("written.log", "given.log"):
    print(name, [message.dlc for message in can.LogReader(name)])
PYTHON
cat >expected <<'TEXT'
['701#R', 'R']
written.log [0]
given.log [1]
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
