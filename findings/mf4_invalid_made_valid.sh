#!/usr/bin/env bash
# mdfr 0.7.3 makes invalid samples of an MF4 valid when it writes the file again.
#
# An MF4 has a channel whose second and fourth sample have their invalidation bit set. The guess: mdfr marks or drops them, and
# a file that it writes without any change has the bits too. What comes: its array has the six numbers without a mark, and asammdf
# 8.8.28 and mf4-rs 3.7.0, which drop or mark the two in the first file, take all six of the second for good.
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

file = MDF(version="4.10")
bad = np.array([0, 1, 0, 1, 0, 0], dtype=bool)
file.append([Signal(np.arange(1.0, 7.0), np.arange(6) * 0.001, name="probe", unit="mm", invalidation_bits=bad)])
file.save("measured.mf4")
file.close()
arrow = mdfr.Mdfr("measured.mf4")
arrow.load_all_channels_data_in_memory()
print("mdfr in memory", arrow.get_channel_data("probe").tolist())
arrow.write("again.mf4", mdfr.CompressionAlgorithm.NoCompression)
for name in ("measured.mf4", "again.mf4"):
    with MDF(name) as read:
        print(name, "asammdf", read.get("probe").samples.tolist())
    print(name, "mf4-rs ", [float(value) for value in mf4_rs.Mdf(name).values("probe")])
PYTHON
cat >expected <<'TEXT'
mdfr in memory [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
measured.mf4 asammdf [1.0, 3.0, 5.0, 6.0]
measured.mf4 mf4-rs  [1.0, nan, 3.0, nan, 5.0, 6.0]
again.mf4 asammdf [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
again.mf4 mf4-rs  [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
