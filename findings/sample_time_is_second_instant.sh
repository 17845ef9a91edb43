#!/usr/bin/env bash
# pytcs 0.2.2 takes the second instant of a TwinCAT Scope export for its sample time, and drops the sample time that the file gives.
#
# An export of a position each 2 ms is cut so that it starts at 5 ms: 5, 7, 9. By the tool's own word older exports give the sample time in the line `SampleTime` (legacy), others in
# `SampleTime[ms]`, and it reads both. The guess: 2 ms in each form, or 2 ms from the difference where the file has no such line.
# What comes: 2 ms from the newer line only; 7 ms from the older one and from none, which is the time of the second row. A speed by that
# sample time is less than a third of the true one. Where an export starts at 0 nothing is seen; the time column itself is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pytcs==0.2.2 polars==2.1.0 pandas==3.1.1 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
from io import StringIO

from pytcs import ScopeFile

HEAD = """Name\tAxis
File\taxis.tcscopex
Starttime of export\t133000000000000000\t18.06.2022
Endtime of export\t133000000000100000\t18.06.2022

Name\tposition
Data-Type\tREAL64
"""
for first in (0, 5):
    rows = "".join(f"{first + 2 * step},0\t{step},25\n" for step in range(3))
    for line in ("", "SampleTime\t2\n", "SampleTime[ms]\t2\n"):
        scope = ScopeFile(StringIO(HEAD + line + "\n" + rows + "EOF\n"))
        (channel,) = scope.values()
        scope.load()
        print(f"{line.strip() or 'no line'!r}, times {channel.time.tolist()}: sample time {channel.sample_time} ms")
PYTHON
cat >expected <<'TEXT'
'no line', times [0.0, 2.0, 4.0]: sample time 2.0 ms
'SampleTime\t2', times [0.0, 2.0, 4.0]: sample time 2.0 ms
'SampleTime[ms]\t2', times [0.0, 2.0, 4.0]: sample time 2.0 ms
'no line', times [5.0, 7.0, 9.0]: sample time 7.0 ms
'SampleTime\t2', times [5.0, 7.0, 9.0]: sample time 7.0 ms
'SampleTime[ms]\t2', times [5.0, 7.0, 9.0]: sample time 2.0 ms
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
