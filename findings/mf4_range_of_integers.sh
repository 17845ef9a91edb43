#!/usr/bin/env bash
# asammdf 8.8.28 takes a range of integers in an MF4 for its upper limit alone, and goes beyond the last one.
#
# A conversion of ranges gives raw values -2 to 0 the value 11, 1 to 2 the value 22, and others 99; limits of integers
# belong to their range (MDF 4.1, value range to value tabular look-up). The guess: 11 11 11 22 22 99 for -2 to 3. What comes: 99
# 99 11 99 22 22. The same numbers as doubles are right, and mdfr 0.7.3 and mf4-rs 3.7.0 read both right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check asammdf==8.8.28 mdfr==0.7.3 mf4-rs==3.7.0
cd "$work"
cat >try.py <<'PYTHON'
import mdfr
import mf4_rs
import numpy as np
from asammdf import MDF, Signal
from asammdf.blocks.v4_blocks import ChannelConversion
from asammdf.blocks.v4_constants import CONVERSION_TYPE_RTAB

# Doubles: the upper limit belongs to the range above
limits = {"integer": (-2.0, 0.0, 1.0, 2.0), "double": (-2.0, 1.0, 1.0, 3.0)}
raw = {"integer": np.arange(-2, 4, dtype=np.int16), "double": np.arange(-2.0, 4.0)}
file = MDF(version="4.10")
for name, (lower, upper, next_lower, next_upper) in limits.items():
    ranges = ChannelConversion(
        conversion_type=CONVERSION_TYPE_RTAB, val_param_nr=7, default=99.0,
        lower_0=lower, upper_0=upper, phys_0=11.0, lower_1=next_lower, upper_1=next_upper, phys_1=22.0,
    )
    file.append([Signal(raw[name], np.arange(6) * 0.001, name=name, conversion=ranges)])
file.save("run.mf4")
file.close()
read = MDF("run.mf4")
arrow = mdfr.Mdfr("run.mf4")
arrow.load_all_channels_data_in_memory()
arrow.convert_all_channels()
rust = mf4_rs.Mdf("run.mf4")
for name in limits:
    values = {
        "asammdf": read.get(name).samples,
        "mdfr": arrow.get_channel_data(name),
        "mf4_rs": rust.values(name),
    }
    for tool, read_by in values.items():
        print(name, tool, *(int(value) for value in read_by))
PYTHON
cat >expected <<'TEXT'
integer asammdf 99 99 11 99 22 22
integer mdfr 11 11 11 22 22 99
integer mf4_rs 11 11 11 22 22 99
double asammdf 11 11 11 22 22 99
double mdfr 11 11 11 22 22 99
double mf4_rs 11 11 11 22 22 99
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
