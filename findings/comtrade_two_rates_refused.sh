#!/usr/bin/env bash
# comtraderecord 1.0.2 refuses a file of 2013 and one of two sampling rates, and gives uniform times to samples that have times of their own.
#
# A move is recorded at 1 kHz, from the contact on at 10 kHz. The configuration says so in two lines, or in none, so that the time stamps of the data hold (C37.111-1999, nrates); since 2013 it ends
# with two lines about the time zone. The guess: all three are read, each sample at its time. What comes: KeyError 'time_code' for 2013 and for two rates, of which only one line is read.
# Without a rate the distance of the first two samples counts for all, so that the last of them, 5 ms after the start, is at 14 ms. What its own writer writes
# is a year that no standard has, 2010; a sample late; a digital channel is counted but not written; and a channel at rest
# ends with a ValueError.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check comtraderecord==1.0.2 comtrade==0.2.0 numpy==2.4.6 pandas==3.1.1
cd "$work"
cat >try.py <<'PYTHON'
import comtrade
import numpy as np
from comtraderecord import comtradeWriter, pyComtrade

UNIFORM = [1000 * at for at in range(15)]
UNEVEN = [1000 * at for at in range(5)] + [4000 + 100 * at for at in range(1, 11)]


def show(name, year, rates, stamps, tail=""):
    start = "05/11/2026,10:00:00.000000\n"
    channels = "2,1A,1D\n1,position,,,mm,0.001,0,0,-32767,32767,1,1,P\n1,contact,,,0\n50\n"
    open("log.cfg", "w").write(f"BENCH,R,{year}\n{channels}{rates}\n{start}{start}ASCII\n1\n{tail}")
    open("log.dat", "w").write("".join(f"{at + 1},{us},{us // 10},{int(us > 4000)}\n" for at, us in enumerate(stamps)))
    other = comtrade.load("log.cfg", "log.dat")
    print(f"{name}: last stamp {stamps[-1] / 1000:.1f} ms, comtrade {1000 * other.time[-1]:.1f} ms, comtraderecord", end=" ")
    try:
        read = pyComtrade.ComtradeFile("log.cfg")
        print(f"{1000 * read.getTime()[-1]:.1f} ms, position {read.getAnalogData('position')[-1]:.1f} mm")
    except KeyError as error:
        print("KeyError", error)


show("1999, one rate", 1999, "1\n1000,15", UNIFORM)
show("2013, one rate", 2013, "1\n1000,15", UNIFORM, "0,0\n0,0\n")
show("1999, two rates", 1999, "2\n1000,5\n10000,15", UNEVEN)
show("1999, stamps", 1999, "0\n0,15", UNEVEN)
comtradeWriter("own", [np.array([0.0, 1, 2, 3, 4]), np.array([0, 0, 1, 1, 1])], 1000, 50, 1).createFile()
lines = open("own.cfg").read().split("\n")
print(f"own file: year {lines[0].split(',')[2]}, channels {lines[1]}, then {lines[2].count(',')} commas and {lines[3]!r}")
print("own data:", *(row.strip() for row in open("own.dat").read().split("\n")[:2]))
try:
    comtradeWriter("own", [np.array([0.0, 1, 2]), np.array([2.5, 2.5, 2.5])], 1000, 50).createFile()
except ValueError as error:
    print("channel at rest: ValueError", error)
PYTHON
cat >expected <<'TEXT'
1999, one rate: last stamp 14.0 ms, comtrade 14.0 ms, comtraderecord 14.0 ms, position 1.4 mm
2013, one rate: last stamp 14.0 ms, comtrade 14.0 ms, comtraderecord KeyError 'time_code'
1999, two rates: last stamp 5.0 ms, comtrade 5.0 ms, comtraderecord KeyError 'time_code'
1999, stamps: last stamp 5.0 ms, comtrade 5.0 ms, comtraderecord 14.0 ms, position 0.5 mm
own file: year 2010, channels 2,1A,1D, then 12 commas and '50'
own data: 1,1000,-99999 2,2000,-49999
channel at rest: ValueError cannot convert float NaN to integer
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
