#!/usr/bin/env bash
# cmm-measurement-parser 1.1.0 finds 171 % of a tolerance used by a bore that passes, and 48 % by one that fails, if the tolerance is not symmetric.
#
# A coordinate measuring machine reports five bores of 20 H7, tolerance 0 to +0.021 mm, and a length of 50 +-0.1 mm. The guess: a bore in the middle of its tolerance uses 0 % of it, one
# at a limit 100 %, one beyond more than 100 %, so that share and status agree; or 0 to 100 % from limit to limit (a tolerance zone lies where its limits are, ISO 286-1; the package
# calls the column the percentage of the tolerance used). What comes: the deviation from the nominal size over half of the width. The middle uses 100 %, the largest good bore 200 %, a
# bore of nominal size, at its lower limit, 0 %, and one that is too small 47.62 %, with FAIL. A list by share puts the scrap below the good parts. Symmetric tolerances are right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check cmm-measurement-parser==1.1.0 numpy==2.4.6 pandas==3.1.1
cd "$work"
cat >try.py <<'PYTHON'
import contextlib
import io

import cmm_measurement_parser as cmm

CIRCLE, DISTANCE = "\u5186(\u6700\u5c0f\u4e8c\u4e57\u6cd5)", "2D\u8ddd\u96e2"
POINTS, INSIDE = "\u70b9\u6570", "\u5185\u5074"


def report():
    for number, deviation in enumerate((-0.005, 0.0, 0.0105, 0.018, 0.021), 1):
        yield f"bore-{number} {CIRCLE} {POINTS} (8) {INSIDE}"
        yield f"{number} D {20 + deviation:.4f} 20.0000 0.0210 0.0000 {deviation:.4f}"
        yield "=" * 40
    for number, deviation in enumerate((0.05, 0.12), 6):
        yield f"length-{number} {DISTANCE} {POINTS} (2)"
        yield f"{number} X {50 + deviation:.4f} 50.0000 0.1000 -0.1000 {deviation:.4f}"
        yield "=" * 40


with contextlib.redirect_stdout(io.StringIO()):
    table = cmm.parse_cmm_data(list(report()), use_japanese_columns=False)
for row in table.itertuples():
    limits = f"{row.lower_tolerance:+.3f} to {row.upper_tolerance:+.3f}"
    print(f"{row.element_name}, {limits}: {row.calculated_deviation:+.4f} mm, {row.status}, {row.tolerance_utilization:.2f} % used")
PYTHON
cat >expected <<'TEXT'
bore-1, +0.000 to +0.021: -0.0050 mm, FAIL, 47.62 % used
bore-2, +0.000 to +0.021: +0.0000 mm, PASS, 0.00 % used
bore-3, +0.000 to +0.021: +0.0105 mm, PASS, 100.00 % used
bore-4, +0.000 to +0.021: +0.0180 mm, PASS, 171.43 % used
bore-5, +0.000 to +0.021: +0.0210 mm, PASS, 200.00 % used
length-6, -0.100 to +0.100: +0.0500 mm, PASS, 50.00 % used
length-7, -0.100 to +0.100: +0.1200 mm, FAIL, 120.00 % used
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
