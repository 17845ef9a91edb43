#!/usr/bin/env bash
# spc-toolbox 0.1.2 multiplies the mean range by d2 instead of dividing by it, and gives each sample of a p-chart limits of its own making.
#
# A bore varies by 2.0 um, 50 samples of 5 are measured; and of parts, 100 a day, 4 % are refused, but none on day 4 and 15 on day 9. The guess: sigma is the mean range by d2 = 2.326, near to
# 2 um, also from the standard deviations (ISO 7870-2, estimates by range and by standard deviation); the limits of the share are one pair, as all samples are equally large:
# 0.044 +- 3 sqrt(0.044 0.956 / 100). What comes: a sigma of 10.3 um by the ranges, 5.4 times as large, while the limits of the means are right, and none by the standard deviations,
# as c4 is not in its table; the chart of standard deviations is refused likewise. The limits of a share come from the share of the day itself: the day without a refused part is
# out of control as both its limits are the mean, the day of 15 is not. A moving range of three values skips the one between.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check spc-toolbox==0.1.2 numpy==1.26.4 pandas==2.3.3 matplotlib==3.11.2
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
import pandas as pd
from spc_toolbox import MRChart, PChart, RChart, SChart, XBarChart

samples = pd.DataFrame(20000 + 2 * np.random.default_rng(7).standard_normal((50, 5))).round(1)
ranges = samples.max(axis=1) - samples.min(axis=1)
print(f"mean range {ranges.mean():.2f} um: sigma by d2 {ranges.mean() / 2.326:.2f} um, by all values {samples.stack().std():.2f} um")
for name, chart, how in (("means", XBarChart, {"dispersion_type": "range"}), ("ranges", RChart, {}), ("means", XBarChart, {"dispersion_type": "std_dev"}), ("deviations", SChart, {})):
    try:
        fitted = chart().fit(samples.index, samples, axis=1, **how)
    except ValueError as error:
        print(f"chart of {name}, {how}: {error}")
    else:
        half = (fitted.upper_control_limit - fitted.center_line)[0]
        print(f"chart of {name}, {how}: sigma {fitted.sigma:.2f} um, upper limit {half:.2f} um above the mean")
refused = pd.Series([4, 3, 5, 4, 0, 6, 4, 3, 4, 15, 4, 5, 3, 4, 2])
size = pd.Series([100] * len(refused))
chart = PChart().fit(refused.index, refused, size)
mean = refused.sum() / size.sum()
print(f"share {mean:.4f}: limits {mean - 3 * np.sqrt(mean * (1 - mean) / 100):.4f} and {mean + 3 * np.sqrt(mean * (1 - mean) / 100):.4f}")
for day in (1, 4, 9):
    low, share, high = chart.lower_control_limit[day], chart.y[day], chart.upper_control_limit[day]
    print(f"day {day}: share {share:.2f}, limits {low:.4f} and {high:.4f}, within: {bool(low <= share <= high)}")
print("moving range of 3 of 0, 9, 0, 9, 0:", MRChart().fit(pd.RangeIndex(5), pd.Series([0.0, 9.0, 0.0, 9.0, 0.0]), n=3).y.tolist())
PYTHON
cat >expected <<'TEXT'
mean range 4.41 um: sigma by d2 1.90 um, by all values 1.81 um
chart of means, {'dispersion_type': 'range'}: sigma 10.26 um, upper limit 2.54 um above the mean
chart of ranges, {}: sigma 10.26 um, upper limit 4.91 um above the mean
chart of means, {'dispersion_type': 'std_dev'}: Invalid chart constant 'c4'.
chart of deviations, {}: Invalid chart constant 'c4'.
share 0.0440: limits -0.0175 and 0.1055
day 1: share 0.03, limits 0.0000 and 0.0952, within: True
day 4: share 0.00, limits 0.0440 and 0.0440, within: False
day 9: share 0.15, limits 0.0000 and 0.1511, within: True
moving range of 3 of 0, 9, 0, 9, 0: [nan, nan, 0.0, 0.0, 0.0]
TEXT
MPLBACKEND=Agg MPLCONFIGDIR="$work" venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
