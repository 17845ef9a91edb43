#!/usr/bin/env bash
# GaugeRnR 0.6.0 divides the interaction of operator and part by the number of parts instead of that of the trials.
#
# Two operators measure four parts twice, and each operator is 0.5 off on two of the parts. By hand the interaction has the mean square
# 4/3 and the repeatability 0.02, so that its variance is (4/3 - 0.02) / 2 trials = 0.657 (AIAG MSA and Montgomery, which the page of the package
# names). The guess: 0.657. What comes: half of it, for it is divided by the four parts; with ten parts and two trials it is a
# fifth. The gauge looks better by that, and without a word. The mean squares, F and p are right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check GaugeRnR==0.6.0
cd "$work"
cat >try.py <<'PYTHON'
import numpy
from GaugeRnR import Component, GaugeRnR, Result


def show(parts):
    readings = numpy.zeros((2, parts, 2))
    for operator in range(2):
        for part in range(parts):
            off = 0.5 if (operator + part) % 2 else -0.5
            readings[operator, part] = 10 + part + off + numpy.array([-0.1, 0.1])
    result = GaugeRnR(readings).calculate()
    name = Component.OPERATOR_BY_PART
    mean_square, error = result[Result.MS][name], result[Result.MS][Component.MEASUREMENT]
    print(
        f"{parts} parts: mean squares {mean_square:.4f} and {error:.4f}, variance {result[Result.Var][name]:.4f},",
        f"by hand {(4 * parts * 0.25 / (parts - 1) - 0.02) / 2:.4f}",
    )


show(4)
show(10)
PYTHON
cat >expected <<'TEXT'
4 parts: mean squares 1.3333 and 0.0200, variance 0.3283, by hand 0.6567
10 parts: mean squares 1.1111 and 0.0200, variance 0.1091, by hand 0.5456
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
