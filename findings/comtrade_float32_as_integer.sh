#!/usr/bin/env bash
# comtrade-io 0.3.0 reads the numbers of a FLOAT32 file as integers of 32 bits.
#
# FLOAT32 has the samples of analog channels as IEEE 754 single precision (IEC 60255-24:2013, data file); the page of the package
# names the format as one that it reads and writes. The guess: 1.5 mm is read as 1.5 mm, as comtrade 0.2.0 does. What comes: 1069547520 mm, the bits
# of the float taken for a number. BINARY32 is right.
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
1000,3
11/11/2026,10:00:00.000000
11/11/2026,10:00:00.000000
{format}
1
0,0
0,0
"""


def file(name, numbers, code):
    open(f"{name}.cfg", "w", newline="").write(CFG.format(format=name).replace("\n", "\r\n"))
    open(f"{name}.dat", "wb").write(b"".join(struct.pack("<II" + code, at + 1, 1000 * at, one) for at, one in enumerate(numbers)))
    return ComtradeFile.from_file(f"{name}.cfg")


def positions(log):
    return [f"{one:.10g}" for one in log.get_data().iloc[:, 2]]


print("BINARY32 3 -4 5:", *positions(file("BINARY32", [3, -4, 5], "i")))
print("FLOAT32 1.5 -0.25 3:", *positions(file("FLOAT32", [1.5, -0.25, 3.0], "f")))
print("the same file, comtrade 0.2.0:", *(f"{one:.10g}" for one in comtrade.load("FLOAT32.cfg", "FLOAT32.dat").analog[0]))
PYTHON
cat >expected <<'TEXT'
BINARY32 3 -4 5: 3 -4 5
FLOAT32 1.5 -0.25 3: 1069547520 -1098907648 1077936128
the same file, comtrade 0.2.0: 1.5 -0.25 3
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
