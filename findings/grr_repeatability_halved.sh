#!/usr/bin/env bash
# qualistics 0.1.0 states about half of the repeatability of a gauge when each part is measured twice.
#
# Two operators measure each part twice, and the two readings are always 2 apart: the variance of two such readings is 2, and pooled over all parts
# it is 2 (repeatability is the mean square within the cells, AIAG MSA). The guess: 2.0000, as in Minitab, whose table it says to be like.
# What comes: 1.07 with four parts, and it goes to 1 with more: the residuals are divided by one less than all readings, not by the readings less the cells.
# With three trials it is 2/3.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pandas==3.1.1
"$work/venv/bin/pip" install --quiet --disable-pip-version-check --no-deps qualistics==0.1.0
cd "$work"
cat >try.py <<'PYTHON'
import statistics

import pandas
from qualistics.gauge import gauge_rr

for parts in (4, 10, 100):
    rows = [
        {"Part": part, "Operator": operator, "Measurement": 100 + part + reading, "Randomised Order": 0}
        for operator in ("A", "B")
        for part in range(parts)
        for reading in (-1.0, 1.0)
    ]
    table = gauge_rr(pandas.DataFrame(rows)).set_index("Source")["Variance"]
    found = table["      Repeatability (Instrument)"]
    print(f"{parts} parts: repeatability {found}, of each pair {statistics.variance([-1.0, 1.0]):.4f}")
PYTHON
cat >expected <<'TEXT'
4 parts: repeatability 1.0667, of each pair 2.0000
10 parts: repeatability 1.0256, of each pair 2.0000
100 parts: repeatability 1.0025, of each pair 2.0000
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
