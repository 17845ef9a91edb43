#!/usr/bin/env bash
# pyuff 2.5.8 writes a measured record in the binary form of dataset 58, and its last sample comes back at another instant.
#
# The universal file format carries records of force and vibration from analyser to analysis; binary datasets 58 hold their
# values as IEEE doubles. The guess: what is stored in binary comes back to the bit, times too. What comes: the values are equal
# to the bit, and evenly spaced times are not stored; their distance stands in a line of text with six digits. 1/48000 s loses
# 1.6e-6 of itself, 1/51200 s (1.953125e-5, seven digits) 2.6e-6 the other way: after two seconds the last sample stands 3.2 us early or
# 5.1 us late. Times that are declared uneven are written one by one and come back as they were.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyuff==2.5.8
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
import pyuff

BOTH = {
    "type": 58, "func_type": 1, "binary": 1, "rsp_node": 1, "rsp_dir": 1, "ref_node": 0, "ref_dir": 0,
    "rsp_ent_name": "Z", "ref_ent_name": "NONE", "id1": "force", "abscissa_spec_data_type": 17,
    "ordinate_spec_data_type": 13, "orddenom_spec_data_type": 0,
}
for rate_hz in (48_000, 51_200):
    for is_even in (1, 0):
        times_s = np.arange(2 * rate_hz) / rate_hz
        record = np.sin(1000 * times_s)
        name = f"{rate_hz}-{is_even}.uff"
        pyuff.UFF(name).write_sets({**BOTH, "x": times_s, "data": record, "abscissa_spacing": is_even}, "add")
        read = pyuff.UFF(name).read_sets(0)
        late_us = (read["x"][-1] - times_s[-1]) * 1e6
        same = np.array_equal(read["data"], record)
        kind = "even" if is_even else "uneven"
        print(f"{rate_hz} Hz, {kind}: ordinates equal {same}, last time off by {late_us:.2f} us")
PYTHON
cat >expected <<'TEXT'
48000 Hz, even: ordinates equal True, last time off by -3.20 us
48000 Hz, uneven: ordinates equal True, last time off by 0.00 us
51200 Hz, even: ordinates equal True, last time off by 5.12 us
51200 Hz, uneven: ordinates equal True, last time off by 0.00 us
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
