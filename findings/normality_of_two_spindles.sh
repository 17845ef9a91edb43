#!/usr/bin/env bash
# cpistats 0.1.1 finds parts of two spindles the less normal the more they are, until 5000 of them are normal with a p-value of infinity.
#
# A bore is made by two spindles whose means lie ten standard deviations apart, and the Anderson-Darling test is to tell that this is no normal distribution. The guess: a statistic of some
# ten and above gives a p-value of practically zero, the smaller the more parts (D'Agostino and Stephens, 1986, table 4.9, the formula for the p-value, which holds up
# to a statistic of about 13). What comes: the exponent of the formula is a parabola, and turns at a statistic of 153: from about 1700 parts the p-value grows again,
# passes 0.05 between 3300 and 3400, and is infinite at 5000. A p-value above 1 is not refused.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check cpistats==0.1.1 numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 matplotlib==3.11.2
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
from cpistats import anderson_darling_normality

for count in (100, 1000, 1500, 2000, 3000, 3300, 3400, 5000):
    parts = 20 + 0.002 * np.random.default_rng(1).standard_normal(count)
    parts[::2] += 0.02
    with np.errstate(over="ignore"):
        result = anderson_darling_normality(parts)
    print(f"{count} parts: statistic {result.statistic_adjusted:.1f}, p-value {result.p_value:.1e}, normal at a level of 5 %: {bool(result.p_value > 0.05)}")
PYTHON
cat >expected <<'TEXT'
100 parts: statistic 10.5, p-value 2.4e-25, normal at a level of 5 %: False
1000 parts: statistic 92.5, p-value 2.3e-160, normal at a level of 5 %: False
1500 parts: statistic 136.6, p-value 4.0e-188, normal at a level of 5 %: False
2000 parts: statistic 182.3, p-value 1.1e-183, normal at a level of 5 %: False
3000 parts: statistic 276.1, p-value 7.7e-69, normal at a level of 5 %: False
3300 parts: statistic 304.4, p-value 2.5e-06, normal at a level of 5 %: False
3400 parts: statistic 312.8, p-value 3.0e+15, normal at a level of 5 %: True
5000 parts: statistic 459.5, p-value inf, normal at a level of 5 %: True
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
