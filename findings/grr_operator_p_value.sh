#!/usr/bin/env bash
# GageRnR 0.8.0 gives an obvious effect of the operator the p-value 1.
#
# Three operators measure five parts twice. Each operator is 0.1 beside the one before, on every part alike, and
# a measurement repeats to 0.05: by hand F = 20 against the repeatability. The guess: a p-value near 0. What
# comes: operators are compared with the interaction, whose mean square is a rounding below 0, so that F is
# negative and its p-value 1. The variances are right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check GageRnR==0.8.0
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
from GageRnR import Component, GageRnR, Result

values = np.zeros((3, 5, 2))  # operators, parts, repeats
for operator in range(3):
    for part in range(5):
        values[operator, part] = part + 0.1 * operator + np.array([-0.05, 0.05])
study = GageRnR(values)
result = study.calculate()
print(round(float(result[Result.Var][Component.OPERATOR]), 6), round(float(result[Result.Var][Component.PART]), 6))
print(float(result[Result.F][Component.OPERATOR]) < 0.0, float(result[Result.P][Component.OPERATOR]))
PYTHON
cat >expected <<'TEXT'
0.01 2.5
True 1.0
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
