#!/usr/bin/env bash
# verity-x3p 0.2.0 takes a point that was not measured for a measured height of zero, if an X3P holds integers.
#
# A surface at 10 mm lacks one point. A file of floating-point heights marks it by NaN; integers have no such number, so that a
# file of integers lists its valid points beside them (ISO 25178-72, ValidPointsLink). The guess: the mask of the surface has a gap in both.
# What comes: with integers the mask is full and the point is at 0, a pit of 10 mm; what verity-x3p writes again has it for good. x3pio
# 2.0.0, which wrote both files, reads the gap in both.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check verity-x3p==0.2.0 x3pio==2.0.0 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
import subprocess
import numpy as np
import verity_x3p
import x3pio

heights_m = np.array([[10.000, 10.001, 10.002], [10.003, np.nan, 10.005]]) * 1e-3
about = x3pio.Metadata(
    creator="a", instrument=x3pio.Instrument("A", "B", "1", "1"),
    probing_system=x3pio.ProbingSystem(x3pio.ProbingType.NON_CONTACTING, "a"),
)
x3pio.write("float64.x3p", heights_m, x_scale=1e-6, y_scale=1e-6, metadata=about)
subprocess.run(["venv/bin/x3pio", "convert", "-t", "int32", "float64.x3p", "int32.x3p"], check=True)
for name in ("float64", "int32"):
    read = verity_x3p.read_x3p(f"{name}.x3p")
    verity_x3p.write_x3p(read, "again.x3p", z_type="D")
    for tool, mm in (
        ("x3pio     ", x3pio.read(f"{name}.x3p").layers[0].z * 1e3),
        ("verity-x3p", read.data * 1e3),
        ("again     ", x3pio.read("again.x3p").layers[0].z * 1e3),
    ):
        print(name, tool, *(f"{value:.3f}" for value in mm[1]), "mm")
    print(name, "mask of verity-x3p", *read.mask[1])
PYTHON
cat >expected <<'TEXT'
float64 x3pio      10.003 nan 10.005 mm
float64 verity-x3p 10.003 nan 10.005 mm
float64 again      10.003 nan 10.005 mm
float64 mask of verity-x3p True False True
int32 x3pio      10.003 nan 10.005 mm
int32 verity-x3p 10.003 0.000 10.005 mm
int32 again      10.003 0.000 10.005 mm
int32 mask of verity-x3p True True True
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
