#!/usr/bin/env bash
# comtrade-io 0.3.0 writes the month before the day, and reads its own file back as another day.
#
# Since C37.111-1999 the date is day/month/year; month/day/year is that of 1991. The guess: a file that says 2013 in its first line is written again as
# it was read. What comes: the start 05/11/2026, 5 November, is written as 11/05/2026 under the same 2013, and all readers, its own too, take it
# for 11 May. From the 13th of a month on comtrade 0.2.0 refuses the file and comtrade-io reads the right day. Units that it does not know
# are gone: position has no mm any more.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check comtrade-io==0.3.0 comtrade==0.2.0
cd "$work"
cat >try.py <<'PYTHON'
import struct

import comtrade
from comtrade_io.parser.comtrade_file import ComtradeFile

CFG = """BENCH,R,2013
1,1A,0D
1,position,,,mm,1,0,0,-1000,1000,1,1,P
50
1
1000,2
05/11/2026,10:00:00.000000
05/11/2026,10:00:00.000000
BINARY
1
0,0
0,0
"""
open("log.cfg", "w", newline="").write(CFG.replace("\n", "\r\n"))
open("log.dat", "wb").write(b"".join(struct.pack("<IIh", at + 1, 1000 * at, 7) for at in range(2)))
log = ComtradeFile.from_file("log.cfg")
log.save_comtrade("again.cfg", data_format="BINARY")
for name in ("log", "again"):
    lines = open(f"{name}.cfg").read().split("\n")
    read = comtrade.load(f"{name}.cfg", f"{name}.dat")
    print(f"{name}: revision {lines[0].split(',')[2]}, date {lines[6].split(',')[0]}, unit {lines[2].split(',')[4]!r}")
    print(f"    comtrade {read.start_timestamp:%d %B}, comtrade-io {ComtradeFile.from_file(f'{name}.cfg').start_time:%d %B}")
PYTHON
cat >expected <<'TEXT'
log: revision 2013, date 05/11/2026, unit 'mm'
    comtrade 05 November, comtrade-io 05 November
again: revision 2013, date 11/05/2026, unit ''
    comtrade 11 May, comtrade-io 11 May
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
