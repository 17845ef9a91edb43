#!/usr/bin/env bash
# deming 0.1.3 draws the limits of a control chart one standard deviation from the mean, so that a steady process is out of control.
#
# A gauge block is measured 200 times, with a normal scatter of 1 um and nothing else. The guess: limits of about 3 um on either side and none or one reading outside, for those of individuals
# are three standard deviations by the moving range, 2.66 times its mean (Shewhart; ISO 7870-2, individuals). What comes: limits of 1 um, and 62 readings outside. The
# deviation is that of all readings, so that a drift of 10 um widens its own limits to 3 um. The chart is drawn from columns that are written into the table
# of the caller: its own column Mean, if it has one, is gone.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check deming==0.1.3 pandas==3.1.1
cd "$work"
cat >try.py <<'PYTHON'
import deming
import numpy as np
import pandas as pd

for name, drift in (("steady", 0.0), ("drift of 10 um", 10.0)):
    readings = np.random.default_rng(1).normal(0.0, 1.0, 200) + np.linspace(0.0, drift, 200)
    table = pd.DataFrame({"number": range(200), "um": readings, "Mean": "set by the caller"})
    deming.control_chart_img_buffer(table, "number", "um")
    half = table["Upper Control Limit"][0] - table["um"].mean()
    outside = (abs(table["um"] - table["um"].mean()) > half).sum()
    by_range = 2.66 * np.abs(np.diff(readings)).mean()
    beyond = (abs(readings - readings.mean()) > by_range).sum()
    print(f"{name}: limits at {half:.2f} um, {outside} readings outside; by the moving range {by_range:.2f} um, {beyond} outside")
print("column Mean kept:", (table["Mean"] == "set by the caller").all())
PYTHON
cat >expected <<'TEXT'
steady: limits at 0.93 um, 62 readings outside; by the moving range 2.85 um, 1 outside
drift of 10 um: limits at 3.04 um, 79 readings outside; by the moving range 2.85 um, 86 outside
column Mean kept: False
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
