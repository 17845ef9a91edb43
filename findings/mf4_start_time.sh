#!/usr/bin/env bash
# python-can 4.6.1 starts an MF4 at the instant at which it is written, so that an older log has negative times.
#
# A log of 14 November 2023 is written anew as MF4, as can_logconvert does it. The guess: the file starts with its first
# message, as the BLF of the same messages does, and that message is at 0 s. What comes: the header has the time of the
# conversion, and asammdf 8.8.28 shows each message by years before 0 s; the BLF, read by vblf 0.3.1, starts in 2023 at 0 ns.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check python-can==4.6.1 asammdf==8.8.28 vblf==0.3.1
cd "$work"
cat >old.log <<'LOG'
(1700000000.250000) can0 181#0100
(1700000000.251000) can0 181#0200
LOG
for kind in blf mf4; do
  venv/bin/python -m can.logconvert old.log "old.$kind" >log 2>&1 || { cat log; exit 2; }
done
cat >try.py <<'PYTHON'
import time

from asammdf import MDF
from vblf.reader import BlfReader

with BlfReader("old.blf") as log:
    start = log.file_statistics.measurement_start_time
    print("BLF", start.year, start.month, start.day, [round(one.header.object_time_stamp, -5) for one in log])
with MDF("old.mf4") as log:
    first, second = log.get("CAN_DataFrame.ID").timestamps.tolist()
    print("MF4 starts now", abs(log.start_time.timestamp() - time.time()) < 86400)
    print("years before its start", (second - first) < 0.002 and first < -3 * 365 * 86400)
PYTHON
cat >expected <<'TEXT'
BLF 2023 11 14 [0, 1000000]
MF4 starts now True
years before its start True
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
