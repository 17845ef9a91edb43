#!/usr/bin/env bash
# npTDMS 1.13.0 writes times of nanoseconds to the microsecond, and these a nanosecond too early.
#
# A TDMS file keeps a time as seconds and a fraction of 64 bits, and npTDMS takes arrays of datetime64[ns]. The
# guess: the nanoseconds of a latch survive when the file is read with raw_timestamps=True. What comes: they
# are cut to whole microseconds when they are written, and the fraction is rounded down on top.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check nptdms==1.13.0
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
from nptdms import ChannelObject, TdmsFile, TdmsWriter

times = np.array(["2026-11-28T10:00:00.123456789", "2026-11-28T10:00:00.000000500"], dtype="datetime64[ns]")
with TdmsWriter("latches.tdms") as writer:
    writer.write_segment([ChannelObject("probe", "edge", times)])
read = TdmsFile.read("latches.tdms", raw_timestamps=True)["probe"]["edge"][:]
print([str(time) for time in read.as_datetime64("ns")])
PYTHON
cat >expected <<'TEXT'
['2026-11-28T10:00:00.123455999', '2026-11-28T10:00:00.000000000']
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
