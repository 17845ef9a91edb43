#!/usr/bin/env bash
# ezstdf 0.0.3 takes a byte for each half byte of a multiple-result record, so that the measured values behind them come from the wrong place.
#
# A tester (STDF version 4) measures four supplies and three offsets at once, each in a multiple-result parametric record: the states that came back are half bytes, two in a byte, the first in
# the low half (the type N of the specification, jxN*1), and the results follow. The guess: states 1 2 3 4 and 1 2 3, results as written, limits and unit behind them.
# What comes: as many bytes as states are read, so that the results start two bytes and one byte too late: 2.5 V is 2.3e-41, without a word; the name loses its first letters and the limits are
# NaN. A record without states is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check ezstdf==0.0.3 pandas==2.3.3 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
import struct

from ezstdf.StdfReader import StdfReader


def record(kind, sub, body):
    return struct.pack("<HBB", len(body), kind, sub) + body


def text(word):
    return bytes([len(word)]) + word.encode()


def results(number, states, values, name, low, high):
    """A multiple-result parametric record (15, 15): head and site 1, states in half bytes, values, texts, scales and limits."""
    halves = [*states, 0] if len(states) % 2 else states
    packed = bytes(first | second << 4 for first, second in zip(halves[::2], halves[1::2]))
    body = struct.pack("<I4BHH", number, 1, 1, 0, 0, len(states), len(values)) + packed + struct.pack(f"<{len(values)}f", *values)
    body += text(name) + text("") + struct.pack("<Bbbb4f", 0x0E, 0, 0, 0, low, high, 0.0, 0.0) + struct.pack(f"<{len(states)}H", *range(1, len(states) + 1))
    return record(15, 15, body + text("V"))


with open("run.stdf", "wb") as file:
    file.write(record(0, 10, bytes([2, 4])))  # little endian, version 4
    file.write(results(100, [], [2.5, 3.25], "plain", 2.0, 4.0))
    file.write(results(101, [1, 2, 3, 4], [2.5, 3.25, 5.0, 1.75], "supplies", 1.0, 6.0))
    file.write(results(102, [1, 2, 3], [0.5, -0.5, 0.25], "offsets", -1.0, 1.0))
reader = StdfReader()
reader.parse_file("run.stdf")
for _, row in reader.mpr.iterrows():
    shown = " ".join(f"{value:.3g}" for value in row.RTN_RSLT)
    print(f"{row.TEST_NUM}: states {row.RTN_STAT}, results {shown}, name {row.TEST_TXT!r}, limits {row.LO_LIMIT:.3g} to {row.HI_LIMIT:.3g}")
PYTHON
cat >expected <<'TEXT'
100: states [], results 2.5 3.25, name 'plain', limits 2 to 4
101: states [33, 67, 0, 0], results 2.3e-41 2.31e-41 2.32e-41 1.08e+31, name 'pplies\x0e?@\x01\x02\x03\x04\x01V', limits nan to nan
102: states [33, 3, 0], results 5.79e-39 1.75e-38 1.43e-34, name 'ffsets\x0e?\x01\x02\x03\x01V', limits nan to nan
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
