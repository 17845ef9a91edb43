#!/usr/bin/env bash
# python-can 4.6.1 reads one class of error frames of a candump log, and takes the others for data.
#
# can-utils write an error frame as an identifier with the error flag and its class: 20000080 is a bus error, 20000004
# a problem of the controller (Linux, can/error.h). The guess: each is an error frame, on the interface of its line.
# What comes: the bus error is one, without a channel; the other one is a data frame of the extended
# identifier 4 with 8 bytes.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check python-can==4.6.1
cd "$work"
cat >given.log <<'FILE'
(1.000000) can1 20000080#0000000000000000
(1.100000) can1 20000004#0010000000000000
(1.200000) can1 701#05
FILE
cat >try.py <<'PYTHON'
import can

for message in can.LogReader("given.log"):
    kind = "error" if message.is_error_frame else f"data 0x{message.arbitration_id:X}"
    print(message.channel, kind, "extended" if message.is_extended_id else "standard", message.dlc)
PYTHON
cat >expected <<'TEXT'
None error extended 0
can1 data 0x4 extended 8
can1 data 0x701 standard 1
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
