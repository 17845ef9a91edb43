#!/usr/bin/env bash
# python-can 4.6.1 gives a frame another channel after a way through its own TRC file.
#
# The guess: what TRCWriter writes, TRCReader reads as it was. What comes: a frame of channel 2 comes back as
# one of channel 3, since the writer counts from 1 and the reader takes the number as it is. Its ASC, BLF and
# MF4 files keep the number.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check python-can==4.6.1 asammdf==8.8.24
cd "$work"
cat >try.py <<'PYTHON'
import can

frame = can.Message(arbitration_id=0x181, data=[1, 2], is_extended_id=False, channel=2, timestamp=1.0)
for name in ("a.trc", "a.asc", "a.blf", "a.mf4"):
    with can.Logger(name) as writer:
        writer.on_message_received(frame)
    (back,) = can.LogReader(name)
    print(name, back.channel)
PYTHON
cat >expected <<'TEXT'
a.trc 3
a.asc 2
a.blf 2
a.mf4 2
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
