#!/usr/bin/env bash
# comtrade 0.2.0 gives a missing sample of a FLOAT32 file as a value of -3.4e38.
#
# A sample that is missing has a value of its own in each format: 0x8000 in BINARY, 0x80000000 in BINARY32, and in FLOAT32 the largest
# negative one, 0xFF7FFFFF (IEC 60255-24:2013, data file). The page of the package lists these and promises NaN. The guess: NaN in all three.
# What comes: NaN in both formats of integers; in FLOAT32 the value itself, times the factor of the channel, without a word: any
# minimum, mean or fit of the channel is then that of the gap.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check comtrade==0.2.0
cd "$work"
cat >try.py <<'PYTHON'
import struct

import comtrade

CFG = """BENCH,R,2013
1,1A,0D
1,position,,,mm,0.5,0,0,-1000,1000,1,1,P
50
1
1000,3
28/11/2026,10:00:00.000000
28/11/2026,10:00:00.000000
{format}
1
0,0
0,0
"""
for name, code, missing in (("BINARY", "<h", b"\x00\x80"), ("BINARY32", "<i", b"\x00\x00\x00\x80"), ("FLOAT32", "<f", b"\xff\xff\x7f\xff")):
    samples = [struct.pack(code, 3), missing, struct.pack(code, 5)]
    open("log.cfg", "w", newline="").write(CFG.format(format=name).replace("\n", "\r\n"))
    open("log.dat", "wb").write(b"".join(struct.pack("<II", at + 1, 1000 * at) + one for at, one in enumerate(samples)))
    print(name, *(f"{value:.6g}" for value in comtrade.load("log.cfg", "log.dat").analog[0]))
PYTHON
cat >expected <<'TEXT'
BINARY 1.5 nan 2.5
BINARY32 1.5 nan 2.5
FLOAT32 1.5 -1.70141e+38 2.5
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
