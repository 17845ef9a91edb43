#!/usr/bin/env bash
# mopyregtest 0.6.0 passes a simulation that became NaN, and finds two exact ramps different because it interpolates by the number of a row.
#
# Results of an axis are compared with a reference, to 1e-6: the same, a false one, one that is NaN from 0.5 s on, and a ramp v = t that a solver wrote at other times than the
# reference. The guess: the false one and NaN are refused, the ramp is passed if "interpolate" is asked for, which is to be linear, for a straight line between samples of a ramp is the
# ramp. What comes: NaN passes, with every metric of the package, because a difference that is NaN is not above the tolerance; a model whose solver broke down is a
# green test. The ramp is refused: a row that is missing gets the mean of its neighbours, wherever its time lies between them. With equal steps it is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check mopyregtest==0.6.0 numpy==2.4.6 pandas==3.1.1
cd "$work"
cat >try.py <<'PYTHON'
import contextlib
import io

from mopyregtest import RegressionTest, metrics

REFERENCE = (0.0, 0.25, 0.5, 0.75, 1.0)
RESULTS = {
    "the same": [(time, time) for time in REFERENCE],
    "false at 0.75 s": [(time, time + 0.01 * (time == 0.75)) for time in REFERENCE],
    "NaN from 0.5 s on": [(time, "nan" if time >= 0.5 else time) for time in REFERENCE],
    "halves of the steps": [(0.125 * step, 0.125 * step) for step in range(9)],
    "other times": [(time, time) for time in (0.0, 0.125, 1.0)],
}


def passes(metric):
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            RegressionTest.compare_csv_files("reference.csv", "result.csv", tol=1e-6, metric=metric, fill_in_method="interpolate", write_comparison=False)
    except AssertionError:
        return "refused"
    return "passed"


def write(name, rows):
    with open(name, "w") as file:
        file.write("time,v\n" + "".join(f"{time},{value}\n" for time, value in rows))


write("reference.csv", [(time, time) for time in REFERENCE])
for name, rows in RESULTS.items():
    write("result.csv", rows)
    shown = {metric.__name__: passes(metric) for metric in (metrics.norm_infty_dist, metrics.Lp_dist, metrics.abs_dist_ptwise)}
    print(f"{name}:", *(f"{key} {value}" for key, value in shown.items()))
PYTHON
cat >expected <<'TEXT'
the same: norm_infty_dist passed Lp_dist passed abs_dist_ptwise passed
false at 0.75 s: norm_infty_dist refused Lp_dist refused abs_dist_ptwise refused
NaN from 0.5 s on: norm_infty_dist passed Lp_dist passed abs_dist_ptwise passed
halves of the steps: norm_infty_dist passed Lp_dist passed abs_dist_ptwise passed
other times: norm_infty_dist refused Lp_dist refused abs_dist_ptwise refused
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
